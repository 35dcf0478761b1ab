"""Searches of pinheiro2013: the gains of (21), (22) that a run reads, certifies and simulates."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from gainsay.errors import ComputationError
from gainsay.tables import Case
from gainsay.tables.designs import FoundDesign
from papers.pinheiro2013 import conditions as mixed
from papers.pinheiro2013 import statements
from papers.pinheiro2013.plant import RECONSTRUCTIONS, GeneralizedPlant, generalized_plant, reconstruction
from papers.pinheiro2013.synthesis import LEVELS, SEPARATE, best, gain_of

#: how far two methods may lie apart before neither is believed
AGREE, AGREE_GAIN = 1e-5, 1e-4


def least_trace_gain(plant: GeneralizedPlant, gamma: float) -> tuple[np.ndarray, float]:
    """Gain of the least trace of Q at a level, to rounding, and the root of that trace.

    The program is convex and its gain is found twice: by the LMI to the root of its gap, and from there by the
    stationary point of the trace that the Riccati equation gives for a gain.

    Raises
    ------
    ComputationError
        If the two differ by more than `AGREE` in the trace or `AGREE_GAIN` in the gain.
    """
    design = best(plant, gamma)
    K = gain_of(design, plant, gamma)
    polished, other = mixed.mixed_by_descent(plant, gamma, K)
    apart = np.abs(polished - K).max() / np.abs(K).max()
    if abs(other / np.sqrt(design.value) - 1) > AGREE or apart > AGREE_GAIN:
        raise ComputationError("(21)", f"descent over the gains finds {other!r}, {polished.tolist()}")
    return polished, other


def _design(gains: Mapping[str, np.ndarray], traces: Mapping[str, float], asked: str) -> FoundDesign:
    return FoundDesign(
        asked=asked,
        method="LMI (21) with the sign corrected, then the stationary point of its trace over the gains",
        matrices=gains,
        converged=True,
        outcome={f"sqrt_trace_{group}": value for group, value in traces.items()},
        digits=15,
    )


def mixed_design(case: Case, name: str, level: str) -> FoundDesign:
    """Least trace of Q under (21) with the sign corrected at a level of the paper."""
    satellite, gamma = reconstruction(case, name), case.number(LEVELS[level])
    gains, traces = {}, {}
    for group in SEPARATE:
        gains[group], traces[group] = least_trace_gain(generalized_plant(satellite, group), gamma)
    K = np.zeros((3, 6))
    K[np.ix_([1], [1, 4])] = gains["pitch"]
    K[np.ix_([0, 2], [0, 2, 3, 5])] = gains["roll_yaw"]
    matrices = {"K": K, "K_pitch": gains["pitch"], "K_roll_yaw": gains["roll_yaw"]}
    return _design(matrices, traces, f"least trace of Q under (21) at gamma = {gamma:g}, reconstruction {name.upper()}")


def near_limit(case: Case, name: str) -> FoundDesign:
    """Least trace of Q just above the infimum of the level, where the gains forget the weights."""
    satellite = reconstruction(case, name)
    gains, traces = {}, {}
    for group in SEPARATE:
        plant = generalized_plant(satellite, group)
        gains[f"K_{group}"], traces[group] = least_trace_gain(plant, mixed.ABOVE * mixed.gamma_min(plant))
    asked = f"least trace of Q under (21) at {mixed.ABOVE} of the infimum of the level, reconstruction {name.upper()}"
    return _design(gains, traces, asked)


def limit(case: Case, name: str, group: str) -> FoundDesign:
    """The closed-form gain that reaches the infimum of the level."""
    plant = generalized_plant(reconstruction(case, name), group)
    return FoundDesign(
        asked=f"a gain whose norm is the infimum of the level, {group}, reconstruction {name.upper()}",
        method="closed form: stiffness and damping that make the squared response largest at infinite frequency",
        matrices={"K": mixed.limit_gain(plant)},
        converged=True,
        outcome={"gamma_min": mixed.gamma_min(plant)},
        digits=15,
    )


SEARCHES = {
    **{
        f"{name}_{statements.GAMMAS[level]}": partial(mixed_design, name=name, level=level)
        for name in RECONSTRUCTIONS
        for level in LEVELS
    },
    **{f"{name}_near_limit": partial(near_limit, name=name) for name in RECONSTRUCTIONS},
    **{
        f"{name}_limit_{group}": partial(limit, name=name, group=group)
        for name in RECONSTRUCTIONS
        for group in SEPARATE
    },
}

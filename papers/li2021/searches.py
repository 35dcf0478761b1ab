"""Searches of li2021: designs and the levels at which certificates are made; a run reads what they leave.

A design comes from smooth minimisation (`searches_smooth`), which is not convex: another processor may end
elsewhere. The trade-off is built up from the narrowest wish to the widest, each point starting from the printed gains
and from the best narrower point, and keeping the best that meets its wish: more room allowed never reaches less.
"""

from collections.abc import Mapping
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from gainsay.errors import ComputationError
from gainsay.lmi import Infeasible, Solved
from gainsay.systems.norms import hinf_norm
from gainsay.tables import Case
from gainsay.tables.designs import FoundDesign, rounded
from papers.li2021 import conditions_arcs as arcs
from papers.li2021 import conditions_robust as robust
from papers.li2021 import plant
from papers.li2021 import searches_smooth as design
from papers.li2021.proofs import lemma_3
from papers.li2021.statements import TABLES

DIGITS = 12
#: shares of the limits of disk and norm found in floating point at which the certificate is made
ROOM, ROOM_OF_NORM, ROOM_OF_ONE = 0.998, 0.992, 0.995
#: the same for the points of the trade-off, whose proofs cost a third with a little more room
ROOM_OF_POINTS = 0.97
#: points of the trade-off, narrower wishes first: bounds on static gain and disk, gain variations asked one by one
TRADE_OFF: dict[str, tuple[dict[str, float], tuple[float, ...]]] = {
    "tradeoff_3": ({"static_gain": 1.0}, (0.05, 0.09, 0.11)),
    "tradeoff_5": ({"static_gain": 1.2, "disk_radius": 0.8}, (0.05, 0.09, 0.11)),
    "tradeoff_4": ({"static_gain": 1.2}, (0.06, 0.1, 0.12)),
    "tradeoff_1": ({"static_gain": 1.5}, (0.06, 0.12, 0.14)),
    "tradeoff_2": ({"static_gain": 3.0}, (0.06, 0.12, 0.15)),
}
#: part of a bound that the search asks for, so that what a penalty leaves over still meets the bound
INSIDE = 0.997
#: the band of lambda is enclosed to this relative width
BAND = 1e-3


class Limits(NamedTuple):
    """Gain variations up to which disk (constant) and norm hold."""

    disk: float
    norm: float

    @property
    def both(self) -> float:
        """The smaller of the two."""
        return min(self.disk, self.norm)


def limits(case: Case, gains: plant.Gains) -> Limits:
    """Gain variations up to which disk (constant) and norm hold, in floating point."""
    k, gamma = plant.constants(case), case.number("gamma") * 0.9995

    def form(delta: float) -> robust.Loop:
        return robust.loop(k, gains, delta).balanced()

    disk, _ = arcs.largest_delta(form, case.number("disk_centre"), case.number("disk_radius"), 0.005, 0.4)
    norm = brentq(lambda delta: robust.norm_scaling(form(delta), gamma)[0] - 1, 0.005, 0.4, xtol=1e-5)
    return Limits(disk, float(norm))


def limit_of_one_matrix(case: Case, gains: plant.Gains, high: float) -> float:
    """Gain variation, at most high, up to which one scaling does for the whole circle, in floating point."""
    circle = -case.number("disk_centre") + case.number("disk_radius") * np.exp(1j * np.linspace(0, np.pi, 181))

    def shared(delta: float) -> float:
        loop = robust.loop(plant.constants(case), gains, delta).balanced()
        return robust.shared_scaling(np.array([loop.response(z) for z in circle]))[0] - 1

    return float(brentq(shared, 0.002, high, xtol=1e-5))


def inside(reach: Limits) -> float:
    """Gain variation just inside both limits."""
    return min(ROOM * reach.disk, ROOM_OF_NORM * reach.norm)


def point_level(reach: Limits) -> dict[str, np.ndarray]:
    """Level at which a point of the trade-off is to be certified, by arcs."""
    return {"level": np.array([[float(f"{ROOM_OF_POINTS * reach.both:.4g}")]])}


def levels(case: Case, gains: plant.Gains, reach: Limits) -> dict[str, np.ndarray]:
    """Levels at which the requirements are to be certified: by arcs, and with one quadratic function for the disk."""
    single = min(limit_of_one_matrix(case, gains, reach.disk), reach.both)
    return {
        "level": np.array([[float(f"{inside(reach):.4g}")]]),
        "level_quadratic": np.array([[float(f"{ROOM_OF_ONE * single:.4g}")]]),
    }


def measures(case: Case, gains: plant.Gains) -> dict[str, float]:
    """Static gain, norm and disk radius of (10), and the abscissa of the flexible loop."""
    nominal = plant.rigid(plant.constants(case))
    loop, B, C = plant.closed_loop(nominal, gains), np.vstack([nominal.B, np.zeros((6, 3))]), np.eye(3, 12)
    flexible = plant.closed_loop(plant.flexible(plant.constants(case)), gains)
    return {
        "static_gain": float(np.linalg.norm(C @ np.linalg.solve(loop, B), 2)),
        "norm": float(hinf_norm(loop, B, C)[0]),
        "disk_radius": float(np.abs(np.linalg.eigvals(loop) + case.number("disk_centre")).max()),
        "flexible_abscissa": float(np.linalg.eigvals(flexible).real.max()),
    }


def improved(case: Case, gains: plant.Gains, wishes: design.Wishes) -> design.Improved:
    """Gains of `searches_smooth.improve`, rounded to the digits of the design."""
    disk = (case.number("disk_centre"), case.number("disk_radius"))
    k = plant.constants(case)
    constant = plant.disturbance(case, k) @ np.array([1.0, 0.0, 1.0])
    outcome = design.improve(k, gains, wishes, disk, case.matrix("x0").ravel(), constant)
    return design.Improved(
        design.unpack(rounded(design.pack(outcome.gains), DIGITS)),
        outcome.converged,
        outcome.iterations,
        outcome.evaluations,
    )


def _design(
    case: Case,
    gains: plant.Gains,
    reach: Limits,
    level: Mapping[str, np.ndarray],
    *,
    asked: str,
    method: str,
    converged: bool,
    effort: Mapping[str, int],
) -> FoundDesign:
    return FoundDesign(
        asked=asked,
        method=method,
        matrices={"A": gains.A, "B": gains.B, "C": gains.C, **level},
        converged=converged,
        outcome={"limit_disk": reach.disk, "limit_norm": reach.norm, **measures(case, gains)},
        effort=effort,
        seed=0,
        digits=DIGITS,
    )


def repaired(case: Case) -> FoundDesign:
    """Gains a little better than what the audit finds for the printed ones on the measures wished for."""
    wishes = design.Wishes(
        case.number("delta_m"),
        disk_radius=0.69,
        abscissa_flexible=-0.00634,
        norm=0.89,
        static_gain=0.89,
        steady=8.4e-4,
        torque=0.425,
        drawn_abscissa=-0.02,
    )
    reached = improved(case, plant.controller(case, "proposed"), wishes)
    reach = limits(case, reached.gains)
    return _design(
        case,
        reached.gains,
        reach,
        levels(case, reached.gains, reach),
        asked="more gain variation than the printed gains allow, with a smaller disk, norm, static gain, steady error "
        "and torque, and poles further left in the flexible loop and under random gains",
        method="quasi-Newton minimisation of the scaled norms with one-sided penalties, from the printed gains",
        converged=reached.converged,
        effort={"iterations": reached.iterations, "evaluations": reached.evaluations},
    )


def _meets(case: Case, gains: plant.Gains, wish: Mapping[str, float]) -> bool:
    values = measures(case, gains)
    return all(values[name] <= bound for name, bound in wish.items())


def tradeoff(case: Case, name: str) -> FoundDesign:
    """The largest gain variation found under the wish of one point of the trade-off."""
    wish, ladder = TRADE_OFF[name]
    order = list(TRADE_OFF)
    narrower = [
        other for other in order[: order.index(name)] if other in case.designs and _narrower(TRADE_OFF[other][0], wish)
    ]
    starts = {"the printed gains": plant.controller(case, "proposed")}
    if narrower:
        widest = max(narrower, key=lambda other: case.designs[other]["level"][0, 0])
        starts[widest] = plant.controller(case, widest)
    asked = {key: INSIDE * bound for key, bound in wish.items()}
    candidates: list[tuple[float, plant.Gains, Limits, bool]] = []
    iterations = evaluations = 0
    for start, gains in starts.items():
        if start != "the printed gains":
            reach = limits(case, gains)
            candidates.append((reach.both, gains, reach, case.designs[start].file.converged))
        for delta in ladder:
            reached = improved(case, gains, design.Wishes(delta, gamma=9.0, torque=0.6, **asked))
            gains, iterations, evaluations = (
                reached.gains,
                iterations + reached.iterations,
                evaluations + reached.evaluations,
            )
            if _meets(case, gains, wish):
                reach = limits(case, gains)
                candidates.append((reach.both, gains, reach, reached.converged))
                print(f"  {name} from {start} at {delta}: {reach.both:.5f}, converged {reached.converged}", flush=True)
    if not candidates:
        raise ComputationError(name, "no gains meet the wish")
    _, gains, reach, converged = max(candidates, key=lambda candidate: candidate[0])
    bounds = ", ".join(f"{key.replace('_', ' ')} at most {bound:g}" for key, bound in wish.items())
    return _design(
        case,
        gains,
        reach,
        point_level(reach),
        asked=f"the largest gain variation with disk, norm and torque, {bounds}",
        method=f"quasi-Newton minimisation of the scaled norms with one-sided penalties, from {', '.join(starts)}",
        converged=converged,
        effort={"iterations": iterations, "evaluations": evaluations},
    )


def _narrower(wish: Mapping[str, float], other: Mapping[str, float]) -> bool:
    """Whether whatever meets a wish meets the other one."""
    return all(name in wish and wish[name] <= bound for name, bound in other.items())


def best(case: Case) -> FoundDesign:
    """The point of the trade-off with the largest gain variation, again."""
    chosen = max(TRADE_OFF, key=lambda name: case.designs[name]["level"][0, 0])
    gains = plant.controller(case, chosen)
    reach = limits(case, gains)
    return _design(
        case,
        gains,
        reach,
        levels(case, gains, reach),
        asked="the largest gain variation with disk, norm and torque together",
        method=f"the best of the trade-off: {chosen}",
        converged=case.designs[chosen].file.converged,
        effort={},
    )


def printed_levels(case: Case) -> FoundDesign:
    """Levels at which the printed gains are to be certified."""
    gains = plant.controller(case, "proposed")
    reach = limits(case, gains)
    return FoundDesign(
        asked="gain variations just below the limits of the printed gains, at which all requirements are certified",
        method="bisection on the largest scaled norm over the circle and over the imaginary axis",
        matrices=levels(case, gains, reach),
        converged=True,
        outcome={"limit_disk": reach.disk, "limit_norm": reach.norm},
        digits=DIGITS,
    )


def _decided(case: Case, lam: float) -> Solved | Infeasible:
    """Whether (12) can be met over all gains at a lambda with the paper's gamma: a point, or multipliers.

    Raises
    ------
    ComputationError
        If neither is found.
    """
    outcome = lemma_3(case, lam=repr(lam), g=TABLES["g"]).by_margin()
    if not isinstance(outcome, Solved | Infeasible):
        raise ComputationError("(12)", f"no margin at lambda = {lam}", outcome.attempts)
    return outcome


def _provable(case: Case, inside: float, outside: float) -> bool:
    """Whether a point at one lambda and multipliers at the other are found."""
    point = lemma_3(case, lam=repr(inside), g=TABLES["g"]).solve()
    beyond = lemma_3(case, lam=repr(outside), g=TABLES["g"]).by_margin()
    return isinstance(point, Solved) and isinstance(beyond, Infeasible)


def lambda_band(case: Case) -> FoundDesign:
    """Values of lambda just inside and just outside the band on which (12) can be met."""
    band, solves = {}, 0
    for end, (within, outside) in {"low": (0.0, -0.6), "high": (1.0, 2.5)}.items():
        while abs(outside - within) > np.log10(1 + BAND):
            middle, solves = 0.5 * (within + outside), solves + 1
            if isinstance(_decided(case, 10.0**middle), Solved):
                within = middle
            else:
                outside = middle
        width = abs(outside - within)
        for _ in range(5):  # the proofs need a little room beyond the solver's own boundary
            ends = [float(f"{10.0**x:.6g}") for x in (within, outside)]
            if _provable(case, *ends):
                break
            within, outside = within + (within - outside) / 2, outside + (outside - within) / 2
        band[f"{end}_inside"], band[f"{end}_outside"] = (np.array([[value]]) for value in ends)
        print(f"  lambda {end}: {ends}, bisected to {width:.2g} in log10", flush=True)
    return FoundDesign(
        asked="the ends of the band of lambda on which (12) can be met over all gains, each from both sides",
        method="bisection over log lambda on the largest common margin",
        matrices=band,
        converged=True,
        outcome={name: float(value[0, 0]) for name, value in band.items()},
        effort={"solves": solves},
        digits=DIGITS,
    )


SEARCHES = {
    "printed_levels": printed_levels,
    "lambda_band": lambda_band,
    "repaired": repaired,
    **{name: partial(tradeoff, name=name) for name in TRADE_OFF},
    "best": best,
}

"""Synthesis of pinheiro2013: levels, limits, the LMIs (21) for both reconstructions, and what is proved of them."""

from collections.abc import Iterator
from contextlib import nullcontext

import numpy as np

from gainsay.errors import ComputationError, InputError
from gainsay.lmi import Infimum, infimum
from gainsay.proof import build
from gainsay.results import Results, task
from gainsay.statements import Stated, enclose, prove
from gainsay.systems import loop_proofs
from gainsay.systems.norms import hinf_norm
from gainsay.tables import Case
from papers.pinheiro2013 import conditions as mixed
from papers.pinheiro2013 import conditions_pitch as pitch
from papers.pinheiro2013 import statements
from papers.pinheiro2013.conditions import AGREE
from papers.pinheiro2013.plant import (
    GROUPS,
    RECONSTRUCTIONS,
    GeneralizedPlant,
    generalized_plant,
    reconstruction,
    short,
)
from papers.pinheiro2013.synthesis_sweep import pareto

LEVELS = {"gamma_0.2": "gamma_min", "gamma_2": "gamma_mixed", "gamma_100": "gamma_max"}
SEPARATE = ("pitch", "roll_yaw")


def plants(case: Case, results: Results | None = None) -> Iterator[tuple[str, str, GeneralizedPlant]]:
    """Yield reconstruction, group and generalized plant; what one rests on is not held against the next."""
    for name in RECONSTRUCTIONS:
        for group in SEPARATE:
            with nullcontext() if results is None else results.apart():
                yield name, group, generalized_plant(reconstruction(case, name), group)


def best(plant: GeneralizedPlant, gamma: float) -> Infimum:
    """Enclose the least trace of Q under (21) corrected.

    Raises
    ------
    ComputationError
        If it was not enclosed.
    """
    return infimum(mixed.mixed_program(plant, gamma)).need(f"(21) at gamma = {gamma!r}, above gamma_min")


#: relative slope at which a gain counts as stationary: the digits of a committed design, times a condition of 1e4
STATIONARY = 1e-8


def trace_within(plant: GeneralizedPlant, gamma: float, K: np.ndarray, optimum: Infimum) -> float:
    """Root of the trace of Q that a gain gives by its Riccati equation; it must be least.

    Raises
    ------
    ComputationError
        If the trace lies outside the enclosure by the LMI widened by `AGREE`, or is not stationary.
    """
    trace = mixed.trace_of_gain(plant, K, gamma)
    slope = np.abs(mixed.trace_gradient(plant, K, gamma) * np.abs(K)).max() / trace if np.isfinite(trace) else np.inf
    if not optimum.lower * (1 - AGREE) <= trace <= optimum.upper * (1 + AGREE) or not slope < STATIONARY:
        raise ComputationError(
            "(21)",
            f"the design has the trace {trace!r} with a relative slope of {slope:.1e}, the LMI encloses "
            f"{optimum.lower!r}..{optimum.upper!r}: search it again",
        )
    return float(np.sqrt(trace))


def gain_of(optimum: Infimum, plant: GeneralizedPlant, gamma: float) -> np.ndarray:
    """Gain (22) of the optimum, held against the least trace that its Riccati equation gives for it alone.

    Raises
    ------
    ComputationError
        If the two values of the trace differ by more than `AGREE`.
    """
    K = np.linalg.solve(optimum.values["X"], optimum.values["Y"].T).T
    own = mixed.trace_of_gain(plant, K, gamma)
    if not abs(own / optimum.value - 1) < AGREE:
        raise ComputationError(
            "(21)", f"trace {optimum.value!r} by the LMI, {own!r} by the Riccati equation of its gain"
        )
    return K


@task("(20), gamma_min")
def levels(case: Case, results: Results) -> None:
    """Find the infimum of the level as the norm of D11, and reach it with a closed-form gain."""
    for name, group, plant in plants(case, results):
        least, K = mixed.gamma_min(plant), mixed.limit_gain(plant)
        norm, _ = hinf_norm(*plant.closed(K)[:4])
        results.quantity(
            f"{name}.gamma_min.{group}",
            least,
            source="(18), (21)",
            method="norm of D11; no gain goes below it, and the norm with a closed-form gain equals it",
        )
        results.quantity(
            f"{name}.limit.hinf.{group}",
            norm,
            source="(18)",
            method="verified Hamiltonian test on the loop with the closed-form gain",
        )
        if abs(norm / least - 1) > 1e-9:
            raise ComputationError("gamma_min", f"{name}, {group}: norm of D11 {least!r}, reached {norm!r}")
        results.say(f"gamma_min {name} {group}", f"{least:.6f}, reached by a closed-form gain")


@task("the H2 limit")
def h2_limit(case: Case, results: Results) -> None:
    """Solve the limit gamma to infinity by its Riccati equation; pitch against its closed form."""
    for name, group, plant in plants(case, results):
        design = mixed.h2_design(plant)
        if abs(design.h2 / design.sqrt_trace - 1) > 1e-9:
            raise ComputationError("H2 limit", f"Riccati {design.sqrt_trace!r}, Gramian {design.h2!r}")
        if group == "pitch":
            K, norm = pitch.h2_limit(plant, reconstruction(case, name).moment("y"))
            if max(abs(norm / design.h2 - 1), np.abs(K / design.K - 1).max()) > 1e-8:
                raise ComputationError("H2 limit", f"closed form {norm!r}, Riccati {design.h2!r}")
        results.quantity(
            f"{name}.h2_limit.{group}",
            design.h2,
            source="(20) as gamma grows",
            method="Riccati equation and, from its gain, both Gramians"
            + (" and the closed form of a double integrator" if group == "pitch" else ""),
        )


@task("(21) near gamma_min")
def limits(case: Case, results: Results) -> None:
    """Solve (21) at 1.001 of the infimum, where the gains forget the weights."""
    for name, group, plant in plants(case, results):
        gamma = mixed.ABOVE * mixed.gamma_min(plant)
        K = case.designs[f"{name}_near_limit"][f"K_{group}"]
        trace_within(plant, gamma, K, best(plant, gamma))
        satellite = reconstruction(case, name)
        if group == "pitch":
            first, second, moment, prefix = K[0, 0], K[0, 1], satellite.moment("y"), f"{name}.limit"
        else:
            first, second, moment, prefix = K[1, 1], K[1, 3], satellite.moment("z"), f"{name}.limit.yaw"
        method = "gain of the design, whose trace by the Riccati equation lies in the enclosure by the LMI"
        results.quantity(f"{prefix}.k1_over_inertia", first / moment, method=method, source="(21), (22)")
        results.quantity(f"{prefix}.k2_over_inertia", second / moment, method=method, source="(21), (22)")


def check_levels(case: Case) -> None:
    """Refuse levels of the table that no state feedback of a reconstruction reaches.

    Raises
    ------
    InputError
        Naming the row and gamma_min.
    """
    for name, group, plant in plants(case):
        least = mixed.gamma_min(plant)
        for parameter in LEVELS.values():
            if not case.number(parameter) > least:
                raise InputError(
                    f"level that no state feedback of {group}, reconstruction {name.upper()}, reaches:",
                    file=f"papers/{case.name}/parameters.csv",
                    row=list(case.parameters).index(parameter) + 2,
                    field=parameter,
                    value=case.parameters[parameter].value,
                    expected=f"above gamma_min = {least!r}",
                )


@task("(21), (22)")
def designs(case: Case, results: Results) -> None:
    """Hold the designs at the three levels against (21) with the sign corrected, and measure them."""
    with results.apart():
        check_levels(case)
    for name in RECONSTRUCTIONS:
        with results.apart():
            for level, parameter in LEVELS.items():
                design = case.designs[f"{name}_{statements.GAMMAS[level]}"]
                gamma, K = case.number(parameter), np.zeros((3, 6))
                for group in SEPARATE:
                    plant = generalized_plant(reconstruction(case, name), group)
                    _design(results, name, level, group, plant, gamma, design[f"K_{group}"])
                K[np.ix_([1], [1, 4])] = design["K_pitch"]
                K[np.ix_([0, 2], [0, 2, 3, 5])] = design["K_roll_yaw"]
                if not np.array_equal(K, design["K"]):
                    raise ComputationError(
                        "(22)", f"designs/{design.name}.json: K is not made of K_pitch and K_roll_yaw"
                    )
                results.say(f"(21) {name} gamma = {gamma:g}", f"pitch K = {short(design['K_pitch'])}")


def _design(
    results: Results, name: str, level: str, group: str, plant: GeneralizedPlant, gamma: float, K: np.ndarray
) -> None:
    design = results.attempted(f"(21) {name} {level} {group}", best(plant, gamma))
    sqrt_trace = trace_within(plant, gamma, K, design)
    lower, upper = np.sqrt([design.lower, design.upper])
    method = "stationary point of the Riccati equation's trace over the gains; band: LMI between checked points"
    if group == "pitch":
        for k in (1, 2):
            results.quantity(
                f"{name}.{level}.k{k}.pitch",
                K[0, k - 1],
                source="(22)",
                method="stationary point of the Riccati equation's trace over the gains; the LMI agrees",
            )
    A, B, C, D, C2 = plant.closed(K)
    h2, (hinf, _) = mixed.h2_norm(A, B, C2), hinf_norm(A, B, C, D)
    results.quantity(
        f"{name}.{level}.sqrt_trace.{group}",
        sqrt_trace,
        method=method,
        source="(21)",
        lower=min(lower, sqrt_trace),
        upper=max(upper, sqrt_trace),
    )
    results.quantity(f"{name}.{level}.h2.{group}", h2, method="both Gramians agree", source="(23)")
    results.quantity(f"{name}.{level}.hinf.{group}", hinf, method="verified Hamiltonian test", source="(23)")
    if level == "gamma_100":
        excess = h2 / mixed.h2_design(plant).h2 - 1
        results.quantity(
            f"{name}.{level}.h2_excess.{group}", excess, method="against the Riccati solution", source="Section 5"
        )


@task("(21) as printed")
def as_printed(case: Case, results: Results) -> None:
    """Prove that (21) as printed has no solution: its block (3, 3) must be negative and is gamma^2 I."""
    plant = generalized_plant(reconstruction(case, "b"), "pitch")
    first = statements.equation_21(statements.sizes(plant), statements.pitch("b"), "number('gamma_mixed')**2")
    stated = Stated(case, [first < 0], label="(21) as printed")
    outcome = stated.solve()
    prove(
        results,
        "eq21.printed.feasible",
        stated,
        outcome,
        id="eq21-as-printed-infeasible",
        source="(21)",
        sentence="X and Y that satisfy the first LMI of (21) with +gamma^2 I in block (3,3), at gamma = 2, pitch, B",
    )
    results.say("(21) as printed", type(outcome).__name__.lower())


@task("(21) corrected, certified")
def certified(case: Case, results: Results) -> None:
    """Certify points of (21) at gamma = 2, reconstruction B, and a bound on the trace from below."""
    gamma = case.number("gamma_mixed")
    for group in SEPARATE:
        plant = generalized_plant(reconstruction(case, "b"), group)
        design = best(plant, gamma)
        stated = statements.paper_problem(case, plant, "b", group, "number('gamma_mixed')**2")
        sentence = f"solution of (21) with -gamma^2 I in block (3,3) at gamma = 2, {group}, reconstruction B"
        prove(
            results,
            f"b.gamma_2.feasible.{group}",
            stated,
            design.solved,
            id=f"eq21-feasible-{group}",
            sentence=sentence,
            source="(21)",
        )
        enclose(
            results,
            f"b.gamma_2.trace.{group}",
            stated,
            design,
            id=f"eq21-least-trace-{group}",
            sentence=f"trace of Q over (21) corrected at gamma = 2, {group}, reconstruction B",
            source="(21)",
        )
        results.say(f"(21) corrected, {group}", "feasible at gamma = 2, point certified")


@task("(23)")
def bounds(case: Case, results: Results) -> None:
    """Certify both bounds of (23) for every design."""
    for name, group, _ in plants(case, results):
        for level, parameter in LEVELS.items():
            short = statements.GAMMAS[level]
            results.certificate(
                loop_proofs.norm_below(
                    case,
                    statements.TO_Z_INF,
                    f"number('{parameter}')",
                    definitions=statements.closed(name, group, f"design('{name}_{short}', 'K_{group}')"),
                    id=f"eq23-hinf-{name}-{short}-{group}",
                    statement="The H-infinity norm from w to z_inf is below "
                    f"gamma = {case.number(parameter):g}, {group}, {name.upper()}.",
                    quantities={"norm": f"{name}.{level}.hinf.{group}"},
                )
            )
    results.say("(23)", "H-infinity bounds certified for twelve loops")


@task("gamma_min, certified")
def gamma_min_certified(case: Case, results: Results) -> None:
    """Certify that the infimum is the norm of D11: infeasible just below, reached just above."""
    plant = generalized_plant(reconstruction(case, "b"), "pitch")
    r = plant.D11[0]
    # Blocks (2, 2), (2, 3), (3, 3) along (r/|r|, 1/|r|): -1 + 2 - level/|r|^2 > 0 for a level below |r|^2. A trace of
    # the identity keeps the multiplier inside its cone when it is rounded.
    z = np.concatenate([np.zeros(2), r / np.linalg.norm(r), [1 / np.linalg.norm(r)], np.zeros(2)])
    multiplier = np.outer(z, z) + 1e-9 * np.diag([0, 0, 1, 1, 1, 1, 1, 1, 1])
    level = "0.999999**2*(channels@channels.T)"
    first = statements.corrected_21(statements.sizes(plant), statements.pitch("b"), level)
    results.prove(
        build.farkas(
            id="below-gamma-min-infeasible",
            statement="No state feedback for pitch, B, satisfies (21) corrected at 0.999999 of the norm of D11.",
            multipliers={first.label: multiplier},
            quantities={"feasible": "b.below_gamma_min.feasible"},
            **Stated(case, [first < 0]).parts(),
        ),
        source="(21)",
    )
    for name, group, plant in plants(case, results):
        least = "sqrt(channels@channels.T)" if group == "pitch" else _largest_row()
        definitions = {**statements.PLANTS[group](name), "least": least}
        results.certificate(
            build.certificate(
                "enclosed",
                id=f"gamma-min-{name}-{group}",
                tables=case,
                definitions=definitions,
                statement=f"The norm of D11, hence the infimum of the level, {group}, reconstruction {name.upper()}.",
                fields={"formula": "least"},
                quantities={"value": f"{name}.gamma_min.{group}"},
                faith=("That no state feedback goes below the norm of D11, the response at infinite frequency.",),
            )
        )
        results.certificate(
            loop_proofs.norm_below(
                case,
                statements.TO_Z_INF,
                f"{mixed.gamma_min(plant) * (1 + 1e-6):.12g}",
                definitions=statements.closed(name, group, f"design('{name}_limit_{group}', 'K')"),
                id=f"gamma-min-reached-{name}-{group}",
                statement=f"A closed-form gain comes within a millionth of the norm of D11, {group}, {name.upper()}.",
                quantities={"norm": f"{name}.limit.hinf.{group}"},
            )
        )
    results.say("gamma_min", "certified from both sides")


def _largest_row() -> str:
    # The rows of D11 have no column in common, so its norm is that of the longer row; Iz is the least moment in both
    # reconstructions, which makes yaw the longer one.
    return "sqrt(rows[1, 0:14]@rows[1, 0:14].T)"


TASKS = (levels, h2_limit, limits, designs, as_printed, certified, bounds, gamma_min_certified, pareto)
assert set(SEPARATE) < set(GROUPS)

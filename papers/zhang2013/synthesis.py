"""Synthesis for zhang2013: Theorem 2 as printed and as corrected, what each accepts, and designs to simulate."""

import numpy as np
from flint import fmpq

from gainsay.errors import ComputationError
from gainsay.lmi import Infimum, Program, Solved, infimum, solve
from gainsay.systems.delay_spectrum import hinf_norm, spectral_abscissa
from gainsay.tables import Case
from gainsay.tables.results import Results, task
from papers.zhang2013 import certificates as prove
from papers.zhang2013 import misprints
from papers.zhang2013.bounds import Structured, enclosed_norm, flexible_point, least_gamma
from papers.zhang2013.design import (
    acceptance_program,
    farkas_multipliers,
    fast_program,
    inequalities,
    least_squares_program,
    margin_program,
    standing,
    unsound_program,
    without_block_26,
)
from papers.zhang2013.formulas import FLEXIBLE, PLANT, flexible_loop
from papers.zhang2013.plant import Spacecraft
from papers.zhang2013.theorem1 import Delayed, theorem1
from papers.zhang2013.theorem2 import EDITIONS, ROWS, Setting, Unknowns, corrected, differing_blocks

PLUS, MINUS = "number('lambda1_corrected')", "number('lambda1')"
#: a committed design is near the optimum where its own objective is at most this times the optimum's lower bound
NEAR_OPTIMUM = 1.001
#: relative half-width at which an optimum is enclosed: wider than what solvers reach, and the same on every machine
ROOM = 1e-5
SWEEP = (0.03, 0.12, 0.3, 1.0, 3.0, 10.0)


def enclosed(program: Program, results: Results, where: str) -> Infimum:
    """Enclosure of an infimum; attempts kept, anything else raised."""
    found = infimum(program)
    results.attempt(where, list(found.attempts))
    if not isinstance(found, Infimum):
        raise ComputationError(where, f"{program.label}: {type(found).__name__.lower()}", found.attempts)
    return found


def point_of(program: Program, results: Results, where: str) -> Solved:
    """A checked point; attempts kept, anything else raised."""
    found = solve(program)
    results.attempt(where, list(found.attempts))
    if not isinstance(found, Solved):
        raise ComputationError(where, f"{program.label}: {type(found).__name__.lower()}", found.attempts)
    return found


def roomy(value: float, lower: float, upper: float) -> dict[str, float]:
    """Value, lower and upper of an optimum widened to `ROOM`; `results.quantity` takes them.

    How narrow an enclosure gets hangs on the arithmetic of the machine. Two values with enclosures of one width differ
    by no more than that width.

    Raises
    ------
    ComputationError
        If the enclosure found is not as narrow.
    """
    low, high = (float(value * (1 + sign * ROOM)) for sign in (-1, 1))
    if not low <= lower <= upper <= high:
        raise ComputationError("optimum", f"enclosed in {lower!r}..{upper!r} only")
    return {"value": float(value), "lower": low, "upper": high}


def near_optimum(design: str, program: Program, lower: float, results: Results) -> None:
    """Refuse a committed design that does no longer do what was asked of it; `program` is that of its gains.

    Raises
    ------
    ComputationError
        If its checked objective lies above `NEAR_OPTIMUM` times the lower bound of all gains.
    """
    if (reached := point_of(program, results, design).objective) > NEAR_OPTIMUM * lower:
        raise ComputationError(
            design, f"designs/{design}.json reaches {reached:.9g}, not {NEAR_OPTIMUM:g} times {lower:.9g}: search again"
        )


@task("(23), (26)")
def correction(case: Case, results: Results) -> None:
    """(23) and (26) against the congruence of (9) under (25)."""
    blocks = differing_blocks(Setting.of(Spacecraft.of(case), case))
    results.quantity(
        "theorem2.differing_blocks",
        len(blocks),
        source="(9), (23), (25)",
        method="coefficients of printed and corrected (23) compared block by block",
    )
    results.certificate(misprints.corrected_form(case))
    results.quantity("theorem2.corrected_form", 1, method="polynomial identity", source="(9), (25), (26)")
    for i, j in blocks:
        results.certificate(misprints.differing_block(case, ROWS[i - 1], ROWS[j - 1]))
    for certificate, quantity in (
        (misprints.printed23_differs(case), "eq23.identity"),
        (misprints.printed26_differs(case), "eq26.identity"),
    ):
        results.certificate(certificate)
        results.quantity(quantity, 0, method="exact counterexample", source="(9), (23), (25), (26)")
    for certificate in misprints.wrong_sizes(case):
        results.certificate(certificate)
    listed = ", ".join(f"({i},{j})" for i, j in blocks)
    results.say("(23), (26)", f"blocks {listed} as printed are not those of (9) under (25), proved")


@task("lambda1")
def sign_of_lambda1(case: Case, results: Results) -> None:
    """No lambda1 <= 0 is feasible, printed or corrected."""
    results.certificate(prove.negative_form(case))
    results.quantity(
        "theorem2.negative_lambda1_form", 1, source="(23)", method="polynomial identity in lambda1 and all unknowns"
    )
    for edition, quantity in (
        ("corrected", "theorem2.feasible_printed_sign"),
        ("printed", "theorem2.printed_feasible_printed_sign"),
    ):
        results.certificate(prove.printed_sign_infeasible(case, edition, quantity))
        results.quantity(quantity, 0, method="exact Farkas multipliers of rank one", source="(23)")
    results.say("lambda1", "-0.12 infeasible, corrected and printed, Farkas certificates checked")


@task("(23)")
def margins(case: Case, results: Results) -> None:
    """Feasibility and margin where lambda1 > 0."""
    craft = Spacecraft.of(case)
    for edition, lambda1, name, quantity, formula, identity in (
        ("corrected", case.number("lambda1_corrected"), "theorem2.margin", "theorem2.feasible", PLUS, "eq23-feasible"),
        (
            "printed",
            1.0,
            "theorem2.printed_margin_lambda1_one",
            "theorem2.printed_feasible_lambda1_one",
            "1",
            "eq23-printed-feasible",
        ),
    ):
        setting = Setting.of(craft, case, lambda1=lambda1)
        found = enclosed(margin_program(setting, edition), results, "(23)")
        results.quantity(
            name,
            **roomy(-found.value, -found.upper, -found.lower),
            source="(23)",
            method="interior point, enclosed by a checked point and checked multipliers",
        )
        results.certificate(prove.feasible(case, identity, edition, formula, found.solved.values, quantity))
        results.quantity(quantity, 1, method="exact feasible point", source="(23)")
        results.say("(23)", f"{edition}, lambda1 = {lambda1:g}: margin {-found.value:.7g}, certified")
    printed_at = Setting.of(craft, case)
    program = Program(subject_to=inequalities(printed_at, Unknowns(), EDITIONS["printed"], 0.0), label="(23) printed")
    multipliers = farkas_multipliers(program)
    quantity = "theorem2.printed_feasible"
    results.certificate(prove.infeasible(case, "eq23-printed-infeasible", "printed", PLUS, multipliers, quantity))
    results.quantity(quantity, 0, method="exact Farkas multipliers", source="(23)")
    results.say("(23)", "printed, lambda1 = 0.12: infeasible, Farkas certificate checked")


@task("(24)")
def printed_gains(case: Case, results: Results) -> None:
    """What the corrected Theorem 2 says of the printed K and L."""
    craft, K, L = Spacecraft.of(case), case.printed("K").exact, case.printed("L").exact
    setting = Setting.of(craft, case)
    found = enclosed(acceptance_program(setting, K, L, corrected), results, "(24)")
    results.certificate(
        prove.accepted(
            case,
            "printed-gains",
            "corrected",
            PLUS,
            "printed('K')",
            "printed('L')",
            found.solved.values,
            "theorem2.printed_gains_feasible",
        )
    )
    results.quantity("theorem2.printed_gains_feasible", 1, method="exact feasible point", source="(23), (24)")
    loop = Delayed.of(craft, K, L, setting.d_M, setting.mu)
    least = least_gamma(loop, Structured(setting.lambda1, setting.lambda2), theorem1)
    results.quantity(
        "theorem2.printed_gains_gamma_min",
        np.sqrt(least.value),
        lower=hinf_norm(craft.design_loop(K, L), setting.d_M).value,
        upper=np.sqrt(least.upper),
        method="interior point; upper: checked point, lower: exact norm at d_M",
        source="(9), (25)",
    )
    results.certificate(prove.gamma_floor(case))
    results.quantity(
        "theorem2.gamma_squared_floor",
        float(case.exact("C2") ** 2),
        source="(23a)",
        method="exact multipliers: a constant w1 reaches y through the estimate",
    )
    results.say("(24)", f"printed K, L accepted at gamma = 1.5, down to {np.sqrt(least.value):.6g}; certified")


@task("(23) printed")
def unsound(case: Case, results: Results) -> None:
    """A point of the printed LMIs whose observer is unstable."""
    craft = Spacecraft.of(case)
    setting = Setting.of(craft, case, lambda1=1.0)
    K, L = case.designs["unsound"]["K"], case.designs["unsound"]["L"]
    point = enclosed(acceptance_program(setting, K, L, EDITIONS["printed"]), results, "(23) printed").solved
    named = "design('unsound', 'K')", "design('unsound', 'L')"
    results.certificate(
        prove.accepted(case, "unsound-accepted", "printed", "1", *named, point.values, "unsound.accepted")
    )
    results.quantity("unsound.accepted", 1, method="exact feasible point", source="(23) as printed")
    pole = -(np.array(case.designs["unsound"].exact("L"), dtype=object) @ craft.B)
    statement = "The observer of that design is unstable."
    results.certificate(
        prove.unstable(
            case,
            "unsound-observer",
            f"-({named[1]} @ B)",
            PLANT,
            pole.astype(float),
            "unsound.observer_stable",
            statement,
        )
    )
    results.quantity("unsound.observer_stable", 0, method="inertia", source="(5)")
    results.quantity("unsound.observer_pole", float(pole.item()), method="-L B in rational arithmetic", source="(5)")
    count = 0
    for lambda1 in SWEEP:
        at = Setting.of(craft, case, lambda1=lambda1)
        count += isinstance(solve(unsound_program(at, without_block_26)), Solved)
    results.quantity(
        "unsound.block26_accepted",
        count,
        source="(23)",
        method=f"checked points at lambda1 = {', '.join(map(str, SWEEP))}",
    )
    results.say("(23) printed", f"accepts an observer with its pole at {float(pole.item()):+.4f} 1/s, certified")


@task("Theorem 2, least squares")
def resynthesised(case: Case, results: Results) -> None:
    """The corrected Theorem 2 with an objective that leaves one solution."""
    craft = Spacecraft.of(case)
    setting = Setting.of(craft, case)
    found = enclosed(least_squares_program(setting), results, "pinned")
    K, L = case.designs["resynthesised"]["K"], case.designs["resynthesised"]["L"]
    near_optimum("resynthesised", least_squares_program(setting, (K, L)), found.lower, results)
    results.quantity(
        "pinned.objective",
        **roomy(found.value, found.lower, found.upper),
        source="(23)",
        method="interior point, enclosed by a checked point and checked multipliers",
    )
    method = f"of the design, whose objective is within {NEAR_OPTIMUM:g} of the optimum"
    results.quantity("pinned.k1", K[0, 0], method=method, source="(23), (24)")
    results.quantity("pinned.k2", K[0, 1], method=method, source="(23), (24)")
    bandwidth = float((np.array(case.designs["resynthesised"].exact("L"), dtype=object) @ craft.B).item())
    results.quantity("pinned.observer_bandwidth", bandwidth, method=method, source="(24)")
    point = enclosed(acceptance_program(setting, K, L, corrected), results, "pinned").solved
    named = "design('resynthesised', 'K')", "design('resynthesised', 'L')"
    results.certificate(
        prove.accepted(case, "resynthesised-accepted", "corrected", PLUS, *named, point.values, "pinned.accepted")
    )
    results.quantity("pinned.accepted", 1, method="exact feasible point", source="(23), (24)")
    results.say("Theorem 2, least squares", f"K = [{K[0, 0]:.4f} {K[0, 1]:.4f}], L B = {bandwidth:.4f}")


@task("Theorem 2, least gamma")
def fast(case: Case, results: Results) -> None:
    """A design of least gamma: accepted by the corrected LMIs, unstable on the flexible plant."""
    craft = Spacecraft.of(case)
    setting = Setting.of(craft, case)
    found = enclosed(fast_program(setting), results, "fast")
    K, L = case.designs["fast"]["K"], case.designs["fast"]["L"]
    near_optimum("fast", fast_program(setting, (K, L)), found.lower, results)
    results.quantity(
        "fast.gamma",
        **roomy(*np.sqrt([found.value, max(found.lower, 0.0), found.upper])),
        source="(23)",
        method="interior point, enclosed by a checked point and checked multipliers",
    )
    point = enclosed(acceptance_program(setting, K, L, corrected), results, "fast").solved
    named = "design('fast', 'K')", "design('fast', 'L')"
    results.certificate(prove.accepted(case, "fast-accepted", "corrected", PLUS, *named, point.values, "fast.accepted"))
    results.quantity("fast.accepted", 1, method="exact feasible point", source="(23)")
    list_gains(case, results, K, L)
    loop = craft.flexible_loop(K, L, "paper")
    definitions = [*FLEXIBLE, *flexible_loop(*named)]
    results.certificate(
        prove.unstable(
            case,
            "fast-unstable",
            "A_bar + A_d",
            definitions,
            loop.A + loop.A1,
            "fast.flexible_stable",
            "Without delay the flexible plant with the fast design is unstable.",
        )
    )
    results.quantity("fast.flexible_stable", 0, method="inertia", source="(1), (4), (6)")
    grows = prove.abscissa(
        case,
        "fast-abscissa",
        "A_bar + A_d",
        definitions,
        "fast.flexible_abscissa",
        "Spectral abscissa of the flexible plant with the fast design.",
    )
    results.certificate(grows)
    found = prove.enclosure(grows)
    results.quantity("fast.flexible_abscissa", **found, method="eigenvalues in balls", source="(1), (4), (6)")
    results.say(
        "Theorem 2, least gamma", f"accepted; flexible plant unstable, abscissa {found['value']:+.3e} 1/s, certified"
    )


def list_gains(case: Case, results: Results, *others: np.ndarray) -> None:
    """Printed against re-synthesised gains; the range of every entry over designs certified by the same LMIs.

    No entry is identified: the printed gains, the least-squares ones and `others` are all accepted.
    """
    least_squares = case.designs["resynthesised"]
    for name, other in zip(("K", "L"), others, strict=True):
        known = np.array([case.matrix(name), least_squares[name], other])
        results.gains(
            name,
            published=case.printed(name),
            resynthesised=least_squares[name],
            identified=np.zeros((1, 2), dtype=bool),
            low=known.min(axis=0),
            high=known.max(axis=0),
        )


@task("repair")
def repaired(case: Case, results: Results) -> None:
    """A design certified on the flexible plant."""
    craft, d_M = Spacecraft.of(case), case.number("d_M")
    K, L = case.designs["repaired"]["K"], case.designs["repaired"]["L"]
    stands = standing(craft, K, L, d_M)
    before = standing(craft, case.matrix("K"), case.matrix("L"), d_M)
    gained = stands.margin_paper - before.margin_paper, stands.margin_all - before.margin_all
    if min(*gained, before.abscissa - stands.abscissa) < 0:
        raise ComputationError("repair", "designs/repaired.json loses delay margin or decay: search it again")
    for mode in ("paper", "all"):
        margin = craft.flexible_loop(K, L, mode).quasi_polynomial.margin()
        results.quantity(
            f"repaired.delay_margin.{mode}",
            margin.delay,
            lower=margin.lower,
            upper=margin.upper,
            method="quasi-polynomial, roots isolated",
            source="(1), (6)",
        )
    loop = craft.flexible_loop(K, L, "paper")
    results.quantity(
        "repaired.abscissa",
        spectral_abscissa(loop, d_M),
        source="(1), (4), (6)",
        method="spectral discretisation and Newton",
    )
    named = "design('repaired', 'K')", "design('repaired', 'L')"
    rigid = prove.abscissa(
        case,
        "repaired-abscissa",
        f"A + B @ {named[0]}",
        PLANT,
        "repaired.design_abscissa",
        "Spectral abscissa of A + BK with the repaired K.",
    )
    results.certificate(rigid)
    results.quantity("repaired.design_abscissa", **prove.enclosure(rigid), method="eigenvalues in balls", source="(3)")
    exact = case.exact("d_M")
    loop = craft.design_loop(K, L)
    results.quantity(
        "repaired.hinf", **enclosed_norm(loop, fmpq(exact.numerator, exact.denominator)), source="(7), (8)"
    )
    for mode, quantity in (("paper", "repaired.feasible_flexible"), ("all", "repaired.feasible_flexible_all")):
        values, gamma_squared = flexible_point(craft, K, L, mode, d_M, case.number("mu"))
        results.certificate(
            prove.theorem1(
                case, f"repaired-theorem1-{mode}", *named, values, quantity, mode=mode, gamma_squared=gamma_squared
            )
        )
        results.quantity(quantity, 1, method="exact feasible point of (9)", source="(1), (4), (6), (9)")
    results.say("repair", f"K = [{K[0, 0]:.4f} {K[0, 1]:.4f}], L2 = {L[0, 1]:.4f}; (9) certified on the flexible plant")


TASKS = (correction, sign_of_lambda1, margins, printed_gains, unsound, resynthesised, fast, repaired)

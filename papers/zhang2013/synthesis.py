"""Synthesis for zhang2013: Theorem 2 as printed and as corrected, what each accepts, and designs to simulate."""

import numpy as np
from flint import fmpq

from gainsay.errors import ComputationError
from gainsay.lmi import Infimum, Solved
from gainsay.results import Results, task
from gainsay.statements import Stated, optimum, prove
from gainsay.systems import loop_proofs
from gainsay.systems.delay_spectrum import hinf_norm, spectral_abscissa
from gainsay.tables import Case
from papers.zhang2013 import derivations_misprints as misprints
from papers.zhang2013 import proofs
from papers.zhang2013.conditions import enclosed_norm, flexible_point, least_gamma, standing
from papers.zhang2013.plant import Spacecraft
from papers.zhang2013.proofs import PRINTED_GAINS, THEOREM_1_ON_FAITH, gains_of
from papers.zhang2013.statements import (
    PARTS,
    PLANT,
    PLUS,
    PRINTED_LOOP,
    ROWS,
    corrected_23,
    fast_program,
    flexible_loop,
    for_gains,
    least_squares_program,
    margin_program,
    structured_theorem_1,
    theorem_1,
    theorem_2,
    unsound_program,
)

#: a committed design is near the optimum where its own objective is at most this times the optimum's lower bound
NEAR_OPTIMUM = 1.001
#: relative half-width at which an optimum is enclosed: wider than what solvers reach, and the same on every machine
ROOM = 1e-5
SWEEP = ("0.03", "0.12", "0.3", "1", "3", "10")


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


def near_optimum(design: str, stated: Stated, lower: float, results: Results) -> None:
    """Refuse a committed design that does no longer do what was asked of it; `stated` is the program for its gains.

    Raises
    ------
    ComputationError
        If its checked objective lies above `NEAR_OPTIMUM` times the lower bound of all gains.
    """
    outcome = results.attempted(design, stated.solve())
    if (reached := outcome.need(design).objective) > NEAR_OPTIMUM * lower:
        raise ComputationError(
            design, f"designs/{design}.json reaches {reached:.9g}, not {NEAR_OPTIMUM:g} times {lower:.9g}: search again"
        )


def accepted(results: Results, edition: str, gains: tuple[str, str], quantity: str, id: str, l1: str = PLUS) -> Infimum:
    """Prove that (23) accepts gains, formulas of K and L: M = K X and N = P22' L."""
    case = results.case
    best = optimum(results, margin_program(case, edition, l1=l1, **for_gains(*gains)), "(24)")
    prove(
        results,
        quantity,
        theorem_2(case, edition, l1=l1, **for_gains(*gains)),
        best.solved,
        id=id,
        sentence=f"solution of (23), {edition}, for K = {gains[0]}, L = {gains[1]} at lambda1 = {l1}",
        source="(23), (24)",
    )
    return best


@task("(23), (26)")
def correction(case: Case, results: Results) -> None:
    """(23) and (26) against the congruence of (9) under (25)."""
    cells = {(c.row, c.column) for part in PARTS for c in corrected_23(part).differences}
    blocks = sorted((ROWS.index(row) + 1, ROWS.index(column) + 1) for row, column in cells)
    results.quantity(
        "theorem2.differing_blocks",
        len(blocks),
        source="(9), (23), (25)",
        method="cells in which the editions of (23) differ, each proved different from the congruence of (9)",
    )
    results.prove(misprints.corrected_form(case), source="(9), (25), (26)")
    for i, j in blocks:
        results.certificate(misprints.differing_block(case, ROWS[i - 1], ROWS[j - 1]))
    results.prove(misprints.printed_23_differs(case), source="(9), (23), (25)")
    results.prove(misprints.printed_26_differs(case), source="(9), (25), (26)")
    for certificate in misprints.wrong_sizes(case):
        results.certificate(certificate)
    listed = ", ".join(f"({i},{j})" for i, j in blocks)
    results.say("(23), (26)", f"blocks {listed} as printed are not those of (9) under (25), proved")


@task("lambda1")
def sign_of_lambda1(case: Case, results: Results) -> None:
    """No lambda1 <= 0 is feasible, printed or corrected."""
    results.prove(proofs.negative_form(case), source="(23)")
    for edition, quantity in (
        ("corrected", "theorem2.feasible_printed_sign"),
        ("printed", "theorem2.printed_feasible_printed_sign"),
    ):
        results.prove(proofs.printed_sign_infeasible(case, edition, quantity), source="(23)")
    for certificate in proofs.definite_slack(case):
        if certificate.conclusions[0].quantity:
            results.prove(certificate, source="(23a)")
        else:
            results.certificate(certificate)
    results.say("lambda1", "-0.12 infeasible, corrected and printed, Farkas certificates checked")


@task("(23)")
def margins(case: Case, results: Results) -> None:
    """Feasibility and margin where lambda1 > 0."""
    for edition, l1, margin, quantity, id in (
        ("corrected", PLUS, "theorem2.margin", "theorem2.feasible", "eq23-feasible"),
        (
            "printed",
            "1",
            "theorem2.printed_margin_lambda1_one",
            "theorem2.printed_feasible_lambda1_one",
            "eq23-printed-feasible",
        ),
    ):
        best = optimum(results, margin_program(case, edition, l1=l1), "(23)")
        results.quantity(
            margin,
            **roomy(-best.value, -best.upper, -best.lower),
            source="(23)",
            method="interior point, enclosed by a checked point and checked multipliers",
        )
        sentence = f"solution of (23), {edition}, at lambda1 = {l1}"
        prove(results, quantity, theorem_2(case, edition, l1=l1), best.solved, id=id, sentence=sentence, source="(23)")
        results.say("(23)", f"{edition}, lambda1 = {l1}: margin {-best.value:.7g}")
    stated = theorem_2(case, "printed")
    as_printed = results.attempted("(23) printed", stated.solve())
    prove(
        results,
        "theorem2.printed_feasible",
        stated,
        as_printed,
        id="eq23-printed-infeasible",
        sentence=f"solution of (23), printed, at lambda1 = {PLUS}",
        source="(23)",
    )
    results.say("(23)", f"printed, lambda1 = 0.12: {type(best).__name__.lower()}")


@task("(24)")
def printed_gains(case: Case, results: Results) -> None:
    """What the corrected Theorem 2 says of the printed K and L."""
    craft, K, L = Spacecraft.of(case), case.printed("K").exact, case.printed("L").exact
    accepted(results, "corrected", PRINTED_GAINS, "theorem2.printed_gains_feasible", "printed-gains")
    least = least_gamma(structured_theorem_1(case, PRINTED_LOOP, g="gamma2"))
    results.quantity(
        "theorem2.printed_gains_gamma_min",
        np.sqrt(least.bound),
        lower=hinf_norm(craft.design_loop(K, L), case.number("d_M")).value,
        upper=np.sqrt(least.upper),
        method="interior point; upper: checked point, lower: exact norm at d_M",
        source="(9), (25)",
    )
    results.prove(proofs.gamma_floor(case), source="(23a)")
    results.say("(24)", f"printed K, L accepted at gamma = 1.5, down to {np.sqrt(least.bound):.6g}")


@task("(23) printed")
def unsound(case: Case, results: Results) -> None:
    """A point of the printed LMIs whose observer is unstable."""
    K, L = gains_of("unsound")
    accepted(results, "printed", (K, L), "unsound.accepted", "unsound-accepted", l1="1")
    pole = -(np.array(case.designs["unsound"].exact("L"), dtype=object) @ Spacecraft.of(case).B)
    results.prove(
        loop_proofs.pole_right_of(
            case,
            f"-({L} @ B)",
            "0",
            definitions=PLANT,
            id="unsound-observer",
            statement="The observer of that design is unstable.",
            quantities={"stable": "unsound.observer_stable"},
        ),
        source="(5)",
    )
    results.quantity("unsound.observer_pole", float(pole.item()), method="-L B in rational arithmetic", source="(5)")
    outcomes = [unsound_program(case, "without (2,6)", l1=l1).solve() for l1 in SWEEP]
    results.quantity(
        "unsound.block26_accepted",
        sum(isinstance(point, Solved) for point in outcomes),
        source="(23)",
        method=f"checked points at lambda1 = {', '.join(SWEEP)}",
    )
    results.say("(23) printed", f"accepts an observer with its pole at {float(pole.item()):+.4f} 1/s")


@task("Theorem 2, least squares")
def resynthesised(case: Case, results: Results) -> None:
    """The corrected Theorem 2 with an objective that leaves one solution."""
    gains = gains_of("resynthesised")
    best = optimum(results, least_squares_program(case), "pinned")
    K = case.designs["resynthesised"]["K"]
    near_optimum("resynthesised", least_squares_program(case, **for_gains(*gains)), best.lower, results)
    results.quantity(
        "pinned.objective",
        **roomy(best.value, best.lower, best.upper),
        source="(23)",
        method="interior point, enclosed by a checked point and checked multipliers",
    )
    method = f"of the design, whose objective is within {NEAR_OPTIMUM:g} of the optimum"
    results.quantity("pinned.k1", K[0, 0], method=method, source="(23), (24)")
    results.quantity("pinned.k2", K[0, 1], method=method, source="(23), (24)")
    bandwidth = (np.array(case.designs["resynthesised"].exact("L"), dtype=object) @ Spacecraft.of(case).B).item()
    results.quantity("pinned.observer_bandwidth", float(bandwidth), method=method, source="(24)")
    accepted(results, "corrected", gains, "pinned.accepted", "resynthesised-accepted")
    results.say("Theorem 2, least squares", f"K = [{K[0, 0]:.4f} {K[0, 1]:.4f}], L B = {float(bandwidth):.4f}")


@task("Theorem 2, least gamma")
def fast(case: Case, results: Results) -> None:
    """A design of least gamma: accepted by the corrected LMIs, unstable on the flexible plant."""
    gains = gains_of("fast")
    best = optimum(results, fast_program(case), "fast")
    K, L = case.designs["fast"]["K"], case.designs["fast"]["L"]
    near_optimum("fast", fast_program(case, **for_gains(*gains)), best.lower, results)
    results.quantity(
        "fast.gamma",
        **roomy(*np.sqrt([best.value, max(best.lower, 0.0), best.upper])),
        source="(23)",
        method="interior point, enclosed by a checked point and checked multipliers",
    )
    accepted(results, "corrected", gains, "fast.accepted", "fast-accepted")
    list_gains(case, results, K, L)
    loop = flexible_loop(*gains)
    results.prove(
        loop_proofs.pole_right_of(
            case,
            "A_bar + A_d",
            "0",
            definitions=loop,
            id="fast-unstable",
            statement="Without delay the flexible plant with the fast design is unstable.",
            quantities={"stable": "fast.flexible_stable"},
        ),
        source="(1), (4), (6)",
    )
    results.prove(
        loop_proofs.abscissa(
            case,
            "A_bar + A_d",
            definitions=loop,
            id="fast-abscissa",
            statement="Spectral abscissa of the flexible plant with the fast design.",
            quantity="fast.flexible_abscissa",
        ),
        source="(1), (4), (6)",
    )
    results.say("Theorem 2, least gamma", "accepted; flexible plant unstable")


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


def certify_on_flexible(results: Results, gains: tuple[str, str], mode: str, quantity: str, id: str) -> None:
    """Prove (9) for gains, formulas of K and L, on the flexible plant with input w1 alone."""
    case = results.case
    values, gamma_squared = flexible_point(case, *gains, mode)
    stated = theorem_1(case, flexible_loop(*gains, mode), 7, 1, g=gamma_squared)
    where = "K x" if mode == "paper" else "whole input"
    prove(
        results,
        quantity,
        stated,
        stated.point(values),
        id=id,
        sentence=f"solution of (9a) and (9b) for K = {gains[0]}, L = {gains[1]} on the flexible plant, {where} delayed",
        source="(1), (4), (6), (9)",
        faith=(THEOREM_1_ON_FAITH,),
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
    gains = gains_of("repaired")
    results.prove(
        loop_proofs.abscissa(
            case,
            f"A + B @ {gains[0]}",
            definitions=PLANT,
            id="repaired-abscissa",
            statement="Spectral abscissa of A + BK with the repaired K.",
            quantity="repaired.design_abscissa",
        ),
        source="(3)",
    )
    exact = case.exact("d_M")
    loop = craft.design_loop(K, L)
    results.quantity(
        "repaired.hinf", **enclosed_norm(loop, fmpq(exact.numerator, exact.denominator)), source="(7), (8)"
    )
    for mode, quantity in (("paper", "repaired.feasible_flexible"), ("all", "repaired.feasible_flexible_all")):
        certify_on_flexible(results, gains, mode, quantity, f"repaired-theorem1-{mode}")
    results.say("repair", f"K = [{K[0, 0]:.4f} {K[0, 1]:.4f}], L2 = {L[0, 1]:.4f}; (9) certified on the flexible plant")


TASKS = (correction, sign_of_lambda1, margins, printed_gains, unsound, resynthesised, fast, repaired)

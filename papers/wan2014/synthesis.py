"""What the paper's LMIs say: (14) refuted, the sub-problem behind the printed gains, certified bounds, designs."""

import numpy as np

from gainsay.errors import ComputationError
from gainsay.lmi import Infimum, Solved, infimum
from gainsay.proof.formulas import names_in
from gainsay.results import Results, task
from gainsay.statements import enclose, optimum, prove
from gainsay.systems.spectrum import spectral_abscissa
from gainsay.tables import Case
from papers.wan2014 import conditions_digits as digits
from papers.wan2014 import derivations, derivations_bounds, plant, proofs, searches
from papers.wan2014.plant import AXES
from papers.wan2014.statements import (
    EQ15,
    EQ24,
    cost_bound,
    joint_design,
    printed_digits,
    problem_38,
    state_feedback,
    thrust_bound,
)

SUBPROBLEM = "(14) rows 1, 3, 5, 7 with (30), (31)"
NEAR = f"at {digits.NEAR} of the optimum"
ENCLOSED = "semidefinite program; enclosed by a point and by multipliers, proved for the program in doubles"
BETWEEN = "upper end certified, lower end by multipliers proved for the program in doubles"


#: widths of enclosures, relative, that are wider than what solvers reach and on record as tolerances
ROOM, BOX_ROOM = 1e-6, 1e-4


def _narrow(least: Infimum, room: float) -> Infimum:
    """The infimum, if it is enclosed as narrowly as the record takes for granted.

    Raises
    ------
    ComputationError
        If it is not.
    """
    if not least.upper - least.lower <= room * abs(least.value):
        raise ComputationError("enclosure", f"{least.lower!r}..{least.upper!r}, wider than {room:g}", least.attempts)
    return least


@task("(14)")
def theorem_2(case: Case, results: Results) -> None:
    """Refute (14), and with it Theorems 2 and 3 and (38), exactly."""
    best, ends = proofs.margin(results)
    _narrow(best, BOX_ROOM)
    margin = -best.value
    results.quantity(
        "farkas.margin",
        float(np.clip(margin, ends["lower"], ends["upper"])),
        source="(14), (41)",
        **ends,
        method="semidefinite program, enclosed exactly by a point and by multipliers",
    )
    results.prove(proofs.infeasible_14(case, best.solved.values), source="(14), (41)")
    results.prove(proofs.infeasible_14(case, best.solved.values, "corrected"), source="(14), (24), (41)")
    results.prove(proofs.wrong_diagonal(case), source="(14), (43)")
    results.prove(proofs.input_counted_twice(case), source="(14), (24), (26)")
    results.prove(proofs.empty_row_14(case), source="(14)")
    results.prove(proofs.infeasible_29(case), source="(29)")
    results.say("(14)", f"infeasible, Farkas certificate checked; margin {margin:.6e}")


@task("(9) to (37)")
def proofs_of_the_paper(case: Case, results: Results) -> None:
    """Check each step of the paper's proofs for matrices of any entries."""
    steps = (*derivations.DERIVATIONS, *derivations_bounds.DERIVATIONS)
    for step in steps:
        results.prove(step(case), source=(step.__doc__ or "").split(":")[0])
    results.say("(9) to (37)", f"{len(steps)} steps of the derivations proved")


@task("(38)")
def problem_as_printed(case: Case, results: Results) -> None:
    """Put (38) as printed before the solver: what somebody who follows the paper sees."""
    result = results.attempted("(38)", problem_38(case).solve())
    if isinstance(result, Solved):
        raise ComputationError("(38)", "a point was found although (14) is proved infeasible", result.attempts)
    results.say("(38)", f"no point ({len(result.attempts)} attempts)")


@task("(15), (24)")
def slips_of_the_text(case: Case, results: Results) -> None:
    """Measure the slips of the text: references to (15) and (24)."""
    matrices = {"A", "B", "E1", "E2", "L", "C"}
    results.quantity(
        "eq15.plant_terms",
        sum(bool(names_in(text) & matrices) for text in EQ15.blocks.values()),
        method="blocks of (15) that name a matrix of the plant",
        source="(15)",
    )
    results.quantity(
        "eq24.order",
        len(EQ24.rows) * 12,
        source="(23), (24)",
        method="order of (24), the size of [x; e]; diag(P^-1, P^-1, I) is larger",
    )


@task(SUBPROBLEM)
def subproblem(case: Case, results: Results) -> None:
    """Solve the part of (14) that has a solution: the printed X, Y and K come from it."""
    optima = {}
    for name, saturated, weight in (
        ("rho", True, "1"),
        ("rho_unsaturated", False, "1"),
        ("rho_input_twice", True, "2"),
    ):
        stated = state_feedback(case, saturated, weight)
        optima[name] = _narrow(optimum(results, stated, name), ROOM)
        sentence = "rho over block rows 1, 3, 5, 7 of (14) with (30) at e(0) = 0"
        sentence += f"{' and (31)' if saturated else ''}{', R twice' if weight == '2' else ''}"
        enclose(results, f"subproblem.{name}", stated, optima[name], sentence=sentence, source="(14), (30), (31)")
    best = optima["rho"]
    rho = best.value
    normalised = {name: np.asarray(best.values[name]) / rho for name in ("X", "Y", "eps")}
    spread = digits.spreads(case, normalised, rho)
    K, design = searches.gain(best.values), case.designs["resynthesised"]["K"]
    # Six digits: more would change with the last digits of the proved end, and with them the statement on record.
    level = f"{digits.NEAR * best.lower:.5e}"
    near = state_feedback(case, Y="design('resynthesised', 'K')@X").changed(
        minimise=None,
        subject_to=[*state_feedback(case, Y="design('resynthesised', 'K')@X").constraints, f"rho < {level}"],
    )
    point = near.solve()
    prove(
        results,
        "subproblem.design_near",
        near,
        point,
        source="(44)",
        sentence=f"X for the gain of designs/resynthesised.json with rho {NEAR}",
    )
    for name, (i, j) in {"k11": (0, 0), "k12": (0, 1), "k14": (0, 3), "k15": (0, 4), "k25": (1, 4)}.items():
        low, high = (float(end[i, j]) for end in (spread["K"].low, spread["K"].high))
        results.quantity(
            f"subproblem.{name}",
            float(design[i, j]),
            source="(44)",
            lower=low,
            upper=high,
            method=f"entry of designs/resynthesised.json, which is proved near the optimum; its range {NEAR}",
        )
    for name, value in (("X", normalised["X"]), ("Y", normalised["Y"]), ("K", K)):
        s = spread[name]
        results.gains(
            name, published=case.printed(name), resynthesised=value, identified=s.identified, low=s.low, high=s.high
        )
    results.quantity(
        "subproblem.identified_gains",
        int(spread["K"].identified.sum()),
        source="(44)",
        method=f"entries of K whose range {NEAR} lies within 10 % to either side",
    )
    results.say(SUBPROBLEM, f"optimal, rho = {rho:.6e} enclosed to {best.width:.0e}")


@task("(43)")
def rounding_of_43(case: Case, results: Results) -> None:
    """Range rho over all X and Y that round to the printed digits; prove (43) and (44) consistent."""
    stated, source, ends = printed_digits(case), "(14), (30), (31), (43)", {}
    for name, formula, sign in (("upper", "inverse_rho", 1), ("lower", "-inverse_rho", -1)):
        least = ends[name] = _narrow(optimum(results, stated.changed(minimise=formula), f"rho_{name}"), BOX_ROOM)
        lower, upper = sorted(sign / end for end in (least.lower, least.upper))
        results.quantity(
            f"box.rho_{name}", sign / least.value, lower=lower, upper=upper, method=ENCLOSED, source=source
        )
    for name, formula in (("x11", "X[0,0]"), ("x22", "X[1,1]"), ("eps", "eps")):
        for end, sign in (("lower", 1), ("upper", -1)):
            least = _narrow(optimum(results, stated.changed(minimise=f"{sign}*{formula}"), f"{name}_{end}"), BOX_ROOM)
            lower, upper = sorted((sign * least.lower, sign * least.upper))
            results.quantity(
                f"box.{name}_{end}", sign * least.value, lower=lower, upper=upper, method=ENCLOSED, source=source
            )
    sentence = "X and Y that round to (43) and satisfy block rows 1, 3, 5, 7 of (14), (30) at e(0) = 0 and (31)"
    prove(
        results,
        "box.feasible",
        stated,
        ends["upper"].solved,
        source="(43)",
        id="subproblem-printed-digits",
        sentence=sentence,
    )
    results.prove(proofs.consistent_digits(case, *digits.consistent_point(case)), source="(43), (44)")
    results.say("(43)", f"rho within {-1 / ends['lower'].value:.6e} .. {1 / ends['upper'].value:.6e}")


def _value(least: Infimum, proved: float) -> float:
    """The infimum, or the least value reached where it has no proved lower end; not above what a certificate proves."""
    value = least.value if np.isfinite(least.value) else least.upper
    return float(min(value, proved))


def _ends(least: Infimum) -> str:
    return BETWEEN if np.isfinite(least.lower) else "upper end certified, the least that was reached"


def _finite(end: float) -> float | None:
    """A lower end, or None where no multipliers were proved."""
    return float(end) if np.isfinite(end) else None


@task("printed K, L: full Lyapunov matrix")
def printed_bounds(case: Case, results: Results) -> None:
    """Certify cost, stability and thrust of the printed controller with 12x12 Lyapunov matrices."""
    _certified(case, results, "full_lyapunov", "printed('K')")


def _certified(case: Case, results: Results, name: str, gain: str) -> np.ndarray:
    """Bound cost and thrust of a gain from both sides, certify, write the quantities; return the thrusts, N."""
    slug = name.replace("_", "-")
    stated = cost_bound(case, gain)
    cost = optimum(results, stated, name)
    certificate = proofs.cost_certificate(
        case,
        gain,
        cost.solved.values,
        id=f"{slug}-cost",
        quantities={"cost": f"{name}.cost_bound", "stable": f"{name}.stable"},
    )
    results.certificate(certificate)
    proved = {c.of: c.value for c in certificate.conclusions}
    upper = float(proved["cost"])
    results.quantity(
        f"{name}.stable", 1, source="(1), (7), (10)", method=f"certificate {certificate.id}, every |Lambda_ii(t)| <= 1"
    )
    results.quantity(
        f"{name}.cost_bound",
        _value(cost, upper),
        lower=_finite(cost.lower),
        upper=upper,
        source="(1), (7), (10)",
        method=f"infimum over 12x12 P; {_ends(cost)}",
    )
    sizes = {**{part: cost.solved.values[part] / cost.upper for part in ("P", "S")}, "square": 100.0}
    peaks = []
    for i, axis in enumerate(AXES):
        stated = thrust_bound(case, gain, i)
        ellipsoid = results.attempted(f"{name} {axis}", infimum(stated.program(), near=sizes)).need(stated.label)
        certificate = proofs.thrust_certificate(
            case, gain, ellipsoid.solved.values, i, id=f"{slug}-thrust-{axis}", quantity=f"{name}.thrust_{axis}"
        )
        results.certificate(certificate)
        peaks.append(float(certificate.conclusions[-1].value or "nan"))
        lower = _finite(ellipsoid.lower)
        results.quantity(
            f"{name}.thrust_{axis}",
            float(np.sqrt(_value(ellipsoid, peaks[-1] ** 2))),
            upper=peaks[-1],
            source="(5), (10)",
            lower=None if lower is None else float(np.nextafter(np.sqrt(max(lower, 0.0)), 0)),
            method=f"infimum over 12x12 P of its own; {_ends(ellipsoid)}",
        )
    results.say(name, f"J <= {upper:.6e}, thrust <= {', '.join(f'{p:.2f}' for p in peaks)} N, certified")
    return np.array(peaks)


@task("repaired design")
def repaired(case: Case, results: Results) -> None:
    """Design a controller for the same limits and certify it as the printed one is certified."""
    design = case.designs["repaired"]
    share = searches.thrust_share(case, design["K"])
    if abs(share - searches.USED) > 1e-6:
        raise ComputationError("repaired design", f"uses {share} of the limits at the start: search it again")
    results.quantity(
        "repaired.weight",
        float(design["weight"][0, 0]),
        source="(5), (14)",
        method=f"input weight of the design, whose thrust at the start is within {searches.USED} of the limits of (5)",
    )
    peaks = _certified(case, results, "repaired", "design('repaired', 'K')")
    if not (peaks <= plant.thrust_limits(case)).all():
        raise ComputationError("repaired design", f"certified thrust {peaks} N exceeds the limits")


@task("Theorem 2, corrected")
def corrected_theorem(case: Case, results: Results) -> None:
    """Show that the theorem can be had: separate Lyapunov matrices for estimate and error are feasible."""
    stated = joint_design(case)
    best = optimum(results, stated, "Theorem 2, corrected")
    enclose(
        results,
        "joint.cost_bound",
        stated,
        best,
        source="Theorem 2",
        sentence="rho over K and two 6x6 Lyapunov matrices, multipliers those of designs/joint.json",
    )
    results.say("Theorem 2, corrected", f"feasible, J <= {best.value:.6e} without thrust limits")


@task("LQR")
def linear_quadratic(case: Case, results: Results) -> None:
    """Compare with an LQR that uses the full thrust limit along x."""
    design, model = case.designs["lqr"], plant.design_model(case)
    K, weight = design["K"], float(design["weight"][0, 0])
    if np.abs(K - searches.lqr_gain(case, weight)).max() > 1e-8 * np.abs(K).max():
        raise ComputationError("LQR", "designs/lqr.json is not the regulator of its weight: search it again")
    if spectral_abscissa(model.A - model.B @ K) >= 0:
        raise ComputationError("LQR", "the gain does not stabilise")
    results.quantity(
        "lqr.weight", weight, method="root of largest |f_x| = 40 N, two-body plant", source="(5), Section 4"
    )
    cost = plant.closed_loop_cost(case, K, case.matrix("L"))
    results.quantity("lqr.cost", cost, method="DOP853, two-body plant, 20 000 s", source="(4), Section 4")
    results.say("LQR", f"r = {weight:.4f}, J = {cost:.6e}")


TASKS = (
    theorem_2,
    proofs_of_the_paper,
    problem_as_printed,
    slips_of_the_text,
    subproblem,
    rounding_of_43,
    printed_bounds,
    repaired,
    corrected_theorem,
    linear_quadratic,
)

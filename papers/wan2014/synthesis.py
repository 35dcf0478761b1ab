"""What the paper's LMIs say: (14) refuted, the sub-problem behind the printed gains, certified bounds, designs."""

import dataclasses
import itertools

import numpy as np

from gainsay.errors import ComputationError
from gainsay.lmi import Infeasible, Infimum, Solved, Undecided, infimum, positive, ranges, solve, symmetric
from gainsay.systems.statespace import spectral_abscissa
from gainsay.tables import Case
from gainsay.tables.results import Results, task
from papers.wan2014 import digits, plant, proofs, repair
from papers.wan2014.lmis import (
    Problem,
    cost_bound,
    farkas_multipliers,
    inequality_15,
    printed_box,
    printed_point,
    problem_38,
    state_feedback,
    thrust_bound,
)
from papers.wan2014.plant import AXES

SUBPROBLEM = "(14) rows 1, 3, 5, 7 with (30), (31)"


def _log(results: Results, where: str, found: Infimum | Solved | Infeasible | Undecided) -> None:
    results.attempt(where, list(found.attempts))


@task("(14)")
def theorem_2(case: Case, results: Results) -> None:
    """Refute (14), and with it Theorems 2 and 3 and (38), exactly."""
    problem = Problem(case)
    best = repair.enclosed(infimum(farkas_multipliers(problem)), "Farkas multipliers of (14)")
    _log(results, "(14)", best)
    below, above = proofs.margin_below(case, best.solved.values), proofs.margin_above(case, best.multipliers)
    results.certificate(below)
    results.certificate(above)
    results.quantity(
        "farkas.margin",
        -best.value,
        method="semidefinite program, enclosed exactly by a point and by multipliers",
        source="(14), (41)",
        lower=float(below.conclusions[-1].value),
        upper=float(above.conclusions[-1].value),
    )
    inside = repair.needed(solve(farkas_multipliers(problem)), "Farkas multipliers of (14)")
    results.certificate(proofs.infeasible_14(case, inside.values))
    results.certificate(proofs.corrected_14(case, inside.values))
    results.certificate(proofs.wrong_diagonal(case))
    results.certificate(proofs.input_counted_twice(case))
    results.certificate(proofs.empty_row_14(case))
    results.certificate(proofs.infeasible_29(case))
    exact = "exact certificate"
    for quantity, value, source in (
        ("eq14.feasible", 0, "(14), (41)"),
        ("eq14_corrected.feasible", 0, "(14), (24), (41)"),
        ("eq14.printed_diagonal_negative", 0, "(14), (43)"),
        ("eq14.input_counted_twice", 1, "(14), (24), (26)"),
        ("eq14.row_4_empty", 1, "(14)"),
        ("eq29.feasible", 0, "(29)"),
    ):
        results.quantity(quantity, value, method=exact, source=source)
    results.say("(14)", f"infeasible, Farkas certificate checked; margin {-best.value:.6e}")


@task("(38)")
def problem_as_printed(case: Case, results: Results) -> None:
    """Put (38) as printed before the solver: what somebody who follows the paper sees."""
    result = solve(problem_38(Problem(case)))
    _log(results, "(38)", result)
    if isinstance(result, Solved):
        raise ComputationError("(38)", "a point was found although (14) is proved infeasible", result.attempts)
    said = "infeasible, multipliers checked" if isinstance(result, Infeasible) else "no point, no multipliers"
    results.say("(38)", f"{said} ({len(result.attempts)} attempts)")


@task("(15), (24), (41)")
def slips_of_the_text(case: Case, results: Results) -> None:
    """Measure the slips: references to (15) and (24), and the entry of L that displaces the poles."""
    problem, X, rho = Problem(case), symmetric("X", 6), positive("rho")
    other = dataclasses.replace(problem.model, A=2 * problem.model.A)
    changed = Problem(case)
    changed.__dict__["model"] = other
    before, after = (inequality_15(p, X, rho, problem.xi0) for p in (problem, changed))
    results.quantity(
        "eq15.plant_terms",
        len(before.differences(after)),
        method="blocks of (15) that change when A is replaced by 2 A",
        source="(15)",
    )
    results.quantity(
        "eq24.order", 12, method="order of (24), the size of [x; e]; diag(P^-1, P^-1, I) is larger", source="(23), (24)"
    )
    L = problem.L.copy()
    L[1, 0] = -0.0025
    eigenvalues = np.linalg.eigvals(problem.model.A - L @ case.matrix("C"))
    wanted = np.array([re + sign * 1j * im for re, im in case.matrix("observer_poles") for sign in (1, -1)])
    error = min(np.abs(eigenvalues - wanted[list(order)]).max() for order in itertools.permutations(range(6)))
    results.quantity(
        "observer.pole_error_corrected", error, method="eigenvalues, best of all matchings", source="(40), (41)"
    )
    results.say("(15), (24), (41)", f"L21 = -0.0025 brings the observer poles within {error:.1e} 1/s")


@task(SUBPROBLEM)
def subproblem(case: Case, results: Results) -> None:
    """Solve the part of (14) that has a solution: the printed X, Y and K come from it."""
    problem = Problem(case)
    found = {}
    for name, saturated, weight in (
        ("rho", True, 1.0),
        ("rho_unsaturated", False, 1.0),
        ("rho_input_twice", True, 2.0),
    ):
        program = state_feedback(problem, saturated, weight)
        best = repair.enclosed(infimum(program), program.label)
        _log(results, program.label, best)
        found[name] = best
        ends = {}
        if weight == 1:
            above = proofs.subproblem_above(case, best.solved.values, name, saturated)
            below = proofs.subproblem_below(case, best.multipliers, name, saturated)
            results.certificate(above)
            results.certificate(below)
            ends = {"lower": float(below.conclusions[-1].value), "upper": float(above.conclusions[-1].value)}
        proved = "enclosed exactly by a point and by multipliers" if ends else "enclosed in floating point"
        results.quantity(
            f"subproblem.{name}",
            best.value,
            method=f"semidefinite program, margin followed to zero; {proved}",
            source="(14), (30), (31)",
            **ends,
        )
    K = np.linalg.solve(found["rho"].values["X"], found["rho"].values["Y"].T).T
    rho = found["rho"].value
    optimum = {name: np.asarray(found["rho"].values[name]) / rho for name in ("X", "Y")}
    optimum["eps"] = found["rho"].values["eps"] / rho
    spread = digits.spreads(problem, optimum, rho)
    design = case.designs["resynthesised"]["K"]
    if not ((spread["K"].low <= design) & (design <= spread["K"].high)).all():
        raise ComputationError(SUBPROBLEM, "designs/resynthesised.json is no near-optimal gain: search it again")
    for name, (i, j) in {"k11": (0, 0), "k12": (0, 1), "k14": (0, 3), "k15": (0, 4), "k25": (1, 4)}.items():
        results.quantity(
            f"subproblem.{name}",
            K[i, j],
            method="K = Y X^-1 at the optimum without margin; enclosed by its range at 1.001 of the optimum",
            source="(44)",
            lower=spread["K"].low[i, j],
            upper=spread["K"].high[i, j],
        )
    for name, value in (("X", optimum["X"]), ("Y", optimum["Y"]), ("K", K)):
        s = spread[name]
        results.gains(
            name, published=case.printed(name), resynthesised=value, identified=s.identified, low=s.low, high=s.high
        )
    results.quantity(
        "subproblem.identified_gains",
        int(spread["K"].identified.sum()),
        method="entries of K whose range at 1.001 of the optimum lies within 10 % to either side",
        source="(44)",
    )
    results.say(SUBPROBLEM, f"optimal, rho = {rho:.6e} enclosed to {found['rho'].width:.0e}")


@task("(43)")
def printed_digits(case: Case, results: Results) -> None:
    """Range rho over all X and Y that round to the printed digits; prove (43) and (44) consistent."""
    problem = Problem(case)
    ends = {}
    for name, sign in (("upper", 1.0), ("lower", -1.0)):
        best = repair.enclosed(infimum(printed_box(problem, sign)), "box of (43)")
        _log(results, "(43)", best)
        ends[name] = best
        results.quantity(
            f"box.rho_{name}",
            sign / best.value,
            method=f"semidefinite program in 1/rho, enclosed to {best.width:.0e} in floating point",
            source="(14), (30), (31), (43)",
        )
    near = ends["upper"].solved.values
    (X, _, eps, _), program = printed_point(problem)
    for name, found in zip(("x11", "x22", "eps"), ranges(program, [X[0, 0], X[1, 1], eps], near), strict=True):
        for end, value in (("lower", found.low), ("upper", found.high)):
            results.quantity(
                f"box.{name}_{end}",
                value,
                method="semidefinite program, attained at a point checked in numpy with a margin of 1e-6",
                source="(14), (30), (31), (43)",
            )
    results.certificate(proofs.box_point(case, ends["upper"].solved.values))
    results.quantity("box.feasible", 1, method="exact certificate", source="(43)")
    results.certificate(proofs.consistent_digits(case, *digits.consistent_point(case)))
    results.quantity("eq44.consistent", 1, method="exact certificate", source="(43), (44)")
    results.say("(43)", f"rho within {1 / -ends['lower'].value:.6e} .. {1 / ends['upper'].value:.6e}")


@task("printed K, L: full Lyapunov matrix")
def printed_bounds(case: Case, results: Results) -> None:
    """Certify cost, stability and thrust of the printed controller with 12x12 Lyapunov matrices."""
    _certified(case, results, "full_lyapunov", "printed('K')", case.matrix("K"))


def _certified(case: Case, results: Results, name: str, formula: str, K: np.ndarray) -> repair.Certified:
    """Bound cost and thrust of a gain, certify the bounds, and write the quantities under a prefix."""
    problem, slug = Problem(case), name.replace("_", "-")
    bounds = repair.certify(problem, K)
    _log(results, name, bounds.cost)
    program = dataclasses.replace(cost_bound(problem, K), margin=1e-7)
    point = repair.needed(solve(program, near=bounds.cost.solved.values), program.label)
    certificate = proofs.cost_certificate(
        case, formula, point.values, id=f"{slug}-cost", quantity=f"{name}.cost_bound", stable=f"{name}.stable"
    )
    results.certificate(certificate)
    proved = {c.of: c.value for c in certificate.conclusions}
    results.quantity(
        f"{name}.cost_bound",
        bounds.cost.value,
        method=f"infimum over 12x12 P, {_width(bounds.cost)}; upper end certified",
        source="(1), (7), (10)",
        upper=float(proved["cost"]),
    )
    results.quantity(f"{name}.stable", 1, method="certificate, every |Lambda_ii(t)| <= 1", source="(1), (7), (10)")
    for i, axis in enumerate(AXES):
        _log(results, f"{name} {axis}", bounds.thrust[i])
        program = dataclasses.replace(thrust_bound(problem, K, i), margin=1e-8)
        point = repair.needed(solve(program, near=bounds.thrust[i].solved.values), program.label)
        certificate = proofs.thrust_certificate(
            case, formula, point.values, i, id=f"{slug}-thrust-{axis}", quantity=f"{name}.thrust_{axis}"
        )
        results.certificate(certificate)
        results.quantity(
            f"{name}.thrust_{axis}",
            np.sqrt(bounds.thrust[i].value),
            method="infimum over 12x12 P of its own; upper end certified",
            source="(5), (10)",
            upper=float(certificate.conclusions[-1].value),
        )
    peaks = ", ".join(f"{p:.2f}" for p in bounds.peaks)
    results.say(name, f"J <= {float(proved['cost']):.6e}, thrust <= {peaks} N, certified")
    return bounds


def _width(found: Infimum) -> str:
    if not np.isfinite(found.lower):
        return "bounded from above only"
    return f"enclosed to {found.width:.0e} in floating point"


@task("repaired design")
def repaired(case: Case, results: Results) -> None:
    """Design a controller for the same limits and certify it as the printed one is certified."""
    problem, design = Problem(case), case.designs["repaired"]
    K, weight = design["K"], float(design["weight"][0, 0])
    share = repair.thrust_share(problem, K)
    if abs(share - repair.USED) > 1e-6:
        raise ComputationError("repaired design", f"uses {share} of the limits at the start: search it again")
    results.quantity(
        "repaired.weight",
        weight,
        method=f"input weight of the design, whose thrust at the start is within {repair.USED} of the limits of (5)",
        source="(5), (14)",
    )
    bounds = _certified(case, results, "repaired", "design('repaired', 'K')", K)
    if not (bounds.peaks <= problem.limits).all():
        raise ComputationError("repaired design", f"certified thrust {bounds.peaks} N exceeds the limits")


@task("Theorem 2, corrected")
def corrected_theorem(case: Case, results: Results) -> None:
    """Show that the theorem can be had: separate Lyapunov matrices for estimate and error are feasible."""
    problem = Problem(case)
    cost = repair.needed(solve(cost_bound(problem, case.matrix("K"))), "full Lyapunov cost")
    start = plant.observer_start(case, "measured_position").reshape(6, 1)
    program = repair.joint_design(problem, np.diag(np.diagonal(cost["S"])), start)
    best = repair.enclosed(infimum(program), program.label)
    _log(results, "Theorem 2, corrected", best)
    results.quantity(
        "joint.cost_bound",
        best.value,
        method="infimum over K and two 6x6 Lyapunov matrices, multipliers those of the printed design's bound",
        source="Theorem 2",
    )
    results.say("Theorem 2, corrected", f"feasible, J <= {best.value:.6e} without thrust limits")


@task("LQR")
def linear_quadratic(case: Case, results: Results) -> None:
    """Compare with an LQR that uses the full thrust limit along x."""
    problem, design = Problem(case), case.designs["lqr"]
    K, weight = design["K"], float(design["weight"][0, 0])
    if np.abs(K - repair.lqr(problem, weight)).max() > 1e-8 * np.abs(K).max():
        raise ComputationError("LQR", "designs/lqr.json is not the regulator of its weight: search it again")
    if spectral_abscissa(problem.model.A - problem.model.B @ K) >= 0:
        raise ComputationError("LQR", "the gain does not stabilise")
    results.quantity(
        "lqr.weight", weight, method="root of largest |f_x| = 40 N, two-body plant", source="(5), Section 4"
    )
    cost = plant.closed_loop_cost(case, K, problem.L)
    results.quantity("lqr.cost", cost, method="DOP853, two-body plant, 20 000 s", source="(4), Section 4")
    results.say("LQR", f"r = {weight:.4f}, J = {cost:.6e}")


TASKS = (
    theorem_2,
    problem_as_printed,
    slips_of_the_text,
    subproblem,
    printed_digits,
    printed_bounds,
    repaired,
    corrected_theorem,
    linear_quadratic,
)

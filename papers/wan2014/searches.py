"""Searches of wan2014: the designs that a run reads, certifies and flies."""

import numpy as np

from gainsay.lmi import infimum
from gainsay.tables import Case
from gainsay.tables.designs import FoundDesign
from papers.wan2014 import repair
from papers.wan2014.lmis import Problem, state_feedback

DIGITS = 12


def resynthesised(case: Case) -> FoundDesign:
    """K = Y X^-1 at the optimum of the sub-problem that the printed gains solve."""
    problem = Problem(case)
    program = state_feedback(problem)
    best = repair.enclosed(infimum(program), program.label)
    return FoundDesign(
        asked="the least rho of block rows 1, 3, 5, 7 of (14) with (30) at e(0) = 0 and (31); L as printed",
        method="semidefinite program, margin followed to zero",
        matrices={"K": repair.gain(best), "L": problem.L},
        converged=True,
        outcome={"rho": best.value},
        digits=DIGITS,
    )


def repaired(case: Case) -> FoundDesign:
    """The guaranteed-cost design with the least input weight that keeps the thrust at the start within its limits."""
    problem = Problem(case)
    weight = repair.repaired_weight(problem)
    K = repair.gain(repair.guaranteed_cost(problem, weight))
    return FoundDesign(
        asked=f"the least input weight whose thrust at the start is within {repair.USED} of every limit of (5)",
        method="guaranteed-cost LMI, block rows 1, 3, 5, 7 of (14) with (30), and a bracketed root over the weight",
        matrices={"K": K, "L": problem.L, "weight": np.array([[weight]])},
        converged=True,
        outcome={"thrust_share": repair.thrust_share(problem, K)},
        digits=DIGITS,
    )


def lqr(case: Case) -> FoundDesign:
    """The linear-quadratic regulator whose thrust along x just reaches its limit."""
    problem = Problem(case)
    weight = repair.lqr_weight(problem)
    K = repair.lqr(problem, weight)
    return FoundDesign(
        asked="the linear-quadratic regulator whose largest |f_x| on the two-body plant is its limit; L as printed",
        method="Riccati equation, and a bracketed root over the input weight",
        matrices={"K": K, "L": problem.L, "weight": np.array([[weight]])},
        converged=True,
        outcome={"peak_fx": repair.peak_fx(problem, K, case.number("horizon"))},
        digits=DIGITS,
    )


SEARCHES = {"resynthesised": resynthesised, "repaired": repaired, "lqr": lqr}

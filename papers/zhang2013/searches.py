"""Searches of zhang2013: the designs that a run reads, certifies and simulates."""

import numpy as np

from gainsay.errors import ComputationError
from gainsay.lmi import Infimum, Program, Solved, infimum, solve
from gainsay.tables import Case
from gainsay.tables.designs import FoundDesign
from papers.zhang2013.design import (
    fast_program,
    gains_of,
    least_squares_program,
    repaired_gains,
    standing,
    unsound_program,
)
from papers.zhang2013.plant import Spacecraft
from papers.zhang2013.theorem2 import EDITIONS, Setting


def _least(program: Program) -> Infimum:
    found = infimum(program)
    if not isinstance(found, Infimum):
        raise ComputationError(program.label, type(found).__name__.lower(), found.attempts)
    return found


def unsound(case: Case) -> FoundDesign:
    """Gains that (23) as printed accepts at lambda1 = 1 although their observer is unstable."""
    setting = Setting.of(Spacecraft.of(case), case, lambda1=1.0)
    found = solve(unsound_program(setting, EDITIONS["printed"]))
    if not isinstance(found, Solved):
        raise ComputationError("(23) printed", "no point with an unstable observer", found.attempts)
    K, L = gains_of(found.values)
    L = np.array([[0.0, round(float(L[0, 1]), 2)]])
    return FoundDesign(
        asked="gains that (23) as printed accepts at lambda1 = 1 with an unstable observer",
        method="a point of (23) as printed with N B <= -1, rounded to two decimals",
        matrices={"K": np.round(K, 2), "L": L},
        converged=True,
        outcome={"observer_pole": -(L @ setting.B).item()},
    )


def resynthesised(case: Case) -> FoundDesign:
    """The corrected Theorem 2 with an objective that leaves one solution."""
    setting = Setting.of(Spacecraft.of(case), case)
    found = _least(least_squares_program(setting))
    K, L = gains_of(found.values)
    return FoundDesign(
        asked="the least sum of squares of all unknowns of the corrected (23): strictly convex, one solution",
        method="semidefinite program, margin followed to zero",
        matrices={"K": K, "L": L},
        converged=True,
        outcome={"sum_of_squares": found.value},
        digits=7,
    )


def fast(case: Case) -> FoundDesign:
    """Gains of least gamma, which the flexible plant refuses."""
    found = _least(fast_program(Setting.of(Spacecraft.of(case), case)))
    K, L = gains_of(found.solved.values)
    return FoundDesign(
        asked="the least gamma of the corrected (23) with entries of at most 100",
        method="semidefinite program, rounded to two decimals",
        matrices={"K": np.round(K, 2), "L": np.array([[0.0, round(float(L[0, 1]), 2)]])},
        converged=True,
        outcome={"gamma": float(np.sqrt(found.value))},
    )


def repaired(case: Case) -> FoundDesign:
    """More damping at the same stiffness, without giving up delay margin or decay on the flexible plant."""
    craft, d_M = Spacecraft.of(case), case.number("d_M")
    K, L = repaired_gains(craft, case.matrix("K"), case.matrix("L"), d_M)
    stands = standing(craft, K, L, d_M)
    return FoundDesign(
        asked="the strongest damping at the printed stiffness whose delay margins and slowest decay are not worse",
        method="bisection over K2, and for each a bracketed root over L2; four decimals as printed",
        matrices={"K": K, "L": L},
        converged=True,
        outcome={
            "delay_margin_paper": stands.margin_paper,
            "delay_margin_all": stands.margin_all,
            "abscissa": stands.abscissa,
        },
    )


SEARCHES = {"unsound": unsound, "resynthesised": resynthesised, "fast": fast, "repaired": repaired}

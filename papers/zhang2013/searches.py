"""Searches of zhang2013: the designs that a run reads, certifies and simulates."""

from typing import Any

import numpy as np
from scipy.optimize import brentq

from gainsay.errors import ComputationError
from gainsay.tables import Case
from gainsay.tables.designs import FoundDesign
from papers.zhang2013.conditions import standing
from papers.zhang2013.plant import Spacecraft
from papers.zhang2013.statements import fast_program, least_squares_program, unsound_program


def gains_of(values: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """K = M X^-1 and L = P22^-T N of (24)."""
    X, M, N, P22 = (np.atleast_2d(values[name]) for name in ("X", "M", "N", "P22"))
    return np.linalg.solve(X.T, M.T).T, np.linalg.solve(P22.T, N)


def repaired_gains(craft: Spacecraft, K: np.ndarray, L: np.ndarray, d_M: float) -> tuple[np.ndarray, np.ndarray]:
    """More damping at the same stiffness, without giving up delay margin or decay on the flexible plant.

    K1 stays, so that the first torque does not grow. For every K2 the observer is made just fast enough for the delay
    margin of mode "all" to stay; the strongest damping K2 is taken for which the slowest root does not slow down.

    Parameters
    ----------
    K, L : array_like, shape (1, 2)
        Gains to be improved.
    d_M : float
        s.

    Returns
    -------
    K, L : ndarray, shape (1, 2)
        Rounded to four decimals, the printed number of digits.
    """
    K, L = np.asarray(K, dtype=float), np.asarray(L, dtype=float)
    before = standing(craft, K, L, d_M)

    def candidate(damping: float) -> tuple[np.ndarray, np.ndarray]:
        def excess(l2: float) -> float:
            loop = craft.flexible_loop([[K[0, 0], damping]], [[0.0, l2]], "all")
            return loop.quasi_polynomial.margin().delay - 1.001 * before.margin_all

        l2 = brentq(excess, 0.9 * L[0, 1], 3 * L[0, 1], xtol=1e-6)
        return np.array([[K[0, 0], round(damping, 4)]]), np.array([[0.0, round(float(l2), 4)]])

    def keeps(damping: float) -> bool:
        return standing(craft, *candidate(damping), d_M).abscissa <= 1.001 * before.abscissa

    low, high = 1.2 * K[0, 1], 4 * K[0, 1]  # K2 is negative: more damping is further down
    if not keeps(low) or keeps(high):
        raise ComputationError("repaired design", "the search interval of K2 does not bracket the wanted damping")
    for _ in range(20):
        middle = (low + high) / 2
        low, high = (middle, high) if keeps(middle) else (low, middle)
    return candidate(low)


def unsound(case: Case) -> FoundDesign:
    """Gains that (23) as printed accepts at lambda1 = 1 although their observer is unstable."""
    point = unsound_program(case, "printed", l1="1").solve().need("(23) printed, unstable observer")
    K, L = gains_of(point.values)
    L = np.array([[0.0, round(float(L[0, 1]), 2)]])
    return FoundDesign(
        asked="gains that (23) as printed accepts at lambda1 = 1 with an unstable observer",
        method="a point of (23) as printed with N B <= -1, rounded to two decimals",
        matrices={"K": np.round(K, 2), "L": L},
        converged=True,
        outcome={"observer_pole": -float((L @ Spacecraft.of(case).B).item())},
    )


def resynthesised(case: Case) -> FoundDesign:
    """The corrected Theorem 2 with an objective that leaves one solution."""
    optimum = least_squares_program(case).infimum().need("(23) least squares")
    K, L = gains_of(optimum.values)
    return FoundDesign(
        asked="the least sum of squares of all unknowns of the corrected (23): strictly convex, one solution",
        method="semidefinite program, margin followed to zero",
        matrices={"K": K, "L": L},
        converged=True,
        outcome={"sum_of_squares": optimum.value},
        digits=7,
    )


def fast(case: Case) -> FoundDesign:
    """Gains of least gamma, which the flexible plant refuses."""
    optimum = fast_program(case).infimum().need("(23) least gamma")
    K, L = gains_of(optimum.solved.values)
    return FoundDesign(
        asked="the least gamma of the corrected (23) with entries of at most 100",
        method="semidefinite program, rounded to two decimals",
        matrices={"K": np.round(K, 2), "L": np.array([[0.0, round(float(L[0, 1]), 2)]])},
        converged=True,
        outcome={"gamma": float(np.sqrt(optimum.value))},
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

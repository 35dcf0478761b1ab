"""Searches of wan2014: the designs that a run reads, certifies and flies."""

from collections.abc import Callable

import numpy as np
from scipy.linalg import solve_continuous_are, solve_continuous_lyapunov
from scipy.optimize import brentq

from gainsay.errors import ComputationError
from gainsay.tables import Case
from gainsay.tables.designs import FoundDesign
from papers.wan2014 import plant
from papers.wan2014.statements import cost_bound, joint_design, state_feedback

DIGITS = 12
#: part of the thrust limits that a design of ours uses at the start
USED = 0.999


def gain(values: dict) -> np.ndarray:
    """Return K = Y X^-1, shape (3, 6)."""
    return np.linalg.solve(np.asarray(values["X"]), np.asarray(values["Y"]).T).T


def thrust_share(case: Case, K: np.ndarray) -> float:
    """Return the largest thrust at the start over its limit of (5), the estimate at the measured position."""
    start = plant.observer_start(case, "measured_position")
    return float(np.max(np.abs(K @ start) / plant.thrust_limits(case)))


def lqr_gain(case: Case, weight: float) -> np.ndarray:
    """Return the linear-quadratic gain for Q and ``weight * R``, shape (3, 6); no uncertainty, full state.

    The Riccati equation is solved in hours-like units of time (its SI form is ill-conditioned) and polished by Newton's
    iteration of Kleinman.
    """
    model, R = plant.design_model(case), weight * case.matrix("R")
    unit = np.diag([1.0, 1.0, 1.0, 30.0, 30.0, 30.0])
    inverse = np.linalg.inv(unit)
    A, B, Q = unit @ model.A @ inverse, unit @ model.B, inverse @ case.matrix("Q") @ inverse
    P = solve_continuous_are(A, B, Q, R)
    for _ in range(3):
        K = np.linalg.solve(R, B.T @ P)
        closed = A - B @ K
        P = solve_continuous_lyapunov(closed.T, -(Q + K.T @ R @ K))
    return np.linalg.solve(R, B.T @ P) @ unit


def peak_fx(case: Case, K: np.ndarray, end: float) -> float:
    """Return the largest modulus of f_x over continuous time on the two-body plant, N, to a time in s."""
    loop = plant.ClosedLoop(case, K, case.matrix("L"))
    trajectory = loop.simulate(plant.observer_start(case, "measured_position"), end)
    return plant.peak_thrust(loop, trajectory, 0)[1]


def lqr_weight(case: Case, peak: Callable[[np.ndarray, float], float] | None = None) -> float:
    """Return the input weight r at which the largest modulus of f_x is exactly its limit.

    Found on the first 600 s, then checked over the whole horizon.

    Raises
    ------
    ComputationError
        If the peak lies later.
    """
    measure = peak or (lambda K, end: peak_fx(case, K, end))
    limit = float(plant.thrust_limits(case)[0])
    weight = brentq(lambda r: measure(lqr_gain(case, r), 600.0) - limit, 1e3, 1e5, xtol=1e-9, rtol=1e-13)
    whole = measure(lqr_gain(case, weight), case.number("horizon"))
    if abs(whole - limit) > 1e-8 * limit:
        raise ComputationError("LQR", f"largest |f_x| is {whole} N and not within the first 600 s")
    return float(weight)


def guaranteed_cost(case: Case, weight: float) -> np.ndarray:
    """Return the gain of block rows 1, 3, 5, 7 of (14) with (30) for the input weight ``weight * R``, without (31)."""
    stated = state_feedback(case, saturated=False, weight=repr(weight))
    return gain(stated.solve().need(stated.label).values)


def resynthesised(case: Case) -> FoundDesign:
    """K = Y X^-1 at the optimum of the sub-problem that the printed gains solve."""
    stated = state_feedback(case)
    best = stated.infimum().need(stated.label)
    return FoundDesign(
        asked="the least rho of block rows 1, 3, 5, 7 of (14) with (30) at e(0) = 0 and (31); L as printed",
        method="semidefinite program, margin followed to zero",
        matrices={"K": gain(best.values), "L": case.matrix("L")},
        converged=True,
        outcome={"rho": best.value},
        digits=DIGITS,
    )


def repaired(case: Case) -> FoundDesign:
    """The guaranteed-cost design with the least input weight that keeps the thrust at the start within its limits.

    (31) bounds the thrust over a whole level set of V, which costs the printed design more than half of its speed. A
    heavier input weight reaches the same limits with less; that the start is the worst is certified afterwards.
    """

    def excess(logarithm: float) -> float:
        return thrust_share(case, guaranteed_cost(case, float(np.exp(logarithm)))) - USED

    weight = float(np.exp(brentq(excess, np.log(1e3), np.log(1e5), xtol=1e-5)))
    K = guaranteed_cost(case, weight)
    return FoundDesign(
        asked=f"the least input weight whose thrust at the start is within {USED} of every limit of (5)",
        method="guaranteed-cost LMI, block rows 1, 3, 5, 7 of (14) with (30), and a bracketed root over the weight",
        matrices={"K": K, "L": case.matrix("L"), "weight": np.array([[weight]])},
        converged=True,
        outcome={"thrust_share": thrust_share(case, K)},
        digits=DIGITS,
    )


def lqr(case: Case) -> FoundDesign:
    """The linear-quadratic regulator whose thrust along x just reaches its limit."""
    weight = lqr_weight(case)
    K = lqr_gain(case, weight)
    return FoundDesign(
        asked="the linear-quadratic regulator whose largest |f_x| on the two-body plant is its limit; L as printed",
        method="Riccati equation, and a bracketed root over the input weight",
        matrices={"K": K, "L": case.matrix("L"), "weight": np.array([[weight]])},
        converged=True,
        outcome={"peak_fx": peak_fx(case, K, case.number("horizon"))},
        digits=DIGITS,
    )


def joint(case: Case) -> FoundDesign:
    """Multipliers of the corrected theorem: those of the printed design's cost bound, to three digits; and its gain."""
    cost = cost_bound(case, "printed('K')")
    multipliers = np.diagonal(np.asarray(cost.solve().need(cost.label)["S"]))
    texts = [f"{m:.2e}" for m in multipliers]
    stated = joint_design(case, M=f"diag({', '.join(texts)})")
    best = stated.infimum().need(stated.label)
    return FoundDesign(
        asked="multipliers with which the corrected theorem is solved; the gain is that of its least bound",
        method="full Lyapunov bound of the printed gains, then a semidefinite program",
        matrices={"M": np.diag([float(t) for t in texts]), "K": gain(best.values)},
        converged=True,
        outcome={"rho": best.value},
        digits=DIGITS,
    )


SEARCHES = {"resynthesised": resynthesised, "repaired": repaired, "lqr": lqr, "joint": joint}

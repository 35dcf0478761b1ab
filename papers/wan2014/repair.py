"""Designs of ours for the same spacecraft, observer and thrust limits: what the paper could have printed."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_continuous_are, solve_continuous_lyapunov
from scipy.optimize import brentq

from gainsay.errors import ComputationError
from gainsay.lmi import BlockMatrix, Infimum, Program, Solved, infimum, matrix, positive, solve, sym, symmetric
from papers.wan2014 import plant
from papers.wan2014.lmis import I6, Problem, cost_bound, state_feedback, thrust_bound
from papers.wan2014.plant import AXES

#: part of the thrust limits that a design of ours uses at the start
USED = 0.999


def gain(solved: Solved | Infimum) -> np.ndarray:
    """Return K = Y X^-1, shape (3, 6)."""
    return np.linalg.solve(np.asarray(solved.values["X"]), np.asarray(solved.values["Y"]).T).T


def needed(result: object, where: str) -> Solved:
    """Return a solution, or raise ComputationError with the attempts."""
    if not isinstance(result, Solved):
        raise ComputationError(where, f"{type(result).__name__} where a point is needed", result.attempts)
    return result


@dataclass(frozen=True)
class Certified:
    """Points of the 12x12 Lyapunov inequalities behind the bounds of a gain.

    Attributes
    ----------
    cost : Infimum
        Of `lmis.cost_bound`.
    thrust : tuple of Infimum
        Of `lmis.thrust_bound`, by axis, N^2.
    """

    cost: Infimum
    thrust: tuple[Infimum, ...]

    @property
    def peaks(self) -> np.ndarray:
        """Certified thrust by axis, N."""
        return np.sqrt([t.upper for t in self.thrust])


def enclosed(result: object, where: str) -> Infimum:
    """Return an infimum, or raise ComputationError with the attempts.

    Where no multipliers are proved the checked point still stands: its value is the bound from above.
    """
    if not isinstance(result, Infimum):
        raise ComputationError(where, f"{type(result).__name__} where an infimum is needed", result.attempts)
    return result if np.isfinite(result.value) else replace(result, value=result.upper)


def certify(problem: Problem, K: np.ndarray) -> Certified:
    """Find the least bounds on cost and thrust with full Lyapunov matrices, one for the cost and one an axis."""
    cost = enclosed(infimum(cost_bound(problem, K)), "full Lyapunov cost")
    thrust = [
        enclosed(infimum(thrust_bound(problem, K, i), near=_sizes(cost)), f"full Lyapunov thrust {AXES[i]}")
        for i in range(3)
    ]
    return Certified(cost, tuple(thrust))


def _sizes(cost: Infimum) -> dict:
    """Sizes for the thrust bounds: the level set of the cost's Lyapunov function through the start."""
    return {
        "P": cost.solved.values["P"] / cost.upper,
        "S": cost.solved.values["S"] / cost.upper,
        "square": 100.0,
    }


def guaranteed_cost(problem: Problem, weight: float) -> Solved:
    """Solve block rows 1, 3, 5, 7 of (14) with (30) for the input weight ``weight * R`` and without (31)."""
    program = state_feedback(problem, saturated=False, weight=weight)
    return needed(solve(program), program.label)


def thrust_share(problem: Problem, K: np.ndarray) -> float:
    """Return the largest thrust at the start over its limit of (5), the estimate at the measured position."""
    start = problem.x0 - problem.xi0[6:]
    return float(np.max(np.abs(K @ start).ravel() / problem.limits))


def repaired_weight(problem: Problem) -> float:
    """Return the least input weight whose thrust at the start keeps within `USED` of every limit of (5).

    (31) bounds the thrust over a whole level set of V, which costs the printed design more than half of its speed. A
    heavier input weight reaches the same limits with less; that the start is the worst is certified afterwards.
    """

    def excess(logarithm: float) -> float:
        return thrust_share(problem, gain(guaranteed_cost(problem, float(np.exp(logarithm))))) - USED

    return float(np.exp(brentq(excess, np.log(1e3), np.log(1e5), xtol=1e-5)))


def lqr(problem: Problem, weight: float) -> np.ndarray:
    """Return the linear-quadratic gain for Q and ``weight * R``, shape (3, 6); no uncertainty, full state.

    The Riccati equation is solved in hours-like units of time (its SI form is ill-conditioned) and polished by Newton's
    iteration of Kleinman.
    """
    m, R = problem.model, weight * problem.R
    unit = np.diag([1.0, 1.0, 1.0, 30.0, 30.0, 30.0])
    inverse = np.linalg.inv(unit)
    A, B, Q = unit @ m.A @ inverse, unit @ m.B, inverse @ problem.Q @ inverse
    P = solve_continuous_are(A, B, Q, R)
    for _ in range(3):
        K = np.linalg.solve(R, B.T @ P)
        closed = A - B @ K
        P = solve_continuous_lyapunov(closed.T, -(Q + K.T @ R @ K))
    return np.linalg.solve(R, B.T @ P) @ unit


def peak_fx(problem: Problem, K: np.ndarray, end: float) -> float:
    """Return the largest modulus of f_x over continuous time on the two-body plant, N, to a time in s."""
    loop = plant.ClosedLoop(problem.case, K, problem.L)
    trajectory = loop.simulate(plant.observer_start(problem.case, "measured_position"), end)
    return plant.peak_thrust(loop, trajectory, 0)[1]


def lqr_weight(problem: Problem, peak: Callable[[np.ndarray, float], float] | None = None) -> float:
    """Return the input weight r at which the largest modulus of f_x is exactly its limit.

    Found on the first 600 s, then checked over the whole horizon.

    Raises
    ------
    ComputationError
        If the peak lies later.
    """
    measure = peak or (lambda K, end: peak_fx(problem, K, end))
    limit = float(problem.limits[0])
    weight = brentq(lambda r: measure(lqr(problem, r), 600.0) - limit, 1e3, 1e5, xtol=1e-9, rtol=1e-13)
    whole = measure(lqr(problem, weight), problem.case.number("horizon"))
    if abs(whole - limit) > 1e-8 * limit:
        raise ComputationError("LQR", f"largest |f_x| is {whole} N and not within the first 600 s")
    return float(weight)


def joint_design(problem: Problem, multiplier: np.ndarray, xhat0: np.ndarray) -> Program:
    """State a corrected theorem: K with separate Lyapunov matrices for estimate and error.

    V = xhat' X^-1 xhat + e' P e; with the multipliers of the uncertainty channels fixed the condition is linear in X,
    Y = K X and P, and it needs no common matrix for plant and error, which is what makes (14) infeasible.

    Parameters
    ----------
    problem : Problem
    multiplier : ndarray, shape (c, c)
        Positive diagonal; one entry a channel with a nonzero column of E1.
    xhat0 : ndarray, shape (6, 1)
        Start of the estimate.
    """
    m = problem.model
    alive = np.flatnonzero(np.abs(m.E1).max(axis=0) > 0)
    E1, E2 = m.E1[:, alive], m.E2[alive]
    X, Y, P, rho = symmetric("X", 6), matrix("Y", 3, 6), symmetric("P", 6), positive("rho")
    F = BlockMatrix("joint", "estimate", "error", "channel", "output", "weight", "input")
    F["estimate", "estimate"] = sym(m.A @ X - m.B @ Y)
    F["estimate", "error"] = problem.L @ problem.case.matrix("C")
    F["estimate", "output"], F["estimate", "weight"], F["estimate", "input"] = X @ E2.T, X, Y.T
    F["error", "error"] = sym(P @ problem.observer)
    F["error", "channel"], F["error", "output"], F["error", "weight"] = P @ E1, E2.T, I6
    F["channel", "channel"], F["output", "output"] = -multiplier, -np.linalg.inv(multiplier)
    F["weight", "weight"], F["input", "input"] = -np.linalg.inv(problem.Q), -np.linalg.inv(problem.R)
    e0 = problem.x0 - xhat0
    start = BlockMatrix("start", "bound", "estimate")
    start["bound", "bound"] = rho - e0.T @ P @ e0
    start["bound", "estimate"], start["estimate", "estimate"] = xhat0.T, X
    return Program(minimise=rho, subject_to=[F < 0, start > 0, (P > 0).named("P > 0")], label="joint design")

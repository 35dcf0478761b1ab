"""The matrix inequalities of the paper, block by block as printed and as corrected, and the programs made of them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gainsay.lmi import (
    Affine,
    BlockMatrix,
    Definite,
    Program,
    diagonal,
    equal,
    matrix,
    positive,
    scalar,
    sym,
    symmetric,
    trace,
    within,
)
from gainsay.tables import Case
from papers.wan2014.plant import AXES, DesignModel, design_model, observer_start, thrust_limits

I3, I6 = np.eye(3), np.eye(6)
#: rows of the input in the state: the velocities
DRIVEN = slice(3, 6)


@dataclass(frozen=True)
class Problem:
    """The data of the paper's example.

    Attributes
    ----------
    case : Case
    """

    case: Case

    @cached_property
    def model(self) -> DesignModel:
        """A, B, E1, E2 of (1)-(3), (42)."""
        return design_model(self.case)

    @cached_property
    def L(self) -> np.ndarray:
        """Observer gain (41), shape (6, 3)."""
        return self.case.matrix("L")

    @cached_property
    def observer(self) -> np.ndarray:
        """A - L C of (9), shape (6, 6)."""
        return self.model.A - self.L @ self.case.matrix("C")

    @cached_property
    def x0(self) -> np.ndarray:
        """Initial state, shape (6, 1): m and m/s."""
        return self.case.matrix("x0").reshape(6, 1)

    @cached_property
    def xi0(self) -> np.ndarray:
        """Initial augmented state [x; e] of the simulations, shape (12, 1)."""
        return np.vstack([self.x0, self.x0 - observer_start(self.case, "measured_position").reshape(6, 1)])

    @cached_property
    def limits(self) -> np.ndarray:
        """Thrust bounds of (5), N."""
        return thrust_limits(self.case)

    @property
    def Q(self) -> np.ndarray:
        """State weight of (4)."""
        return self.case.matrix("Q")

    @property
    def R(self) -> np.ndarray:
        """Input weight of (4)."""
        return self.case.matrix("R")


def inequality_14(
    problem: Problem, X: Affine, Y: Affine, eps: Affine, rho: float | Affine = 1.0, weight: float = 1.0
) -> BlockMatrix:
    """Left side of (14) as printed.

    With `rho`, the same matrix times rho after X <- rho X, Y <- rho Y, eps <- rho eps: linear in all four. With
    `weight`, for the input weight ``weight * R``.
    """
    m = problem.model
    eps_EE = eps * (m.E1 @ m.E1.T)
    F = BlockMatrix("(14)", "state", "error", "uncertainty", "nothing", "input", "input again", "weight")
    F["state", "state"] = sym(m.A @ X - m.B @ Y) + eps_EE
    F["state", "error"] = m.B @ Y + eps_EE
    F["state", "uncertainty"] = X @ m.E2.T
    F["state", "input"] = Y.T
    F["state", "input again"] = -Y.T
    F["state", "weight"] = X
    F["error", "error"] = sym(problem.observer @ X) + eps_EE
    F["error", "input"] = -Y.T
    F["error", "input again"] = Y.T
    F["uncertainty", "uncertainty"] = -eps * I6
    F["nothing", "nothing"] = -eps * I6
    F["input", "input"] = -(rho * np.linalg.inv(weight * problem.R))
    F["input again", "input again"] = -(rho * np.linalg.inv(weight * problem.R))
    F["weight", "weight"] = -(rho * np.linalg.inv(problem.Q))
    return F


def inequality_14_corrected(problem: Problem, X: Affine, Y: Affine, eps: Affine) -> BlockMatrix:
    """Left side of (14) as (24) gives it: one column [Y'; -Y'] for the input."""
    return inequality_14(problem, X, Y, eps).sub(
        "state", "error", "uncertainty", "nothing", "input", "weight", label="(14) corrected"
    )


def inequality_15(problem: Problem, X: Affine, rho: Affine, xi0: np.ndarray) -> BlockMatrix:
    """Left side of (15) with the augmented start `xi0`, shape (12, 1)."""
    F = BlockMatrix("(15)", "bound", "state", "error")
    F["bound", "bound"] = -rho
    F["bound", "state"], F["bound", "error"] = xi0[:6].T, xi0[6:].T
    F["state", "state"] = F["error", "error"] = -X
    return F


def inequality_30(X: Affine, inverse_rho: Affine, start: np.ndarray) -> BlockMatrix:
    """Left side of (30) at e(0) = 0, where the rows of the error drop out; linear in 1/rho."""
    F = BlockMatrix("(30)", "bound", "state")
    F["bound", "bound"] = -inverse_rho
    F["bound", "state"] = inverse_rho * start.T
    F["state", "state"] = -X
    return F


def inequality_31(X: Affine, Y: Affine, inverse_rho: Affine, limit: float, axis: int) -> BlockMatrix:
    """Left side of (31) for one axis, with the row of Y that U_i picks."""
    F = BlockMatrix(f"(31) {AXES[axis]}", "state", "error", "input")
    F["state", "state"] = F["error", "error"] = -X
    F["state", "input"] = Y[axis, :].T
    F["error", "input"] = -Y[axis, :].T
    F["input", "input"] = -(limit**2) * inverse_rho
    return F


def inequality_37(w: Affine, inverse_rho: Affine) -> BlockMatrix:
    """Left side of (37)."""
    F = BlockMatrix("(37)", "w", "rho")
    F["w", "w"], F["w", "rho"], F["rho", "rho"] = -w, np.ones((1, 1)), -inverse_rho
    return F


def problem_38(problem: Problem) -> Program:
    """(38) as printed: minimise w subject to (14), (30), (31) and (37); infeasible, whatever the data but n and L."""
    X, Y, eps = symmetric("X", 6), matrix("Y", 3, 6), positive("eps")
    inverse_rho, w = positive("inverse_rho"), positive("w")
    saturation = [inequality_31(X, Y, inverse_rho, u, i) < 0 for i, u in enumerate(problem.limits)]
    return Program(
        minimise=w,
        subject_to=[
            inequality_14(problem, X, Y, eps) < 0,
            (X > 0).named("X > 0"),
            inequality_30(X, inverse_rho, problem.x0) < 0,
            saturation,
            inequality_37(w, inverse_rho) < 0,
        ],
        label="(38)",
    )


def farkas_multipliers(problem: Problem) -> Program:
    """Multipliers that refute (14): V >= 0 of trace 1 with rows 4-6 of V1 and V2 equal, and W >= l I.

    W = A'V1 + V1 A + Ac'V3 + V3 Ac. The weighted sum of the first two block rows and columns of (14) is then tr(W X)
    plus a non-negative multiple of eps: Y drops out, since B' (V1 - V2) = 0.
    """
    A, Ac = problem.model.A, problem.observer
    V1, V3, level = symmetric("V1", 6), symmetric("V3", 6), scalar("level")
    upper = matrix("V2", 3, 6)
    V = BlockMatrix("V", "state", "error")
    V["state", "state"], V["error", "error"] = V1, V3
    V["state", "error"] = I6[:, :3] @ upper + I6[:, DRIVEN] @ (I6[DRIVEN] @ V1)
    W = sym(V1 @ A) + sym(V3 @ Ac)
    return Program(
        minimise=-level,
        subject_to=[V > 0, (level * I6 < W).named("W"), equal(trace(V1) + trace(V3), 1, "trace V")],
        label="Farkas multipliers of (14)",
    )


def state_feedback(problem: Problem, saturated: bool = True, weight: float = 1.0) -> Program:
    """Block rows 1, 3, 5, 7 of (14) with (30) at e(0) = 0 and (31): what the printed X, Y, K solve.

    Linear in rho after X <- rho X, Y <- rho Y, eps <- rho eps. (31) is 2 y_i X^-1 y_i' <= u_i^2 / rho: its Schur
    complement, X being there twice.

    Parameters
    ----------
    problem : Problem
    saturated : bool
        Whether (31) is imposed.
    weight : float
        Factor of R: 1 as printed; 2 where its term is counted twice, as the two columns of (14) do.
    """
    X, Y, eps, rho = symmetric("X", 6), matrix("Y", 3, 6), positive("eps"), positive("rho")
    F = inequality_14(problem, X, Y, eps, rho, weight).sub(
        "state", "uncertainty", "input", "weight", label="(14) 1,3,5,7"
    )
    start = BlockMatrix("(30)", "bound", "state")
    start["bound", "bound"], start["bound", "state"], start["state", "state"] = -np.eye(1), problem.x0.T, -X
    constraints: list[Definite] = [F < 0, start < 0]
    for i, limit in enumerate(problem.limits if saturated else ()):
        thrust = BlockMatrix(f"(31) {AXES[i]}", "state", "input")
        thrust["state", "state"], thrust["state", "input"] = -X, Y[i, :].T
        thrust["input", "input"] = -(limit**2 / 2) * np.eye(1)
        constraints.append(thrust < 0)
    return Program(minimise=rho, subject_to=constraints, label="(14) 1,3,5,7 with (30), (31)")


def _unscaled_subproblem(problem: Problem) -> tuple[tuple, list]:
    """Unknowns X, Y, eps, 1/rho and constraints of the sub-problem as printed, linear in 1/rho."""
    X, Y, eps, inverse_rho = symmetric("X", 6), matrix("Y", 3, 6), positive("eps"), positive("inverse_rho")
    F = inequality_14(problem, X, Y, eps).sub("state", "uncertainty", "input", "weight", label="(14) 1,3,5,7")
    constraints = [F < 0, inequality_30(X, inverse_rho, problem.x0) < 0]
    for i, limit in enumerate(problem.limits):
        thrust = BlockMatrix(f"(31) {AXES[i]}", "state", "input")
        thrust["state", "state"], thrust["state", "input"] = -X, Y[i, :].T
        thrust["input", "input"] = -(limit**2 / 2) * inverse_rho
        constraints.append(thrust < 0)
    return (X, Y, eps, inverse_rho), constraints


def _digits_kept(problem: Problem) -> tuple[tuple, list]:
    """Unknowns and constraints of the sub-problem, X and Y within half a unit of the last digits of (43)."""
    unknowns, constraints = _unscaled_subproblem(problem)
    for name, unknown in zip("XY", unknowns, strict=False):
        printed = problem.case.printed(name)
        low = np.array([[float(x.low) for x in row] for row in printed.rows])
        high = np.array([[float(x.high) for x in row] for row in printed.rows])
        constraints.append(within(unknown, low, high, f"digits of {name}"))
    return unknowns, constraints


def printed_point(problem: Problem) -> tuple[tuple[Affine, ...], Program]:
    """Return the unknowns X, Y, eps, 1/rho of the sub-problem and all its points that round to (43)."""
    unknowns, constraints = _digits_kept(problem)
    return unknowns, Program(subject_to=constraints, label="box of (43)")


def printed_box(problem: Problem, sign: float) -> Program:
    """Range of 1/rho over those points.

    Parameters
    ----------
    problem : Problem
    sign : float
        1 minimises 1/rho, -1 maximises it.
    """
    (_, _, _, inverse_rho), constraints = _digits_kept(problem)
    return Program(minimise=sign * inverse_rho, subject_to=constraints, label="box of (43)")


def near_optimal(problem: Problem, rho: float) -> tuple[tuple[Affine, ...], Program]:
    """Return the unknowns X, Y, eps, 1/rho of the sub-problem as printed, and all its points with a cost below rho."""
    unknowns, constraints = _unscaled_subproblem(problem)
    level = (unknowns[3] > 1 / rho).named("near the optimum")
    return unknowns, Program(subject_to=[*constraints, level], label="near-optimal sub-problem")


@dataclass(frozen=True)
class ClosedLoop:
    """Plant and observer in xi = [x; e]: dxi/dt = (A + E Lambda F) xi, u = k xi, cost weight Q.

    Attributes
    ----------
    A : ndarray, shape (12, 12)
    E, F : ndarray, shapes (12, c) and (c, 12)
        Uncertainty channels; the last one of (42) is left out, since its column of E1 is zero.
    k : ndarray, shape (3, 12)
    Q : ndarray, shape (12, 12)
    """

    A: np.ndarray
    E: np.ndarray
    F: np.ndarray
    k: np.ndarray
    Q: np.ndarray


def closed_loop(problem: Problem, K: np.ndarray) -> ClosedLoop:
    """Close the loop of (9) and (11) with a gain K, shape (3, 6)."""
    m = problem.model
    alive = np.flatnonzero(np.abs(m.E1).max(axis=0) > 0)
    A = np.block([[m.A - m.B @ K, m.B @ K], [np.zeros((6, 6)), problem.observer]])
    E = np.vstack([m.E1, m.E1])[:, alive]
    F = np.hstack([m.E2, np.zeros((6, 6))])[alive]
    k = np.hstack([-K, K])
    weight = k.T @ problem.R @ k
    weight[:6, :6] += problem.Q
    return ClosedLoop(A, E, F, k, weight)


def _dissipation(loop: ClosedLoop, P: Affine, S: Affine, weight: np.ndarray) -> BlockMatrix:
    """Form of dV/dt + xi' weight xi under one multiplier a channel, in (xi, w); S-procedure with |Lambda_ii| <= 1."""
    form = BlockMatrix("dissipation", "state", "channel")
    form["state", "state"] = sym(P @ loop.A) + loop.F.T @ S @ loop.F + weight
    form["state", "channel"] = P @ loop.E
    form["channel", "channel"] = -S
    return form


def cost_bound(problem: Problem, K: np.ndarray) -> Program:
    """Least certified bound on J from xi(0), over all 12x12 P and one multiplier a channel."""
    loop = closed_loop(problem, K)
    P, S = symmetric("P", 12), diagonal("S", loop.E.shape[1])
    return Program(
        minimise=problem.xi0.T @ P @ problem.xi0,
        subject_to=[_dissipation(loop, P, S, loop.Q) < 0, (P > 0).named("P > 0")],
        label="full Lyapunov cost",
    )


def thrust_bound(problem: Problem, K: np.ndarray, axis: int) -> Program:
    """Least certified square of the thrust along an axis (N^2), over all 12x12 P and one multiplier a channel."""
    loop = closed_loop(problem, K)
    P, S, square = symmetric("P", 12), diagonal("S", loop.E.shape[1]), positive("square")
    reach = BlockMatrix("reach", "state", "input")
    reach["state", "state"], reach["state", "input"] = P, loop.k[axis : axis + 1].T
    reach["input", "input"] = square
    return Program(
        minimise=square,
        subject_to=[
            _dissipation(loop, P, S, np.zeros((12, 12))) < 0,
            reach > 0,
            (1 - problem.xi0.T @ P @ problem.xi0 > 0).named("start inside"),
        ],
        label=f"full Lyapunov thrust {AXES[axis]}",
    )

"""H-infinity and H2 synthesis with certificates: state feedback and full-order output feedback.

The controller is found by rounded numbers; what is reported of the loop that it closes is enclosed from the gains as
they stand. That no controller does better rests on multipliers of a linear matrix inequality (H-infinity).

References
----------
C. Scherer, P. Gahinet, M. Chilali, Multiobjective output-feedback control via LMI optimization, IEEE Trans. Automatic
Control 42 (1997) 896-911.
J. Doyle, K. Glover, P. Khargonekar, B. Francis, State-space solutions to standard H2 and H-infinity control problems,
IEEE Trans. Automatic Control 34 (1989) 831-847.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import solve_continuous_are

from gainsay.errors import ComputationError, InputError
from gainsay.lmi import BlockMatrix, Infimum, Program, Solved, infimum, matrix, scalar, solve, sym, symmetric
from gainsay.systems.norm_bounds import NormBounds
from gainsay.systems.norms import h2_enclosure, hinf_enclosure
from gainsay.systems.statespace import StateSpace, finite, square

_ROOMS = (1e-3, 1e-2, 1e-1)  # above the least gamma: at it the solution is on the boundary and the gains run away


@dataclass(frozen=True, eq=False, init=False)
class StandardPlant:
    """x' = A x + B1 w + B2 u, z = C1 x + D11 w + D12 u, y = C2 x + D21 w.

    Attributes
    ----------
    A, B1, B2, C1, C2 : ndarray
        Shapes (n, n), (n, w), (n, u), (z, n), (y, n).
    D11, D12, D21 : ndarray
        Shapes (z, w), (z, u), (y, w); zero where None.

    Raises
    ------
    InputError
        If shapes do not fit together or an entry is not finite.
    """

    A: np.ndarray
    B1: np.ndarray
    B2: np.ndarray
    C1: np.ndarray
    C2: np.ndarray
    D11: np.ndarray
    D12: np.ndarray
    D21: np.ndarray

    def __init__(
        self,
        A: ArrayLike,
        B1: ArrayLike,
        B2: ArrayLike,
        C1: ArrayLike,
        C2: ArrayLike,
        D11: ArrayLike | None = None,
        D12: ArrayLike | None = None,
        D21: ArrayLike | None = None,
    ) -> None:
        object.__setattr__(self, "A", square(A, "A"))
        B1, B2, C1, C2 = finite(B1, "B1"), finite(B2, "B2"), finite(C1, "C1"), finite(C2, "C2")
        n, w, u, z, y = len(self.A), B1.shape[1], B2.shape[1], C1.shape[0], C2.shape[0]
        for name, given, shape in (
            ("B1", B1, (n, w)),
            ("B2", B2, (n, u)),
            ("C1", C1, (z, n)),
            ("C2", C2, (y, n)),
            ("D11", D11, (z, w)),
            ("D12", D12, (z, u)),
            ("D21", D21, (y, w)),
        ):
            value = np.zeros(shape) if given is None else finite(given, name)
            if value.shape != shape or 0 in shape:
                raise InputError("plant", field=name, value=value.shape, expected=f"shape {shape}, none of it zero")
            object.__setattr__(self, name, value)

    def with_gain(self, K: np.ndarray) -> StateSpace:
        """Loop from w to z under u = K x."""
        return StateSpace(self.A + self.B2 @ K, self.B1, self.C1 + self.D12 @ K, self.D11)

    def with_controller(self, K: StateSpace) -> StateSpace:
        """Loop from w to z under u = K(s) y."""
        through = self.B2 @ K.D
        A = np.block([[self.A + through @ self.C2, self.B2 @ K.C], [K.B @ self.C2, K.A]])
        B = np.vstack([self.B1 + through @ self.D21, K.B @ self.D21])
        C = np.hstack([self.C1 + self.D12 @ K.D @ self.C2, self.D12 @ K.C])
        return StateSpace(A, B, C, self.D11 + self.D12 @ K.D @ self.D21)


@dataclass(frozen=True, eq=False)
class Synthesis:
    """A controller and what is known of the loop that it closes.

    Attributes
    ----------
    controller : ndarray or StateSpace
        State feedback gain K, shape (u, n), of u = K x, or K(s) of u = K y.
    norm : NormBounds
        Of the loop from w to z, proved for the gains as they stand.
    least : float
        No controller of the kind reaches less, to rounding: from checked multipliers (H-infinity), or the optimum of
        the Riccati equations, which the loop reaches to 1e-7 (H2).
    """

    controller: np.ndarray | StateSpace
    norm: NormBounds
    least: float


def hinf_state_feedback(plant: StandardPlant) -> Synthesis:
    """State feedback u = K x with about the least H-infinity norm from w to z.

    Parameters
    ----------
    plant : StandardPlant
        Its outputs y play no part.

    Returns
    -------
    Synthesis
        The norm is that of the best point found, raised by at most 1e-3, 1e-2 or 1e-1, the first that gives gains which
        keep it. How far it is from the best is what lies between `least` and the norm: little on well-scaled plants,
        much where the solver's enclosure is wide, as on plants with rates of 1e3 beside costs of one.

    Raises
    ------
    ComputationError
        If the least gamma is not enclosed, or no gain found keeps its promise.

    Examples
    --------
    >>> plant = StandardPlant([[-1.0]], [[1.0]], [[1.0]], [[1.0], [0.0]], [[1.0]], D12=[[0.0], [1.0]])
    >>> found = hinf_state_feedback(plant)  # the least norm is 1/sqrt(2)
    >>> found.least <= 2**-0.5 <= found.norm.upper
    True
    """
    n, u = plant.B2.shape
    X, Y = symmetric("X", n), matrix("Y", u, n)

    def conditions(gamma: Any) -> list:
        F = BlockMatrix("bounded real lemma", "x", "w", "z")
        F["x", "x"] = sym(plant.A @ X + plant.B2 @ Y)
        F["x", "w"] = plant.B1
        F["x", "z"] = X @ plant.C1.T + Y.T @ plant.D12.T
        F["w", "w"] = -gamma * np.eye(plant.B1.shape[1])
        F["w", "z"] = plant.D11.T
        F["z", "z"] = -gamma * np.eye(len(plant.C1))
        return [F < 0, X > 0]

    def close(values: dict) -> tuple[np.ndarray, StateSpace]:
        K = np.linalg.solve(values["X"], values["Y"].T).T
        return K, plant.with_gain(K)

    return _near_the_least(conditions, close)


def hinf_output_feedback(plant: StandardPlant) -> Synthesis:
    """Controller u = K(s) y of the plant's order with about the least H-infinity norm from w to z.

    Parameters
    ----------
    plant : StandardPlant

    Returns
    -------
    Synthesis
        As `hinf_state_feedback`; `least` bounds controllers of every order.

    Raises
    ------
    ComputationError
        If the least gamma is not enclosed, or no controller found keeps its promise.
    """
    A, B1, B2, C1, C2 = plant.A, plant.B1, plant.B2, plant.C1, plant.C2
    D11, D12, D21 = plant.D11, plant.D12, plant.D21
    (n, u), y = B2.shape, len(C2)
    X, Y = symmetric("X", n), symmetric("Y", n)
    Ah, Bh, Ch, Dh = matrix("Ah", n, n), matrix("Bh", n, y), matrix("Ch", u, n), matrix("Dh", u, y)

    def conditions(gamma: Any) -> list:
        F = BlockMatrix("bounded real lemma", "x", "y", "w", "z")
        F["x", "x"] = sym(A @ X + B2 @ Ch)
        F["x", "y"] = Ah.T + A + B2 @ Dh @ C2
        F["x", "w"] = B1 + B2 @ Dh @ D21
        F["x", "z"] = X @ C1.T + Ch.T @ D12.T
        F["y", "y"] = sym(Y @ A + Bh @ C2)
        F["y", "w"] = Y @ B1 + Bh @ D21
        F["y", "z"] = C1.T + C2.T @ Dh.T @ D12.T
        F["w", "w"] = -gamma * np.eye(B1.shape[1])
        F["w", "z"] = D11.T + D21.T @ Dh.T @ D12.T
        F["z", "z"] = -gamma * np.eye(len(C1))
        G = BlockMatrix("coupling", "x", "y")
        G["x", "x"], G["x", "y"], G["y", "y"] = X, np.eye(n), Y
        return [F < 0, G > 0]

    def close(values: dict) -> tuple[StateSpace, StateSpace]:
        X, Y, Dk = values["X"], values["Y"], values["Dh"]
        # M N' = I - X Y; any factors do, these are of one size
        left, sizes, right = np.linalg.svd(np.eye(n) - X @ Y)
        M, N = left * np.sqrt(sizes), right.T * np.sqrt(sizes)
        Ck = np.linalg.solve(M, (values["Ch"] - Dk @ C2 @ X).T).T
        Bk = np.linalg.solve(N, values["Bh"] - Y @ B2 @ Dk)
        inner = values["Ah"] - N @ Bk @ C2 @ X - Y @ B2 @ Ck @ M.T - Y @ (A + B2 @ Dk @ C2) @ X
        Ak = np.linalg.solve(M, np.linalg.solve(N, inner).T).T
        K = StateSpace(Ak, Bk, Ck, Dk)
        return K, plant.with_controller(K)

    return _near_the_least(conditions, close)


def _near_the_least(
    conditions: Callable[[Any], list], close: Callable[[dict], tuple[np.ndarray | StateSpace, StateSpace]]
) -> Synthesis:
    gamma = scalar("gamma")
    found = infimum(Program(minimise=gamma, subject_to=conditions(gamma), label="H-infinity synthesis"))
    if not isinstance(found, Infimum):
        raise ComputationError("H-infinity synthesis", f"least gamma: {type(found).__name__.lower()}", found.attempts)
    attempts = []
    for room in _ROOMS:
        level = found.upper + room * max(abs(found.upper), 1e-12)
        point = solve(Program(subject_to=conditions(level), label="H-infinity synthesis"))
        if not isinstance(point, Solved):
            attempts.append({"gamma": level, "outcome": type(point).__name__})
            continue
        try:
            controller, loop = close(point.values)
            norm = hinf_enclosure(loop.A, loop.B, loop.C, loop.D)
        except (InputError, ComputationError, np.linalg.LinAlgError) as error:
            attempts.append({"gamma": level, "error": str(error)})
            continue
        if norm.upper <= level:
            return Synthesis(controller, norm, max(found.lower, 0.0))
        attempts.append({"gamma": level, "norm": norm.upper})
    raise ComputationError("H-infinity synthesis", "no controller keeps the norm of the inequality", attempts)


def h2_state_feedback(plant: StandardPlant) -> Synthesis:
    """State feedback u = K x with the least H2 norm from w to z.

    Parameters
    ----------
    plant : StandardPlant
        With D11 = 0 and D12 of full column rank.

    Raises
    ------
    InputError
        If D11 is not zero or D12 has not full column rank.
    ComputationError
        If the Riccati equation has no stabilising solution.
    """
    _require_regular(plant, output=False)
    P, K = _regulator(plant.A, plant.B2, plant.C1, plant.D12)
    loop = plant.with_gain(K)
    norm = h2_enclosure(loop.A, loop.B, loop.C)
    return _optimal(K, norm, float(np.trace(plant.B1.T @ P @ plant.B1)))


def h2_output_feedback(plant: StandardPlant) -> Synthesis:
    """Controller u = K(s) y with the least H2 norm from w to z: the regulator on the Kalman filter's estimate.

    Parameters
    ----------
    plant : StandardPlant
        With D11 = 0, D12 of full column and D21 of full row rank.

    Raises
    ------
    InputError
        If D11 is not zero or D12 or D21 has not full rank.
    ComputationError
        If a Riccati equation has no stabilising solution.
    """
    _require_regular(plant, output=True)
    P, K = _regulator(plant.A, plant.B2, plant.C1, plant.D12)
    S, L = _regulator(plant.A.T, plant.C2.T, plant.B1.T, plant.D21.T)
    L = L.T
    controller = StateSpace(plant.A + plant.B2 @ K + L @ plant.C2, -L, K)
    loop = plant.with_controller(controller)
    norm = h2_enclosure(loop.A, loop.B, loop.C, loop.D)
    through = plant.D12 @ K
    optimum = np.trace(plant.B1.T @ P @ plant.B1) + np.trace(through @ S @ through.T)
    return _optimal(controller, norm, float(optimum))


def _optimal(controller: np.ndarray | StateSpace, norm: NormBounds, square: float) -> Synthesis:
    """The synthesis, if the loop has the norm that the Riccati equations promise; two ways to the same number."""
    least = float(np.sqrt(max(square, 0.0)))
    if not abs(norm.upper - least) <= 1e-7 * norm.upper:
        raise ComputationError("H2 synthesis", f"the loop has the norm {norm.upper!r}, the Riccati equations {least!r}")
    return Synthesis(controller, norm, least)


def _require_regular(plant: StandardPlant, output: bool) -> None:
    if plant.D11.any():
        raise InputError("H2 synthesis", field="D11", expected="zero: else the norm is infinite")
    if np.linalg.matrix_rank(plant.D12) < plant.D12.shape[1]:
        raise InputError("H2 synthesis", field="D12", expected="full column rank")
    if output and np.linalg.matrix_rank(plant.D21) < plant.D21.shape[0]:
        raise InputError("H2 synthesis", field="D21", expected="full row rank")


def _regulator(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """P and K = -R^-1 (B'P + D'C) of the regulator with cost |C x + D u|^2."""
    R = D.T @ D
    try:
        # SciPy before 1.17 takes s only together with e
        P = solve_continuous_are(A, B, C.T @ C, R, e=np.eye(len(A)), s=C.T @ D)
    except (np.linalg.LinAlgError, ValueError) as error:
        raise ComputationError("H2 synthesis", f"Riccati equation: {str(error).splitlines()[0]}") from None
    return P, -np.linalg.solve(R, B.T @ P + D.T @ C)

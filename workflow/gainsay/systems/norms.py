"""H-infinity and H2 norms of stable systems, and the bounded real lemma's certificate matrix.

References
----------
Boyd, Balakrishnan, Kabamba, Mathematics of Control, Signals and Systems 2 (1989) 207-219: the Hamiltonian test.
Bruinsma, Steinbuch, Systems & Control Letters 14 (1990) 287-293: the two-step iteration.
"""

import warnings
from itertools import pairwise

import numpy as np
from scipy.linalg import eig, solve_continuous_are, solve_continuous_lyapunov

from gainsay.errors import ComputationError, InputError
from gainsay.systems.statespace import StateSpace

_LIMIT = 60


def hinf_norm(A, B, C, D=None, *, tolerance: float = 1e-10) -> tuple[float, float]:
    """H-infinity norm of a stable system, by the Hamiltonian test.

    The value is the gain at the returned frequency, hence a lower bound. It is also the norm to (1 + 2 tolerance):
    at that level no eigenvalue of the Hamiltonian pencil is a crossing, every one near the imaginary axis being
    judged by the gain of the system at its frequency.

    Parameters
    ----------
    A, B, C, D : array_like
        Shapes (n, n), (n, m), (p, n), (p, m); D is zero where None.
    tolerance : float
        Relative width of the final enclosure.

    Returns
    -------
    norm : float
        The norm.
    frequency : float
        Angular frequency, rad/s, at which it is attained; infinity where it is the norm of D.

    Raises
    ------
    InputError
        If the system is unstable or shapes do not fit.
    ComputationError
        If the iteration does not end.
    """
    system = StateSpace(A, B, C, D)
    system.require_stable("H-infinity norm")
    system = system.balanced()
    best, frequency = _first_guess(system)
    if best == 0.0:
        return 0.0, 0.0
    for _ in range(_LIMIT):
        level = best * (1 + 2 * tolerance)
        crossings = _crossings(system, level)
        middles = [0.5 * (a + b) for a, b in pairwise(crossings)] + crossings
        highest = max(((system.gain(w), w) for w in middles), default=(0.0, 0.0))
        best, frequency = max((best, frequency), highest)
        if highest[0] <= level:
            return best, frequency
    raise ComputationError("H-infinity norm", f"no convergence in {_LIMIT} Hamiltonian tests, lower bound {best!r}")


def _first_guess(system: StateSpace) -> tuple[float, float]:
    """Largest gain over zero, infinity, the poles' frequencies and a coarse grid around them, with its frequency."""
    poles = np.linalg.eigvals(system.A)
    sizes = np.abs(poles)
    grid = np.geomspace(sizes.min() / 30, 30 * sizes.max(), 40)
    candidates = {0.0, np.inf, *sizes.tolist(), *np.abs(poles.imag).tolist(), *grid.tolist()}
    return max((system.gain(w), w) for w in sorted(candidates))


def _crossings(system: StateSpace, level: float) -> list[float]:
    """Frequencies w >= 0 where the response may have `level` as a singular value, in ascending order.

    A double eigenvalue on the axis splits off it by the square root of the rounding error, so that everything
    near the axis is returned; the caller judges by the gain there.
    """
    numerators, denominators = eig(*_hamiltonian_pencil(system, level), right=False, homogeneous_eigvals=True)
    finite = np.abs(denominators) > 1e-14 * np.abs(numerators)
    eigenvalues = numerators[finite] / denominators[finite]
    near = eigenvalues[np.abs(eigenvalues.real) <= 1e-4 * np.abs(eigenvalues) + 1e-300]
    return sorted({abs(float(w)) for w in near.imag})


def _hamiltonian_pencil(system: StateSpace, level: float) -> tuple[np.ndarray, np.ndarray]:
    """Pencil (M, N) whose finite imaginary eigenvalues are the crossings of `level`.

    Without an inverse of level^2 I - D'D, which is nearly singular where the norm is close to that of D.
    """
    A, B, C, D = system.A, system.B, system.C, system.D
    (p, m), n = D.shape, A.shape[0]
    # Singular pair (w, z) of the response: G w = level z and G* z = level w, with states of G and of its adjoint.
    M = np.block(
        [
            [A, np.zeros((n, n)), B, np.zeros((n, p))],
            [np.zeros((n, n)), -A.T, np.zeros((n, m)), -C.T],
            [C, np.zeros((p, n)), D, -level * np.eye(p)],
            [np.zeros((m, n)), B.T, -level * np.eye(m), D.T],
        ]
    )
    return M, np.diag(np.concatenate([np.ones(2 * n), np.zeros(m + p)]))


def h2_norm(A, B, C, D=None) -> float:
    """H2 norm of a stable, strictly proper system: square root of trace C P C' with the controllability Gramian P.

    Parameters
    ----------
    A, B, C : array_like
        Shapes (n, n), (n, m), (p, n).
    D : array_like, shape (p, m), optional
        Must be zero where given.

    Returns
    -------
    float

    Raises
    ------
    InputError
        If the system is unstable or D is not zero (the norm is infinite).
    ComputationError
        If the value by the observability Gramian differs by more than 1e-8 relative.
    """
    system = StateSpace(A, B, C, D)
    system.require_stable("H2 norm")
    if np.any(system.D):
        raise InputError("H2 norm of a system with feedthrough is infinite", field="D", expected="zero")
    system = system.balanced()
    P = solve_continuous_lyapunov(system.A, -system.B @ system.B.T)
    Q = solve_continuous_lyapunov(system.A.T, -system.C.T @ system.C)
    by_inputs, by_outputs = np.trace(system.C @ P @ system.C.T), np.trace(system.B.T @ Q @ system.B)
    if abs(by_inputs - by_outputs) > 2e-8 * abs(by_outputs):
        raise ComputationError("H2 norm", f"the two Gramians give squares {by_inputs!r} and {by_outputs!r}")
    return float(np.sqrt(max(by_inputs, 0.0)))


def bounded_real_matrix(A, B, C, D, P, gamma: float) -> np.ndarray:
    """Matrix of the bounded real lemma, [[A'P + PA + C'C, PB + C'D], [., D'D - gamma^2 I]].

    Negative definite with P > 0 proves that A is stable and the H-infinity norm is below gamma.

    Parameters
    ----------
    A, B, C, D : array_like
        Shapes (n, n), (n, m), (p, n), (p, m); D is zero where None.
    P : array_like, shape (n, n)
        Symmetric Lyapunov matrix.
    gamma : float
        The bound.

    Returns
    -------
    ndarray, shape (n + m, n + m)
    """
    system = StateSpace(A, B, C, D)
    A, B, C, D, P = system.A, system.B, system.C, system.D, np.asarray(P, dtype=float)
    cross = P @ B + C.T @ D
    return np.block([[A.T @ P + P @ A + C.T @ C, cross], [cross.T, D.T @ D - gamma**2 * np.eye(B.shape[1])]])


def is_definite(M, sign: int = 1) -> bool:
    """Whether sign * M is positive definite, after scaling the diagonal to one so that units do not matter."""
    M = sign * 0.5 * (np.asarray(M, dtype=float) + np.asarray(M, dtype=float).T)
    diagonal = np.diag(M)
    if not np.isfinite(M).all() or np.any(diagonal <= 0):
        return False
    scale = 1 / np.sqrt(diagonal)
    # The margin is what rounding can move an eigenvalue of a matrix with unit diagonal by.
    return bool(np.linalg.eigvalsh(M * np.outer(scale, scale)).min() > 8 * M.shape[0] * np.finfo(float).eps)


def bounded_real_certificate_matrix(A, B, C, D, gamma: float) -> np.ndarray:
    """Lyapunov matrix P > 0 for which the bounded real matrix at gamma is negative definite, strictly.

    The Riccati equation of the lemma is solved with C'C raised by a positive matrix, the largest multiple for
    which a solution exists, so that the returned point lies inside the feasible set and can be certified after
    rounding. What is returned has been tested in floating point; it is a proof only once a checker says so.

    Parameters
    ----------
    A, B, C, D : array_like
        Shapes (n, n), (n, m), (p, n), (p, m); D is zero where None.
    gamma : float
        The bound to certify, above the norm by 1e-6 relative or more.

    Returns
    -------
    ndarray, shape (n, n)

    Raises
    ------
    InputError
        If the system is unstable or gamma does not exceed its norm.
    ComputationError
        If no certificate matrix was found.
    """
    norm, frequency = hinf_norm(A, B, C, D)
    if not gamma > norm:
        raise InputError(
            f"bound at or below the H-infinity norm {norm!r} attained at {frequency!r} rad/s",
            field="gamma", value=gamma, expected="a larger bound",
        )  # fmt: skip
    system = StateSpace(A, B, C, D)
    A, B, C, D = system.A, system.B, system.C, system.D
    R = gamma**2 * np.eye(B.shape[1]) - D.T @ D
    weight = _state_weight(system)
    attempts = []
    for exponent in range(0, -15, -1):
        Q = C.T @ C + 10.0**exponent * weight
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                P = solve_continuous_are(A, B, Q, -R, s=C.T @ D)
        except (np.linalg.LinAlgError, ValueError) as error:
            attempts.append({"raised": 10.0**exponent, "error": str(error).splitlines()[0]})
            continue
        P = 0.5 * (P + P.T)
        if is_definite(P) and is_definite(bounded_real_matrix(A, B, C, D, P, gamma), -1):
            return P
        attempts.append({"raised": 10.0**exponent, "error": "solution not inside the feasible set"})
    raise ComputationError("bounded real lemma", f"no certificate matrix at gamma = {gamma!r}", attempts)


def _state_weight(system: StateSpace) -> np.ndarray:
    """Positive diagonal weight on the states in the units of C'C, from the closed Gramians' typical sizes."""
    P = solve_continuous_lyapunov(system.A, -system.B @ system.B.T)
    sizes = np.diag(P).clip(min=0)
    largest = sizes.max() or 1.0
    return np.trace(system.C @ P @ system.C.T) / P.shape[0] * np.diag(1 / np.maximum(sizes, 1e-12 * largest))

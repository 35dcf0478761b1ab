"""H-infinity and H2 norms of stable systems in continuous and discrete time, and the bounded real lemma's matrix.

References
----------
Boyd, Balakrishnan, Kabamba, Mathematics of Control, Signals and Systems 2 (1989) 207-219: the Hamiltonian test.
K. Zhou, J. C. Doyle, K. Glover, Robust and Optimal Control, 1996, section 21.2: the bilinear transformation.
"""

import warnings
from dataclasses import replace
from itertools import pairwise

import numpy as np
from flint import fmpq_mat
from numpy.typing import ArrayLike
from scipy.linalg import eig, solve_continuous_are, solve_continuous_lyapunov

from gainsay.errors import ComputationError, InputError
from gainsay.systems.norm_bounds import NormBounds, h2_bounds, hinf_bounds, identity
from gainsay.systems.spectrum import rational, require_hurwitz, require_schur
from gainsay.systems.statespace import StateSpace


def hinf_norm(
    A: ArrayLike,
    B: ArrayLike,
    C: ArrayLike,
    D: ArrayLike | None = None,
    *,
    tolerance: float = 1e-10,
    sample: float | None = None,
) -> tuple[float, float]:
    """H-infinity norm of a stable system.

    Parameters
    ----------
    A, B, C, D : array_like
        Shapes (n, n), (n, m), (p, n), (p, m); D is zero where None.
    tolerance : float
        The norm is at most (1 + 2 tolerance) times the value, which is proved.
    sample : float, optional
        Sampling time, s, of a system in discrete time; continuous time where None.

    Returns
    -------
    norm : float
        The gain at the returned frequency, rounded down.
    frequency : float
        Angular frequency, rad/s, at which it is attained; infinity where it is the norm of D.

    Raises
    ------
    InputError
        If the system is unstable or shapes do not fit.
    ComputationError
        If stability or the norm cannot be settled.

    Examples
    --------
    >>> hinf_norm([[-2.0]], [[1.0]], [[1.0]])
    (0.5, 0.0)
    """
    bounds = hinf_enclosure(A, B, C, D, tolerance=tolerance, sample=sample)
    return bounds.lower, bounds.frequency


def hinf_enclosure(
    A: ArrayLike,
    B: ArrayLike,
    C: ArrayLike,
    D: ArrayLike | None = None,
    *,
    tolerance: float = 1e-10,
    sample: float | None = None,
) -> NormBounds:
    """H-infinity norm of a stable system between two proved ends, (1 + 2 tolerance) apart; see `hinf_norm`."""
    if not 0 < tolerance < 1:
        raise InputError("", field="tolerance", value=tolerance, expected="between 0 and 1")
    system = StateSpace(A, B, C, D)
    exact = _exact(system)
    if not (system.B.shape[1] and system.C.shape[0]):
        raise InputError("a norm needs inputs and outputs", field="B, C", value=(system.B.shape, system.C.shape))
    if sample is None:
        require_hurwitz(system.A, "H-infinity norm")
        return hinf_bounds(*exact, _likely_peaks(system), width=2 * tolerance)
    require_sample(sample)
    require_schur(system.A, "H-infinity norm")
    moved = _bilinear(*exact)
    floats = StateSpace(*(_rounded(M) for M in moved))
    bounds = hinf_bounds(*moved, _likely_peaks(floats), width=2 * tolerance)
    return replace(bounds, frequency=float(2 * np.arctan(bounds.frequency) / sample))


def _exact(system: StateSpace) -> tuple[fmpq_mat, fmpq_mat, fmpq_mat, fmpq_mat]:
    return rational(system.A), rational(system.B), rational(system.C), rational(system.D)


def _rounded(M: fmpq_mat) -> np.ndarray:
    return np.array(M.tolist(), dtype=object).astype(float).reshape(M.nrows(), M.ncols())


def require_sample(sample: float) -> None:
    """Refuse what is no sampling time, s."""
    if not (np.isfinite(sample) and sample > 0):
        raise InputError("", field="sample", value=sample, expected="a positive time, s")


def _bilinear(A: fmpq_mat, B: fmpq_mat, C: fmpq_mat, D: fmpq_mat) -> tuple[fmpq_mat, fmpq_mat, fmpq_mat, fmpq_mat]:
    """Continuous system with the response at s of the discrete one at z = (1 + s)/(1 - s); A has no eigenvalue -1."""
    inverse = (A + identity(A.nrows())).inv()
    return (A - identity(A.nrows())) * inverse, 2 * inverse * B, C * inverse, D - C * inverse * B


def _likely_peaks(system: StateSpace) -> list[float]:
    """Frequency of the largest gain over the poles' frequencies and a coarse grid around them, by rounded numbers."""
    system = system.balanced()
    poles = np.linalg.eigvals(system.A)
    sizes = np.abs(poles)
    grid = np.geomspace(max(sizes.min() / 30, 1e-300), 30 * sizes.max() + 1e-300, 40)
    candidates = {0.0, *sizes.tolist(), *np.abs(poles.imag).tolist(), *grid.tolist()}
    best, shift = 0.0, 0.0
    for w in sorted(candidates):
        gain = _rounded_gain(system, w)
        if gain > best:
            best, shift = gain, w
    return [shift, *_level_guesses(system, best)] if best > 0 else [shift]


def _rounded_gain(system: StateSpace, frequency: float) -> float:
    """The gain by rounded numbers, zero where a pole or the range of doubles is too near."""
    try:
        return system.gain(frequency)
    except np.linalg.LinAlgError:
        return 0.0


def _level_guesses(system: StateSpace, best: float) -> list[float]:
    """Frequencies between the crossings of levels that rise to the peak, by rounded numbers: guesses, no more."""
    guess = []
    for _ in range(12):
        numerators, denominators = eig(
            *_hamiltonian_pencil(system, best * (1 + 1e-9)), right=False, homogeneous_eigvals=True
        )
        finite = np.abs(denominators) > 1e-14 * np.abs(numerators)
        values = numerators[finite] / denominators[finite]
        near = np.unique(np.abs(values[np.abs(values.real) <= 1e-6 * np.abs(values)].imag))
        middles = [0.5 * (a + b) for a, b in pairwise(near)] + list(near)
        gain, place = max(((_rounded_gain(system, w), float(w)) for w in middles), default=(0.0, 0.0))
        if not gain > best * (1 + 1e-9):
            break
        best, guess = gain, [place]
    return guess


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


def h2_norm(
    A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike | None = None, *, sample: float | None = None
) -> float:
    """H2 norm of a stable system: square root of trace C P C' (and D D') with the controllability Gramian P.

    Parameters
    ----------
    A, B, C : array_like
        Shapes (n, n), (n, m), (p, n).
    D : array_like, shape (p, m), optional
        Must be zero where given, in continuous time.
    sample : float, optional
        Sampling time, s, of a system in discrete time; continuous time where None.

    Returns
    -------
    float
        Right to 1e-9 relative: where rounding could have done more, the Gramian is computed exactly.

    Raises
    ------
    InputError
        If the system is unstable or, in continuous time, D is not zero (the norm is infinite).
    ComputationError
        If stability cannot be settled.
    """
    system = StateSpace(A, B, C, D)
    if sample is None:
        value = _rounded_h2(system)
        if value is not None:
            return value
    bounds = h2_enclosure(A, B, C, D, sample=sample)
    return 0.5 * (bounds.lower + bounds.upper)


def h2_enclosure(
    A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike | None = None, *, sample: float | None = None
) -> NormBounds:
    """H2 norm of a stable system between two proved ends, equal but for rounding; see `h2_norm`."""
    system = StateSpace(A, B, C, D)
    exact = _exact(system)
    if sample is None:
        _require_strictly_proper(system)
        require_hurwitz(system.A, "H2 norm")
        return h2_bounds(*exact)
    require_sample(sample)
    require_schur(system.A, "H2 norm")
    return h2_bounds(*exact, discrete=True)


def _require_strictly_proper(system: StateSpace) -> None:
    if np.any(system.D):
        raise InputError("H2 norm of a system with feedthrough is infinite", field="D", expected="zero")


def _rounded_h2(system: StateSpace) -> float | None:
    """The norm from a Gramian in double precision, None where its residual does not prove nine digits.

    With R the residual of P and Q the other Gramian, the square of the norm is off by trace Q R.
    """
    _require_strictly_proper(system)
    system = system.balanced()
    A, B, C = system.A, system.B, system.C
    n, eps = len(A), np.finfo(float).eps
    poles, T = np.linalg.eig(A)
    # Bauer and Fike: no eigenvalue of A is farther to the right of the computed ones than this
    slack = 10 * n * eps * np.linalg.norm(A) * np.linalg.cond(T)
    if not poles.real.max() + 1e4 * slack < 0:
        return None
    P = solve_continuous_lyapunov(A, -B @ B.T)
    Q = solve_continuous_lyapunov(A.T, -C.T @ C)
    square = float(np.trace(C @ P @ C.T))
    residual = np.linalg.norm(A @ P + P @ A.T + B @ B.T) + 4 * n * eps * np.linalg.norm(A) * np.linalg.norm(P)
    if not abs(np.trace(Q)) * residual + 4 * n * eps * np.sum(np.abs(C) @ np.abs(P) * np.abs(C)) < 1e-9 * square:
        return None
    return float(np.sqrt(square))


def bounded_real_matrix(
    A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike | None, P: ArrayLike, gamma: float
) -> np.ndarray:
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


def is_definite(M: ArrayLike, sign: int = 1) -> bool:
    """Whether sign * M is positive definite, after scaling the diagonal to one so that units do not matter."""
    given = np.asarray(M, dtype=float)
    signed = sign * 0.5 * (given + given.T)
    diagonal = np.diag(signed)
    if not np.isfinite(signed).all() or np.any(diagonal <= 0):
        return False
    scale = 1 / np.sqrt(diagonal)
    # The margin is what rounding can move an eigenvalue of a matrix with unit diagonal by.
    return bool(np.linalg.eigvalsh(signed * np.outer(scale, scale)).min() > 8 * len(signed) * np.finfo(float).eps)


def bounded_real_certificate_matrix(
    A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike | None, gamma: float
) -> np.ndarray:
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
            field="gamma",
            value=gamma,
            expected="a larger bound",
        )
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
                # SciPy before 1.17 takes s only together with e
                P = solve_continuous_are(A, B, Q, -R, e=np.eye(len(A)), s=C.T @ D)
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

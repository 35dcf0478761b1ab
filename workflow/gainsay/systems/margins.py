"""Disk margins of a loop and bounds on the structured singular value of a matrix.

References
----------
P. Seiler, A. Packard, P. Gahinet, An introduction to disk margins, IEEE Control Systems Magazine 40 (2020) 78-95.
A. Packard, J. Doyle, The complex structured singular value, Automatica 29 (1993) 71-109.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from flint import acb, acb_mat, arb, ctx
from numpy.typing import ArrayLike
from scipy.linalg import block_diag
from scipy.optimize import minimize

from gainsay.errors import ComputationError, InputError
from gainsay.exact.definite import hermitian_positive_definite
from gainsay.systems.norms import hinf_enclosure
from gainsay.systems.statespace import StateSpace

_ROUNDS = 200
#: largest logarithm of a scaling
_WIDEST = 100.0


@dataclass(frozen=True)
class DiskMargin:
    """How far gain and phase of one loop may change together, proved.

    Attributes
    ----------
    lower, upper : float
        The disk margin alpha lies between them; ends without a unit.
    frequency : float
        rad/s at which it is least.
    gain : tuple of float
        The loop stays stable while its gain is multiplied by any constant between the two (at `lower`).
    phase : float
        The loop stays stable while its phase changes by less, rad (at `lower`).
    """

    lower: float
    upper: float
    frequency: float
    gain: tuple[float, float]
    phase: float


def disk_margin(
    A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike | None = None, *, skew: float = 0.0
) -> DiskMargin:
    """Disk margin of a loop L = C (sI - A)^-1 B + D of one channel, closed by negative feedback.

    Parameters
    ----------
    A, B, C, D : array_like
        Shapes (n, n), (n, 1), (1, n), (1, 1); D is zero where None.
    skew : float
        0 for the balanced margin, 1 for that of the sensitivity, -1 for that of the complementary sensitivity.

    Returns
    -------
    DiskMargin

    Raises
    ------
    InputError
        If the loop has not one channel, or is unstable or not well posed when closed.
    ComputationError
        If stability or the margin cannot be settled.

    Examples
    --------
    >>> round(disk_margin([[0.0]], [[1.0]], [[1.0]]).lower, 6)  # an integrator
    2.0
    """
    loop = StateSpace(A, B, C, D)
    if loop.D.shape != (1, 1):
        raise InputError("disk margin", field="D", value=loop.D.shape, expected="a loop of one channel, (1, 1)")
    if not np.isfinite(skew):
        raise InputError("disk margin", field="skew", value=skew, expected="a finite number")
    direct = 1 + loop.D[0, 0]
    if direct == 0:
        raise InputError("disk margin", field="D", value=-1.0, expected="a loop that is well posed when closed")
    into, out = loop.B / direct, loop.C / direct
    # S + (skew - 1)/2, with the sensitivity S = 1/(1 + L)
    bounds = hinf_enclosure(loop.A - into @ loop.C, into, -out, [[1 / direct + (skew - 1) / 2]])
    if bounds.lower == 0:
        raise ComputationError("disk margin", "the margin is infinite")
    lower, upper = float(np.nextafter(1 / bounds.upper, 0)), float(np.nextafter(1 / bounds.lower, np.inf))
    return DiskMargin(lower, upper, bounds.frequency, *_classical(lower, skew))


def _classical(alpha: float, skew: float) -> tuple[tuple[float, float], float]:
    """Gains and phases inside the disk D(alpha, skew): what its circle cuts off the real axis and the unit circle."""
    low = (2 - alpha * (1 - skew)) / (2 + alpha * (1 + skew)) if 2 + alpha * (1 + skew) > 0 else 0.0
    room = 2 - alpha * (1 + skew)
    high = (2 + alpha * (1 - skew)) / room if room else np.inf
    cosine = (1 + low * high) / (low + high) if np.isfinite(high) else low
    phase = float(np.arccos(cosine)) if abs(cosine) <= 1 else np.inf
    return (max(low, 0.0), float(high) if room > 0 else np.inf), phase


@dataclass(frozen=True)
class StructuredBounds:
    """Bounds on the structured singular value.

    Attributes
    ----------
    lower : float
        1 / |Delta| of the perturbation found; rounded.
    upper : float
        Proved by the scaling.
    perturbation : ndarray, shape (n, n), complex
        Delta of the structure and of norm 1/lower for which I - M Delta is singular to rounding.
    scaling : ndarray, shape (k,)
        d_i > 0 of each block: the norm of D M D^-1 is at most `upper`.
    """

    lower: float
    upper: float
    perturbation: np.ndarray
    scaling: np.ndarray


def uncertain_matrix(M: ArrayLike) -> np.ndarray:
    """The matrix of a structured singular value in complex doubles; InputError unless it is square and finite."""
    try:
        matrix = np.asarray(M, dtype=complex)
    except (TypeError, ValueError) as error:
        raise InputError("structured singular value", field="M", expected="a matrix of complex numbers") from error
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or not matrix.size or not np.isfinite(matrix).all():
        raise InputError("structured singular value", field="M", value=matrix.shape, expected="a finite square matrix")
    return matrix


def structured_bounds(M: ArrayLike, blocks: Sequence[int]) -> StructuredBounds:
    """Bounds on the structured singular value of a matrix for full complex blocks.

    The upper bound is least over the scalings, a convex problem; with at most three blocks it is the value itself. The
    lower bound comes from the power iteration, whose perturbation is checked.

    Parameters
    ----------
    M : array_like, shape (n, n)
        Complex.
    blocks : sequence of int
        Sizes of the square full blocks down the diagonal; they add up to n.

    Returns
    -------
    StructuredBounds

    Raises
    ------
    InputError
        If the matrix is not square and finite, or the blocks do not add up.
    ComputationError
        If the upper bound is not proved.

    Examples
    --------
    >>> round(structured_bounds([[0, 4], [1, 0]], [1, 1]).upper, 6)
    2.0
    """
    M = uncertain_matrix(M)
    sizes = [int(k) for k in blocks]
    if any(k < 1 or k != b for k, b in zip(sizes, blocks, strict=True)) or sum(sizes) != len(M):
        raise InputError("blocks", value=list(blocks), expected=f"positive sizes that add up to {len(M)}")
    if not M.any():
        return StructuredBounds(0.0, 0.0, np.full_like(M, np.nan), np.ones(len(sizes)))
    try:
        with np.errstate(over="ignore", under="ignore"):
            scaling = _best_scaling(M, sizes)
            whole = np.repeat(scaling, sizes)
            norm = float(np.linalg.norm(M * whole[:, None] / whole[None, :], 2))
    except np.linalg.LinAlgError as error:  # entries too far apart for doubles
        raise ComputationError("structured singular value", f"no scaling of the blocks: {error}") from error
    for room in (1e-13, 1e-11, 1e-9, 1e-6):
        if _norm_below(M, whole, norm * (1 + room)):
            try:
                lower, perturbation = _worst(M, sizes)
            except np.linalg.LinAlgError as error:
                raise ComputationError("structured singular value", f"no lower bound: {error}") from error
            return StructuredBounds(lower, norm * (1 + room), perturbation, scaling)
    raise ComputationError("structured singular value", f"no proof of the upper bound {norm!r}")


def _pieces(sizes: list[int]) -> list[slice]:
    return [slice(a, b) for a, b in pairwise(np.cumsum([0, *sizes]))]


def _best_scaling(M: np.ndarray, sizes: list[int]) -> np.ndarray:
    """Scalings d_i > 0 of the blocks, the first one 1, for which D M D^-1 has about the least norm."""
    pieces, count = _pieces(sizes), len(sizes)
    size = np.array([[np.linalg.norm(M[rows, columns]) for columns in pieces] for rows in pieces])
    log = np.zeros(count)
    for _ in range(_ROUNDS):  # Osborne: rows and columns of equal size
        for i in range(count):
            scaled = size * np.exp(log[:, None] - log[None, :])
            row = np.sqrt((scaled[i] ** 2).sum() - scaled[i, i] ** 2)
            column = np.sqrt((scaled[:, i] ** 2).sum() - scaled[i, i] ** 2)
            floor = 1e-12 * size.max()  # a structure that falls apart has no best scaling, only ever better ones
            log[i] += 0.5 * np.log(max(column, floor) / max(row, floor))

    def value(free: np.ndarray) -> float:
        # a structure that falls apart has scalings without end, beyond which doubles leave nothing to compare
        whole = np.repeat(np.exp(np.clip(np.append(0.0, free), -_WIDEST, _WIDEST)), sizes)
        return float(np.log(np.linalg.norm(M * whole[:, None] / whole[None, :], 2)))

    best = log[1:] - log[0]
    if count > 1:
        for _ in range(3):  # convex but not smooth: restarted simplices
            minimum = minimize(
                value, best, method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-14, "maxiter": 4000}
            )
            best = minimum.x if minimum.fun < value(best) else best
    return np.exp(np.clip(np.append(0.0, best), -_WIDEST, _WIDEST))


def _norm_below(M: np.ndarray, whole: np.ndarray, level: float) -> bool:
    """Prove in balls that D M D^-1 has a norm below a level: level^2 D^2 - M* D^2 M > 0."""
    with ctx.workprec(256):
        d = [arb(float(x)) ** 2 for x in whole]
        rows = [[acb(float(x.real), float(x.imag)) for x in row] for row in M]
        weighted = acb_mat([[d[i] * x for x in row] for i, row in enumerate(rows)])
        product = acb_mat([[x.conjugate() for x in column] for column in zip(*rows, strict=True)]) * weighted
        square = acb_mat([[d[i] * arb(level) ** 2 if i == j else acb(0) for j in range(len(d))] for i in range(len(d))])
        return hermitian_positive_definite(square - product)


def _worst(M: np.ndarray, sizes: list[int]) -> tuple[float, np.ndarray]:
    """Largest spectral radius of M Q found over block-diagonal contractions Q, and the perturbation that it gives."""
    pieces = _pieces(sizes)
    best, chosen = 0.0, np.eye(len(M), dtype=complex)
    left, _, right = np.linalg.svd(M)
    starts = [right[k].conj() for k in range(len(M))] + [np.ones(len(M), dtype=complex)]
    starts += list(np.linalg.eig(M)[1].T)
    for b in starts:
        w = left[:, 0]
        for _ in range(_ROUNDS):
            # Packard and Doyle's iteration: a = M b, z from w, w = M* z, b from a
            a = M @ b
            if not np.linalg.norm(a):
                break
            a = a / np.linalg.norm(a)
            z = np.concatenate([_aligned(w[p], a[p]) for p in pieces])
            w = M.conj().T @ z
            if not np.linalg.norm(w):
                break
            w = w / np.linalg.norm(w)
            b = np.concatenate([_aligned(a[p], w[p]) for p in pieces])
        else:
            Q = block_diag(*(_turn(a[p], b[p]) for p in pieces))
            values = np.linalg.eigvals(M @ Q)
            top = values[np.argmax(np.abs(values))]
            if abs(top) > best:
                best, chosen = float(abs(top)), Q / top
    return best, chosen


def _aligned(source: np.ndarray, like: np.ndarray) -> np.ndarray:
    """`like` turned and stretched to the length of `source`, as far as it has a direction."""
    size = np.linalg.norm(like)
    return like * (np.linalg.norm(source) / size) if size else source


def _turn(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """A contraction of rank one that takes the direction of a to that of b."""
    lengths = np.linalg.norm(a) * np.linalg.norm(b)
    return np.outer(b, a.conj()) / lengths if lengths else np.zeros((len(a), len(a)), dtype=complex)

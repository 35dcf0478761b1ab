"""Disks that hold the eigenvalues of many matrices at once, proved in floating point, and what they resolve.

References
----------
G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed., section 7.2.1 (Gershgorin); the bound on what the
eigenvectors leave out as in S. M. Rump, "Verification methods: rigorous results using floating-point arithmetic", Acta
Numerica 19 (2010), section 13.
"""

from collections.abc import Callable

import numpy as np

from gainsay.errors import InputError

__all__ = ["INSIDE", "OUTSIDE", "UNRESOLVED", "eigenvalue_disks", "resolved"]

#: what is proved of a matrix: every eigenvalue inside a region, at least one outside, or neither
INSIDE, OUTSIDE, UNRESOLVED = 1, -1, 0


def _unit(terms: int) -> float:
    """Relative error of a complex sum of so many products, with room for its own rounding."""
    return 4 * 1.2e-16 * (terms + 4)


def eigenvalue_disks(A: np.ndarray, error: np.ndarray | float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Disks that cover the eigenvalues of every matrix near some matrices.

    Any disks that touch none of the others hold as many eigenvalues as they are.

    Parameters
    ----------
    A : ndarray, shape (..., n, n)
    error : ndarray, shape (..., n, n), or float
        Bound on the distance of the matrices meant, entry by entry.

    Returns
    -------
    (centres, radii) : tuple of ndarray, shape (..., n)
        A radius is infinite where nothing could be proved.
    """
    A = np.asarray(A, dtype=float)
    n = A.shape[-1]
    with np.errstate(all="ignore"):
        finite = np.isfinite(A).all(axis=(-2, -1))
        centres, X = np.linalg.eig(np.where(finite[..., None, None], A, 0.0))
        centres = np.asarray(centres, dtype=complex)
        Y = _inverses(X)
        size_X, size_Y = np.abs(X), np.abs(Y)
        room = _unit(n)
        # of X^-1 (A + E) X - diag(centres) = X^-1 (R + E X): row sums of R, then of what Y makes of it
        rest = np.abs(A @ X - X * centres[..., None, :])
        rest += room * (np.abs(A) @ size_X + size_X * np.abs(centres)[..., None, :])
        rest += np.broadcast_to(error, A.shape) @ size_X
        sums = (size_Y @ rest.sum(axis=-1)[..., None])[..., 0] * (1 + 4 * room)
        # Y is the inverse but for (I - Y X), whose norm is below one
        defect = np.abs(np.eye(n) - Y @ X) + room * (size_Y @ size_X + np.eye(n))
        part = defect.sum(axis=-1).max(axis=-1) * (1 + room)
        radii = sums + (part / (1 - part) * sums.max(axis=-1))[..., None]
        radii = radii * (1 + room) + 1e-300
    radii = np.where(np.isfinite(radii) & (finite & (part < 1))[..., None] & np.isfinite(centres), radii, np.inf)
    return np.where(np.isfinite(centres), centres, 0), radii


def _inverses(X: np.ndarray) -> np.ndarray:
    """Near inverses; of a matrix that has none, nan."""
    try:
        return np.linalg.inv(X)
    except np.linalg.LinAlgError:
        flat = X.reshape(-1, *X.shape[-2:])
        out = np.full_like(flat, np.nan)
        for k, matrix in enumerate(flat):
            try:
                out[k] = np.linalg.inv(matrix)
            except np.linalg.LinAlgError:
                continue
        return out.reshape(X.shape)


def resolved(
    A: np.ndarray, distance: Callable[[np.ndarray], np.ndarray], error: np.ndarray | float = 0.0
) -> np.ndarray:
    """Prove of each of some matrices that its eigenvalues lie inside a region, or that one lies outside.

    Parameters
    ----------
    A, error
        As for `eigenvalue_disks`.
    distance : callable
        Of points of the plane to the border of the region, negative inside; must not change faster than the points do
        (``lambda s: s.real`` for the left half plane, ``lambda s: abs(s + a) - b`` for a disk), and be rounded by
        less than 1e-14 (1 + abs(s)).

    Returns
    -------
    ndarray of int, shape (...)
        `INSIDE`, `OUTSIDE` or `UNRESOLVED`.

    Raises
    ------
    InputError
        If the matrices are not square.

    Examples
    --------
    >>> import numpy as np
    >>> list(resolved(np.array([[[-1.0, 5.0], [0.0, -2.0]], [[0.5, 0.0], [3.0, -1.0]]]), lambda s: s.real))
    [np.int64(1), np.int64(-1)]
    """
    A = np.asarray(A, dtype=float)
    if A.ndim < 2 or A.shape[-1] != A.shape[-2]:
        raise InputError("matrices", value=A.shape, expected="square matrices")
    centres, radii = eigenvalue_disks(A, error)
    away = distance(centres)
    radii = radii * (1 + 1e-12) + 1e-14 * (1 + np.abs(centres) + np.abs(away))  # the distance is computed too
    inside, outside = away + radii < 0, away - radii > 0
    whole = (inside | outside).all(axis=-1)
    some = outside.any(axis=-1)
    apart = some & ~whole
    if apart.any():  # disks outside that touch none of the others
        some = some & (whole | _separate(centres, radii, outside))
    else:
        some = some & whole
    return np.where(inside.all(axis=-1), INSIDE, np.where(some, OUTSIDE, UNRESOLVED))


def _separate(centres: np.ndarray, radii: np.ndarray, outside: np.ndarray) -> np.ndarray:
    """Whether the disks outside touch none of the others."""
    gap = np.abs(centres[..., :, None] - centres[..., None, :]) * (1 - 1e-12)
    touching = ~(gap > radii[..., :, None] + radii[..., None, :])
    return ~(touching & outside[..., :, None] & ~outside[..., None, :]).any(axis=(-1, -2))

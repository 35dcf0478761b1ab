"""Which matrix is behind an inequality: coefficients read back as those of Lyapunov, of Stein, or of a region of poles.

P stands for any matrix that is linear in the unknowns: a symmetric unknown, a block-diagonal one, a complex one written
in reals, a sum, a vertex of an affine family. What is read is checked against every coefficient, to the rounding of
sums of products.

Reference: M. Chilali, P. Gahinet, "H-infinity design with pole placement constraints: an LMI approach", IEEE Trans.
Autom. Control 41 (1996) 358-367.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from gainsay.lmi.rounding import gamma

__all__ = ["Region", "read_region", "read_stein"]

#: roundings of a change of the units of rows and unknowns
_UNITS = 8
#: coefficient of a fit that is taken for zero, relative to what it is fitted to
_NOTHING = 1e-11
#: entries of the equations of a matrix that are solved together
_MOST_ENTRIES = 4_000_000
#: rows up to which a matrix of a Stein inequality is looked for where none of its rows can be read
_MOST_INTERTWINED = 16
#: sets of rows that may have either sign
_MOST_SIGNS = 6


@dataclass(frozen=True)
class Region:
    """``L (x) P + M (x) P A + M' (x) A'P``, (x) the Kronecker product: negative for P > 0 if A has its poles there.

    Attributes
    ----------
    A : ndarray, shape (n, n)
    size : ndarray, shape (n, n)
        Sizes to whose rounding the entries of A are known.
    L, M : ndarray, shape (m, m)
        The region: ``f(s) = L + s M + conj(s) M' < 0``. Lyapunov's inequality has m = 1, L = 0, M = 1.
    """

    A: np.ndarray
    size: np.ndarray
    L: np.ndarray
    M: np.ndarray

    def at(self, s: complex) -> np.ndarray:
        """The Hermitian f(s)."""
        return self.L + s * self.M + np.conj(s) * self.M.T


def within_rounding(given: np.ndarray, made: np.ndarray, size: np.ndarray, terms: int) -> bool:
    """Whether coefficients differ by the rounding of sums of so many products, and of units, entry by entry."""
    return bool((np.abs(given - made) <= 2 * gamma(terms + _UNITS) * size).all())


def read_region(value: np.ndarray, basis: np.ndarray) -> Region | None:
    """The matrix and the region whose form, at each P_k of `basis`, has the coefficients `value`.

    Parameters
    ----------
    value : ndarray, shape (m n, m n, k)
    basis : ndarray, shape (n, n, k)

    Returns
    -------
    Region or None
        None where there is none, or it is not found.
    """
    n = len(basis)
    m = len(value) // n
    blocks = value.reshape(m, n, m, n, -1).transpose(0, 2, 1, 3, 4)
    for A, known in _matrices(blocks, basis):
        region = _region_of(A, known, blocks, basis)
        if region is not None:
            return region
    return None


def _region_of(A: np.ndarray, known: np.ndarray, blocks: np.ndarray, basis: np.ndarray) -> Region | None:
    """The region in which the blocks place the poles of a matrix; None where they do not."""
    m = len(blocks)
    L, M = np.zeros((m, m)), np.zeros((m, m))
    behind = np.einsum("ijk,jl->ilk", basis, A)
    before = behind.transpose(1, 0, 2)
    sizes = np.einsum("ijk,jl->ilk", np.abs(basis), known)
    for p in range(m):
        for q in range(p, m):
            parts = (basis, behind + before) if p == q else (basis, behind, before)
            coefficients = _fitted(blocks[p, q], parts)
            constant, slope, back = coefficients if p != q else (coefficients[0], coefficients[1], coefficients[1])
            made = constant * basis + slope * behind + back * before
            size = abs(constant) * np.abs(basis) + abs(slope) * sizes + abs(back) * sizes.transpose(1, 0, 2)
            if not within_rounding(blocks[p, q], made, size, 2 * _terms(basis) + 2):
                return None
            L[p, q] = L[q, p] = constant
            M[p, q], M[q, p] = slope, back
    return Region(A, known, L, M)


def _terms(basis: np.ndarray) -> int:
    return int(np.count_nonzero(basis, axis=0).max(initial=1))


def _matrices(blocks: np.ndarray, basis: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Matrices that may be behind blocks, up to a factor and a multiple of I, which the region has; their sizes."""
    m, scalars = len(blocks), []
    places = [(p, q) for gap in range(m) for p, q in zip(range(m), range(gap, m), strict=False)]
    for p, q in places:
        for side in ("right", "left", "apart") if p < q else ("both",):  # one side first: nothing is left open then
            for pair in _read(blocks[p, q], basis, side):
                if _is_scalar(pair[0]):
                    scalars.append(pair)
                else:
                    yield pair
    yield from scalars[:1]


def _is_scalar(matrix: np.ndarray) -> bool:
    rest = matrix - matrix[0, 0] * np.eye(len(matrix))
    return len(matrix) > 1 and not np.abs(rest).max() > _NOTHING * np.abs(matrix).max()


def _read(
    value: np.ndarray, basis: np.ndarray, side: str, least: float = 0.0
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """X of ``P_k X`` (side right), ``X'P_k`` (left), their sum (both), or of a sum with another matrix (apart); sizes.

    `value` is that sum, or smaller than `least` altogether; what is given need not be a solution.
    """
    from scipy import sparse

    n, count = len(basis), basis.shape[2]
    r, c, k = np.nonzero(basis)
    along = np.arange(n)
    weights = np.repeat(basis[r, c, k], n)
    first = k[:, None] * n * n
    right = ((first + r[:, None] * n + along).ravel(), (c[:, None] * n + along).ravel())
    left = ((first + along * n + c[:, None]).ravel(), (r[:, None] * n + along).ravel() + (side == "apart") * n * n)
    terms = [right] * (side != "left") + [left] * (side != "right")
    place = tuple(np.concatenate(part) for part in zip(*terms, strict=True))
    shape = (count * n * n, (2 if side == "apart" else 1) * n * n)
    stated = sparse.csr_matrix((np.tile(weights, len(terms)), place), shape=shape)
    solution = _solved(stated, value.transpose(2, 0, 1).ravel(), n * n if side == "apart" else None, least)
    if solution is not None:
        yield from zip(*(part.reshape(-1, n, n) for part in solution), strict=True)


def _solved(stated: Any, right: np.ndarray, free: int | None, least: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Unknowns one after another where an equation holds one alone, least squares for the rest; and their sizes.

    X + c I and Y - c I are as good as X and Y: the unknown `free` is zero where nothing says otherwise. Those solved
    together may be off by one shift for all: they are as large as the largest of all.
    """
    x, left = np.zeros(stated.shape[1]), np.ones(stated.shape[1])
    pattern, number = stated.copy(), np.arange(stated.shape[1])
    pattern.data = np.ones_like(pattern.data)
    while left.any():
        alone = np.flatnonzero(pattern @ left == 1)
        if not len(alone) and free is not None and left[free]:
            left[free] = 0.0
            continue
        if not len(alone):
            break
        rest, factor = (right - stated @ x)[alone], (stated @ left)[alone]
        which = (pattern @ (left * number))[alone].astype(int)
        x[which] = rest / factor
        left[which] = 0.0
        if np.abs(factor * x[which] - rest).max() > _NOTHING * max(np.abs(right).max(), least):
            return None  # two equations that ask for different values
    others = np.flatnonzero(left)
    if not len(others):
        return x, np.abs(x)
    rows = np.flatnonzero(pattern @ left)
    if not len(rows) or len(rows) * len(others) > _MOST_ENTRIES:
        return None if len(rows) else (x, np.abs(x))
    dense = stated[rows][:, others].toarray()
    for _ in range(2):
        x[others] += np.linalg.lstsq(dense, (right - stated @ x)[rows], rcond=1e-12)[0]
    size = np.abs(x)
    size[others] = size.max()
    return x, size


def _fitted(value: np.ndarray, parts: tuple[np.ndarray, ...]) -> list[float]:
    """Weights of parts that add up to a value, those at the size of rounding zero."""
    columns = np.stack([part.ravel() for part in parts], axis=1)
    units = 1 / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    weights = np.zeros(len(parts))
    kept = np.arange(len(parts))
    for _ in range(2):
        coefficients = np.linalg.lstsq(columns[:, kept] * units[kept], value.ravel(), rcond=1e-13)[0]
        weights[:] = 0.0
        weights[kept] = coefficients * units[kept]
        kept = kept[np.abs(coefficients) > _NOTHING * np.abs(coefficients).max(initial=0.0)]
    return [float(w) for w in weights]


def read_stein(value: np.ndarray, basis: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Matrices A with ``P_k - A'P_k A`` = `value`, at each P_k of `basis`, and to which sizes they are known.

    Parameters
    ----------
    value, basis : ndarray, shape (n, n, k)
    """
    outer = basis - value
    matrices = [(A, np.abs(A)) for A in _by_rows(outer, basis)]
    matrices = matrices or [(A, np.full_like(A, np.abs(A).max())) for A in _intertwined(outer, basis)]
    for A, known in matrices:
        size = np.abs(basis) + _congruent(known, np.abs(basis))
        if within_rounding(value, basis - _congruent(A, basis), size, 4):
            yield A, known


def _congruent(A: np.ndarray, tensor: np.ndarray) -> np.ndarray:
    return np.einsum("ji,jlk,lm->imk", A, tensor, A, optimize=True)


def _by_rows(outer: np.ndarray, basis: np.ndarray) -> Iterator[np.ndarray]:
    """A of ``A'P_k A``, each row up to its sign from a P_k of one entry; rows that no P_k joins may have either."""
    n = len(basis)
    A, sets = np.zeros((n, n)), list(range(n))
    counts = np.count_nonzero(basis, axis=(0, 1))
    diagonal = np.einsum("iik->ik", basis)
    for i in range(n):
        single = np.flatnonzero((counts == 1) & (diagonal[i] != 0))
        if not len(single):
            return
        square = outer[:, :, single[0]] / diagonal[i, single[0]]
        diagonals = np.diagonal(square).copy()
        if np.delete(diagonals, i).max(initial=0.0) > 0:
            diagonals[i] = 0.0  # the own entry is a difference from that of P
        lead = int(np.argmax(diagonals))
        if square[lead, lead] > 0:
            A[i] = square[lead] / np.sqrt(square[lead, lead])
    for k in np.flatnonzero(counts == 2):
        i, j = (int(t) for t in np.argwhere(basis[:, :, k])[0])
        own = basis[i, j, k] * np.outer(A[i], A[j])
        agreement = float(((own + own.T) * outer[:, :, k]).sum())
        if i == j or sets[i] == sets[j] or not agreement:
            continue
        moved = [t for t in range(n) if sets[t] == sets[j]]
        A[moved] *= np.sign(agreement)
        for t in moved:
            sets[t] = sets[i]
    free = sorted({s for s, row in zip(sets, A, strict=True) if row.any()})
    if len(free) > _MOST_SIGNS:
        return
    for signs in product((1.0, -1.0), repeat=len(free)):
        if signs[:1] == (-1.0,):
            break  # A and -A are alike
        by_set = dict(zip(free, signs, strict=True))
        yield A * np.array([by_set.get(s, 1.0) for s in sets])[:, None]


def _intertwined(outer: np.ndarray, basis: np.ndarray) -> Iterator[np.ndarray]:
    """A of ``G_k = A'P_k A``, both regular, from ``P_1^-1 P_2 A = A G_1^-1 G_2``, and Newton's steps for its digits.

    What commutes with all P_k may stand before A: of a complex P in reals, a factor of size one.
    """
    n, count = len(basis), basis.shape[2]
    if n > _MOST_INTERTWINED:
        return
    mixed = np.cos(1.0 + np.outer(np.arange(count), 1 + np.arange(4)))  # any weights do
    P, G = np.moveaxis(basis @ mixed, 2, 0), np.moveaxis(outer @ mixed, 2, 0)
    try:
        left, right = np.linalg.solve(P[0], P[1:]), np.linalg.solve(G[0], G[1:])
        stacked = np.vstack([np.kron(a, np.eye(n)) - np.kron(np.eye(n), b.T) for a, b in zip(left, right, strict=True)])
        values, vectors = np.linalg.svd(stacked)[1:]
        kernel = vectors[values < _NOTHING * values[0]]
        A = (np.cos(1.0 + np.arange(len(kernel))) @ kernel).reshape(n, n)
        made = _congruent(A, basis)
        scale = np.sum(outer * made) / max(np.sum(made**2), 1e-300)
        if not scale > 0:
            return
        A = np.sqrt(scale) * A
        for _ in range(2):
            back = np.linalg.inv(A)
            rest = _congruent(back, outer) - basis
            for step, _ in _read(rest, basis, "both", np.abs(basis).max()):
                A = A + step @ A
    except np.linalg.LinAlgError:
        return
    yield A

"""Inequalities of Lyapunov, of Stein and of a region of poles, of a matrix outside: refuted by a wrong inertia.

Multipliers of ``A'P + P A < 0, P > 0`` live on the unstable invariant subspace of A, which is irrational: none near
them is exact. The proof here is another. Let H satisfy ``A'H + H A < 0`` without being positive. If P were a solution,
so would H + t P be for t >= 0; where it first is singular, with kernel x, ``x'(A'(H + t P) + (H + t P) A) x = 0``: a
contradiction (of Stein's ``H - A'H A > 0``: the form at x is at most zero). Nothing is asked of the structure of P. H
is rounded, the inequality proved for it and for every A within rounding. The inequality of a region, compressed by
vectors ``u (x) x``, is Lyapunov's of another matrix, complex where u is: it is written in reals.

It speaks of the inequality of a matrix: sums such as a_11 + a_22 in the coefficients are rounded, and coefficients off
by that are taken as those of A, although they alone may leave points of a condition number of 1e16.

Reference: A. Ostrowski, H. Schneider, "Some theorems on the inertia of general matrices", J. Math. Anal. Appl. 4
(1962) 72-84.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise, permutations

import numpy as np
from flint import fmpq_mat

from gainsay.exact.definite import positive_definite, positive_semidefinite
from gainsay.exact.rational import to_fmpq
from gainsay.lmi.affine import Definite
from gainsay.lmi.lyapunov_forms import Region, read_region, read_stein
from gainsay.lmi.outcomes import Farkas
from gainsay.lmi.points import is_strict
from gainsay.lmi.program import Program, Row
from gainsay.lmi.rounding import gamma, proved_positive
from gainsay.lmi.row_scales import region_scales, stein_scales

# error of an entry of A, relative to the sizes that it is summed of
_ROUNDING = 32 * 2.0**-53
# eigenvalue of a constant that no rounding makes negative, relative to its entries
_NEGATIVE = 1e-9
# block rows of a region, and orders of the blocks of P
_MOST_ROWS, _MOST_ORDERS = 4, 24


@dataclass(frozen=True)
class _Part:
    """A principal part whose constant is not positive: ``tensor . x``, what depends on unknowns, is > or >= 0."""

    row: Row
    rows: slice
    tensor: np.ndarray
    strict: bool

    @property
    def size(self) -> int:
        return self.rows.stop - self.rows.start

    @property
    def used(self) -> np.ndarray:
        return np.asarray(self.tensor.any(axis=(0, 1)))

    def multiplier(self, y: np.ndarray) -> np.ndarray:
        """Of the whole constraint, which weighs this part by the real part of yy*."""
        multiplier = np.zeros((self.row.size, self.row.size))
        multiplier[self.rows, self.rows] = np.real(np.outer(y, y.conj()))
        return multiplier


@dataclass(frozen=True)
class _Stated:
    """A part, and the positive ones by whose sum it falls short of an inequality in P alone.

    Attributes
    ----------
    part : _Part
    tensor : ndarray
        Of the part and what is added.
    added : tuple of (_Part, ndarray)
        With the matrix Q: a part r of one row is added as r Q; another as it is, Q the identity.
    """

    part: _Part
    tensor: np.ndarray
    added: tuple[tuple[_Part, np.ndarray], ...] = ()

    @property
    def size(self) -> int:
        return self.part.size

    @property
    def used(self) -> np.ndarray:
        return np.asarray(self.tensor.any(axis=(0, 1)))


@dataclass(frozen=True)
class _Positive:
    """A positive matrix P, linear in the unknowns: parts, each at its place in P."""

    tensor: np.ndarray
    parts: tuple[tuple[_Part, slice], ...]

    @property
    def strict(self) -> bool:
        return all(part.strict for part, _ in self.parts)


def refutation(program: Program) -> Farkas | None:
    """Find P that is to be positive and an inequality in it whose matrix is proved to have an eigenvalue outside."""
    parts: list[_Part] = []
    runs: list[_Part] = []
    for row in program.rows:
        if row.is_matrix:
            positive, equal = _pieces(row), _runs(row)
            known = {place: _part(row, slice(*place)) for place in {*positive, *equal}}
            for listed, places in ((parts, positive), (runs, equal)):
                listed += [part for place in places if (part := known[place]) is not None]
    for run in runs:
        for stated in _completed(run, parts):
            for basis in _positives(stated, parts):
                told = _refuted(program, stated, basis)
                if told is not None:
                    return told
    return None


def _refuted(program: Program, stated: _Stated, positive: _Positive) -> Farkas | None:
    if not (stated.part.strict or positive.strict):
        return None
    basis, n = positive.tensor, len(positive.tensor)
    w = region_scales(-stated.tensor, basis)
    region = read_region(-stated.tensor * np.outer(w, w)[:, :, None], basis)
    if region is not None:
        for value, u, v in _outside(region):
            if _unstable(*_compressed(region, u), "Lyapunov"):
                kind = "Lyapunov" if len(u) == 1 else "region"
                return _told(program, stated, w * np.kron(u, v), positive, value, v, kind)
    if region is None and stated.size == n:
        w = stein_scales(stated.tensor, basis)
        for A, size in read_stein(stated.tensor * np.outer(w, w)[:, :, None], basis):
            if _unstable(A, size, "Stein"):
                eigenvalues, vectors = np.linalg.eig(A)
                last = int(np.argmax(np.abs(eigenvalues)))
                v = vectors[:, last]
                return _told(program, stated, w * v, positive, abs(eigenvalues[last]) ** 2 - 1, v, "Stein")
    return None


def _completed(part: _Part, parts: Sequence[_Part]) -> Iterator[_Stated]:
    """A part as it is, and with positive ones added that it holds with the other sign."""
    yield _Stated(part, part.tensor)
    tensor, added = part.tensor.copy(), []
    for other in parts:
        own = other.used
        if other.row is part.row or not tensor[:, :, own].any(axis=(0, 1)).all():
            continue
        if other.size == 1 and own.sum() == 1:
            slope = other.tensor[0, 0, own][0]
            Q = -np.sign(slope) * tensor[:, :, own][:, :, 0]
            if _sign(Q) is None:
                continue
            tensor[:, :, own], Q = 0.0, Q / abs(slope)
        elif other.size == part.size and np.array_equal(tensor[:, :, own], -other.tensor[:, :, own]):
            Q = np.eye(part.size)
            tensor = tensor + other.tensor
        else:
            continue
        added.append((other, Q))
    if added and tensor.any():
        yield _Stated(part, tensor, tuple(added))


def _pieces(row: Row) -> list[tuple[int, int]]:
    """Ends of the whole of a matrix inequality and of its block rows."""
    return sorted({(0, row.size)} | {(start, start + length) for start, length in _blocks(row)})


def _blocks(row: Row) -> list[tuple[int, int]]:
    """Start and length of the block rows as named, and of diagonal blocks."""
    blocks, total = [], 0
    for _, length in row.constraint.rows if isinstance(row.constraint, Definite) else ():
        blocks.append((total, length))
        total += length
    linked = np.abs(row.constant) + np.abs(row.tensor).sum(axis=2)
    cuts = [i for i in range(row.size + 1) if not linked[:i, i:].any()]
    return blocks + [(a, b - a) for a, b in pairwise(cuts)]


def _runs(row: Row) -> list[tuple[int, int]]:
    """Ends of what may be an inequality: runs of equal block rows, and diagonal blocks cut into equal rows."""
    ends = [(start, start + count * length) for start, length in _blocks(row) for count in range(1, _MOST_ROWS + 1)]
    return list(dict.fromkeys(place for place in ends if place[1] <= row.size))


def _part(row: Row, rows: slice) -> _Part | None:
    """A principal part with unknowns; None where its constant is not known to be at most zero."""
    tensor = row.tensor[rows, rows]
    sign = _sign(-row.constant[rows, rows]) if tensor.any() else None
    return None if sign is None else _Part(row, rows, tensor, sign or is_strict(row.constraint))


def _sign(constant: np.ndarray) -> bool | None:
    """True for a constant that is proved > 0, False for >= 0, None else."""
    if not constant.any():
        return False
    if np.linalg.eigvalsh(constant)[0] < -_NEGATIVE * np.abs(constant).max():
        return None
    exact = fmpq_mat([[to_fmpq(float(v)) for v in line] for line in constant])
    if positive_definite(exact):
        return True
    return False if positive_semidefinite(exact) else None


def _positives(stated: _Stated, parts: Sequence[_Part]) -> Iterator[_Positive]:
    """Positive matrices of whose unknowns alone a part is made: one part, alone or repeated, diagonal blocks, a sum."""
    used = stated.used
    inside = []
    for part in parts:
        if part.row is stated.part.row and part.rows == stated.part.rows:
            continue
        if not (used & ~part.used).any() and _fits(stated, part.size):
            yield _Positive(part.tensor, ((part, slice(0, part.size)),))
            if part.size < stated.size:
                yield from _repeated(part, stated.size // part.size)
        elif not (part.used & ~used).any():
            inside.append(part)
    apart: list[_Part] = []
    for part in sorted(inside, key=lambda p: np.count_nonzero(p.tensor)):  # P itself has fewer than what holds it
        if not any((part.used & other.used).any() for other in apart):
            apart.append(part)
    if len(apart) < 2 or not np.array_equal(np.any([p.used for p in apart], axis=0), used):
        return
    apart.sort(key=inside.index)
    if len({part.size for part in apart}) == 1 and _fits(stated, apart[0].size):
        whole = slice(0, apart[0].size)
        yield _Positive(
            sum((p.tensor for p in apart), np.zeros_like(apart[0].tensor)), tuple((p, whole) for p in apart)
        )
    size = sum(part.size for part in apart)
    if _fits(stated, size):
        for order in islice(permutations(apart), _MOST_ORDERS):
            yield _diagonal(order, size)


def _fits(stated: _Stated, size: int) -> bool:
    """Whether a part may be a region's inequality in a P of so many rows."""
    return stated.size % size == 0 and stated.size <= _MOST_ROWS * size


def _repeated(part: _Part, times: int) -> Iterator[_Positive]:
    """I (x) P and P (x) I."""
    n = part.size
    blocks = [slice(k * n, (k + 1) * n) for k in range(times)]
    entries = [slice(k, times * n, times) for k in range(times)]
    for places in (blocks, entries):
        tensor = np.zeros((times * n, times * n, part.tensor.shape[2]))
        for place in places:
            tensor[place, place] = part.tensor
        yield _Positive(tensor, tuple((part, place) for place in places))


def _diagonal(parts: Sequence[_Part], size: int) -> _Positive:
    tensor = np.zeros((size, size, parts[0].tensor.shape[2]))
    placed, total = [], 0
    for part in parts:
        place = slice(total, total + part.size)
        tensor[place, place] = part.tensor
        placed.append((part, place))
        total = place.stop
    return _Positive(tensor, tuple(placed))


def _outside(region: Region) -> Iterator[tuple[float, np.ndarray, np.ndarray]]:
    """Eigenvalues of A outside a region, the furthest first: u'f(s)u > 0, u, and the eigenvector."""
    try:
        eigenvalues, vectors = np.linalg.eig(region.A)
    except np.linalg.LinAlgError:
        return
    outside = []
    for s, v in zip(eigenvalues, vectors.T, strict=True):
        values, us = np.linalg.eigh(region.at(s))
        size = np.abs(region.L).max() + 2 * abs(s) * np.abs(region.M).max()
        if values[-1] > 0:
            outside.append((values[-1] / size, float(values[-1]), us[:, -1], v))
    for _, value, u, v in sorted(outside, key=lambda one: -one[0])[:2]:
        yield value, u, v


def _compressed(region: Region, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The matrix C whose Lyapunov inequality is what a region says at vectors u (x) x, in reals, and its sizes."""
    eye = np.eye(len(region.A))
    C = np.real(u.conj() @ region.L @ u) / 2 * eye + (u.conj() @ region.M @ u) * region.A
    large = np.abs(u)
    size = (large @ np.abs(region.L) @ large) / 2 * eye + (large @ np.abs(region.M) @ large) * region.size
    if not np.iscomplex(C).any():
        return np.real(C), size
    return np.block([[C.real, -C.imag], [C.imag, C.real]]), np.block([[size, size], [size, size]])


def _unstable(A: np.ndarray, size: np.ndarray, kind: str) -> bool:
    """Prove by a matrix of the wrong inertia that every matrix within rounding of `size` around A is unstable."""
    from scipy.linalg import matrix_balance

    _, (units, _) = matrix_balance(A, permute=False, separate=True)  # powers of two: nothing is rounded
    A, size = A * units / units[:, None], size * units / units[:, None]
    for H in candidates(A, kind):
        large = size.T @ np.abs(H)
        if kind == "Lyapunov":
            value = -(A.T @ H + H @ A)
            error = large + large.T
        else:
            value = H - A.T @ H @ A
            error = large @ size + np.abs(H)
        error = (gamma(2 * len(A) + 4) + 2 * _ROUNDING) * (error + error.T)
        values, vectors = np.linalg.eigh(H)
        if not values[0] < 0 or not proved_positive((value + value.T) / 2, error):
            continue
        z = [to_fmpq(float(v)) for v in vectors[:, 0]]
        exact = fmpq_mat([[to_fmpq(float(v)) for v in line] for line in H])
        column = fmpq_mat(len(z), 1, z)
        if (column.transpose() * exact * column)[0, 0] <= 0:
            return True
    return False


def candidates(A: np.ndarray, kind: str) -> Iterator[np.ndarray]:
    """Symmetric H, not positive, for which A'H + H A (kind Lyapunov) or A'H A - H (Stein) may be negative.

    None where A is stable to rounding.
    """
    from scipy.linalg import solve_continuous_lyapunov, solve_discrete_lyapunov

    try:
        eigenvalues, vectors = np.linalg.eig(A)
    except np.linalg.LinAlgError:
        return
    beyond = eigenvalues.real if kind == "Lyapunov" else np.abs(eigenvalues) - 1
    if not beyond.max() > 0:
        return
    for attempt in range(2):
        try:
            if attempt == 0:
                back = np.linalg.inv(vectors)
                H = np.real(back.conj().T @ np.diag(np.where(beyond > 0, -1.0, 1.0)) @ back)
            elif kind == "Lyapunov":
                H = solve_continuous_lyapunov(A.T, -np.eye(len(A)))
            else:
                H = solve_discrete_lyapunov(A.T, np.eye(len(A)))
        except (np.linalg.LinAlgError, ValueError):
            continue
        if np.isfinite(H).all():
            yield (H + H.T) / 2


def _told(
    program: Program, stated: _Stated, y: np.ndarray, positive: _Positive, weight: float, v: np.ndarray, kind: str
) -> Farkas:
    """The refutation, with floats near its multipliers from an eigenvector v outside."""
    multipliers = {r.constraint.label: np.zeros((r.size, r.size) if r.is_matrix else r.size) for r in program.rows}
    weighed = [(stated.part, y)]
    weighed += [(part, np.sqrt([np.real(y.conj() @ Q @ y)]) if part.size == 1 else y) for part, Q in stated.added]
    weighed += [(part, np.sqrt(weight) * v[place]) for part, place in positive.parts]
    for part, vector in weighed:
        multipliers[part.row.constraint.label] += part.multiplier(vector)
    total = sum(float(np.trace(m)) for m in multipliers.values() if m.ndim == 2)
    what = {"Lyapunov": "Lyapunov inequality", "Stein": "Stein inequality", "region": "inequality of a region"}[kind]
    where = "with an eigenvalue outside" if kind == "region" else "that is unstable"
    label = stated.part.row.constraint.label
    reason = f"{what} {label!r} of a matrix {where} (its sums rounded), by a matrix of the wrong inertia"
    return Farkas({name: m / total for name, m in multipliers.items()}, 0.0, float("nan"), reason)

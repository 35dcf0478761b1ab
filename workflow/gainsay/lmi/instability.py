"""Lyapunov and Stein inequalities of an unstable matrix: refuted by a matrix of the wrong inertia.

Multipliers of ``A'P + P A < 0, P > 0`` live on the unstable invariant subspace of A, which is irrational: none near
them is exact. The proof here is another. Let H satisfy ``A'H + H A < 0`` without being positive. If P were a solution,
so would H + t P be for t >= 0; where it first is singular, with kernel x, ``x'(A'(H + t P) + (H + t P) A) x = 0``: a
contradiction (of Stein's ``H - A'H A > 0``: the form at x is at most zero). H is rounded, the inequality proved for it
and for every A within rounding. It speaks of the inequality of a matrix: sums such as a_11 + a_22 in the coefficients
are rounded, and coefficients off by that are taken as those of A, although they alone may leave points of a condition
number of 1e16.

Reference: A. Ostrowski, H. Schneider, "Some theorems on the inertia of general matrices", J. Math. Anal. Appl. 4
(1962) 72-84.
"""

from collections.abc import Iterator

import numpy as np
from flint import fmpq_mat

from gainsay.exact.definite import positive_definite, positive_semidefinite
from gainsay.exact.rational import to_fmpq
from gainsay.lmi.affine import Definite, Variable
from gainsay.lmi.outcomes import Farkas
from gainsay.lmi.points import is_strict
from gainsay.lmi.program import Program, Row
from gainsay.lmi.rounding import gamma, proved_positive

_ROUNDING = 4 * 2.0**-53


def refutation(program: Program) -> Farkas | None:
    """Find P that is to be positive and a Lyapunov or Stein inequality in it whose matrix is proved unstable."""
    matrices = [row for row in program.rows if row.is_matrix]
    for variable, place in program.places.items():
        if variable.kind != "symmetric":
            continue
        found = [(row, _keeps_positive(row, variable, place)) for row in matrices]
        kept_positive = [(row, strict) for row, strict in found if strict is not None]
        for row in matrices:
            for kind, T, A, strict in (*_inequalities(row, variable, place), *_completed(row, variable, place)):
                for positive, sure in kept_positive:
                    if (strict or sure) and _unstable(A, kind):
                        return _told(program, row, T, positive, A, kind)
    return None


def _block(row: Row, rows: slice, place: slice) -> tuple[np.ndarray, np.ndarray] | None:
    """Constant and coefficients of a principal part that depends on one unknown alone."""
    tensor = row.tensor[rows, rows]
    if np.count_nonzero(tensor) != np.count_nonzero(tensor[:, :, place]):
        return None
    return row.constant[rows, rows], tensor[:, :, place]


def _parts(row: Row, size: int) -> Iterator[slice]:
    """Principal parts of `size` rows: the block rows as named, and diagonal blocks."""
    starts, total = [], 0
    for _, length in row.constraint.rows if isinstance(row.constraint, Definite) else ():
        if length == size:
            starts.append(total)
        total += length
    linked = np.abs(row.constant) + np.abs(row.tensor).sum(axis=2)
    for start in range(row.size - size + 1):
        if not linked[:start, start:].any() and start not in starts:
            starts.append(start)
    for start in starts:
        yield slice(start, start + size)


def _sign(constant: np.ndarray) -> bool | None:
    """True for a constant that is proved > 0, False for >= 0, None else."""
    exact = fmpq_mat([[to_fmpq(float(v)) for v in line] for line in constant])
    if positive_definite(exact):
        return True
    return False if positive_semidefinite(exact) else None


def _keeps_positive(row: Row, variable: Variable, place: slice) -> bool | None:
    """Whether a constraint says P > 0 (True) or P >= 0 (False)."""
    found = None
    for rows in _parts(row, variable.shape[0]):
        part = _block(row, rows, place)
        if part is not None and np.array_equal(part[1], variable.terms[variable]):
            sign = _sign(-part[0])
            if sign is not None:
                found = bool(found) or sign or is_strict(row.constraint)
    return found


def _inequalities(row: Row, variable: Variable, place: slice) -> Iterator[tuple[str, np.ndarray, np.ndarray, bool]]:
    """Principal parts that are -(A'P + P A) - Q or P - A'P A - Q, Q >= 0: kind, rows as a matrix, A, whether strict."""
    n = variable.shape[0]
    diagonal = [k for k, (i, j) in enumerate(variable.index) if i == j]
    for rows in _parts(row, n):
        part = _block(row, rows, place)
        if part is None or not part[1].any():
            continue
        constant, tensor = part
        for kind, read in (("Lyapunov", _read_lyapunov), ("Stein", _read_stein)):
            A = read(tensor, diagonal, n)
            if A is not None and _is(kind, tensor, A, variable):
                sign = _sign(-constant)
                if sign is not None:
                    yield kind, np.eye(row.size)[:, rows], A, sign or is_strict(row.constraint)


def _completed(row: Row, variable: Variable, place: slice) -> Iterator[tuple[str, np.ndarray, np.ndarray, bool]]:
    """Principal parts [[P, A'P], [., P]] or [[P, P A], [., P]]: a congruence T makes them P - A'P A."""
    n = variable.shape[0]
    diagonal = [k for k, (i, j) in enumerate(variable.index) if i == j]
    basis = variable.terms[variable]
    for start in range(row.size - 2 * n + 1):
        first, last = slice(start, start + n), slice(start + n, start + 2 * n)
        part = _block(row, slice(start, start + 2 * n), place)
        if part is None or part[0].any():
            continue
        tensor = part[1]
        if not (np.array_equal(tensor[:n, :n], basis) and np.array_equal(tensor[n:, n:], basis)):
            continue
        corner, eye = tensor[:n, n:], np.eye(row.size)
        before = np.array([corner[:, j, diagonal[j]] for j in range(n)])  # A, of a corner A'P
        if np.array_equal(corner, np.einsum("ji,jlk->ilk", before, basis)):
            yield "Stein", eye[:, first] - eye[:, last] @ before, before, is_strict(row.constraint)
        behind = np.array([corner[i, :, diagonal[i]] for i in range(n)])  # A, of a corner P A
        if np.array_equal(corner, np.einsum("ilk,lj->ijk", basis, behind)):
            yield "Stein", eye[:, last] - eye[:, first] @ behind, behind, is_strict(row.constraint)


def _read_lyapunov(tensor: np.ndarray, diagonal: list[int], n: int) -> np.ndarray:
    A = np.array([-tensor[k, :, diagonal[k]] for k in range(n)])
    A[range(n), range(n)] /= 2
    return A


def _read_stein(tensor: np.ndarray, diagonal: list[int], n: int) -> np.ndarray | None:
    A = np.zeros((n, n))
    for k in range(n):
        outer = -tensor[:, :, diagonal[k]].copy()
        outer[k, k] += 1
        lead = int(np.argmax(np.diagonal(outer)))
        if outer[lead, lead] > 0:
            A[k] = outer[lead] / np.sqrt(outer[lead, lead])
    # each row is known up to its sign: those of the other products fix them
    place = {(i, j): j * (j + 1) // 2 + i for j in range(n) for i in range(j + 1)}
    for k in range(1, n):
        for earlier in range(k):
            cross = -tensor[:, :, place[earlier, k]].copy()
            cross[earlier, k] += 1
            cross[k, earlier] += 1
            own = np.outer(A[earlier], A[k])
            own = own + own.T
            if own.any():
                if (own * cross).sum() < 0:
                    A[k] = -A[k]
                break
    return A


def _is(kind: str, tensor: np.ndarray, A: np.ndarray, variable: Variable) -> bool:
    """Whether coefficients are those of the inequality of A to the rounding of sums of two products."""
    n = len(A)
    for k, (i, j) in enumerate(variable.index):
        basis = np.zeros((n, n))
        basis[i, j] = basis[j, i] = 1.0
        left, right = A.T @ basis, basis @ A
        made = -(left + right) if kind == "Lyapunov" else basis - left @ A
        size = np.abs(left) + np.abs(right) if kind == "Lyapunov" else basis + np.abs(left) @ np.abs(A)
        if (np.abs(tensor[:, :, k] - made) > (1 if kind == "Lyapunov" else 4) * _ROUNDING * size).any():
            return False
    return True


def _unstable(A: np.ndarray, kind: str) -> bool:
    """Prove by a matrix of the wrong inertia that A, and every matrix within rounding of it, is unstable."""
    for H in candidates(A, kind):
        size = np.abs(A).T @ np.abs(H)
        if kind == "Lyapunov":
            value = -(A.T @ H + H @ A)
            error = size + size.T
        else:
            value = H - A.T @ H @ A
            error = size @ np.abs(A) + np.abs(H)
        error = (gamma(2 * len(A) + 4) + 8 * _ROUNDING) * (error + error.T)
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


def _told(program: Program, row: Row, T: np.ndarray, positive: Row, A: np.ndarray, kind: str) -> Farkas:
    """The refutation, with floats near its multipliers from the rightmost (outermost) eigenvector."""
    eigenvalues, vectors = np.linalg.eig(A)
    last = int(np.argmax(eigenvalues.real if kind == "Lyapunov" else np.abs(eigenvalues)))
    v, eigenvalue = vectors[:, last], eigenvalues[last]
    first = np.real(np.outer(v, v.conj()))
    weight = 2 * eigenvalue.real if kind == "Lyapunov" else abs(eigenvalue) ** 2 - 1
    n = len(A)
    multipliers = {r.constraint.label: np.zeros((r.size, r.size) if r.is_matrix else r.size) for r in program.rows}
    multipliers[row.constraint.label] += T @ first @ T.T
    for part in _parts(positive, n):
        multipliers[positive.constraint.label][part, part] += weight * first
        break
    total = sum(float(np.trace(m)) for m in multipliers.values() if m.ndim == 2)
    label = row.constraint.label
    reason = f"{kind} inequality {label!r} of an unstable matrix (its sums rounded), by a matrix of the wrong inertia"
    return Farkas({name: m / total for name, m in multipliers.items()}, 0.0, float("nan"), reason)

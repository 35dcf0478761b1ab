"""Definiteness of symmetric matrices, proved: exact L D L' over the rationals, Cholesky and Gershgorin in balls.

Every function answers what is proved; False means "not proved" for balls and "not so" for rationals.

References: N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, ch. 10-11;
S. M. Rump, "Verification of positive definiteness", BIT 46 (2006) 433-452.
"""

from flint import acb, acb_mat, arb, arb_mat, ctx, fmpq, fmpq_mat

from gainsay.exact.budget import multiply_cost, spend

__all__ = [
    "ball_positive_definite",
    "cholesky_factor",
    "hermitian_positive_definite",
    "inertia",
    "is_symmetric",
    "positive_definite",
    "positive_semidefinite",
    "rational_positive_definite",
]

#: half of the size below which a Hermitian matrix is factorised as a whole
_SMALL = 4


def is_symmetric(matrix: fmpq_mat) -> bool:
    """Whether a rational matrix equals its transpose."""
    return matrix.nrows() == matrix.ncols() and matrix == matrix.transpose()


def rational_positive_definite(matrix: fmpq_mat, semidefinite: bool = False) -> bool:
    """Decide definiteness by exact L D L'.

    A zero pivot of a positive semidefinite matrix has a zero row, so no pivoting is needed.

    Parameters
    ----------
    matrix : fmpq_mat, shape (n, n)
        Symmetric.
    semidefinite : bool, optional
        Decide >= 0 instead of > 0.
    """
    if not is_symmetric(matrix):
        return False
    rows = matrix.tolist()
    size = len(rows)
    # after k steps an entry is a quotient of minors of size k
    bits = max(x.height_bits() for x in matrix.entries())
    spend(size**3 / 6 * multiply_cost(size * bits, size * bits), "an exact factorisation")
    for k in range(size):
        pivot = rows[k][k]
        if pivot < 0 or (pivot == 0 and not semidefinite):
            return False
        if pivot == 0:
            if any(rows[i][k] != 0 for i in range(k + 1, size)):
                return False
            continue
        column = [rows[i][k] for i in range(size)]
        for i in range(k + 1, size):
            if column[i] == 0:
                continue
            factor = column[i] / pivot
            row = rows[i]
            for j in range(k + 1, i + 1):
                if column[j] != 0:
                    row[j] = row[j] - factor * column[j]
    return True


def inertia(matrix: fmpq_mat) -> tuple[int, int, int]:
    """Numbers of positive, negative and zero eigenvalues of a symmetric rational matrix, by exact congruences.

    Raises
    ------
    ValueError
        If the matrix is not symmetric.
    """
    if not is_symmetric(matrix):
        raise ValueError("inertia of a matrix that is not symmetric")
    rows = matrix.tolist()
    plus = minus = 0
    while rows:
        size = len(rows)
        pivot = next((i for i in range(size) if rows[i][i] != 0), None)
        if pivot is None:
            pair = next(((i, j) for i in range(size) for j in range(i) if rows[i][j] != 0), None)
            if pair is None:
                break
            i, j = pair  # the congruence row i += row j, column i += column j makes the diagonal entry 2 a_ij
            rows[i] = [a + b for a, b in zip(rows[i], rows[j], strict=True)]
            for row in rows:
                row[i] = row[i] + row[j]
            pivot = i
        value = rows[pivot][pivot]
        plus, minus = plus + (value > 0), minus + (value < 0)
        head = rows[pivot]
        rest = [i for i in range(size) if i != pivot]
        rows = [[rows[i][j] - rows[i][pivot] * head[j] / value for j in rest] for i in rest]
    return plus, minus, matrix.nrows() - plus - minus


def _ball_cholesky(rows: list[list[arb]]) -> bool:
    size = len(rows)
    spend(size**3 / 6 * (60 + multiply_cost(ctx.prec, ctx.prec)), "a factorisation in balls")
    factor: list[list[arb]] = []
    for i in range(size):
        line: list[arb] = []
        for j in range(i):
            entry = rows[i][j]
            other = factor[j]
            for k in range(j):
                entry = entry - line[k] * other[k]
            line.append(entry / other[j])
        pivot = rows[i][i]
        for entry in line:
            pivot = pivot - entry * entry
        if not pivot > 0:
            return False
        line.append(pivot.sqrt())
        factor.append(line)
    return True


def _ball_gershgorin(matrix: arb_mat) -> bool:
    """Prove T F T' > 0 by Gershgorin's circles, T the inverse Cholesky factor of the midpoint: tight for wide balls."""
    size = matrix.nrows()
    spend(size**3 * (60 + multiply_cost(ctx.prec, ctx.prec)), "a factorisation in balls")
    middle = matrix.mid().tolist()
    factor: list[list[arb]] = []
    for i in range(size):
        line: list[arb] = []
        for j in range(i):
            entry = middle[i][j] - sum((line[k] * factor[j][k] for k in range(j)), arb(0))
            line.append((entry / factor[j][j]).mid())
        pivot = (middle[i][i] - sum((x * x for x in line), arb(0))).mid()
        if not pivot > 0:
            return False
        factor.append([*line, pivot.sqrt().mid()])
    full = arb_mat([[factor[i][j] if j <= i else arb(0) for j in range(size)] for i in range(size)])
    try:
        inverse = full.inv().mid()
    except ZeroDivisionError:
        return False
    product = (inverse * matrix * inverse.transpose()).tolist()
    for i, row in enumerate(product):
        off = sum((row[j].abs_upper() for j in range(size) if j != i), arb(0))
        if not row[i] - off > 0:
            return False
    return True


def ball_positive_definite(matrix: arb_mat) -> bool:
    """Prove that every symmetric matrix enclosed by the symmetric part of a ball matrix is positive definite."""
    if matrix.nrows() != matrix.ncols():
        return False
    symmetric = (matrix + matrix.transpose()) * arb(0.5)
    return _ball_cholesky(symmetric.tolist()) or _ball_gershgorin(symmetric)


def hermitian_positive_definite(matrix: acb_mat) -> bool:
    """Prove that every Hermitian matrix enclosed by a complex ball matrix is positive definite.

    By Cholesky; a large one by halves, the second of which is the Schur complement of the first: most of the work is
    then a product of matrices. The lower triangle is read; the imaginary parts of the diagonal, zero in a Hermitian
    matrix, are not.
    """
    return _hermitian(matrix.tolist())


def _hermitian(rows: list[list[acb]]) -> bool:
    half = len(rows) // 2
    if half < _SMALL:
        return _hermitian_cholesky(rows)
    whole = acb_mat(
        [
            [acb(rows[i][i].real) if i == j else rows[i][j] if j < i else rows[j][i].conjugate() for j in range(half)]
            for i in range(half)
        ]
    )
    if not _hermitian(whole.tolist()):
        return False
    below = acb_mat([row[:half] for row in rows[half:]])
    try:
        taken = below * whole.solve(below.conjugate().transpose(), algorithm="lu")
    except ZeroDivisionError:
        return False
    rest = acb_mat([row[half:] for row in rows[half:]]) - taken
    return _hermitian(rest.tolist())


def _hermitian_cholesky(rows: list[list[acb]]) -> bool:
    factor: list[list[acb]] = []
    conjugates: list[list[acb]] = []
    for i, row in enumerate(rows):
        line: list[acb] = []
        for j in range(i):
            entry = row[j]
            for known, other in zip(line, conjugates[j], strict=False):
                entry = entry - known * other
            line.append(entry / factor[j][j])
        pivot = row[i].real
        for entry in line:
            pivot = pivot - entry.real * entry.real - entry.imag * entry.imag
        if not pivot > 0:
            return False
        line.append(acb(pivot.sqrt()))
        factor.append(line)
        conjugates.append([x.conjugate() for x in line[:-1]])
    return True


def _in_balls(matrix: fmpq_mat) -> bool:
    """Prove a rational symmetric matrix > 0 by Cholesky in balls, at growing precision; False proves nothing."""
    bits = ctx.prec
    for factor in (1, 2, 4):
        with ctx.workprec(factor * bits):
            if _ball_cholesky(arb_mat(matrix).tolist()):
                return True
    return False


def positive_definite(matrix: fmpq_mat | arb_mat) -> bool:
    """Prove > 0: balls first, since they are fast, and exact L D L' for a rational matrix that they cannot settle."""
    if isinstance(matrix, fmpq_mat):
        return is_symmetric(matrix) and (_in_balls(matrix) or rational_positive_definite(matrix))
    return ball_positive_definite(matrix)


def positive_semidefinite(matrix: fmpq_mat | arb_mat) -> bool:
    """Prove >= 0: a rational matrix in balls where it is > 0, else exactly, without its zero rows and columns.

    A ball matrix must be provably > 0, or a provably non-negative number.
    """
    if isinstance(matrix, fmpq_mat):
        if not is_symmetric(matrix):
            return False
        matrix = _without_zeros(matrix)
        return _in_balls(matrix) or rational_positive_definite(matrix, semidefinite=True)
    if matrix.nrows() == matrix.ncols() == 1:
        return bool(matrix[0, 0] >= 0)
    return ball_positive_definite(matrix)


def _without_zeros(matrix: fmpq_mat) -> fmpq_mat:
    """Matrix without the rows and columns of zeros, which change nothing about >= 0; one of zeros stays."""
    rows = matrix.tolist()
    keep = [i for i, row in enumerate(rows) if any(x != 0 for x in row)] or [0]
    return fmpq_mat([[rows[i][j] for j in keep] for i in keep])


def cholesky_factor(matrix: fmpq_mat | arb_mat) -> arb_mat:
    """Exact dyadic R near the factor of a positive definite matrix R' R; no more than nearness is promised.

    Raises
    ------
    ArithmeticError
        If the factorisation breaks down at the precision in force.
    """
    rows = arb_mat(matrix).mid().tolist()
    size = len(rows)
    factor = [[arb(0)] * size for _ in range(size)]
    for i in range(size):
        for j in range(i + 1):
            entry = (rows[i][j] - sum((factor[i][k] * factor[j][k] for k in range(j)), arb(0))).mid()
            if i == j and not entry > 0:
                raise ArithmeticError("no Cholesky factor at this precision")
            factor[i][j] = (entry.sqrt() if i == j else entry / factor[j][j]).mid()
    return arb_mat(factor).transpose()


def quadratic_form(matrix: fmpq_mat | arb_mat, vector: list[fmpq]) -> fmpq | arb:
    """Value z' F z, exact for a rational F and enclosed for a ball matrix."""
    column = fmpq_mat(len(vector), 1, vector)
    if isinstance(matrix, arb_mat):
        wide = arb_mat(column)
        return (wide.transpose() * matrix * wide)[0, 0]
    return (column.transpose() * matrix * column)[0, 0]

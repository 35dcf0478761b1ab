"""Steps that several kinds of proof share: orders between quadratic forms, vertices, bounds."""

from fractions import Fraction

from gainsay.exact.ball import lower, upper
from gainsay.exact.definite import is_symmetric, positive_definite, positive_semidefinite
from gainsay.exact.matrix import BALL, POLYNOMIAL, Matrix, RingError
from gainsay.proof.scope import Scope

__all__ = ["bounds", "demand", "order_holds", "regular_symmetric", "sym", "vertices"]


def sym(matrix: Matrix) -> Matrix:
    """Sum of a matrix and its transpose."""
    return matrix + matrix.T


def regular_symmetric(scope: Scope, matrix: Matrix, what: str) -> Matrix:
    """The matrix if it is square and symmetric (balls: not provably otherwise); refused if not."""
    if matrix.ring == POLYNOMIAL:
        raise scope.fail(f"{what} holds indeterminates where a value is expected")
    if matrix.shape[0] != matrix.shape[1]:
        raise scope.fail(f"{what} has shape {matrix.shape}: an order needs a square matrix")
    symmetric = matrix.data.overlaps(matrix.data.transpose()) if matrix.ring == BALL else is_symmetric(matrix.data)
    if not symmetric:
        raise scope.fail(f"{what} is not symmetric")
    return matrix


def order_holds(scope: Scope, matrix: Matrix, relation: str, what: str) -> bool:
    """Whether ``matrix relation 0`` is proved; between matrices the order is that of quadratic forms."""
    if relation == "==":
        if matrix.ring == BALL:
            raise scope.fail(f"{what}: an equation cannot be proved in balls")
        return all(x == 0 for row in matrix.rows() for x in row)
    matrix = regular_symmetric(scope, matrix, what)
    signed = matrix if relation in (">", ">=") else -matrix
    return positive_definite(signed.data) if relation in (">", "<") else positive_semidefinite(signed.data)


def demand(scope: Scope, matrix: Matrix, relation: str, what: str) -> None:
    """Refuse the certificate unless ``matrix relation 0`` is proved."""
    if not order_holds(scope, matrix, relation, what):
        raise scope.fail(f"{what} {relation} 0 is not proved")


def vertices(scope: Scope, name: str) -> list[Matrix]:
    """Values of a field that holds one formula or a list of them, the vertices of a polytope."""
    raw = scope.field(name)
    texts = raw if isinstance(raw, list) else [raw]
    if not texts or any(not isinstance(t, str) for t in texts):
        raise scope.fail(f"field {name!r}: expected a formula or a list of formulas")
    return [scope.evaluate(text) for text in texts]


def bounds(scope: Scope, value: Matrix, what: str) -> tuple[Fraction, Fraction]:
    """Exact lower and upper end of a number."""
    if not value.is_number or value.ring == POLYNOMIAL:
        raise scope.fail(f"{what}: expected a number, found a {value.ring} matrix of shape {value.shape}")
    if value.is_exact:
        return value.value(), value.value()
    try:
        return lower(value.entry(0, 0)), upper(value.entry(0, 0))
    except (ArithmeticError, RingError) as error:
        raise scope.fail(f"{what}: {error}") from error

"""Steps that several kinds of proof share: orders between quadratic forms, vertices of polytopes and boxes, bounds.

A matrix over a box has the field ``ranges``: uncertain numbers, each as ``[name, low, high]``, its ends formulas over
the tables. A matrix that is affine in each of them, the others held (their products are allowed, no powers, no
quotients), is everywhere in the box a convex combination of what it is at the corners; that it is affine in each is
checked, not taken on faith.
"""

from fractions import Fraction
from itertools import product

from flint import fmpq_mpoly_ctx

from gainsay.exact.ball import lower, upper
from gainsay.exact.budget import spend
from gainsay.exact.definite import is_symmetric, positive_definite, positive_semidefinite
from gainsay.exact.matrix import BALL, POLYNOMIAL, Matrix, RingError
from gainsay.exact.rational import rational_matrix, to_fmpq
from gainsay.proof.scope import Scope

__all__ = [
    "Ends",
    "bounds",
    "corners",
    "define",
    "demand",
    "order_holds",
    "ranges",
    "regular_symmetric",
    "sym",
    "vertices",
]

#: least and greatest value of each uncertain number
Ends = dict[str, tuple[Fraction, Fraction]]
#: uncertain numbers of one box, which has 2 to their number of corners
MOST_RANGES = 12


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


def ranges(scope: Scope) -> Ends:
    """Ends of the uncertain numbers of the field ``ranges``; none where there is no such field."""
    raw = scope.certificate.fields.get("ranges", [])
    entries = raw if isinstance(raw, list) else [raw]
    if any(not isinstance(e, list) or len(e) != 3 or any(not isinstance(text, str) for text in e) for e in entries):
        raise scope.fail("field 'ranges': expected a name and the formulas of two ends for each uncertain number")
    if len(entries) > MOST_RANGES:
        raise scope.fail(f"field 'ranges': {len(entries)} uncertain numbers, at most {MOST_RANGES} expected")
    over_tables = Scope(scope.certificate, scope.reader.tables)
    over_tables.reader = scope.reader
    ends: Ends = {}
    for name, *texts in entries:
        low, high = (over_tables.number(text) for text in texts)
        if name in ends or name in scope.certificate.unknowns or low > high:
            raise scope.fail(f"field 'ranges': {name!r} from {low} to {high}: expected each number once, low <= high")
        ends[name] = (low, high)
    return ends


def define(scope: Scope) -> Ends:
    """Evaluate the definitions over uncertain numbers, which are indeterminates; returns the ends of these."""
    ends = ranges(scope)
    if ends:
        for name, generator in zip(ends, fmpq_mpoly_ctx.get(list(ends)).gens(), strict=True):
            scope.bind(name, Matrix([[generator]]))
    scope.define()
    return ends


def corners(scope: Scope, value: Matrix, ends: Ends, what: str) -> list[Matrix]:
    """Values of a matrix at the corners of the box, of which it is a convex combination everywhere in it."""
    if value.ring != POLYNOMIAL:
        return [value]
    entries = value.rows()
    for power in (powers for row in entries for entry in row for powers in entry.monoms()):
        for name, exponent in zip(ends, power, strict=True):
            if exponent > 1:
                raise scope.fail(f"{what} holds {name}**{exponent}: expected a matrix affine in each uncertain number")
    spend(2 ** len(ends) * (value.terms + 1) * 20, "corners of a box")
    points = product(*[[to_fmpq(end) for end in pair] for pair in ends.values()])
    return [Matrix(rational_matrix([[entry(*point) for entry in row] for row in entries])) for point in points]


def vertices(scope: Scope, name: str, ends: Ends | None = None) -> list[Matrix]:
    """Vertices of a polytope: those that a field lists, or the corners of what its one formula is over the ranges."""
    raw = scope.field(name)
    texts = raw if isinstance(raw, list) else [raw]
    if not texts or any(not isinstance(t, str) for t in texts):
        raise scope.fail(f"field {name!r}: expected a formula or a list of formulas")
    if ends and len(texts) > 1:
        raise scope.fail(f"field {name!r}: expected a list of vertices or a formula over ranges, not both")
    return [corner for text in texts for corner in corners(scope, scope.evaluate(text), ends or {}, f"field {name!r}")]


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

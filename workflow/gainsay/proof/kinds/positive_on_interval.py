"""A polynomial, or a symmetric matrix of polynomials in one number, is positive on an interval.

Theorem: if F(t) is a symmetric matrix of polynomials, F(low) > 0 and det F has no root in [low, high], then F(t) > 0
for every t there: an eigenvalue cannot change sign without passing zero. The determinant is formed exactly (by
interpolation), and its real roots are counted by Sturm's theorem.

Fields: ``constraint`` (``F > 0`` or ``F < 0``), ``low``, ``high``; one unknown, a number. No witness.
Reference: H. Cohen, A Course in Computational Algebraic Number Theory, Springer 1993, section 4.1.
"""

from itertools import pairwise

from flint import fmpq, fmpq_mat, fmpq_poly

from gainsay.exact.budget import multiply_cost, spend
from gainsay.exact.definite import positive_definite
from gainsay.exact.matrix import POLYNOMIAL, Matrix
from gainsay.exact.rational import to_fmpq
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "a matrix polynomial that is positive at one point and regular on an interval is positive on it"
REQUIRED = ("constraint", "low", "high")
OPTIONAL = ()
LEVELS = ()
FOUND = ()


def coefficients(form: Matrix) -> list[fmpq_mat]:
    """Matrix coefficients of a matrix polynomial in one number, from the constant one up."""
    entries = [[x.to_dict() for x in row] for row in form.rows()]
    degree = max((int(e[0]) for row in entries for d in row for e in d), default=0)
    return [fmpq_mat([[d.get((k,), fmpq(0)) for d in row] for row in entries]) for k in range(degree + 1)]


def value_at(parts: list[fmpq_mat], point: fmpq) -> fmpq_mat:
    """Value of a matrix polynomial, by Horner's rule."""
    total = parts[-1]
    for part in reversed(parts[:-1]):
        total = total * point + part
    return total


def determinant(parts: list[fmpq_mat]) -> fmpq_poly:
    """Determinant of a matrix polynomial, by Newton's interpolation at the integers."""
    size = parts[0].nrows()
    count = size * (len(parts) - 1) + 1
    bits = max(x.height_bits() for part in parts for x in part.entries()) + len(parts) * count.bit_length()
    spend(count * size**3 * multiply_cost(size * bits, bits), "determinants")
    # the members of Sturm's chain have coefficients of about degree times as many bits
    spend(count**3 * multiply_cost(count * size * bits, size * bits), "a determinant as a polynomial and Sturm's chain")
    differences = [value_at(parts, fmpq(k)).det() for k in range(count)]
    for level in range(1, count):
        for k in range(count - 1, level - 1, -1):
            differences[k] = (differences[k] - differences[k - 1]) / level
    result = fmpq_poly([differences[-1]])
    for k in range(count - 2, -1, -1):
        result = result * fmpq_poly([-k, 1]) + fmpq_poly([differences[k]])
    return result


def roots_between(polynomial: fmpq_poly, low: fmpq, high: fmpq) -> int:
    """Number of different real roots in [low, high], by Sturm's theorem; -1 for the zero polynomial."""
    if polynomial.degree() < 0:
        return -1
    if polynomial(low) == 0 or polynomial(high) == 0:
        return 1
    chain = [polynomial, polynomial.derivative()]
    while chain[-1].degree() > 0:
        rest = -(chain[-2] % chain[-1])
        if rest.degree() < 0:
            break
        chain.append(rest)

    def changes(point: fmpq) -> int:
        signs = [value > 0 for value in (member(point) for member in chain) if value != 0]
        return sum(a != b for a, b in pairwise(signs))

    return changes(low) - changes(high)


def prove(scope: Scope) -> list[Proved]:
    """Prove the sign on the interval."""
    shapes = scope.unknown_shapes()
    if [shape for shape, _ in shapes.values()] != [(1, 1)]:
        raise scope.fail("expected one unknown, a number")
    scope.bind_indeterminates()
    scope.define()
    form, relation = scope.constraint(scope.field("constraint"))
    low, high = (to_fmpq(scope.number(scope.field(name))) for name in ("low", "high"))
    if relation not in (">", "<") or low > high:
        raise scope.fail("expected F > 0 or F < 0, and low <= high")
    form = form if relation == ">" else -form
    if form.ring != POLYNOMIAL:
        raise scope.fail("the constraint does not hold the unknown, or is not exact")
    if not form.equals(form.T):
        raise scope.fail("the constraint's difference is not symmetric")
    parts = coefficients(form)
    if not positive_definite(value_at(parts, low)):
        raise scope.fail("the constraint is not proved at the lower end")
    if roots_between(determinant(parts), low, high) != 0:
        raise scope.fail("the determinant vanishes in the interval")
    return [Proved("definite", "holds")]

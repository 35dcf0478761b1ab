"""A complex number is not an eigenvalue, of one matrix or of every matrix of a box of printed digits.

Theorem: if |I - R (s I - A)| < 1 in a norm that is consistent, for some R, then s I - A is regular. R is the inverse
at the midpoint, rounded; the norm is the largest row sum. The same R proves more: with t = |R| and
q = |I - R (s I - A)|, every eigenvalue is at least (1 - q) / t away from s.

Fields: ``matrix``, ``real`` and ``imaginary`` (of s). No witness.
Reference: S. M. Rump, "Verification methods: rigorous results using floating-point arithmetic", Acta Numerica 19
(2010) 287-449.
"""

from flint import acb, acb_mat, arb, ctx

from gainsay.exact.ball import decimal_below, lower
from gainsay.exact.budget import multiply_cost, spend
from gainsay.exact.matrix import Matrix
from gainsay.exact.rational import to_fmpq, to_text
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "a matrix with an approximate inverse of residual below one is regular"
REQUIRED = ("matrix", "real", "imaginary")
OPTIONAL = ()
LEVELS = ()
FOUND = ()


def row_norm(matrix: acb_mat) -> arb:
    """Largest row sum of moduli, from above."""
    sums = [sum((x.abs_upper() for x in row), arb(0)).upper() for row in matrix.tolist()]
    largest = sums[0]
    for value in sums[1:]:
        largest = largest.max(value)
    return largest.upper()


def distance(a: Matrix, point: acb) -> arb:
    """Lower bound on the distance of every eigenvalue from a point; at most 0 where nothing is proved."""
    size = a.shape[0]
    spend(2 * (60 + multiply_cost(ctx.prec, ctx.prec)) * size**3, "an inverse")
    unit = acb_mat([[int(i == j) for j in range(size)] for i in range(size)])
    regular = unit * point - acb_mat(a.to_ball().data)
    try:
        near = regular.mid().inv().mid()
    except ZeroDivisionError:
        return arb(0)
    residual = row_norm(unit - near * regular)
    return ((1 - residual) / row_norm(near)).lower()


def prove(scope: Scope) -> list[Proved]:
    """Prove that s is not an eigenvalue."""
    scope.define()
    a = scope.evaluate(scope.field("matrix"))
    if a.shape[0] != a.shape[1]:
        raise scope.fail(f"matrix of shape {a.shape}: an eigenvalue needs a square one")
    real, imaginary = scope.number(scope.field("real")), scope.number(scope.field("imaginary"))
    gap = distance(a, acb(arb(to_fmpq(real)), arb(to_fmpq(imaginary))))
    if not gap > 0:
        raise scope.fail("s I - A is not proved regular")
    return [Proved("eigenvalue", "fails"), Proved("distance", "at_least", to_text(decimal_below(lower(gap), 12)))]

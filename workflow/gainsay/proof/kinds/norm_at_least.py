"""A lower bound on an H-infinity norm: the gain at one frequency along one input.

Theorem: the norm of G(s) = C (s I - A)^-1 B + D, the supremum of its largest singular value over the imaginary axis, is
at least |G(i w) u| / |u| for every w and u. If A is not Hurwitz the norm counts as infinite, and the bound holds too.

Fields: ``A``, ``B``, ``C``, ``D`` (may be left out), ``frequency`` (w, rad/s), ``gamma``. Witness: ``u``, columns of
real and imaginary parts.
Reference: K. Zhou, J. C. Doyle, K. Glover, Robust and Optimal Control, Prentice Hall 1996, section 4.3.
"""

from flint import acb, acb_mat, arb, ctx

from gainsay.exact.budget import multiply_cost, spend
from gainsay.exact.rational import to_fmpq, to_text
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "the gain at one frequency is at most the supremum over all"
REQUIRED = ("A", "B", "C", "frequency", "gamma")
OPTIONAL = ("D",)
LEVELS = ("gamma",)
FOUND = ("frequency",)


def prove(scope: Scope) -> list[Proved]:
    """Prove the gain at the frequency."""
    scope.define()
    a, b, c = (acb_mat(scope.evaluate(scope.field(name)).to_ball().data) for name in "ABC")
    frequency, gamma = scope.number(scope.field("frequency")), scope.number(scope.field("gamma"))
    if gamma < 0:
        raise scope.fail("field 'gamma' must not be negative")
    point = acb(0, arb(to_fmpq(frequency)))
    size = a.nrows()
    spend((60 + multiply_cost(ctx.prec, ctx.prec)) * size**3, "a frequency response")
    parts = scope.witness("u", (b.ncols(), 2))
    u = acb_mat([[acb(arb(re), arb(im))] for re, im in parts.rows()])
    if all(x == 0 for row in parts.rows() for x in row):
        raise scope.fail("witness 'u' is zero")
    unit = acb_mat([[int(i == j) for j in range(size)] for i in range(size)])
    try:
        y = c * (unit * point - a).solve(b * u)
    except ZeroDivisionError as error:
        raise scope.fail("i w I - A is not proved regular") from error
    if "D" in scope.certificate.fields:
        y = y + acb_mat(scope.evaluate(scope.field("D")).to_ball().data) * u

    def square(column: acb_mat) -> arb:
        return sum((x.real * x.real + x.imag * x.imag for (x,) in column.tolist()), arb(0))

    if not square(y) - arb(to_fmpq(gamma**2)) * square(u) >= 0:
        raise scope.fail("|G(i w) u| >= gamma |u| is not proved")
    return [Proved("norm", "at_least", to_text(gamma))]

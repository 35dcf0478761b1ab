"""Some eigenvalue lies right of a vertical line, or outside a disk.

Theorem: if P A + A' P < 2 alpha P and z' P z <= 0 for some z != 0, then some eigenvalue of A has real part greater
than alpha. (Were the abscissa less than alpha, P would be positive definite; and no eigenvalue lies on the line,
since v* (P A + A' P - 2 alpha P) v = 0 for its eigenvector v.) Likewise (A + a I)' P (A + a I) < b^2 P with z' P z <=
0 leaves an eigenvalue s with |s + a| > b. Over a box of printed digits this holds for every matrix of the box.

Fields: ``matrix`` and ``alpha``, or ``matrix``, ``shift`` (a) and ``radius`` (b). Witness: ``P``, ``z``.
Reference: A. Ostrowski, H. Schneider, "Some theorems on the inertia of general matrices", Journal of Mathematical
Analysis and Applications 4 (1962) 72-84.
"""

from gainsay.exact.definite import quadratic_form
from gainsay.exact.matrix import Matrix, eye
from gainsay.exact.rational import to_text
from gainsay.proof.inequalities import demand, sym
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "the inertia theorem of Ostrowski and Schneider"
REQUIRED = ("matrix",)
OPTIONAL = ("alpha", "shift", "radius")
LEVELS = ("alpha", "radius")
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove that some eigenvalue lies outside the region."""
    scope.fields_fit(("shift", "radius"))
    if ("alpha" in scope.certificate.fields) == ("radius" in scope.certificate.fields):
        raise scope.fail("expected a line (alpha) or a disk (shift and radius)")
    scope.define()
    a = scope.evaluate(scope.field("matrix"))
    size = a.shape[0]
    p = scope.symmetric_witness("P", size)
    z = [row[0] for row in scope.witness("z", (size, 1)).rows()]
    if all(x == 0 for x in z) or quadratic_form(p.data, z) > 0:
        raise scope.fail("witness 'z': expected z != 0 with z' P z <= 0")
    if "alpha" in scope.certificate.fields:
        alpha = scope.number(scope.field("alpha"))
        form = sym(p @ a) - p.scaled(Matrix.number(2 * alpha))
        demand(scope, form, "<", "P A + A' P - 2 alpha P")
        result = [Proved("abscissa", "greater_than", to_text(alpha))]
        return [*result, Proved("stable", "fails")] if alpha >= 0 else result
    shift, radius = scope.number(scope.field("shift")), scope.number(scope.field("radius"))
    if radius <= 0:
        raise scope.fail("field 'radius' must be positive")
    moved = a + eye(size).scaled(Matrix.number(shift))
    demand(scope, moved.T @ p @ moved - p.scaled(Matrix.number(radius**2)), "<", "(A + a I)' P (A + a I) - b^2 P")
    return [Proved("radius", "greater_than", to_text(radius))]

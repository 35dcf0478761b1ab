"""Every eigenvalue lies in a disk with its centre on the real axis.

Theorem (Stein): if P > 0 and (A + a I)' P (A + a I) < b^2 P, b > 0, then every eigenvalue s of A satisfies |s + a| < b;
with <= at most b. For a list of matrices and one P this holds for every matrix of their convex hull.

Fields: ``matrix`` (a formula, over the uncertain numbers of ``ranges`` if there are any, or a list of vertices),
``shift`` (a), ``radius`` (b). Witness: ``P``.
Reference: M. Chilali, P. Gahinet, "H-infinity design with pole placement constraints: an LMI approach", IEEE
Transactions on Automatic Control 41 (1996) 358-367.
"""

from gainsay.exact.matrix import Matrix, eye
from gainsay.exact.rational import to_text
from gainsay.proof.inequalities import define, demand, order_holds, vertices
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "Stein's inequality for a disk"
REQUIRED = ("matrix", "shift", "radius")
OPTIONAL = ("ranges",)
LEVELS = ("radius",)
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove the bound on the distance of the eigenvalues from -a."""
    ends = define(scope)
    matrices = vertices(scope, "matrix", ends)
    shift, radius = scope.number(scope.field("shift")), scope.number(scope.field("radius"))
    if radius <= 0:
        raise scope.fail("field 'radius' must be positive")
    size = matrices[0].shape[0]
    p = scope.symmetric_witness("P", size)
    demand(scope, p, ">", "P")
    strict = True
    for number, a in enumerate(matrices, 1):
        moved = a + eye(size).scaled(Matrix.number(shift))
        form = moved.T @ p @ moved - p.scaled(Matrix.number(radius**2))
        what = f"(A + a I)' P (A + a I) - b^2 P (vertex {number})"
        if not order_holds(scope, form, "<", what):
            demand(scope, form, "<=", what)
            strict = False
    result = [Proved("radius", "less_than" if strict else "at_most", to_text(radius))]
    if radius < shift or (radius == shift and strict):
        result.append(Proved("stable", "holds"))
    return result

"""Every eigenvalue of a pencil s E - A, E regular, lies in a disk with its centre on the real axis.

Theorem: if [[b^2 P, -(P K (A + a E))'], [-P K (A + a E), P K E + (P K E)' - P]] > 0 for some K, b > 0, then E is
regular and every s with det(s E - A) = 0 satisfies |s + a| < b. (The first block gives P > 0. At (0, y) with E y = 0
the form is -y* P y, so that E is regular. With A v = s E v, v != 0, and y = (s + a) v, it is (b^2 - |s + a|^2) v* P v.)
The form is affine in A and in E together: with one P and one K it holds for every pencil of a convex hull. So a matrix
M^-1 N is proved whose M and N are affine in uncertain numbers.

Fields: ``matrix`` (A) and ``descriptor`` (E), formulas over the uncertain numbers of ``ranges`` if there are any,
``shift`` (a), ``radius`` (b). Witness: ``P``, ``K`` (near the inverse of E).
Reference: M. C. de Oliveira, R. E. Skelton, "Stability tests for constrained linear systems", in Perspectives in Robust
Control, Springer 2001, 241-257.
"""

from gainsay.exact.blocks import block
from gainsay.exact.matrix import Matrix
from gainsay.exact.rational import to_text
from gainsay.proof.inequalities import corners, define, demand, sym
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "Stein's inequality for a descriptor form, with a slack matrix"
REQUIRED = ("matrix", "descriptor", "shift", "radius")
OPTIONAL = ("ranges",)
LEVELS = ("radius",)
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove the bound on the distance of the pencil's eigenvalues from -a."""
    ends = define(scope)
    a, e = (scope.evaluate(scope.field(name)) for name in ("matrix", "descriptor"))
    size = a.shape[0]
    if a.shape != (size, size) or e.shape != a.shape:
        raise scope.fail(f"matrix of shape {a.shape} and descriptor of shape {e.shape}: two square ones expected")
    shift, radius = scope.number(scope.field("shift")), scope.number(scope.field("radius"))
    if radius <= 0:
        raise scope.fail("field 'radius' must be positive")
    p = scope.symmetric_witness("P", size)
    near = p.scaled(Matrix.number(radius**2))
    demand(scope, near, ">", "b^2 P")
    slack, weight = (p @ scope.witness("K", (size, size))).to_ball(), near.to_ball().inverse()
    pencil = block([[a + e.scaled(Matrix.number(shift)), e]])
    for number, corner in enumerate(corners(scope, pencil, ends, "the pencil"), 1):
        product = slack @ corner
        cross, held = (product.take(range(size), range(k, k + size)) for k in (0, size))
        # the Schur complement of the first block
        demand(scope, sym(held) - p - cross @ weight @ cross.T, ">", f"the form of the pencil (vertex {number})")
    result = [Proved("radius", "less_than", to_text(radius))]
    return [*result, Proved("stable", "holds")] if radius <= shift else result

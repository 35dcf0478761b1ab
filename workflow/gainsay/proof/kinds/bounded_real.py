"""An upper bound on an H-infinity norm.

Theorem (bounded real lemma): if P > 0 and [[P A + A' P + C' C, P B + C' D], [., D' D - gamma^2 I]] < 0, then A is
Hurwitz and the norm of C (s I - A)^-1 B + D is less than gamma. For lists of matrices of equal length and one P this
holds for every system of their convex hull, even as it varies with time (norm from L2 to L2).

Fields: ``A``, ``B``, ``C``, ``D`` (formulas, over the uncertain numbers of ``ranges`` if there are any, or lists of
vertices; D may be left out), ``gamma``. Witness: ``P``.
Reference: Boyd et al., Linear Matrix Inequalities in System and Control Theory, SIAM 1994, section 2.7.3.
"""

from gainsay.exact.blocks import block
from gainsay.exact.matrix import Matrix, eye, zeros
from gainsay.exact.rational import to_text
from gainsay.proof.inequalities import Ends, define, demand, sym, vertices
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "the bounded real lemma"
REQUIRED = ("A", "B", "C", "gamma")
OPTIONAL = ("D", "ranges")
LEVELS = ("gamma",)
FOUND = ()


def systems(scope: Scope, names: tuple[str, ...], ends: Ends) -> list[tuple[Matrix, ...]]:
    """Vertices of a system: every matrix that has one vertex is shared by all."""
    lists = [vertices(scope, name, ends) for name in names]
    count = max(len(matrices) for matrices in lists)
    if any(len(matrices) not in (1, count) for matrices in lists):
        raise scope.fail("lists of vertices of different length")
    return list(zip(*(matrices * count if len(matrices) == 1 else matrices for matrices in lists), strict=True))


def prove(scope: Scope) -> list[Proved]:
    """Prove the bound on the norm."""
    ends = define(scope)
    gamma = scope.number(scope.field("gamma"))
    if gamma <= 0:
        raise scope.fail("field 'gamma' must be positive")
    names = ("A", "B", "C", "D") if "D" in scope.certificate.fields else ("A", "B", "C")
    listed = systems(scope, names, ends)
    p = scope.symmetric_witness("P", listed[0][0].shape[0])
    demand(scope, p, ">", "P")
    for number, (a, b, c, *rest) in enumerate(listed, 1):
        d = rest[0] if rest else zeros(c.shape[0], b.shape[1])
        level = eye(b.shape[1]).scaled(Matrix.number(gamma**2))
        form = block([[sym(p @ a) + c.T @ c, p @ b + c.T @ d], [None, d.T @ d - level]])
        demand(scope, form, "<", f"the bounded real inequality (vertex {number})")
    return [Proved("norm", "less_than", to_text(gamma)), Proved("stable", "holds")]

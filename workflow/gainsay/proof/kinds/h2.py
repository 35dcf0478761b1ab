"""Bounds on an H2 norm.

Theorem: if P > 0 and P A + A' P + C' C < 0, then A is Hurwitz and the squared H2 norm of C (s I - A)^-1 B is less than
or equal to trace B' P B. If A is Hurwitz and S A + A' S + C' C >= 0 (S symmetric), it is at least trace B' S B.
For lists of matrices and one P the upper bound holds for every system of their convex hull.

Fields: ``A``, ``B``, ``C``, ``ranges`` (as for ``bounded_real``), ``bound`` (on the norm), and for a lower bound
``lower``. Witness: ``P``, and ``S`` with ``lower``.
Reference: Boyd et al., Linear Matrix Inequalities in System and Control Theory, SIAM 1994, section 6.2.
"""

from gainsay.exact.rational import to_text
from gainsay.proof.inequalities import bounds, define, demand, sym
from gainsay.proof.kinds import Proved
from gainsay.proof.kinds.bounded_real import systems
from gainsay.proof.scope import Scope

THEOREM = "the observability Gramian inequality"
REQUIRED = ("A", "B", "C", "bound")
OPTIONAL = ("lower", "ranges")
LEVELS = ("bound", "lower")
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove the bounds on the norm."""
    ends = define(scope)
    bound = scope.number(scope.field("bound"))
    listed = systems(scope, ("A", "B", "C"), ends)
    size = listed[0][0].shape[0]
    p = scope.symmetric_witness("P", size)
    demand(scope, p, ">", "P")
    for number, (a, b, c) in enumerate(listed, 1):
        demand(scope, sym(p @ a) + c.T @ c, "<", f"P A + A' P + C' C (vertex {number})")
        _, high = bounds(scope, (b.T @ p @ b).trace(), "trace B' P B")
        if bound < 0 or high > bound**2:
            raise scope.fail(f"trace B' P B <= bound^2 is not proved (vertex {number})")
    result = [Proved("norm", "at_most", to_text(bound)), Proved("stable", "holds")]
    if "lower" in scope.certificate.fields:
        if len(listed) != 1:
            raise scope.fail("field 'lower': one system, not a list of vertices")
        a, b, c = listed[0]
        s, least = scope.symmetric_witness("S", size), scope.number(scope.field("lower"))
        demand(scope, sym(s @ a) + c.T @ c, ">=", "S A + A' S + C' C")
        low, _ = bounds(scope, (b.T @ s @ b).trace(), "trace B' S B")
        if least < 0 or low < least**2:
            raise scope.fail("trace B' S B >= lower^2 is not proved")
        result.append(Proved("norm", "at_least", to_text(least)))
    return result

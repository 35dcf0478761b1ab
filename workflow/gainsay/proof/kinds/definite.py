"""A symmetric matrix is definite, or semidefinite.

Theorem: F > 0 if and only if all pivots of its L D L' (or Cholesky) factorisation are positive; exact over the
rationals, in balls otherwise (Higham 2002, ch. 10; Rump 2006). The field ``constraint`` is ``F > 0``, ``F < G``, ...
"""

from gainsay.proof.inequalities import demand
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "a symmetric matrix is positive definite if and only if its Cholesky factorisation exists"
REQUIRED = ("constraint",)
OPTIONAL = ()
LEVELS = ()
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove the constraint."""
    scope.define()
    text = scope.field("constraint")
    form, relation = scope.constraint(text)
    if relation == "==":
        raise scope.fail("field 'constraint': expected an inequality")
    demand(scope, form, relation, "the constraint's difference")
    return [Proved("definite", "holds")]

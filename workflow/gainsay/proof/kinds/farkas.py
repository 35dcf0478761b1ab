"""Constraints are infeasible: multipliers under which their weighted sum cannot be positive (Farkas' lemma).

Theorem: let F_k(x) > 0 (or >= 0, or = 0) be constraints and Z_k >= 0 (any Z_k for an equation). If the sum s(x) of
<Z_k, T_k' F_k(x) T_k> is at most 0 for every x in question, and negative, or some Z_k of a strict constraint (with
T_k the identity) is not zero, then no x satisfies the constraints: s would be non-negative, or positive.
F < 0 counts as -F > 0. s is formed symbolically in the entries of the unknowns, so it must be a constant; with
``boxes`` (unknown -> printed matrix) it may be affine in entries that lie within the printed digits. T_k (field
``congruences``, a formula that may hold unknowns) allows terms like e^2 <Z, F>.

Reference: V. Balakrishnan, L. Vandenberghe, "Semidefinite programming duality and linear time-invariant systems", IEEE
Transactions on Automatic Control 48 (2003) 30-41.
"""

from gainsay.proof.duality import greatest_over_boxes, unknown_boxes, weighted_sum
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "Farkas' lemma for linear matrix inequalities"
REQUIRED = ("constraints",)
OPTIONAL = ("congruences", "boxes")
LEVELS = ()
FOUND = ()


def prove(scope: Scope, elementwise: bool = False) -> list[Proved]:
    """Prove that no point satisfies the constraints."""
    scope.bind_indeterminates()
    scope.define()
    if not scope.certificate.witness:
        raise scope.fail("no multipliers")
    total, strict = weighted_sum(scope, elementwise)
    greatest = greatest_over_boxes(scope, total, unknown_boxes(scope))
    if greatest > 0 or (greatest == 0 and not strict):
        raise scope.fail("the weighted sum of the constraints is not proved negative")
    return [Proved("feasible", "fails")]

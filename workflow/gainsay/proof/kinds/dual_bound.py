"""A bound on an objective over all feasible points, by multipliers (weak duality).

Theorem: with constraints F_k(x) > 0 and Z_k >= 0 as for `farkas`, if c(x) - v - sum <Z_k, T_k' F_k(x) T_k> >= 0 for
every x in question, then c(x) >= v at every feasible x, hence inf c >= v (``minimise``). For ``maximise``: v - c in
place of c - v, and c(x) <= v.
"""

from gainsay.exact.matrix import Matrix
from gainsay.exact.rational import to_text
from gainsay.proof.duality import greatest_over_boxes, unknown_boxes, weighted_sum
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "weak duality of semidefinite programmes"
REQUIRED = ("constraints", "bound")
OPTIONAL = ("congruences", "boxes", "minimise", "maximise")
LEVELS = ("bound",)
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove the bound on the objective."""
    scope.bind_indeterminates()
    scope.define()
    minimise = "minimise" in scope.certificate.fields
    if minimise == ("maximise" in scope.certificate.fields):
        raise scope.fail("expected one of the fields 'minimise' and 'maximise'")
    total, _ = weighted_sum(scope)
    bound = scope.number(scope.field("bound"))
    objective = scope.evaluate(scope.field("minimise" if minimise else "maximise"))
    slack = objective - Matrix.number(bound) if minimise else Matrix.number(bound) - objective
    if slack.ring == "ball":
        raise scope.fail("the objective is not exact")
    if greatest_over_boxes(scope, total - slack, unknown_boxes(scope)) > 0:
        raise scope.fail("the multipliers do not prove the bound")
    return [Proved("objective", "at_least" if minimise else "at_most", to_text(bound))]

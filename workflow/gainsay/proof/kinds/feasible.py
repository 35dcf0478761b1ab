"""Constraints are feasible: a point that satisfies all of them.

Theorem: a point that satisfies the constraints is feasible, and the value of an objective there bounds its infimum
(``minimise``) from above, its supremum (``maximise``) from below; not both, since each is a bound of ``objective``.
With ``boxes`` (unknown -> printed matrix) the point lies within half a unit of the last printed digit of every entry.
"""

from gainsay.exact.rational import to_text
from gainsay.proof.duality import box_ends, constraints
from gainsay.proof.inequalities import bounds, order_holds
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "a point that satisfies the constraints shows that they are feasible"
REQUIRED = ("constraints",)
OPTIONAL = ("minimise", "maximise", "boxes")
LEVELS = ()
FOUND = ()


def inside_boxes(scope: Scope) -> None:
    """Refuse a point that leaves the boxes of printed digits."""
    for name, printed in scope.certificate.fields.get("boxes", {}).items():
        if name not in scope.certificate.unknowns:
            raise scope.fail(f"box of {name!r}, which is not an unknown")
        low, high = box_ends(scope, printed)
        point = scope.names[name]
        if point.shape != low.shape:
            raise scope.fail(f"box of {name!r}: shapes {low.shape} and {point.shape}")
        for i, row in enumerate(point.rows()):
            for j, x in enumerate(row):
                if not low.entry(i, j) <= x <= high.entry(i, j):
                    raise scope.fail(f"{name!r} leaves the printed digits in row {i + 1}, column {j + 1}")


def objective(scope: Scope) -> list[Proved]:
    """What the point says of the objective."""
    result = []
    for name, relation in (("minimise", "at_most"), ("maximise", "at_least")):
        if name in scope.certificate.fields:
            low, high = bounds(scope, scope.evaluate(scope.field(name)), name)
            result.append(Proved("objective", relation, to_text(high if name == "minimise" else low)))
    return result


def prove(scope: Scope) -> list[Proved]:
    """Prove every constraint at the witness."""
    if {"minimise", "maximise"} <= set(scope.certificate.fields):
        raise scope.fail("expected one of the fields 'minimise' and 'maximise'")
    scope.bind_witness()
    scope.define()
    inside_boxes(scope)
    for name, text in constraints(scope):
        form, relation = scope.constraint(text)
        if not order_holds(scope, form, relation, f"constraint {name!r}"):
            raise scope.fail(f"constraint {name!r} is not proved at the witness")
    return [Proved("feasible", "holds"), *objective(scope)]

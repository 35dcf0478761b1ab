"""Linear equations and inequalities over boxes of printed digits: solvable, or not.

Every order here is entry by entry, not that of quadratic forms.

Theorem: a point within the boxes that satisfies the constraints shows that they are solvable. Multipliers (non-negative
for inequalities) under which the weighted sum of the constraints is negative over the whole box show that they are not
(Farkas' lemma).

Fields: ``constraints`` (pairs of a name and an affine constraint on the unknowns), ``boxes`` (unknown -> printed
matrix), ``answer`` ("holds" or "fails"). Witness: the unknowns for "holds", a multiplier for each constraint used for
"fails".
Reference: A. Schrijver, Theory of Linear and Integer Programming, Wiley 1986, section 7.3.
"""

from gainsay.proof.duality import constraints
from gainsay.proof.kinds import Proved, farkas, feasible
from gainsay.proof.scope import Scope

THEOREM = "Farkas' lemma for linear inequalities over a box"
REQUIRED = ("constraints", "boxes", "answer")
OPTIONAL = ()
LEVELS = ()
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove that the constraints are solvable within the boxes, or that they are not."""
    answer = scope.field("answer")
    if answer == "fails":
        return farkas.prove(scope, elementwise=True)
    if answer != "holds":
        raise scope.fail(f"answer {answer!r}: expected holds or fails")
    scope.bind_witness()
    scope.define()
    feasible.inside_boxes(scope)
    for name, text in constraints(scope):
        form, relation = scope.constraint(text)
        compare = {
            "==": lambda x: x == 0,
            ">": lambda x: x > 0,
            ">=": lambda x: x >= 0,
            "<": lambda x: x < 0,
            "<=": lambda x: x <= 0,
        }[relation]
        if not form.is_exact or not all(compare(x) for row in form.rows() for x in row):
            raise scope.fail(f"constraint {name!r} is not proved at the witness")
    return [Proved("feasible", "holds")]

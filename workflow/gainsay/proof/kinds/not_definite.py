"""A symmetric matrix is not definite: a vector on which the quadratic form has the wrong sign.

Theorem: F > 0 fails if z' F z <= 0 for some z != 0, and F >= 0 fails if z' F z < 0. The field ``constraint`` is what
fails, the witness ``z`` a column. Over a box of printed digits it fails for every matrix of the box.
"""

from gainsay.exact.definite import quadratic_form
from gainsay.exact.matrix import Matrix
from gainsay.proof.inequalities import bounds, regular_symmetric
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "a form that is not positive on some vector z != 0 is not positive definite"
REQUIRED = ("constraint",)
OPTIONAL = ()
LEVELS = ()
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Prove that the constraint fails."""
    scope.define()
    form, relation = scope.constraint(scope.field("constraint"))
    if relation == "==":
        raise scope.fail("field 'constraint': expected an inequality")
    form = regular_symmetric(scope, form, "the constraint's difference")
    z = [row[0] for row in scope.witness("z", (form.shape[0], 1)).rows()]
    if all(x == 0 for x in z):
        raise scope.fail("witness 'z' is zero")
    value = Matrix.number(quadratic_form((form if relation in (">", ">=") else -form).data, z))
    _, high = bounds(scope, value, "z' F z")
    if high > 0 or (high == 0 and relation in (">=", "<=")):
        raise scope.fail("the quadratic form is not proved to have the wrong sign on the witness 'z'")
    return [Proved("definite", "fails")]

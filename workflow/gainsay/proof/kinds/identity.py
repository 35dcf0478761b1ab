"""Two formulas are equal for every value of their indeterminates.

Theorem: polynomials with rational coefficients that are equal term by term have equal values everywhere. With the
field ``modulo`` (formulas in the indeterminates, such as ``c**2 + s**2 - 1``) they are equal wherever those vanish:
the difference leaves no remainder on division by them.
"""

from gainsay.exact.matrix import POLYNOMIAL, Matrix
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "polynomials with rational coefficients that are equal term by term are equal everywhere"
REQUIRED = ("left", "right")
OPTIONAL = ("modulo",)
LEVELS = ()
FOUND = ()


def difference(scope: Scope) -> Matrix:
    """Left minus right, reduced by the relations among the indeterminates."""
    scope.bind_indeterminates()
    scope.define()
    value = scope.evaluate(scope.field("left")) - scope.evaluate(scope.field("right"))
    relations = [scope.evaluate(text) for text in scope.certificate.fields.get("modulo", [])]
    if value.ring != POLYNOMIAL:
        return value
    for relation in relations:
        if relation.ring != POLYNOMIAL or not relation.is_number or relation.entry(0, 0) == 0:
            raise scope.fail("field 'modulo': expected formulas in the indeterminates that are numbers and not zero")
        value = Matrix([[divmod(x, relation.entry(0, 0))[1] for x in row] for row in value.rows()])
    return value


def prove(scope: Scope) -> list[Proved]:
    """Prove the identity."""
    value = difference(scope)
    if value.ring == "ball":
        raise scope.fail("left and right are not exact: an identity cannot be proved in balls")
    for i, row in enumerate(value.rows()):
        for j, x in enumerate(row):
            if x != 0:
                raise scope.fail(f"left and right differ in row {i + 1}, column {j + 1}")
    return [Proved("identity", "holds")]

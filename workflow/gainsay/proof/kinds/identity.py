"""Two formulas are equal for every value of their indeterminates.

Theorem: polynomials with rational coefficients that are equal term by term have equal values everywhere. With the
field ``modulo`` (formulas in the indeterminates, such as ``c**2 + s**2 - 1``) their difference is a combination of
these, the remainder on division by them being zero: so they are equal wherever the relations vanish (and, for a
relation ``e**2``, to first order in e). The relations must vanish somewhere, or this would be said of no point: the
witness gives every unknown its value at one such point, exact.
"""

from flint import fmpq_mpoly

from gainsay.exact.budget import spend
from gainsay.exact.matrix import POLYNOMIAL, Matrix
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "polynomials with rational coefficients that are equal term by term are equal everywhere"
REQUIRED = ("left", "right")
OPTIONAL = ("modulo",)
LEVELS = ()
FOUND = ()


def relations(scope: Scope) -> list[str]:
    """Formulas of the relations among the indeterminates."""
    texts = scope.certificate.fields.get("modulo", [])
    if not isinstance(texts, list) or any(not isinstance(t, str) for t in texts):
        raise scope.fail("field 'modulo': expected a list of formulas")
    return texts


def meet_somewhere(scope: Scope) -> None:
    """Refuse relations that do not all vanish at the point of the witness."""
    texts = relations(scope)
    if not texts:
        return
    point = Scope(scope.certificate, scope.reader.tables)
    point.bind_witness()
    point.define()
    for text in texts:
        value = point.evaluate(text)
        if not value.is_number or not value.is_exact or value.value() != 0:
            raise scope.fail(
                f"the relation {text!r} does not vanish at the witness: the identity may speak of no point"
            )


def reduced(entry: fmpq_mpoly, relation: fmpq_mpoly) -> fmpq_mpoly:
    """Remainder on division: every term that the relation's leading one divides is replaced, until none is left."""
    leading, coefficient = relation.monoms()[0], relation.leading_coefficient()
    context = entry.context()
    while True:
        terms = {
            tuple(p - q for p, q in zip(powers, leading, strict=True)): value / coefficient
            for powers, value in entry.to_dict().items()
            if all(p >= q for p, q in zip(powers, leading, strict=True))
        }
        if not terms:
            return entry
        spend((len(terms) * len(relation) + len(entry)) * (100 + len(leading)), "a division of polynomials")
        entry = Matrix([[entry - context.from_dict(terms) * relation]]).entry(0, 0)


def difference(scope: Scope) -> Matrix:
    """Left minus right, reduced by the relations among the indeterminates."""
    scope.bind_indeterminates()
    scope.define()
    value = scope.evaluate(scope.field("left")) - scope.evaluate(scope.field("right"))
    matrices = [scope.evaluate(text) for text in relations(scope)]
    if value.ring != POLYNOMIAL:
        return value
    for relation in matrices:
        if relation.ring != POLYNOMIAL or not relation.is_number or relation.entry(0, 0) == 0:
            raise scope.fail("field 'modulo': expected formulas in the indeterminates that are numbers and not zero")
        value = Matrix([[reduced(x, relation.entry(0, 0)) for x in row] for row in value.rows()])
    return value


def prove(scope: Scope) -> list[Proved]:
    """Prove the identity."""
    value = difference(scope)
    meet_somewhere(scope)
    if value.ring == "ball":
        raise scope.fail("left and right are not exact: an identity cannot be proved in balls")
    for i, row in enumerate(value.rows()):
        for j, x in enumerate(row):
            if x != 0:
                raise scope.fail(f"left and right differ in row {i + 1}, column {j + 1}")
    return [Proved("identity", "holds")]

"""A number given by a closed formula lies in an interval.

Theorem: the formula evaluated in balls (or exactly) encloses its value; with ``box`` and ``interval`` its value for
every datum in them.

Fields: ``formula``, and ``low`` or ``high`` or both (or none: the enclosure found is what is proved). No witness.
"""

from gainsay.exact.ball import decimal_above, decimal_below
from gainsay.exact.rational import to_text
from gainsay.proof.inequalities import bounds
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "interval arithmetic encloses the value"
REQUIRED = ("formula",)
OPTIONAL = ("low", "high")
LEVELS = ("low", "high")
FOUND = ()


def prove(scope: Scope) -> list[Proved]:
    """Enclose the value."""
    scope.define()
    low, high = bounds(scope, scope.evaluate(scope.field("formula")), "the formula")
    fields = scope.certificate.fields
    result = []
    if "low" in fields:
        least = scope.number(scope.field("low"))
        if low < least:
            raise scope.fail(f"the formula is not proved to be at least {to_text(least)}")
        result.append(Proved("value", "greater_than" if low > least else "at_least", to_text(least)))
    if "high" in fields:
        most = scope.number(scope.field("high"))
        if high > most:
            raise scope.fail(f"the formula is not proved to be at most {to_text(most)}")
        result.append(Proved("value", "less_than" if high < most else "at_most", to_text(most)))
    if low != high:
        low, high = decimal_below(low, 25), decimal_above(high, 25)
    return [*result, Proved("value", "inside", f"{to_text(low)}..{to_text(high)}")]

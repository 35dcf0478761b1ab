"""What turns a claim: a case with other numbers, and values held against every claim on a quantity."""

from dataclasses import replace
from types import MappingProxyType

from gainsay.scans.criterion import NUMERIC, criteria
from gainsay.tables import Case


def changed(case: Case, **values: str) -> Case:
    """The case with other values of numbers."""
    rows = dict(case.parameters)
    for name, value in values.items():
        rows[name] = rows[name].model_copy(update={"value": value})
    return replace(case, parameters=MappingProxyType(rows))


def turns(case: Case, quantity: str, values: list[float]) -> None:
    """Hold values against every claim on a quantity: some must be met, and some not."""
    asked = [c for c in case.claims.values() if c.quantity == quantity and c.comparator in NUMERIC]
    assert asked, quantity
    for claim in asked:
        strict, lenient = criteria(claim)[0], criteria(claim)[-1]
        assert any(lenient.holds(value) for value in values), claim.id
        assert not all(strict.holds(value) for value in values), claim.id

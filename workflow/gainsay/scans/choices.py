"""A quantity over the readings of one choice that a paper leaves open."""

from collections.abc import Mapping
from typing import Any

from gainsay.results import Results
from gainsay.scans.ranges import plausible
from gainsay.scans.sampling import Scan, scan


def over_choice(
    case: Any, results: Results, quantity: str, choice: str, values: Mapping[str, float], *, method: str, source: str
) -> Scan:
    """Write a quantity at every reading of a choice, and at the one that the tables assume.

    Parameters
    ----------
    case : gainsay.tables.Case
    results : Results
    quantity : str
    choice : str
        A parameter with the status ``assumed`` and readings such as ``reduced|full``.
    values : mapping of str to float
        The quantity by reading.
    method, source : str
        As for `Results.quantity`.

    Raises
    ------
    KeyError
        If a reading has no value.
    """
    outcome = scan(case, quantity, [plausible(case, choice)], lambda reading: float(values[reading[choice]]))
    results.scan(outcome)
    results.quantity(quantity, float(values[case.choice(choice)]), method=method, source=source)
    return outcome

"""Errata as the results have them: those of a statement with the texts that follow from its edition."""

from collections.abc import Iterator
from dataclasses import replace

from gainsay.errors import InputError
from gainsay.results.returned import read_returned
from gainsay.tables import Case
from gainsay.tables.files import Table
from gainsay.tables.models import Erratum

ERRATA_COLUMNS = tuple(Erratum.model_fields)


def errata_table(case: Case) -> Table:
    """Return the errata of a case as the table ``errata.csv`` of its results."""
    return ERRATA_COLUMNS, [list(map(str, row.model_dump().values())) for row in case.errata.values()]


def _texts(case: Case) -> dict[str, tuple[str, str]]:
    """Return what the results say is printed, and should stand there, by id; nothing where they cannot be read."""
    try:
        rows = read_returned(case.results / "errata.csv", case.root, ERRATA_COLUMNS)
    except InputError:
        return {}
    return {row["id"]: (row["printed"], row["corrected"]) for row in rows}


def unsaid(case: Case) -> Iterator[Erratum]:
    """Yield the errata of statements whose texts do not stand in the results."""
    texts = _texts(case)
    for id, row in case.errata.items():
        if row.edition and not all(texts.get(id, ("",))):
            yield row


def with_results(case: Case) -> Case:
    """Return the case with the texts of all errata as the results have them, else with the name of the edition."""
    texts, filled = _texts(case), dict(case.errata)
    for id, row in case.errata.items():
        if row.edition:
            printed, corrected = texts.get(id, ("", ""))
            filled[id] = row.model_copy(update={"printed": printed or row.edition, "corrected": corrected})
    return replace(case, errata=filled)

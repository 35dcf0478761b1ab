"""The tables of all papers in one."""

from collections.abc import Sequence

from gainsay.errors import InputError
from gainsay.results.returned import VERDICT_COLUMNS, read_returned
from gainsay.tables import Case
from gainsay.tables.files import Table
from gainsay.verdicts.differences import DIFFERENCE_COLUMNS
from gainsay.verdicts.published import PUBLISHED_COLUMNS

#: joined over the papers: table -> columns, the paper's name first
JOINED = {
    "verdicts": ("paper", *VERDICT_COLUMNS),
    "published": PUBLISHED_COLUMNS,
    "differences": DIFFERENCE_COLUMNS,
}


def _rows(case: Case, table: str, columns: Sequence[str]) -> list[dict[str, str]]:
    """Rows of a paper's table; none where it is missing or damaged, which the page says."""
    own = [column for column in columns if table != "verdicts" or column != "paper"]
    try:
        return read_returned(case.results / f"{table}.csv", case.root, own)
    except InputError:
        return []


def joined(cases: Sequence[Case]) -> dict[str, Table]:
    """Return the tables over some papers by the name of their file."""
    return {
        table: (
            columns,
            [
                [case.name if column == "paper" else row[column] for column in columns]
                for case in cases
                for row in _rows(case, table, columns)
            ],
        )
        for table, columns in JOINED.items()
    }

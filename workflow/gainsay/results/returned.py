"""Results read back: whatever a file was made to hold, a table as a step writes it, or one typed error.

A step trusts no file that another step left, since files are copied, edited and damaged between steps. Numbers are
checked where they are read, so that nobody who uses them has to.
"""

from collections.abc import Callable, Sequence
from pathlib import Path, PurePosixPath

from gainsay.errors import InputError
from gainsay.exact.digits import PrintedNumber, double
from gainsay.results.listing import LISTING_COLUMNS
from gainsay.tables.case import Case
from gainsay.tables.files import is_there, read_csv, short_path

QUANTITY_COLUMNS = ("quantity", "value", "unit", "lower", "upper", "method", "source")
GAIN_COLUMNS = (
    "gain",
    "row",
    "column",
    "published",
    "rounding_low",
    "rounding_high",
    "resynthesised",
    "identified",
    "range_low",
    "range_high",
)
POLE_COLUMNS = ("set", "pole", "part", "published", "rounding_low", "rounding_high", "recomputed", "radius")
READ_COLUMNS = ("quantity", "parameter", "how")
FAILURE_COLUMNS = ("step", "where", "task", "message")
#: the tables of a step's results that are joined over all steps of a paper
PARTS = {
    "quantities": QUANTITY_COLUMNS,
    "gains": GAIN_COLUMNS,
    "poles": POLE_COLUMNS,
    "reads": READ_COLUMNS,
    "failures": FAILURE_COLUMNS,
}
#: what the method of a quantity begins with of which neither side could be proved; its value is nan
UNDECIDED = "undecided:"
#: what the method of a quantity begins with whose enclosure carries the rounding of what the paper prints
FROM_DIGITS = "printed digits:"
#: steps that keep records, in the order of the workflow
STEPS = ("synthesis", "audit", "simulation", "figures", "views")
CERTIFICATE_COLUMNS = ("certificate", "accepted", "says")
VERDICT_COLUMNS = (
    "claim",
    "where",
    "kind",
    "statement",
    "published",
    "recomputed",
    "unit",
    "tolerance",
    "verdict",
    "expected",
    "evidence",
    "range_low",
    "range_high",
    "witness",
    "quantity",
    "certificate",
    "note",
    "given",
    "weight",
    "digits",
    "holds_for",
    "sentence",
    "as_read",
    "of_sentence",
)


def _number(text: str) -> None:
    double(text)


def _number_or_nothing(text: str) -> None:
    if text:
        double(text)


def _printed(text: str) -> None:
    PrintedNumber(text)


def _truth_or_nothing(text: str) -> None:
    if text not in ("", "0", "1"):
        raise InputError(expected="1, 0 or nothing")


def _truth(text: str) -> None:
    if text not in ("0", "1"):
        raise InputError(expected="1 or 0")


def _place(text: str) -> None:
    """Below the results, never beside them: files of a list are removed when their step begins again."""
    path = PurePosixPath(text)
    if not text or path.is_absolute() or ".." in path.parts or "\0" in text:
        raise InputError(expected="a file below the results")


#: table -> column -> what its cells must be; other columns hold text
CHECKS: dict[str, dict[str, Callable[[str], None]]] = {
    "quantities": {"value": _number, "lower": _number_or_nothing, "upper": _number_or_nothing},
    "gains": {
        "published": _printed,
        "rounding_low": _number,
        "rounding_high": _number,
        "resynthesised": _number_or_nothing,
        "identified": _truth_or_nothing,
        "range_low": _number_or_nothing,
        "range_high": _number_or_nothing,
    },
    "poles": {
        "published": _printed,
        "rounding_low": _number,
        "rounding_high": _number,
        "recomputed": _number,
        "radius": _number,
    },
    "verdicts": dict.fromkeys(("recomputed", "tolerance", "range_low", "range_high"), _number_or_nothing),
    "published": dict.fromkeys(("recomputed", "low", "high", "units_of_last_digit"), _number_or_nothing),
    "certificates": {"accepted": _truth},
    "files": {"file": _place},
}
#: table -> the columns that a step writes
COLUMNS = {**PARTS, "certificates": CERTIFICATE_COLUMNS, "verdicts": VERDICT_COLUMNS, "files": LISTING_COLUMNS}
#: table -> the column by which a row is known, each value once
KEYS = {"quantities": "quantity", "verdicts": "claim", "certificates": "certificate", "files": "file"}


def read_returned(path: Path, root: Path, columns: Sequence[str] = ()) -> list[dict[str, str]]:
    """Read a table of results.

    Parameters
    ----------
    path : Path
        Its name says which: ``quantities.csv``, ``audit.quantities.csv``.
    root : Path
        Project root, for errors.
    columns : sequence of str, optional
        Those that a step writes, where `COLUMNS` does not say.

    Raises
    ------
    InputError
        If it is missing or not as a step writes it, naming file, row, column and value.
    """
    file, table = short_path(path, root), path.name.split(".")[-2]
    columns = columns or COLUMNS[table]
    header, lines = read_csv(path, root)
    if header != list(columns):
        raise InputError("header", file=file, row=1, value=",".join(header), expected=",".join(columns))
    checks, key, seen = CHECKS.get(table, {}), KEYS.get(table), set()
    rows = []
    for number, cells in lines:
        row = dict(zip(columns, cells, strict=True))
        for column, check in checks.items():
            try:
                check(row[column])
            except InputError as error:
                raise InputError(
                    file=file, row=number, field=column, value=row[column], expected=error.expected
                ) from None
        if key is not None:
            if row[key] in seen:
                raise InputError(file=file, row=number, field=key, value=row[key], expected="a name not used above")
            seen.add(row[key])
        rows.append(row)
    return rows


def read_part(case: Case, part: str) -> list[dict[str, str]]:
    """Read one of `PARTS` or the files, joined over the steps in their order; steps not run yet are passed over.

    Raises
    ------
    InputError
        If a table is not as a step writes it, or two steps found the same quantity.
    """
    rows: list[dict[str, str]] = []
    for step in STEPS:
        path = case.results / "parts" / f"{step}.{part}.csv"
        if is_there(path, case.root):
            rows += read_returned(path, case.root)
    return rows

"""What differs between two folders of results, of two machines, versions or days."""

from collections.abc import Iterator
from pathlib import Path

from gainsay.errors import InputError
from gainsay.tables.files import read_records

#: table of a paper -> the column that names a row, and those that are held against each other
COMPARED = {
    "verdicts": ("claim", ("verdict", "recomputed", "range_low", "range_high")),
    "quantities": ("quantity", ("value", "lower", "upper")),
    "certificates": ("certificate", ("accepted",)),
    "failures": ("where", ("message",)),
}


def _papers(folder: Path) -> set[str]:
    names = {path.parent.name for path in folder.glob("*/quantities.csv")}
    if not names:
        raise InputError("results", value=str(folder), expected="a folder with <paper>/quantities.csv")
    return names


def _by_name(path: Path, column: str) -> dict[str, dict[str, str]]:
    """Rows of a table by the column that names them; none where there is no such table."""
    rows = read_records(path) if path.is_file() else []
    if rows and column not in rows[0]:
        raise InputError("no such column", file=str(path), row=1, value=column, expected="a table of results")
    return {row[column]: row for row in rows}


def _apart(one: str, other: str) -> str:
    """Say how far two texts are apart, relative to the larger, where both are numbers."""
    try:
        a, b = float(one), float(other)
    except ValueError:
        return ""
    size = max(abs(a), abs(b))
    return f" ({abs(a - b) / size:.1e} relative)" if size else ""


def between(one: Path, other: Path) -> Iterator[str]:
    """Yield a line for everything in which two folders of results differ.

    Parameters
    ----------
    one, other : Path
        Such as ``results``; only papers that both hold are compared in full.

    Raises
    ------
    InputError
        If a folder holds no results.
    """
    first, second = _papers(one), _papers(other)
    for paper in sorted(first ^ second):
        yield f"{paper}: only in {one if paper in first else other}"
    for paper in sorted(first & second):
        for table, (key, columns) in COMPARED.items():
            rows = [_by_name(folder / paper / f"{table}.csv", key) for folder in (one, other)]
            for name in dict.fromkeys([*rows[0], *rows[1]]):
                if name not in rows[0] or name not in rows[1]:
                    yield f"{paper}  {table} {name}: only in {one if name in rows[0] else other}"
                    continue
                for column in columns:
                    a, b = (entries[name].get(column, "") for entries in rows)
                    if a != b:
                        yield f"{paper}  {table} {name}: {column} {a or 'nothing'} | {b or 'nothing'}{_apart(a, b)}"

"""The papers of a project, and the tables of one read whole."""

import keyword
import re
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from gainsay.errors import InputError, one_of
from gainsay.exact.digits import PrintedNumber
from gainsay.tables.case import Case, Named
from gainsay.tables.designs import read_designs
from gainsay.tables.files import listed, real_path, short_path
from gainsay.tables.lint import lint
from gainsay.tables.models import (
    Campaign,
    Claim,
    Erratum,
    NotChecked,
    Parameter,
    Quantity,
    Recorded,
    RecordedCertificate,
    RecordedPublished,
    RecordedRead,
    RecordedScan,
    Reply,
)
from gainsay.tables.reading import AnyRow, PrintedMatrix, read_matrix, read_paper_file, read_rows

_NAME = re.compile(r"[a-z][a-z0-9_]*", re.ASCII)
_LONGEST_NAME = 60
#: names of the workflow's own targets
_RESERVED = ("all", "campaigns", "check", "report")
_MATRIX = re.compile(r"(?P<file>printed/[A-Za-z0-9_]+\.csv) (?P<rows>[1-9]\d{0,3})x(?P<columns>[1-9]\d{0,3})", re.ASCII)


def find_root(start: Path | None = None) -> Path:
    """Return the project root at or above a folder.

    Raises
    ------
    InputError
        Outside a project.
    """
    start = real_path(start or Path.cwd())
    for folder in (start, *start.parents):
        if (folder / "papers").is_dir() and (folder / "Snakefile").is_file():
            return folder
    raise InputError("not inside a project", value=str(start), expected="a folder with Snakefile and papers/ above it")


def checked_name(name: str) -> str:
    """Return the name of a paper's folder if it may be one: it becomes a module, a rule and part of a command.

    Raises
    ------
    InputError
        If it is anything but lower-case letters, digits and underscores, beginning with a letter, or has another
        meaning for the workflow or for Python.
    """
    if _NAME.fullmatch(name) is None or len(name) > _LONGEST_NAME:
        expected = f"up to {_LONGEST_NAME} lower-case letters, digits and underscores, a letter first"
        raise InputError("name of a paper", value=name[:_LONGEST_NAME], expected=expected)
    if name in _RESERVED:
        raise InputError("name of a paper", value=name, expected="a name that is not a target of the workflow")
    if keyword.iskeyword(name):
        raise InputError("name of a paper", value=name, expected="no keyword of Python, since it names a module")
    return name


def paper_names(root: Path) -> list[str]:
    """Return the names of all papers: the folders of `papers` that hold a `paper.toml`.

    Raises
    ------
    InputError
        If a folder has a name that no paper may have, holds tables and no ``paper.toml``, or cannot be read.
    """
    inside = {folder: listed(folder, root) for folder in listed(root / "papers", root)}
    folders = [folder for folder, paths in inside.items() if any(path.suffix in (".csv", ".toml") for path in paths)]
    for folder in folders:
        checked_name(folder.name)
        if not (folder / "paper.toml").is_file():
            raise InputError("file not found", file=f"papers/{folder.name}/paper.toml", expected="a readable file")
    return [folder.name for folder in folders]


def _by(rows: Mapping[int, AnyRow], key: str | tuple[str, ...], file: str) -> Mapping[Any, AnyRow]:
    by_name: dict[Any, AnyRow] = {}
    for number, row in rows.items():
        name = getattr(row, key) if isinstance(key, str) else tuple(getattr(row, part) for part in key)
        if name in by_name:
            raise InputError(file=file, row=number, field=str(key), value=name, expected="a name not used above")
        by_name[name] = row
    return MappingProxyType(by_name)


def _check_parameter(row: Parameter, file: str, number: int) -> None:
    def refuse(column: str, value: str, expected: str) -> None:
        raise InputError(file=file, row=number, field=column, value=value, expected=expected)

    if row.type == "number":
        try:
            PrintedNumber(row.value)
        except InputError as error:
            refuse("value", row.value, error.expected)
    elif row.unit != "1" and row.type != "matrix":
        refuse("unit", row.unit, "1, since only numbers and matrices have units")
    if row.status in ("assumed", "method") and not row.plausible:
        refuse("plausible", row.plausible, "the plausible values of what the paper leaves out")
    if row.status not in ("assumed", "method") and row.plausible:
        refuse("plausible", row.plausible, "nothing, since the paper gives the value")
    if row.plausible and row.type == "number":
        low, dots, high = row.plausible.partition("..")
        try:
            ends = [PrintedNumber(part).value for part in ([low, high] if dots else row.plausible.split("|"))]
        except InputError:
            refuse("plausible", row.plausible, "`low..high` or `a|b|c` of decimal numbers")
        value = PrintedNumber(row.value).value
        if not (ends[0] <= value <= ends[1] if dots else value in ends):
            refuse("plausible", row.plausible, f"a {'range' if dots else 'list'} that contains the value {row.value}")
    if row.digits and row.status != "printed":
        refuse("digits", row.digits, "nothing, since the digits are ours")
    if row.plausible and row.type == "choice" and row.value not in row.plausible.split("|"):
        refuse("value", row.value, f"one of {row.plausible}")


def _read_parameters(root: Path, folder: Path) -> tuple[Mapping[str, Parameter], dict[str, PrintedMatrix]]:
    path = folder / "parameters.csv"
    file = short_path(path, root)
    rows = read_rows(path, Parameter, root)
    matrices = {}
    for number, row in rows.items():
        _check_parameter(row, file, number)
        if row.type != "matrix":
            continue
        named = _MATRIX.fullmatch(row.value)
        if named is None:
            raise InputError(
                file=file, row=number, field="value", value=row.value, expected="file and shape: printed/L.csv 6x3"
            )
        matrix = read_matrix(folder / named["file"], root)
        shape = int(named["rows"]), int(named["columns"])
        if matrix.shape != shape:
            raise InputError(
                file=short_path(folder / named["file"], root),
                field="shape",
                value="{}x{}".format(*matrix.shape),
                expected="{}x{}".format(*shape),
            )
        matrices[row.name] = matrix
    return _by(rows, "name", file), matrices


def read_case(root: Path, paper: str) -> Case:
    """Read and validate all tables of a paper.

    Raises
    ------
    InputError
        At the first fault, naming file, row, field, value and what was expected.
    """
    if checked_name(paper) not in paper_names(root):
        known = paper_names(root)
        expected = one_of(paper, known) if known else "a folder of papers/ with a paper.toml"
        raise InputError("unknown paper", value=paper, expected=expected)
    folder = root / "papers" / paper
    parameters, matrices = _read_parameters(root, folder)

    def table(
        file: str, model: type[AnyRow], key: str | tuple[str, ...], required: bool = True
    ) -> Mapping[Any, AnyRow]:
        return _by(read_rows(folder / file, model, root, required=required), key, f"papers/{paper}/{file}")

    paper_file = read_paper_file(folder / "paper.toml", root)
    case = Case(
        name=paper,
        root=root,
        paper=paper_file,
        parameters=parameters,
        quantities=table("quantities.csv", Quantity, "id"),
        claims=Named("claim", table("claims.csv", Claim, "id")),
        errata=table("errata.csv", Erratum, "id", required=False),
        not_checked=tuple(read_rows(folder / "not_checked.csv", NotChecked, root).values()),
        replies=tuple(read_rows(folder / "replies.csv", Reply, root, required=False).values()),
        recorded=table("recorded.csv", Recorded, "quantity", required=False),
        recorded_scans=table("recorded_scans.csv", RecordedScan, ("claim", "item"), required=False),
        recorded_reads=table("recorded_reads.csv", RecordedRead, ("quantity", "parameter"), required=False),
        recorded_certificates=table("recorded_certificates.csv", RecordedCertificate, "certificate", required=False),
        recorded_published=table("recorded_published.csv", RecordedPublished, ("what", "entry"), required=False),
        designs=Named("design", read_designs(folder, paper_file.designs, root)),
        campaigns=table("campaigns.csv", Campaign, "name", required=False),
        _matrices=MappingProxyType(matrices),
    )
    lint(case)
    return case

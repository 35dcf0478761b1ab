"""Typed reading of the tables of a paper's folder."""

import tomllib
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import TypeVar

import numpy as np
from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from gainsay.errors import InputError
from gainsay.exact.digits import PrintedNumber
from gainsay.tables.files import is_there, read_csv, read_text, short_path
from gainsay.tables.models import PaperFile, Row, columns, optional

AnyRow = TypeVar("AnyRow", bound=Row)


def expectation(model: type[BaseModel], detail: ErrorDetails) -> tuple[str, object, str]:
    """Return field, value found and what was expected, of one error that pydantic found in a model."""
    field = ".".join(str(part) for part in detail["loc"])
    message = detail["msg"].removeprefix("Value error, ")
    if detail["type"] == "extra_forbidden":
        return field, None, f"one of {', '.join(model.model_fields)}"
    if detail["type"] == "missing":
        return field, None, "a value, the field is missing"
    return field, detail["input"], message.removeprefix("Input should be ").replace("String should", "text that should")


def read_rows(path: Path, model: type[AnyRow], root: Path | None = None, *, required: bool = True) -> dict[int, AnyRow]:
    """Read a table whose columns are the fields of a model; one that may be missing has no rows then.

    Columns that may be empty in every row may be left out, all others stand in the order of the model.

    Returns
    -------
    dict
        Line number -> row.

    Raises
    ------
    InputError
        At the first fault, naming file, row, field, value and what was expected.
    """
    file = short_path(path, root)
    if not required and not is_there(path, root):
        return {}
    header, rows = read_csv(path, root)
    wanted = [column for column in columns(model) if column in header or column not in optional(model)]
    if header != wanted:
        raise InputError("header", file=file, row=1, value=",".join(header), expected=",".join(columns(model)))
    typed = {}
    for number, cells in rows:
        try:
            typed[number] = model.model_validate(dict(zip(wanted, cells, strict=True)))
        except ValidationError as error:
            field, value, expected = expectation(model, error.errors()[0])
            raise InputError(file=file, row=number, field=field, value=value, expected=expected) from None
    return typed


def read_paper_file(path: Path, root: Path | None = None) -> PaperFile:
    """Read `paper.toml`.

    Raises
    ------
    InputError
        If it is missing, no TOML, or lacks a key.
    """
    file = short_path(path, root)
    try:
        return PaperFile.model_validate(tomllib.loads(read_text(path, root)))
    except ValidationError as error:
        field, value, expected = expectation(PaperFile, error.errors()[0])
        raise InputError(file=file, field=field, value=value, expected=expected) from None
    except (ValueError, RecursionError) as error:  # also of numbers too long to convert and brackets without end
        if isinstance(error, InputError):
            raise
        raise InputError(str(error), file=file, expected="well-formed TOML") from None


@dataclass(frozen=True)
class PrintedMatrix:
    """A matrix digit for digit as printed.

    Attributes
    ----------
    rows : tuple of tuple of PrintedNumber
    """

    rows: tuple[tuple[PrintedNumber, ...], ...]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.rows), len(self.rows[0])

    def _each(self, attribute: str) -> tuple[tuple[Fraction, ...], ...]:
        return tuple(tuple(getattr(entry, attribute) for entry in row) for row in self.rows)

    @cached_property
    def exact(self) -> tuple[tuple[Fraction, ...], ...]:
        """The printed digits as rationals."""
        return self._each("value")

    @cached_property
    def half_units(self) -> tuple[tuple[Fraction, ...], ...]:
        """Half a unit of the last printed digit of every entry."""
        return self._each("half_unit")

    @cached_property
    def low(self) -> tuple[tuple[Fraction, ...], ...]:
        """Smallest matrix that rounds to these digits."""
        return self._each("low")

    @cached_property
    def high(self) -> tuple[tuple[Fraction, ...], ...]:
        """Largest matrix that rounds to these digits."""
        return self._each("high")

    @cached_property
    def floats(self) -> np.ndarray:
        """The nearest doubles, read-only."""
        array = np.array([[float(entry) for entry in row] for row in self.rows])
        array.flags.writeable = False
        return array


def read_matrix(path: Path, root: Path | None = None) -> PrintedMatrix:
    """Read a printed matrix: one row a line, exact decimals, no header.

    Raises
    ------
    InputError
        If the file is missing, ragged, or holds anything but decimal numbers.
    """
    file = short_path(path, root)
    header, rows = read_csv(path, root)
    lines = [(1, header), *rows]
    matrix = []
    for number, cells in lines:
        entries = []
        for column, text in enumerate(cells, start=1):
            try:
                entries.append(PrintedNumber(text))
            except InputError as error:
                raise InputError(
                    file=file, row=number, field=f"column {column}", value=text, expected=error.expected
                ) from None
        matrix.append(tuple(entries))
    return PrintedMatrix(tuple(matrix))

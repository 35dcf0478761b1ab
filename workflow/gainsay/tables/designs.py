"""Designs: gains that a search found, committed beside the paper's tables and read like a printed matrix.

A run finds no design. `gainsay search` does, and writes ``papers/<paper>/designs/<name>.json``; a run reads it,
certifies it and audits it, so that what a search depends on (a processor, a thread, a library) is no part of a result.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from gainsay.errors import InputError
from gainsay.exact.digits import PrintedNumber
from gainsay.tables.files import is_there, listed, read_json, short_path, write_json
from gainsay.tables.models import Decimal, Filled, Name
from gainsay.tables.reading import PrintedMatrix, expectation


class DesignFile(BaseModel):
    """``designs/<name>.json``: a design with what was asked of the search and how it went."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    asked: Filled = Field(description="what was asked of the search, one sentence")
    method: Filled = Field(description="how the design was found, one sentence")
    seed: int | None = Field(description="seed of the random numbers that the search drew; null where it drew none")
    effort: dict[str, int] = Field(description="what the search cost, such as iterations and evaluations")
    converged: bool = Field(description="whether the search met its own stopping criterion")
    outcome: dict[str, Decimal] = Field(description="what the search measured at its end; a run measures it again")
    matrices: dict[Name, list[list[Decimal]]] = Field(min_length=1, description="the gains, exact decimals")


@dataclass(frozen=True)
class Design(Mapping[str, np.ndarray]):
    """The gains of a design: a mapping of entry names to the nearest doubles, read-only.

    Attributes
    ----------
    name : str
        As in ``paper.toml``.
    file : DesignFile
        What was asked, how it was found and how the search went.
    matrices : mapping of str to PrintedMatrix
        The gains digit for digit; certificates speak of these.
    """

    name: str
    file: DesignFile
    matrices: Mapping[str, PrintedMatrix]

    def __getitem__(self, entry: str) -> np.ndarray:
        if entry not in self.matrices:
            raise InputError(
                file=f"designs/{self.name}.json", field="matrices", value=entry, expected=f"one of {', '.join(self)}"
            )
        return self.matrices[entry].floats

    def __iter__(self) -> Iterator[str]:
        return iter(self.matrices)

    def __len__(self) -> int:
        return len(self.matrices)

    def exact(self, entry: str) -> tuple[tuple[Fraction, ...], ...]:
        """Return a matrix as the rationals that its decimals stand for.

        Raises
        ------
        InputError
            If the design has no such matrix.
        """
        self[entry]
        return self.matrices[entry].exact


@dataclass(frozen=True)
class FoundDesign:
    """What a search returns; `write_design` puts it into the paper's folder.

    Attributes
    ----------
    asked, method : str
        One sentence each.
    matrices : mapping of str to ndarray
        Finite gains of shape (m, n).
    converged : bool
        Whether the search met its own stopping criterion.
    outcome : mapping of str to float
        What was measured of the gains after rounding to `digits`.
    effort : mapping of str to int
    seed : int, optional
    digits : int
        Significant digits kept of every gain; the outcome is to be measured after this rounding (`rounded`).
    """

    asked: str
    method: str
    matrices: Mapping[str, np.ndarray]
    converged: bool
    outcome: Mapping[str, float]
    effort: Mapping[str, int] = field(default_factory=dict)
    seed: int | None = None
    digits: int = 12


def _text(value: float, digits: int) -> str:
    return f"{float(value):.{digits}g}"


def rounded(matrix: np.ndarray, digits: int = 12) -> np.ndarray:
    """Return a matrix with every entry rounded to so many significant decimal digits.

    Examples
    --------
    >>> rounded(np.array([[0.123456]]), 3)
    array([[0.123]])
    """
    return np.vectorize(lambda value: float(_text(value, digits)), otypes=[float])(np.asarray(matrix, dtype=float))


def design_path(folder: Path, name: str) -> Path:
    """Return the file of a design of the paper in `folder`."""
    return folder / "designs" / f"{name}.json"


def write_design(folder: Path, name: str, design: FoundDesign) -> Path:
    """Write a design that a search found and return its path.

    Raises
    ------
    InputError
        If a gain or an outcome is not finite.
    """
    path = design_path(folder, name)
    numbers = [*(float(x) for matrix in design.matrices.values() for x in np.ravel(matrix)), *design.outcome.values()]
    if not all(math.isfinite(number) for number in numbers):
        raise InputError("design", file=path.name, value="an entry that is not finite", expected="finite gains")
    content = {
        "asked": design.asked,
        "method": design.method,
        "seed": design.seed,
        "effort": dict(design.effort),
        "converged": design.converged,
        "outcome": {key: _text(value, 12) for key, value in design.outcome.items()},
        "matrices": {
            key: [[_text(x, design.digits) for x in row] for row in np.atleast_2d(matrix)]
            for key, matrix in design.matrices.items()
        },
    }
    write_json(path, content)
    return path


def read_design(path: Path, root: Path | None = None) -> Design:
    """Read a design.

    Raises
    ------
    InputError
        If the file is missing or malformed, or holds anything but finite decimal numbers.
    """
    file = short_path(path, root)
    try:
        content = DesignFile.model_validate(read_json(path, root))
    except ValidationError as error:
        field_, value, expected = expectation(DesignFile, error.errors()[0])
        raise InputError(file=file, field=field_, value=value, expected=expected) from None
    matrices = {}
    for name, rows in content.matrices.items():
        widths = {len(row) for row in rows}
        if len(widths) != 1 or widths == {0}:
            raise InputError(file=file, field=name, value=sorted(widths), expected="rows of one length")
        matrices[name] = PrintedMatrix(tuple(tuple(PrintedNumber(x) for x in row) for row in rows))
    return Design(path.stem, content, matrices)


def read_designs(folder: Path, declared: Mapping[str, str], root: Path | None = None) -> dict[str, Design]:
    """Read every design of a paper, in the order of ``paper.toml``.

    Raises
    ------
    InputError
        If a file is malformed, or there is one that ``paper.toml`` does not name.
    """
    for path in listed(folder / "designs", root):
        if path.suffix == ".json" and path.stem not in declared:
            raise InputError("design", file=short_path(path, root), expected="a design that paper.toml names")
    paths = {name: design_path(folder, name) for name in declared}
    return {name: read_design(path, root) for name, path in paths.items() if is_there(path, root)}

"""A paper's folder, read and validated as a whole."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import TypeVar

import numpy as np

from gainsay.errors import InputError, one_of
from gainsay.exact.digits import PrintedNumber
from gainsay.tables.designs import Design
from gainsay.tables.models import (
    Campaign,
    Claim,
    Erratum,
    NotChecked,
    PaperFile,
    Parameter,
    Quantity,
    Recorded,
    RecordedCertificate,
    RecordedPublished,
    RecordedRead,
    RecordedScan,
    Reply,
)
from gainsay.tables.reading import PrintedMatrix
from gainsay.tables.reads import note
from gainsay.tables.units import is_exact, to_si

T = TypeVar("T")


class Named(dict[str, T]):
    """Rows of a table by name; an unknown one is refused with the nearest."""

    def __init__(self, what: str, rows: Mapping[str, T]) -> None:
        super().__init__(rows)
        self.what = what

    def __missing__(self, name: str) -> T:
        """Refuse a name that there is not."""
        raise InputError(self.what, value=name, expected=one_of(str(name), self))


@dataclass(frozen=True)
class Case:
    """Everything that a paper's folder says.

    Attributes
    ----------
    name : str
        Folder name, such as ``wan2014``.
    root : Path
        Project root.
    paper : PaperFile
    parameters : mapping of name to Parameter
    quantities : mapping of id to Quantity
    claims, errata : mapping of id to row
    not_checked : tuple of NotChecked
    replies : tuple of Reply
    recorded : mapping of quantity to Recorded
    recorded_scans : mapping of (claim, item) to RecordedScan
    recorded_reads : mapping of (quantity, parameter) to RecordedRead
    recorded_certificates : mapping of certificate to RecordedCertificate
    recorded_published : mapping of (what, entry) to RecordedPublished
    designs : mapping of name to Design
        Gains that a search found.
    campaigns : mapping of name to Campaign
        Computations too large for a run of the workflow.
    """

    name: str
    root: Path
    paper: PaperFile
    parameters: Mapping[str, Parameter]
    quantities: Mapping[str, Quantity]
    claims: Mapping[str, Claim]
    errata: Mapping[str, Erratum]
    not_checked: tuple[NotChecked, ...]
    replies: tuple[Reply, ...]
    recorded: Mapping[str, Recorded]
    recorded_scans: Mapping[tuple[str, str], RecordedScan]
    recorded_reads: Mapping[tuple[str, str], RecordedRead]
    recorded_certificates: Mapping[str, RecordedCertificate]
    recorded_published: Mapping[tuple[str, str], RecordedPublished]
    designs: Mapping[str, Design]
    campaigns: Mapping[str, Campaign]
    _matrices: Mapping[str, PrintedMatrix] = field(repr=False)

    @property
    def folder(self) -> Path:
        """The folder of the paper's tables."""
        return self.root / "papers" / self.name

    @property
    def results(self) -> Path:
        """The folder of the paper's results."""
        return self.root / "results" / self.name

    def _parameter(self, name: str, type_: str) -> Parameter:
        row = self.parameters.get(name)
        if row is None or row.type != type_:
            known = [other for other, row in self.parameters.items() if row.type == type_]
            raise InputError(
                file=f"papers/{self.name}/parameters.csv",
                field="name",
                value=name,
                expected=f"a {type_} of this name, since the computation needs it; there is {one_of(name, known)}",
            )
        if row.status == "assumed":
            note(name)
        return row

    def exact(self, name: str) -> Fraction:
        """Return a number in SI units as an exact rational.

        Raises
        ------
        InputError
            If pi belongs to its unit, as to degrees: it has no rational value in SI.
        """
        row = self._parameter(name, "number")
        if not is_exact(row.unit):
            raise InputError(
                file=f"papers/{self.name}/parameters.csv",
                field=name,
                value=f"{row.value} {row.unit}",
                expected="a unit without pi, since an exact number is computed with: 1 for the number of degrees",
            )
        return PrintedNumber(row.value).value * to_si(row.unit)[1]

    def plausible(self, name: str) -> tuple[Fraction, Fraction]:
        """Return the ends, in SI units, of the plausible range of a number that the paper leaves out.

        Raises
        ------
        InputError
            If the table gives no range, or pi belongs to the unit.
        """
        row = self.parameters.get(name)
        low, dots, high = (row.plausible if row and row.type == "number" else "").partition("..")
        if row is None or row.status != "assumed" or not dots or not is_exact(row.unit):
            raise InputError(
                file=f"papers/{self.name}/parameters.csv",
                field="plausible",
                value=name,
                expected="an assumed number with a range `low..high`, in a unit without pi",
            )
        factor = to_si(row.unit)[1]
        return PrintedNumber(low).value * factor, PrintedNumber(high).value * factor

    def rounded(self, name: str) -> tuple[Fraction, Fraction]:
        """Return the ends, in SI units, of what rounds to the digits of a number as they are printed."""
        row = self._parameter(name, "number")
        printed, factor = PrintedNumber(row.value), to_si(row.unit)[1]
        return printed.low * factor, printed.high * factor

    def number(self, name: str) -> float:
        """Return a number in SI units as the nearest double."""
        row = self._parameter(name, "number")
        return float(PrintedNumber(row.value).value * to_si(row.unit)[1])

    def choice(self, name: str) -> str:
        """Return a choice among words."""
        return self._parameter(name, "choice").value

    def text(self, name: str) -> str:
        """Return a text."""
        return self._parameter(name, "text").value

    def printed(self, name: str) -> PrintedMatrix:
        """Return a matrix digit for digit as printed."""
        self._parameter(name, "matrix")
        return self._matrices[name]

    def matrix(self, name: str) -> np.ndarray:
        """Return the nearest doubles of a printed matrix, read-only, in the unit of its row: as printed, not SI."""
        return self.printed(name).floats

    def replies_to(self, claim: str) -> tuple[Reply, ...]:
        """Return what is held against the verdict on a claim, in the order of the table."""
        return tuple(reply for reply in self.replies if reply.claim == claim)

    @cached_property
    def assumed(self) -> dict[str, Parameter]:
        """The parameters that the paper leaves out."""
        return {name: row for name, row in self.parameters.items() if row.status == "assumed"}

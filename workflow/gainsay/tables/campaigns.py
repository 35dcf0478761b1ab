"""The inputs of a campaign: ranges and grids written in a cell of `campaigns.csv`, and their faults."""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from gainsay.errors import InputError, one_of
from gainsay.exact.digits import PrintedNumber
from gainsay.tables.case import Case
from gainsay.tables.models import Campaign

#: points of a campaign at most, and chunks: each is a file and a job, and all are planned at once
MOST_POINTS, MOST_CHUNKS = 10**12, 10**6
#: significant digits of the values of a grid: few enough to be the same decimals on every machine
DIGITS = 6
_INPUT = re.compile(r"(?P<name>[A-Za-z][A-Za-z0-9_]*)=(?P<low>\S+?)\.\.(?P<high>\S+?)(?P<log> log)?", re.ASCII)
_RESOLUTION = re.compile(r"[1-9]\d{0,14}(x[1-9]\d{0,14})*", re.ASCII)


@dataclass(frozen=True)
class Axis:
    """The range of one input.

    Attributes
    ----------
    name : str
    low, high : float
    logarithmic : bool
        Whether a grid is even in the logarithm.
    """

    name: str
    low: float
    high: float
    logarithmic: bool = False

    def value(self, index: int, count: int) -> str:
        """Value of a grid by its index, ends included, as a decimal: what a certificate says is exactly this.

        Examples
        --------
        >>> Axis("gamma", 1.0, 100.0, True).value(1, 3)
        '10'
        """
        part = index / (count - 1) if count > 1 else 0.5
        if self.logarithmic:
            value = math.exp((1 - part) * math.log(self.low) + part * math.log(self.high))
        else:
            value = (1 - part) * self.low + part * self.high
        return f"{value:.{DIGITS}g}"

    def tells_apart(self, count: int) -> bool:
        """Whether so many values of a grid differ from their neighbours in the digits that they are given."""
        if count < 2:
            return True
        if self.logarithmic:  # their last digit is largest, beside them, where they begin with 1
            return math.expm1(math.log(self.high / self.low) / (count - 1)) > 10.0 ** (1 - DIGITS)
        unit = 10.0 ** (math.floor(math.log10(max(abs(self.low), abs(self.high)))) + 1 - DIGITS)
        return (self.high - self.low) / (count - 1) > unit * (1 - 1e-9)

    def has_cells(self, count: int) -> bool:
        """Whether so many cells are wide enough to be halved some twenty times in floating point."""
        return (self.high - self.low) / count > 1e-9 * max(abs(self.low), abs(self.high))

    def cell(self, index: int, count: int) -> tuple[float, float]:
        """Ends of one of `count` even cells; neighbours share their end to the bit.

        Examples
        --------
        >>> Axis("inertia", -1.0, 1.0).cell(1, 4)
        (-0.5, 0.0)
        """
        return self._border(index, count), self._border(index + 1, count)

    def _border(self, index: int, count: int) -> float:
        part = index / count
        return self.high if index == count else (1 - part) * self.low + part * self.high


def _refuse(field: str, value: str, expected: str) -> InputError:
    return InputError(field=field, value=value, expected=expected)


def axes(row: Campaign) -> tuple[Axis, ...]:
    """Return the inputs of a campaign in the order of its row.

    Raises
    ------
    InputError
        If the cell is not a list of ranges, names an input twice, or a range is empty or cannot be logarithmic.
    """
    axis_of: dict[str, Axis] = {}
    for part in (word.strip() for word in row.inputs.split(";")):
        read = _INPUT.fullmatch(part)
        if read is None:
            raise _refuse("inputs", part, "`name=low..high; name=low..high log`")
        try:
            low, high = (float(PrintedNumber(read[end]).value) for end in ("low", "high"))
        except (ValueError, OverflowError):
            raise _refuse("inputs", part, "decimal numbers as the ends of a range") from None
        if not low < high:
            raise _refuse("inputs", part, "a range whose low end is below its high end")
        if read["log"] and not low > 0:
            raise _refuse("inputs", part, "a range above 0, since it is logarithmic")
        if read["name"] in axis_of:
            raise _refuse("inputs", read["name"], "each input once")
        axis_of[read["name"]] = Axis(read["name"], low, high, bool(read["log"]))
    return tuple(axis_of.values())


def counts(row: Campaign) -> tuple[int, ...]:
    """Return the number of points along each input, or the one number of draws.

    Raises
    ------
    InputError
        If the cell is neither one number for all inputs nor one for each.
    """
    if _RESOLUTION.fullmatch(row.resolution) is None:
        raise _refuse("resolution", row.resolution, "a whole number from 1, or one for each input as in `24x16`")
    given = tuple(int(part) for part in row.resolution.split("x"))
    if row.kind == "draws":
        if len(given) > 1:
            raise _refuse("resolution", row.resolution, "the number of draws alone")
        return given
    number = len(axes(row))
    if len(given) not in (1, number):
        raise _refuse("resolution", row.resolution, f"one number, or one for each of {number} inputs")
    return given * number if len(given) == 1 else given


def whole(row: Campaign, field: str) -> int:
    """Return a count in a cell as a number.

    Raises
    ------
    InputError
        If it is not a whole number from 1.
    """
    text = getattr(row, field)
    if not re.fullmatch(r"[1-9]\d{0,11}", text, re.ASCII):
        raise _refuse(field, text, "a whole number from 1")
    return int(text)


def faults(case: Case, row: Campaign) -> Iterator[tuple[str, object, str]]:
    """Yield field, value and what was expected, for every fault of a row."""
    for read in (axes, counts, lambda r: whole(r, "block"), lambda r: whole(r, "chunk")):
        try:
            read(row)
        except InputError as error:
            yield str(error.field), error.value, str(error.expected)
            return
    points = math.prod(counts(row))
    if points > MOST_POINTS:
        yield "resolution", row.resolution, f"{MOST_POINTS:.0e} points at most"
    if row.kind in ("map", "scan"):
        for axis, count in zip(axes(row), counts(row), strict=True):
            if not axis.tells_apart(count):
                yield (
                    "resolution",
                    row.resolution,
                    f"values of {axis.name} that differ in {DIGITS} digits: fewer of them",
                )
    if row.kind == "box":
        for axis, count in zip(axes(row), counts(row), strict=True):
            if axis.logarithmic:
                yield "inputs", row.inputs, f"an even range of {axis.name}: the cells of a box are halved"
            if not axis.has_cells(count):
                yield "resolution", row.resolution, f"cells of {axis.name} wider than 1e-9 of its values: fewer of them"
    block, chunk = whole(row, "block"), whole(row, "chunk")
    if points > MOST_CHUNKS * chunk:
        yield "chunk", row.chunk, f"{-(-points // MOST_CHUNKS)} or more, since {MOST_CHUNKS:.0e} chunks are the most"
    if chunk % block:
        yield "chunk", row.chunk, f"a multiple of the block of {block} points, since a chunk is whole blocks"
    if row.kind == "draws" and not re.fullmatch(r"\d{1,18}", row.seed, re.ASCII):
        yield "seed", row.seed, "a whole number from 0, since the campaign draws"
    if row.kind != "draws" and row.seed:
        yield "seed", row.seed, f"nothing, since a {row.kind} draws nothing"
    if row.claim and row.claim not in case.claims:
        yield "claim", row.claim, f"a claim of claims.csv, {one_of(row.claim, case.claims)}, or nothing"


def check_inputs(row: Campaign, wanted: tuple[str, ...], file: str) -> None:
    """Refuse inputs that the computation does not know, or lacks.

    Raises
    ------
    InputError
        Naming the nearest input.
    """
    given = [axis.name for axis in axes(row)]
    for name in given:
        if name not in wanted:
            raise InputError(row.name, file=file, field="inputs", value=name, expected=one_of(name, wanted))
    for name in wanted:
        if name not in given:
            raise InputError(row.name, file=file, field="inputs", value=row.inputs, expected=f"a range of {name} too")


def named(campaigns: Mapping[str, Campaign], name: str, file: str) -> Campaign:
    """Return a campaign by name.

    Raises
    ------
    InputError
        If there is none of this name; names the nearest.
    """
    if name not in campaigns:
        raise InputError("campaign", file=file, value=name, expected=one_of(name, campaigns))
    return campaigns[name]

"""What a scan says of a claim: its values are held against the claim's criterion here, not where they were computed."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from gainsay.errors import InputError
from gainsay.scans.criterion import NUMERIC, Criterion, criteria
from gainsay.scans.ranges import Plausible, Point, nearest
from gainsay.tables import Case
from gainsay.tables.files import read_json, short_path
from gainsay.tables.models import Claim
from gainsay.tables.reading import expectation
from gainsay.tables.units import to_si

Pair = tuple[float, Point]
#: how far outside its range, as a share of it, rounding may put the end of an input
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Boundary:
    """Where the outcome turns along one input, all others fixed.

    Attributes
    ----------
    input : str
    holds, fails : value
        The two values of the input between which the outcome turns; adjacent to the bisection's width, or two
        values of a choice.
    at : Point
        All inputs at the value that holds.
    """

    input: str
    holds: Any
    fails: Any
    at: Point


@dataclass(frozen=True)
class Outcome:
    """A scan under a claim.

    Attributes
    ----------
    claim, quantity : str
    inputs : tuple of Plausible
    samples, distinct : int
        Points evaluated, scattered ones and corners, and how many of them differ.
    holding, at_best : int
        Those at which the claim holds, under the strictest reading of its threshold and under the most lenient, which
        are the same where the paper prints it.
    least, greatest : (float, Point)
        Smallest and largest value of the quantity with their inputs.
    holds_at, fails_at : (float, Point) or None
        A sample with each outcome, joined by `boundary`.
    boundary : Boundary or None
    criterion : str
        What it means to hold, one phrase.
    turning : str
        Where the outcome turns along a threshold that the paper does not print, one phrase.
    one_is_enough : bool
        Whether the sentence says `can` or the like, so that one sample bears it out.
    closer, closer_holding : int
        Points looked at around samples that are few in deciding otherwise than all others, and at how many it holds.
    """

    claim: str
    quantity: str
    inputs: tuple[Plausible, ...]
    samples: int
    distinct: int
    holding: int
    at_best: int
    least: Pair
    greatest: Pair
    holds_at: Pair | None
    fails_at: Pair | None
    boundary: Boundary | None
    criterion: str
    turning: str = ""
    one_is_enough: bool = False
    closer: int = 0
    closer_holding: int = 0

    @property
    def outcome(self) -> str:
        """``holds`` for every sample and reading, or for one where that is enough; ``fails`` for every; ``depends``.

        Where one would be enough and no sample of a range has it, others may: ``open``.
        """
        if self.holding == self.samples or (self.one_is_enough and self.holding):
            return "holds"
        if self.at_best:
            return "depends"
        return "open" if self.one_is_enough and not self.finite else "fails"

    def _phrase(self, pair: Pair | None) -> str:
        if pair is None:
            return ""
        units = {p.name: p.unit for p in self.inputs}
        at = ", ".join(f"{k} = {_short(v)} {units[k]}".removesuffix(" 1") for k, v in pair[1].items())
        return f"{self.quantity} = {_short(pair[0])} at {at}"

    @property
    def witness(self) -> str:
        """One sentence: the counterexample, or both outcomes with the boundary between them."""
        if self.outcome == "holds":
            return f"borne out by {self._phrase(self.holds_at)}" if self.one_is_enough else ""
        if self.outcome in ("fails", "open"):
            return self._phrase(self.fails_at)
        return "; ".join(part for part in (self.turning, self._turns()) if part)

    def _turns(self) -> str:
        """Say where the outcome turns along an input, else one sample at which the claim fails."""
        if self.boundary is None:
            return self._phrase(self.fails_at)
        unit = next(p.unit for p in self.inputs if p.name == self.boundary.input)
        turns = (
            f"depends on {self.boundary.input}: holds at {_short(self.boundary.holds)}, "
            f"fails at {_short(self.boundary.fails)} {unit}".removesuffix(" 1")
        )
        return f"{turns}; holds: {self._phrase(self.holds_at)}; fails: {self._phrase(self.fails_at)}"

    @property
    def finite(self) -> bool:
        """Whether every reading of a finite list was gone through."""
        return all(one.values for one in self.inputs)

    @property
    def evidence(self) -> str:
        """What the verdict rests on: how many samples, how many of them distinct; or every reading of a list."""
        if self.finite:
            return f"sampled {self.samples} of {self.samples} readings"
        return f"sampled {self.samples} (distinct {self.distinct})"

    @property
    def note(self) -> str:
        """How many samples hold, and what holding means."""
        count = str(self.holding) if self.holding == self.at_best else f"{self.holding} to {self.at_best}"
        of = "readings" if self.finite else "plausible inputs"
        enough = ", of which one is enough" if self.one_is_enough else ""
        closer = f", closer to the few that differ at {self.closer_holding} of {self.closer}" if self.closer else ""
        return f"holds at {count} of {self.samples} {of}{enough}{closer} ({self.quantity} {self.criterion})"


class _Found(BaseModel):
    """Values of the quantity, each at its point."""

    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)

    values: list[float] = []
    points: list[list[float | str | bool]] = []


class ScanFile(_Found):
    """``scans/<quantity>.json``: values of a quantity over what a paper leaves out."""

    values: list[float] = Field(min_length=1)
    quantity: str
    seed: int
    sequence: str
    inputs: list[dict[str, float | str | bool | list[float | str]]]
    crossings: list[_Found]
    bears_out: list[str] = []
    closer: _Found = _Found()


def _short(value: Any) -> str:
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def read_scans(paths: Iterable[Path], root: Path) -> dict[str, dict[str, Any]]:
    """Return the content of scan files by the quantity scanned.

    Raises
    ------
    InputError
        If a file is not a scan as a step writes it.
    """
    scans = [_read_scan(path, root) for path in sorted(paths)]
    return {scan["quantity"]: scan for scan in scans}


def _read_scan(path: Path, root: Path) -> dict[str, Any]:
    """Read a scan and see that its points are points of its inputs."""
    content: Any = read_json(path, root)
    try:
        scan = ScanFile.model_validate(content)
        inputs = [Plausible.from_json(entry) for entry in content["inputs"]]
        for pair in (scan, *scan.crossings, scan.closer):
            for _, row in zip(pair.values, pair.points, strict=True):
                for entry, at in zip(inputs, row, strict=True):
                    # raises where the input is one of values and this is none of them
                    if not -_ROUNDING <= entry.fraction(at) <= 1 + _ROUNDING:
                        raise ValueError(f"{entry.name} = {at!r} is outside its range")
        for crossing in scan.crossings:
            if len(crossing.values) != 2 or crossing.points[0] == crossing.points[1]:
                raise ValueError("a crossing that joins no two points")
    except ValidationError as error:
        field, value, expected = expectation(ScanFile, error.errors()[0])
        raise InputError(file=short_path(path, root), field=field, value=value, expected=expected) from None
    except (ValueError, TypeError, ArithmeticError) as error:
        message = f"no scan: {error}"
        raise InputError(message, file=short_path(path, root), expected="a scan as a step writes it") from None
    return content


def outcomes(case: Case, scans: Mapping[str, Mapping[str, Any]]) -> dict[str, Outcome]:
    """Hold scans against the claims on their quantities.

    Parameters
    ----------
    case : Case
    scans : mapping of quantity to content of its file

    Returns
    -------
    dict of claim to Outcome
        In the order of the claims' ids.
    """
    scanned = [c for c in case.claims.values() if c.quantity in scans and c.comparator in NUMERIC]
    return {c.id: outcome(c, scans[c.quantity]) for c in sorted(scanned, key=lambda claim: claim.id)}


def outcome(claim: Claim, scan: Mapping[str, Any]) -> Outcome:
    """Hold a scan against a claim on its quantity."""
    inputs = tuple(Plausible.from_json(entry) for entry in scan["inputs"])

    def pair(value: float, row: list[Any]) -> Pair:
        return value, dict(zip((p.name for p in inputs), row, strict=True))

    strict, lenient = (wanted := criteria(claim))[0], wanted[-1]
    pairs = [pair(value, row) for value, row in zip(scan["values"], scan["points"], strict=True)]
    by_value = sorted(pairs, key=lambda one: one[0])
    holding, at_best = (sum(one.holds(value) for value, _ in pairs) for one in (strict, lenient))
    crossings = []
    for crossing in scan["crossings"]:
        first, second = map(pair, crossing["values"], crossing["points"])
        crossings.append((first, second))
    turns = strict if holding or not at_best else lenient
    boundary, holds_at, fails_at = _boundary(inputs, turns, crossings, pairs)
    parts: dict[str, Any] = {"criterion": strict.phrase, "one_is_enough": claim.holds_for == "some"}
    if strict != lenient:
        parts["criterion"] = f"{strict.phrase} to {lenient.phrase}"
        if at_best and holding < len(pairs):
            parts["turning"] = _along_the_threshold(claim, by_value[0][0], by_value[-1][0])
    around = scan.get("closer", {}).get("values", [])
    parts |= {"closer": len(around), "closer_holding": sum(strict.holds(value) for value in around)}
    distinct = len({tuple(row) for row in scan["points"]})
    return Outcome(
        claim.id,
        scan["quantity"],
        inputs,
        len(pairs),
        distinct,
        holding,
        at_best,
        by_value[0],
        by_value[-1],
        holds_at,
        fails_at,
        boundary,
        **parts,
    )


def _along_the_threshold(claim: Claim, least: float, greatest: float) -> str:
    """Say from which threshold on the claim holds everywhere, and from which on nowhere."""
    factor = float(to_si(claim.unit)[1])
    low, high = (_short(value / factor) for value in (least, greatest))
    ends = (f"from {high}", f"below {low}") if claim.comparator == "at_most" else (f"up to {low}", f"above {high}")
    holds, fails = (f"{end} {claim.unit}".removesuffix(" 1") for end in ends)
    return f"depends on the threshold: holds everywhere {holds}, nowhere {fails}"


def _boundary(
    inputs: tuple[Plausible, ...], wanted: Criterion, crossings: list[tuple[Pair, Pair]], pairs: list[Pair]
) -> tuple[Boundary | None, Pair | None, Pair | None]:
    """Return the crossing at which the criterion turns, else no boundary and the nearest pair of outcomes."""
    good = [one for one in pairs if wanted.holds(one[0])]
    bad = [one for one in pairs if not wanted.holds(one[0])]
    if not good or not bad:
        return None, next(iter(good), None), next(iter(bad), None)
    for first, second in crossings:
        if wanted.holds(first[0]) == wanted.holds(second[0]):
            continue
        inside, outside = (first, second) if wanted.holds(first[0]) else (second, first)
        name = next(p.name for p in inputs if inside[1][p.name] != outside[1][p.name])
        return Boundary(name, inside[1][name], outside[1][name], inside[1]), inside, outside
    i, j = nearest(inputs, [point for _, point in good], [point for _, point in bad])[0]
    return None, good[i], bad[j]

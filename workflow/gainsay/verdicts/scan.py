"""A claim over every plausible value of what a paper leaves out: sampled evenly, its boundary located by bisection.

The samples are a Halton sequence, of low discrepancy, with a shift drawn from a seed, and the corners of the ranges. A
claim that holds at every sample holds for every plausible input, one that fails at every sample fails; else two samples
with different outcomes are joined by changing one input at a time, and the input at which the outcome turns is
bisected.

References
----------
H. Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods, SIAM, 1992, section 3.1.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from gainsay.errors import ComputationError, InputError
from gainsay.verdicts.plausible import Plausible, Point, corners, fractions, plausible, sample

__all__ = ["Boundary", "Plausible", "Point", "Scan", "corners", "fractions", "plausible", "sample", "scan"]

#: fewest samples on which a verdict may rest
LEAST_SAMPLES = 200
_MOST_CUTS = 60
#: parts into which a boundary is cut at a time: bisection, or many where points are evaluated together
_HALVES, _TOGETHER = 2, 32


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
class Scan:
    """What a scan found; written by `Results.scan`.

    Attributes
    ----------
    claim, quantity : str
    inputs : tuple of Plausible
    samples, holding : int
        Points evaluated, scattered ones and corners, and those at which the claim holds.
    seed : int
    least, greatest : (float, Point)
        Smallest and largest value of the quantity with their inputs.
    holds_at, fails_at : (float, Point) or None
        A sample with each outcome, joined by `boundary`.
    boundary : Boundary or None
    criterion : str
        What it means to hold, one phrase.
    """

    claim: str
    quantity: str
    inputs: tuple[Plausible, ...]
    samples: int
    holding: int
    seed: int
    least: tuple[float, Point]
    greatest: tuple[float, Point]
    holds_at: tuple[float, Point] | None
    fails_at: tuple[float, Point] | None
    boundary: Boundary | None
    criterion: str

    @property
    def outcome(self) -> str:
        """``holds`` for every sample, ``fails`` for every sample, or ``depends``."""
        if self.holding == self.samples:
            return "holds"
        return "fails" if self.holding == 0 else "depends"

    def _phrase(self, found: tuple[float, Point] | None) -> str:
        if found is None:
            return ""
        units = {p.name: p.unit for p in self.inputs}
        at = ", ".join(f"{k} = {_short(v)} {units[k]}".removesuffix(" 1") for k, v in found[1].items())
        return f"{self.quantity} = {_short(found[0])} at {at}"

    @property
    def witness(self) -> str:
        """One sentence: the counterexample, or both outcomes with the boundary between them."""
        if self.outcome == "holds":
            return ""
        if self.outcome == "fails" or self.boundary is None:
            return self._phrase(self.fails_at)
        unit = next(p.unit for p in self.inputs if p.name == self.boundary.input)
        turns = (
            f"depends on {self.boundary.input}: holds at {_short(self.boundary.holds)}, "
            f"fails at {_short(self.boundary.fails)} {unit}".removesuffix(" 1")
        )
        return f"{turns}; holds: {self._phrase(self.holds_at)}; fails: {self._phrase(self.fails_at)}"

    @property
    def note(self) -> str:
        """How many samples hold, and what holding means."""
        return f"holds at {self.holding} of {self.samples} plausible inputs ({self.criterion})"

    def to_json(self) -> dict[str, Any]:
        """Return the content of the result file."""

        def pair(found: tuple[float, Point] | None) -> dict[str, Any] | None:
            return None if found is None else {"value": found[0], "inputs": found[1]}

        return {
            "claim": self.claim,
            "quantity": self.quantity,
            "criterion": self.criterion,
            "outcome": self.outcome,
            "samples": self.samples,
            "holding": self.holding,
            "seed": self.seed,
            "sequence": "Halton, seeded shift; and the corners of the plausible values",
            "inputs": [p.to_json() for p in self.inputs],
            "smallest": self.least[0],
            "largest": self.greatest[0],
            "smallest_at": self.least[1],
            "largest_at": self.greatest[1],
            "holds_at": pair(self.holds_at),
            "fails_at": pair(self.fails_at),
            "boundary": None
            if self.boundary is None
            else {
                "input": self.boundary.input,
                "holds": self.boundary.holds,
                "fails": self.boundary.fails,
                "at": self.boundary.at,
            },
            "witness": self.witness,
            "note": self.note,
        }


def _short(value: Any) -> str:
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def scan(
    claim: str,
    quantity: str,
    inputs: Sequence[Plausible],
    evaluate: Callable[[Mapping], float],
    holds: Callable[[float], bool],
    *,
    criterion: str,
    samples: int = 256,
    seed: int = 0,
    admissible: Callable[[Mapping], bool] | None = None,
    width: float = 1e-3,
    together: Callable[[Sequence[Point]], Sequence[float]] | None = None,
) -> Scan:
    """Evaluate a claim over the plausible inputs and locate the boundary where its outcome turns.

    Parameters
    ----------
    claim, quantity : str
        Ids of the claim and of the quantity that it speaks of.
    inputs : sequence of Plausible
    evaluate : callable
        Mapping of input names to values -> the quantity; must be deterministic.
    holds : callable
        Value of the quantity -> whether the claim holds.
    criterion : str
        What it means to hold, one phrase.
    samples : int
        At least `LEAST_SAMPLES`; the corners of the plausible values come beside them.
    seed : int
    admissible : callable, optional
        See `sample`.
    width : float
        Fraction of an input's range at which the bisection stops.
    together : callable, optional
        Points -> the quantity at each, where that is cheaper than one by one: it serves the samples and the corners.

    Raises
    ------
    InputError
        For too few samples or inputs that hardly ever fit together.
    ComputationError
        If the quantity cannot be computed at a sample: nothing is passed over.
    """
    if samples < LEAST_SAMPLES:
        raise InputError("samples of a scan", field=claim, value=samples, expected=f"at least {LEAST_SAMPLES}")

    def value_at(point: Point) -> float:
        try:
            value = float(evaluate(dict(point)))
        except (ComputationError, InputError) as error:
            raise ComputationError(claim, f"scan broke at {point}: {error}") from error
        if math.isnan(value):
            raise ComputationError(claim, f"scan broke at {point}: the quantity is not a number")
        return value

    points = [*sample(inputs, samples, seed, admissible), *corners(inputs, admissible)]

    def values_at(points: Sequence[Point]) -> list[float]:
        if together is None:
            return [value_at(point) for point in points]
        values = [float(value) for value in together(points)]
        if any(math.isnan(value) for value in values):
            raise ComputationError(claim, "scan broke: the quantity is not a number at a sample")
        return values

    found = list(zip(values_at(points), points, strict=True))
    good = [pair for pair in found if holds(pair[0])]
    bad = [pair for pair in found if not holds(pair[0])]
    boundary, first_good, first_bad = None, next(iter(good), None), next(iter(bad), None)
    if good and bad:
        parts = _HALVES if together is None else _TOGETHER
        boundary, first_good, first_bad = _boundary(inputs, good, bad, values_at, holds, admissible, width, parts)
    by_value = sorted(found, key=lambda pair: pair[0])
    return Scan(
        claim, quantity, tuple(inputs), len(found), len(good), seed, by_value[0], by_value[-1], first_good, first_bad,
        boundary, criterion,
    )  # fmt: skip


def _boundary(
    inputs: Sequence[Plausible],
    good: list,
    bad: list,
    values_at: Callable[[Sequence[Point]], list[float]],
    holds: Callable[[float], bool],
    admissible: Callable[[Mapping], bool] | None,
    width: float,
    parts: int,
) -> tuple[Boundary | None, tuple[float, Point], tuple[float, Point]]:
    """Join the nearest pair of different outcomes one input at a time and bisect the input that turns it."""

    def distance(a: Point, b: Point) -> float:
        return sum((p.fraction(a[p.name]) - p.fraction(b[p.name])) ** 2 for p in inputs)

    nearest = sorted(
        ((distance(g[1], b[1]), i, j) for i, g in enumerate(good) for j, b in enumerate(bad)), key=lambda t: t
    )
    for _, i, j in nearest[:50]:
        path = _turn(inputs, good[i], bad[j], values_at, holds, admissible)
        if path is None:
            continue
        turning, inside, outside = path
        if not turning.values:
            inside, outside = _narrow(turning, inside, outside, values_at, holds, width, parts)
        name = turning.name
        return Boundary(name, inside[1][name], outside[1][name], inside[1]), inside, outside
    return None, good[nearest[0][1]], bad[nearest[0][2]]


def _turn(inputs, start, end, values_at, holds, admissible) -> tuple[Plausible, tuple, tuple] | None:
    """Walk from a point that holds to one that fails; return the input at whose change the outcome turns."""
    before = start
    for changed in inputs:
        point = {**before[1], changed.name: end[1][changed.name]}
        if point == before[1]:
            continue
        if admissible is not None and not admissible(point):
            return None
        after = (values_at([point])[0], point)
        if not holds(after[0]):
            return changed, before, after
        before = after
    return None


def _narrow(turning, inside, outside, values_at, holds, width, parts) -> tuple[tuple, tuple]:
    """Narrow the boundary: cut it into so many parts at a time, keep the first in which the outcome turns."""
    low, high = turning.fraction(inside[1][turning.name]), turning.fraction(outside[1][turning.name])
    for _ in range(_MOST_CUTS):
        if abs(high - low) <= width:
            break
        cuts = [low + (high - low) * k / parts for k in range(1, parts)]
        points = [{**inside[1], turning.name: turning.at(cut)} for cut in cuts]
        for cut, value, point in zip(cuts, values_at(points), points, strict=True):
            if not holds(value):
                high, outside = cut, (value, point)
                break
            low, inside = cut, (value, point)
    return inside, outside

"""A quantity over every plausible value of what a paper leaves out: sampled evenly, with where its claims turn.

The samples are a Halton sequence, of low discrepancy, with a shift drawn from a seed, and the corners of the ranges; a
finite list of readings is gone through one by one.
What is written are values and the inputs they belong to; whether a claim holds is said where verdicts are made. A claim
says where to look closer: two samples of which it holds at one alone are joined by changing one input at a time, and
the input at which it turns is bisected.

References
----------
H. Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods, SIAM, 1992, section 3.1.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import takewhile
from typing import Any

from gainsay.errors import ComputationError, InputError, one_of
from gainsay.verdicts.criterion import NUMERIC, criteria
from gainsay.verdicts.plausible import Plausible, Point, corners, fractions, nearest, plausible, readings, sample

__all__ = ["Plausible", "Point", "Scan", "corners", "fractions", "plausible", "sample", "scan", "scans"]

#: fewest samples on which a verdict may rest
LEAST_SAMPLES = 200
_MOST_CUTS = 60
#: so few samples that decide otherwise than all others are looked at closer, at so many more points
FEW, CLOSER = 5, 64
#: pairs of samples with different outcomes that are tried, nearest first
_MOST_PAIRS = 50

Pair = tuple[float, Point]
Holds = Callable[[float], bool]


@dataclass(frozen=True)
class Scan:
    """What a scan found; written by `Results.scan`.

    Attributes
    ----------
    quantity : str
    inputs : tuple of Plausible
    seed : int
    found : tuple of (float, Point)
        The quantity at every sample, scattered ones first, then the corners.
    crossings : tuple of pairs of (float, Point)
        Two points that differ in one input, close to each other or two values of a choice, between which a claim turns.
    bears_out : tuple of str
        Printed parameters that every point bears out: it is a condition of what is said of the points.
    closer : tuple of (float, Point)
        The quantity at points around samples that are few in deciding otherwise than all others.
    """

    quantity: str
    inputs: tuple[Plausible, ...]
    seed: int
    found: tuple[Pair, ...]
    crossings: tuple[tuple[Pair, Pair], ...]
    bears_out: tuple[str, ...] = ()
    closer: tuple[Pair, ...] = ()

    @property
    def note(self) -> str:
        """Between which values the quantity lies, over how many samples."""
        values = [value for value, _ in self.found]
        return f"{min(values):.5g} to {max(values):.5g} over {len(values)} plausible inputs"

    def to_json(self) -> dict[str, Any]:
        """Return the content of the result file."""

        def row(point: Point) -> list[Any]:
            return [point[p.name] for p in self.inputs]

        return {
            "quantity": self.quantity,
            "seed": self.seed,
            "sequence": "every reading"
            if all(p.values for p in self.inputs)
            else "Halton, seeded shift; and the corners of the plausible values",
            "inputs": [p.to_json() for p in self.inputs],
            "values": [value for value, _ in self.found],
            "points": [row(point) for _, point in self.found],
            "crossings": [
                {"values": [value for value, _ in pair], "points": [row(point) for _, point in pair]}
                for pair in self.crossings
            ],
            "bears_out": list(self.bears_out),
            "closer": {
                "values": [value for value, _ in self.closer],
                "points": [row(point) for _, point in self.closer],
            },
        }


def scan(
    case: Any,
    quantity: str,
    inputs: Sequence[Plausible],
    evaluate: Callable[[Mapping], float] | None = None,
    *,
    samples: int = 256,
    seed: int = 0,
    admissible: Callable[[Mapping], bool] | None = None,
    bears_out: Sequence[str] = (),
    width: float = 1e-3,
    together: Callable[[Sequence[Point]], Sequence[float]] | None = None,
    parts: int = 2,
) -> Scan:
    """Evaluate a quantity over the plausible inputs and locate where the claims on it turn.

    Parameters
    ----------
    case : gainsay.tables.Case
        Its claims on the quantity say where to look closer.
    quantity : str
        In SI, as declared in the paper's quantities.csv.
    inputs : sequence of Plausible
    evaluate : callable, optional
        Mapping of input names to values -> the quantity; must be deterministic.
    samples : int
        At least `LEAST_SAMPLES`; the corners of the plausible values come beside them.
    seed : int
    admissible : callable, optional
        See `sample`.
    bears_out : sequence of str
        Printed parameters that the admissible points bear out; claims on the quantity name them in `given`.
    width : float
        Fraction of an input's range at which the bisection stops.
    together : callable, optional
        Points -> the quantity at each, instead of `evaluate` where that is cheaper than one by one.
    parts : int
        Into how many parts a boundary is cut at a time: two is bisection; more where many points cost little more than
        one. A power of two keeps the boundary that bisection finds.

    Raises
    ------
    InputError
        For too few samples, inputs that hardly ever fit together, or fewer than two parts.
    ComputationError
        If the quantity cannot be computed at a sample: nothing is passed over.
    """
    if samples < LEAST_SAMPLES:
        raise InputError("samples of a scan", field=quantity, value=samples, expected=f"at least {LEAST_SAMPLES}")
    if parts < 2:
        raise InputError("parts of a scan", field=quantity, value=parts, expected="at least 2")

    def value_at(point: Point) -> float:
        try:
            return float(evaluate(dict(point)))  # type: ignore[misc]  # one of the two is given
        except (ComputationError, InputError) as error:
            raise ComputationError(quantity, f"scan broke at {point}: {error}") from error

    def values_at(points: Sequence[Point]) -> list[float]:
        values = [value_at(point) for point in points] if together is None else [float(v) for v in together(points)]
        for value, point in zip(values, points, strict=True):
            if math.isnan(value):
                raise ComputationError(quantity, f"scan broke at {point}: the quantity is not a number")
        return values

    if all(one.values for one in inputs):
        points = readings(inputs, admissible)
    else:
        points = [*sample(inputs, samples, seed, admissible), *corners(inputs, admissible)]
    found = list(zip(values_at(points), points, strict=True))
    crossings: list[tuple[Pair, Pair]] = []
    closer: list[Pair] = []
    for claim in case.claims.values():
        if claim.quantity == quantity and claim.comparator in NUMERIC:
            for one in criteria(claim):
                crossings += _crossing(inputs, found, values_at, one.holds, admissible, width, parts)
            if not closer:  # under the strictest reading, by which samples are counted
                around = _around_the_few(inputs, found, criteria(claim)[0].holds, seed, admissible)
                closer = list(zip(values_at(around), around, strict=True))
    return Scan(quantity, tuple(inputs), seed, tuple(found), tuple(crossings), tuple(bears_out), tuple(closer))


def scans(
    case: Any,
    quantities: Sequence[str],
    inputs: Sequence[Plausible],
    evaluate: Callable[[Mapping], Mapping[str, float]],
    **more: Any,
) -> Iterator[Scan]:
    """Scan several quantities that are computed together: each point is computed once for all.

    Parameters
    ----------
    case, inputs, **more
        As for `scan`.
    quantities : sequence of str
    evaluate : callable
        Mapping of input names to values -> these quantities, and others, by their ids.

    Yields
    ------
    Scan
        One a quantity, for `Results.scan`.
    """
    known: dict[tuple, Mapping[str, float]] = {}

    def value_of(quantity: str, point: Mapping) -> float:
        key = tuple(point.items())
        if key not in known:
            known[key] = evaluate(point)
        found = known[key]
        if quantity not in found:
            raise InputError("quantity of a scan", value=quantity, expected=one_of(quantity, found))
        return found[quantity]

    for quantity in quantities:
        yield scan(case, quantity, inputs, partial(value_of, quantity), **more)


def _around_the_few(
    inputs: Sequence[Plausible],
    found: Sequence[Pair],
    holds: Holds,
    seed: int,
    admissible: Callable[[Mapping], bool] | None,
) -> list[Point]:
    """Draw points from the least box around the few samples that decide otherwise and, of each, the nearest other."""
    sides: tuple[list[Point], list[Point]] = ([], [])
    for value, point in found:
        sides[holds(value)].append(point)
    few, others = sorted(sides, key=len)
    if not 0 < len(few) < FEW or all(one.values for one in inputs):  # a list of readings has nothing between them
        return []
    near: dict[int, Point] = {}
    for i, j in nearest(inputs, few, others):
        near.setdefault(i, others[j])
    box = []
    for one in inputs:
        values = [point[one.name] for point in (*few, *near.values())]
        ends = min(values), max(values)
        if one.values or ends[0] == ends[1]:
            box.append(replace(one, low=None, high=None, values=tuple(dict.fromkeys(values))))
        else:
            box.append(replace(one, low=ends[0], high=ends[1]))
    return sample(box, CLOSER, seed, admissible)


def _crossing(
    inputs: Sequence[Plausible],
    found: Sequence[Pair],
    values_at: Callable[[Sequence[Point]], list[float]],
    holds: Holds,
    admissible: Callable[[Mapping], bool] | None,
    width: float,
    parts: int,
) -> list[tuple[Pair, Pair]]:
    """Join the nearest pair of different outcomes one input at a time and bisect the input that turns it."""
    good = [pair for pair in found if holds(pair[0])]
    bad = [pair for pair in found if not holds(pair[0])]
    for i, j in nearest(inputs, [point for _, point in good], [point for _, point in bad])[:_MOST_PAIRS]:
        path = _turn(inputs, good[i], bad[j], values_at, holds, admissible, parts - 1)
        if path is None:
            continue
        turning, inside, outside = path
        if not turning.values:
            inside, outside = _narrow(turning, inside, outside, values_at, holds, width, parts)
        return [(inside, outside)]
    return []


def _turn(
    inputs: Sequence[Plausible],
    start: Pair,
    end: Pair,
    values_at: Callable[[Sequence[Point]], list[float]],
    holds: Holds,
    admissible: Callable[[Mapping], bool] | None,
    at_once: int,
) -> tuple[Plausible, Pair, Pair] | None:
    """Walk from a point that holds to one that fails; return the input at whose change the outcome turns."""
    changes, point = [], start[1]
    for changed in inputs:
        following = {**point, changed.name: end[1][changed.name]}
        if following != point:
            changes.append((changed, following))
            point = following
    before = start
    for first in range(0, len(changes), at_once):
        several = changes[first : first + at_once]
        possible = list(takewhile(lambda change: admissible is None or admissible(change[1]), several))
        values = values_at([point for _, point in possible])
        for value, (changed, point) in zip(values, possible, strict=True):
            if not holds(value):
                return changed, before, (value, point)
            before = (value, point)
        if len(possible) < len(several):
            return None
    return None


def _narrow(
    turning: Plausible,
    inside: Pair,
    outside: Pair,
    values_at: Callable[[Sequence[Point]], list[float]],
    holds: Holds,
    width: float,
    parts: int,
) -> tuple[Pair, Pair]:
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

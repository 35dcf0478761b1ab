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
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile
from typing import Any, TypeAlias, TypeVar

from gainsay.errors import ComputationError, InputError, one_of
from gainsay.scans.criterion import NUMERIC, criteria
from gainsay.scans.ranges import Plausible, Point, corners, nearest, readings, sample

__all__ = ["Scan", "scan", "scans"]

#: fewest samples on which a verdict may rest
LEAST_SAMPLES = 200
_MOST_CUTS = 60
#: so few samples that decide otherwise than all others are looked at closer, at so many more points
FEW, CLOSER = 5, 64
#: pairs of samples with different outcomes that are tried, nearest first
_MOST_PAIRS = 50

T = TypeVar("T")
Pair = tuple[float, Point]
Holds = Callable[[float], bool]
#: asks for the quantity at points, list by list, is sent its values there, and returns what it was looking for
Asking: TypeAlias = Generator[Sequence[Point], list[float], T]
#: points -> the quantities at each, by their ids
Together: TypeAlias = Callable[[Sequence[Point]], Sequence[Mapping[str, float]]]


@dataclass(frozen=True)
class Scan:
    """Values of a scan and the points they were computed at; written by `Results.scan`.

    Attributes
    ----------
    quantity : str
    inputs : tuple of Plausible
    seed : int
    pairs : tuple of (float, Point)
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
    pairs: tuple[Pair, ...]
    crossings: tuple[tuple[Pair, Pair], ...]
    bears_out: tuple[str, ...] = ()
    closer: tuple[Pair, ...] = ()

    @property
    def note(self) -> str:
        """Between which values the quantity lies, over how many samples."""
        values = [value for value, _ in self.pairs]
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
            "values": [value for value, _ in self.pairs],
            "points": [row(point) for _, point in self.pairs],
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
    asking = _scan(case, quantity, inputs, samples, seed, admissible, bears_out, width, parts)

    def each(points: Sequence[Point]) -> list[Mapping[str, float]]:
        values = together(points) if together else [_at(quantity, evaluate, point) for point in points]
        return [{quantity: value} for value in values]

    return _answered({quantity: asking}, each)[quantity]


def scans(
    case: Any,
    quantities: Sequence[str],
    inputs: Sequence[Plausible],
    evaluate: Callable[[Mapping], Mapping[str, float]] | None = None,
    *,
    samples: int = 256,
    seed: int = 0,
    admissible: Callable[[Mapping], bool] | None = None,
    bears_out: Sequence[str] = (),
    width: float = 1e-3,
    together: Callable[[Sequence[Point]], Sequence[Mapping[str, float]]] | None = None,
    parts: int = 2,
) -> list[Scan]:
    """Scan several quantities that are computed together: each point is computed once for all.

    What the scans ask for goes round by round: points that each of them needs next are one list.

    Parameters
    ----------
    case, inputs, samples, seed, admissible, bears_out, width, parts
        As for `scan`.
    quantities : sequence of str
    evaluate : callable, optional
        Mapping of input names to values -> these quantities, and others, by their ids.
    together : callable, optional
        Points -> the same at each, instead of `evaluate` where that is cheaper than one by one.

    Returns
    -------
    list of Scan
        One a quantity, for `Results.scan`.
    """
    asking = {q: _scan(case, q, inputs, samples, seed, admissible, bears_out, width, parts) for q in quantities}

    def each(points: Sequence[Point]) -> Sequence[Mapping[str, float]]:
        return together(points) if together else [_at(", ".join(quantities), evaluate, point) for point in points]

    answers = _answered(asking, each)
    return [answers[quantity] for quantity in quantities]


def _at(what: str, evaluate: Callable[[Mapping], T] | None, point: Point) -> T:
    """Compute one point."""
    assert evaluate is not None, "one of the two is given"
    try:
        return evaluate(dict(point))
    except (ComputationError, InputError) as error:
        raise ComputationError(what, f"scan broke at {point}: {error}") from error


def _answered(asking: Mapping[str, Asking[Scan]], together: Together) -> dict[str, Scan]:
    """Give scans the values that they ask for, round by round, until all have ended; no point is computed twice."""
    known: dict[tuple, Mapping[str, float]] = {}
    ended: dict[str, Scan] = {}
    asked = {quantity: next(one) for quantity, one in asking.items()}
    while asked:
        listed = {tuple(point.items()): point for points in asked.values() for point in points}
        new = {key: point for key, point in listed.items() if key not in known}
        known.update(zip(new, together(list(new.values())) if new else (), strict=True))
        for quantity, points in list(asked.items()):
            values = [_value_of(quantity, point, known[tuple(point.items())]) for point in points]
            try:
                asked[quantity] = asking[quantity].send(values)
            except StopIteration as end:
                ended[quantity] = end.value
                del asked[quantity]
    return ended


def _value_of(quantity: str, point: Point, values: Mapping[str, float]) -> float:
    if quantity not in values:
        raise ComputationError(quantity, f"quantity of a scan {quantity!r}: expected {one_of(quantity, values)}")
    value = float(values[quantity])
    if math.isnan(value):
        raise ComputationError(quantity, f"scan broke at {point}: the quantity is not a number")
    return value


def _scan(
    case: Any,
    quantity: str,
    inputs: Sequence[Plausible],
    samples: int,
    seed: int,
    admissible: Callable[[Mapping], bool] | None,
    bears_out: Sequence[str],
    width: float,
    parts: int,
) -> Asking[Scan]:
    """Sample a quantity and look closer where its claims turn."""
    if samples < LEAST_SAMPLES:
        raise InputError("samples of a scan", field=quantity, value=samples, expected=f"at least {LEAST_SAMPLES}")
    if parts < 2:
        raise InputError("parts of a scan", field=quantity, value=parts, expected="at least 2")
    if all(one.values for one in inputs):
        points = readings(inputs, admissible)
    else:
        points = [*sample(inputs, samples, seed, admissible), *corners(inputs, admissible)]
    pairs = list(zip((yield points), points, strict=True))
    crossings: list[tuple[Pair, Pair]] = []
    closer: list[Pair] = []
    for claim in case.claims.values():
        if claim.quantity == quantity and claim.comparator in NUMERIC:
            for one in criteria(claim):
                crossings += yield from _crossing(inputs, pairs, one.holds, admissible, width, parts)
            if not closer:  # under the strictest reading, by which samples are counted
                around = _around_the_few(inputs, pairs, criteria(claim)[0].holds, seed, admissible)
                closer = list(zip((yield around), around, strict=True))
    return Scan(quantity, tuple(inputs), seed, tuple(pairs), tuple(crossings), tuple(bears_out), tuple(closer))


def _around_the_few(
    inputs: Sequence[Plausible],
    pairs: Sequence[Pair],
    holds: Holds,
    seed: int,
    admissible: Callable[[Mapping], bool] | None,
) -> list[Point]:
    """Draw points from the least box around the few samples that decide otherwise and, of each, the nearest other."""
    sides: tuple[list[Point], list[Point]] = ([], [])
    for value, point in pairs:
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
    pairs: Sequence[Pair],
    holds: Holds,
    admissible: Callable[[Mapping], bool] | None,
    width: float,
    parts: int,
) -> Asking[list[tuple[Pair, Pair]]]:
    """Join the nearest pair of different outcomes one input at a time and bisect the input that turns it."""
    good = [pair for pair in pairs if holds(pair[0])]
    bad = [pair for pair in pairs if not holds(pair[0])]
    for i, j in nearest(inputs, [point for _, point in good], [point for _, point in bad])[:_MOST_PAIRS]:
        path = yield from _turn(inputs, good[i], bad[j], holds, admissible, parts - 1)
        if path is None:
            continue
        turning, inside, outside = path
        if not turning.values:
            inside, outside = yield from _narrow(turning, inside, outside, holds, width, parts)
        return [(inside, outside)]
    return []


def _turn(
    inputs: Sequence[Plausible],
    start: Pair,
    end: Pair,
    holds: Holds,
    admissible: Callable[[Mapping], bool] | None,
    at_once: int,
) -> Asking[tuple[Plausible, Pair, Pair] | None]:
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
        values = yield [point for _, point in possible]
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
    holds: Holds,
    width: float,
    parts: int,
) -> Asking[tuple[Pair, Pair]]:
    """Narrow the boundary: cut it into so many parts at a time, keep the first in which the outcome turns."""
    low, high = turning.fraction(inside[1][turning.name]), turning.fraction(outside[1][turning.name])
    for _ in range(_MOST_CUTS):
        if abs(high - low) <= width:
            break
        cuts = [low + (high - low) * k / parts for k in range(1, parts)]
        points = [{**inside[1], turning.name: turning.at(cut)} for cut in cuts]
        for cut, value, point in zip(cuts, (yield points), points, strict=True):
            if not holds(value):
                high, outside = cut, (value, point)
                break
            low, inside = cut, (value, point)
    return inside, outside

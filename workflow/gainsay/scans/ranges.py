"""Plausible values of what a paper leaves out, and points spread evenly over them.

References
----------
H. Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods, SIAM, 1992, section 3.1.
"""

import math
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np

from gainsay.errors import InputError

Point = dict[str, Any]
_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29)


@dataclass(frozen=True)
class Plausible:
    """The plausible values of one input.

    Attributes
    ----------
    name : str
    unit : str
    low, high : float or None
        Ends of a range.
    logarithmic : bool
        Whether the range is sampled evenly in the logarithm.
    values : tuple
        The values of a choice, instead of a range.
    parameter : str
        The parameter of the table that it stands for, where that has another name.
    """

    name: str
    unit: str = "1"
    low: float | None = None
    high: float | None = None
    logarithmic: bool = False
    values: tuple = ()
    parameter: str = ""

    def __post_init__(self) -> None:
        if self.values:
            return
        if self.low is None or self.high is None or not self.low < self.high:
            raise InputError(field=self.name, value=(self.low, self.high), expected="a range low < high or values")
        if self.logarithmic and self.low <= 0:
            raise InputError(field=self.name, value=self.low, expected="a positive range for logarithmic sampling")

    def at(self, fraction: float) -> Any:
        """Return the value at a fraction 0..1 of the range, or of the list of values."""
        if self.values:
            return self.values[min(int(fraction * len(self.values)), len(self.values) - 1)]
        low, high = self.ends
        return low * (high / low) ** fraction if self.logarithmic else low + fraction * (high - low)

    @property
    def ends(self) -> tuple[Any, Any]:
        """The two ends of the range, or the first and last of the values."""
        return (self.values[0], self.values[-1]) if self.values else (self.low, self.high)

    def fraction(self, value: Any) -> float:
        """Return the fraction of the range at which a value lies, the inverse of `at`."""
        if self.values:
            return self.values.index(value) / max(len(self.values) - 1, 1)
        low, high = self.ends
        if self.logarithmic:
            return math.log(value / low) / math.log(high / low)
        return (value - low) / (high - low)

    def to_json(self) -> dict[str, Any]:
        """Return what a result file says of the input."""
        ends = {"values": list(self.values)} if self.values else {"low": self.low, "high": self.high}
        parameter = self.parameter or self.name
        return {
            "name": self.name,
            "unit": self.unit,
            **ends,
            "logarithmic": self.logarithmic,
            "parameter": parameter,
        }

    @classmethod
    def from_json(cls, entry: Mapping[str, Any]) -> "Plausible":
        """Return the input that a result file speaks of."""
        return cls(**{**entry, "values": tuple(entry.get("values", ()))})


def plausible(case: Any, name: str, *, logarithmic: bool = False) -> Plausible:
    """Read the plausible values of a parameter from a paper's table, in SI units.

    Parameters
    ----------
    case : gainsay.tables.Case
    name : str
        A parameter with the status `assumed`.
    logarithmic : bool
        Whether to sample a range evenly in the logarithm.

    Raises
    ------
    InputError
        If the table gives no plausible values.
    """
    from gainsay.tables.units import to_si

    row = case.parameters.get(name)
    if row is None or not row.plausible:
        raise InputError(
            file=f"papers/{case.name}/parameters.csv", field="plausible", value=name, expected="its plausible values"
        )
    unit, factor = to_si(row.unit)
    low, dots, high = row.plausible.partition("..")
    if row.type == "number" and dots:
        return Plausible(name, unit, float(low) * float(factor), float(high) * float(factor), logarithmic)
    words = row.plausible.split("|")
    return Plausible(
        name, unit, values=tuple(float(w) * float(factor) for w in words) if row.type == "number" else tuple(words)
    )


def nearest(
    inputs: Sequence[Plausible], some: Sequence[Mapping[str, Any]], others: Sequence[Mapping[str, Any]]
) -> list[tuple[int, int]]:
    """Return the pairs of some points and others by number, nearest first, each input as a fraction of its range."""
    squares = np.zeros((len(some), len(others)))
    for one in inputs:
        here, there = (np.array([one.fraction(point[one.name]) for point in points]) for points in (some, others))
        squares += (here[:, None] - there) ** 2
    order = np.argsort(squares, axis=None, kind="stable")
    return [(int(i), int(j)) for i, j in zip(*np.unravel_index(order, squares.shape), strict=True)]


def fractions(dimensions: int, seed: int) -> Iterator[tuple[float, ...]]:
    """Yield the points of the sequence in the unit cube, without end.

    Parameters
    ----------
    dimensions : int
    seed : int
        Of the shift.
    """
    if dimensions > len(_PRIMES):
        raise InputError("inputs of a scan", value=dimensions, expected=f"at most {len(_PRIMES)}")
    source = random.Random(seed)
    shift = [source.random() for _ in range(dimensions)]
    index = 0
    while True:
        index += 1
        yield tuple((s + _mirrored(index, b)) % 1.0 for s, b in zip(shift, _PRIMES, strict=False))


def _mirrored(index: int, base: int) -> float:
    """Digits of an integer mirrored at the point: the radical inverse."""
    value, place = 0.0, 1.0
    while index:
        index, digit = divmod(index, base)
        place /= base
        value += digit * place
    return value


def sample(
    inputs: Sequence[Plausible], samples: int, seed: int, admissible: Callable[[Mapping], bool] | None = None
) -> list[Point]:
    """Draw points from the plausible values of the inputs.

    Parameters
    ----------
    inputs : sequence of Plausible
    samples : int
        Number of admissible points.
    seed : int
    admissible : callable, optional
        Says whether inputs fit together, such as moments of inertia; others are passed over.

    Raises
    ------
    InputError
        If fewer than one point in a hundred is admissible.
    """
    return [dict(point) for point in _drawn(tuple(inputs), samples, seed, admissible)]


@lru_cache(maxsize=16)
def _drawn(
    inputs: tuple[Plausible, ...], samples: int, seed: int, admissible: Callable[[Mapping], bool] | None
) -> tuple[Point, ...]:
    """Draw the points of a sample, kept for the other scans over the same inputs."""
    points: list[Point] = []
    for number, fraction in enumerate(fractions(len(inputs), seed)):
        if number > 100 * max(samples, 10):
            raise InputError("hardly any plausible inputs fit together", value=f"{len(points)} of {number} drawn")
        point = {p.name: p.at(f) for p, f in zip(inputs, fraction, strict=True)}
        if admissible is None or admissible(point):
            points.append(point)
            if len(points) == samples:
                return tuple(points)
    raise AssertionError("the sequence does not end")


def readings(inputs: Sequence[Plausible], admissible: Callable[[Mapping], bool] | None = None) -> list[Point]:
    """Return every combination of inputs of which each has a list of values.

    Raises
    ------
    InputError
        If an input has a range: there is no end to its values.
    """
    for one in inputs:
        if not one.values:
            raise InputError(field=one.name, value=(one.low, one.high), expected="a list of values")
    points = [dict(zip((p.name for p in inputs), row, strict=True)) for row in product(*(p.values for p in inputs))]
    return [point for point in points if admissible is None or admissible(point)]


def corners(inputs: Sequence[Plausible], admissible: Callable[[Mapping], bool] | None = None) -> list[Point]:
    """Return the admissible corners of the plausible values: every input at one of its ends.

    What holds at scattered points often fails first in a corner, which no scattered point comes near in many
    dimensions.

    Raises
    ------
    InputError
        With more than ten inputs.
    """
    if len(inputs) > len(_PRIMES):
        raise InputError("inputs of a scan", value=len(inputs), expected=f"at most {len(_PRIMES)}")
    points = [dict(zip((p.name for p in inputs), ends, strict=True)) for ends in product(*(p.ends for p in inputs))]
    return [point for point in points if admissible is None or admissible(point)]

"""Exact responses of autonomous linear systems dx/dt = A x, with located extremes of their outputs.

Constant and sinusoidal inputs are states of the system (`with_harmonics`), so that no input is interpolated and no
integrator is needed: a state is a matrix exponential times the start.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy  # its packages are loaded when they are used

from gainsay.errors import ComputationError, InputError
from gainsay.exact.floats import real_array, real_number
from gainsay.simulation.summits import resolution

#: most evaluations at a turn; part of a step within which Newton's next one squares to rounding
_ITERATIONS, _CLOSE = 60, 1e-7
#: s, to which crossings are located, and the part of a response that is shorter than a second
_LOCATED = 1e-10


@dataclass(frozen=True)
class Peak:
    """Largest value of an output, or of its modulus: when, and the signed value."""

    time: float
    value: float


class Response:
    """Solution of dx/dt = A x from a start on 0..end, sampled at equal steps and exact between them.

    Parameters
    ----------
    A : ndarray, shape (n, n)
    start : ndarray, shape (n,)
    end : float
        s.
    steps : int
        Number of steps; every output is monotonic within one where extremes are to be found.

    Attributes
    ----------
    step : float
        s.
    states : ndarray, shape (steps + 1, n)

    Raises
    ------
    InputError
        If an entry is not finite, shapes do not fit, the end is not positive or the steps are no count.
    ComputationError
        If the state leaves double precision.
    """

    def __init__(self, A: np.ndarray, start: np.ndarray, end: float, steps: int) -> None:
        self.A, self.end = real_array(A, "A"), real_number(end, "end")
        start = real_array(start, "start")
        if self.A.shape != (start.size, start.size):
            raise InputError("start", value=start.shape, expected=f"shape ({self.A.shape[0]},)")
        if not (end > 0 and isinstance(steps, int | np.integer) and steps >= 1):
            raise InputError("response", value=(end, steps), expected="a positive end and at least one whole step")
        self.steps, self.step = steps, self.end / steps
        self.states = np.empty((steps + 1, start.size))
        self.states[0] = start
        # Doubling: rows filled so far times the exponential over their span give as many rows again.
        filled, span = 1, scipy.linalg.expm(self.A * self.step)
        with np.errstate(over="ignore", invalid="ignore"):  # the states are looked at
            while filled <= steps:
                more = min(filled, steps + 1 - filled)
                self.states[filled : filled + more] = self.states[:more] @ span.T
                filled += more
                if filled <= steps:
                    span = span @ span
        if not np.isfinite(self.states).all():
            lost = float(self.time[~np.isfinite(self.states).all(axis=1)][0])
            raise ComputationError("response", f"the state leaves double precision before {lost:g} s")

    @cached_property
    def time(self) -> np.ndarray:
        """Times of the samples, shape (steps + 1,)."""
        return np.linspace(0.0, self.end, self.steps + 1)

    def at(self, time: float) -> np.ndarray:
        """State at any time of 0..end, by the exponential from the sample before it; InputError for any other."""
        if not -1e-9 * self.end <= real_number(time, "time") <= (1 + 1e-9) * self.end:
            raise InputError("response", field="time", value=time, expected=f"0..{self.end:g} s")
        index = min(max(int(time / self.step), 0), self.steps)
        return scipy.linalg.expm(self.A * (time - self.time[index])) @ self.states[index]

    @property
    def _located(self) -> float:
        """Distance to which crossings are located, s."""
        return resolution(_LOCATED, self.end)

    def _row(self, output: np.ndarray) -> np.ndarray:
        output = real_array(output, "output")
        if output.shape != (len(self.A),):
            raise InputError("", field="output", value=output.shape, expected=f"shape ({len(self.A)},)")
        return output

    def peak(self, output: np.ndarray) -> Peak:
        """Locate the largest modulus of a linear output c x over continuous time.

        Parameters
        ----------
        output : ndarray, shape (n,)
            c.

        Returns
        -------
        Peak
        """
        return Consecutive([(0.0, self)]).peak(output)

    def largest(self, output: np.ndarray) -> Peak:
        """Locate the largest value of a linear output c x over continuous time; that of -c is the least."""
        return Consecutive([(0.0, self)]).largest(output)

    def _turn(self, rows: np.ndarray, index: int) -> tuple[float, float]:
        """Time after a sample at which an output turns within the step, and its value there, by Newton's method.

        `rows` times the state are the output, its slope and the slope's slope. Where a step of Newton's leaves the
        bracket of the turn, the bracket is halved.
        """
        (start, first, bend), (stop, last, other) = (self.states[index : index + 2] @ rows.T).tolist()
        low, high = 0.0, self.step
        after = self.step * _turn_of_quintic(
            stop - start, self.step * first, self.step * last, self.step**2 * bend, self.step**2 * other
        )
        for _ in range(_ITERATIONS):
            value, slope, bend = rows @ (scipy.linalg.expm(self.A * after) @ self.states[index])
            if slope * first > 0:
                low = after
            else:
                high = after
            further = after - slope / bend if bend else low
            if not low <= further <= high:
                further = 0.5 * (low + high)
            moved, after = abs(further - after), further
            if moved <= _CLOSE * self.step:
                break
        # So close to a turn the parabola through the last point gives its value.
        parabola = bend and abs(slope) < abs(bend) * self.step
        return after, float(value - 0.5 * slope**2 / bend) if parabola else float(value)

    def last_above(self, output: np.ndarray, level: float) -> float:
        """Time after which |c x| stays below a level up to the end; the end itself where it never settles."""
        output, level = self._row(output), real_number(level, "level")
        above = np.flatnonzero(np.abs(self.states @ output) >= level)
        last = int(above[-1]) if len(above) else -1
        if last == self.steps:
            return self.end
        ends = (self.time[last], self.time[last + 1]) if len(above) else None
        later = range(self.steps - 1, max(last, 0) - 1, -1)
        for k, turn in self._passes(output, np.abs, level, later):
            ends = turn, self.time[k + 1]
            break
        return 0.0 if ends is None else self._root(lambda x: abs(float(output @ x)) - level, *ends)

    def first_crossing(self, output: np.ndarray, level: float) -> float:
        """Time at which c x first passes a level, such as a rise time; the end itself where it never does."""
        output, level = self._row(output), real_number(level, "level")
        values = self.states @ output - level
        if values[0] == 0:
            return 0.0
        side = -np.sign(values[0])
        passed = np.flatnonzero(side * values >= 0)
        first = int(passed[0]) if len(passed) else self.steps + 1
        ends = (self.time[first - 1], self.time[first]) if len(passed) else None
        for k, turn in self._passes(output, lambda value: side * value, side * level, range(min(first, self.steps))):
            ends = self.time[k], turn
            break
        return self.end if ends is None else self._root(lambda x: float(output @ x) - level, *ends)

    def _passes(
        self, output: np.ndarray, size: Callable[[Any], Any], level: float, steps: Sequence[int]
    ) -> Iterator[tuple[int, float]]:
        """Yield those of some steps within which an output turns at a size from a level on, and when it turns."""
        rows = np.array([output, output @ self.A, output @ self.A @ self.A])
        values, slopes = self.states @ rows[0], self.states @ rows[1]
        reach = np.maximum(size(values[:-1]), size(values[1:]))
        reach = reach + self.step * np.maximum(np.abs(slopes[:-1]), np.abs(slopes[1:]))
        may = (slopes[:-1] * slopes[1:] < 0) & (reach >= level)
        for k in (k for k in steps if may[k]):
            after, value = self._turn(rows, k)
            if size(value) >= level:
                yield k, float(self.time[k] + after)

    def _root(self, function: Callable[[np.ndarray], float], low: float, high: float) -> float:
        """Time at which a function of the state is zero between two; the first where it is barely touched there."""
        if function(self.at(low)) * function(self.at(high)) > 0:
            return float(low)
        return float(scipy.optimize.brentq(lambda t: function(self.at(t)), low, high, xtol=self._located))


class Consecutive:
    """Responses that follow one another in time, as one: what is largest is located over all of them.

    Parameters
    ----------
    pieces : sequence of (float, Response)
        When each begins, s, and what it is; all have as many states.
    """

    def __init__(self, pieces: Sequence[tuple[float, Response]]) -> None:
        self.pieces = list(pieces)
        counts = [len(response.states) for _, response in self.pieces]
        self._first = np.cumsum([0, *counts[:-1]])  # number of each piece's first sample among all
        self._steps = np.repeat([response.step for _, response in self.pieces], counts)
        self._steps[np.cumsum(counts) - 1] = 0.0  # no step goes from a last sample

    def peak(self, output: np.ndarray) -> Peak:
        """Locate the largest modulus of a linear output c x over continuous time, as `Response.peak`."""
        return self._farthest(output, np.abs)

    def largest(self, output: np.ndarray) -> Peak:
        """Locate the largest value of a linear output c x over continuous time, as `Response.largest`."""
        return self._farthest(output, np.positive)

    def last_above(self, output: np.ndarray, level: float) -> float:
        """Time after which |c x| stays below a level up to the end, as `Response.last_above`."""
        for begin, response in reversed(self.pieces):
            if last := response.last_above(output, level):
                return begin + last
        return 0.0

    def _farthest(self, output: np.ndarray, size: Callable[[Any], Any]) -> Peak:
        """Locate where the size of an output, its modulus or itself, is largest."""
        output = self.pieces[0][1]._row(output)
        values = np.concatenate([response.states @ output for _, response in self.pieces])
        slopes = np.concatenate([response.states @ (output @ response.A) for _, response in self.pieces])
        sizes, steepness = size(values), np.abs(slopes)
        best = int(sizes.argmax())
        piece, row = self._place(best)
        begin, response = self.pieces[piece]
        largest = Peak(begin + row * response.step, float(values[best]))
        # A step cannot raise the output by more than its length times the larger slope at its ends.
        most = np.maximum(sizes[:-1], sizes[1:]) + self._steps[:-1] * np.maximum(steepness[:-1], steepness[1:])
        turns = (slopes[:-1] * slopes[1:] < 0) & (self._steps[:-1] > 0)
        worth = np.flatnonzero(turns & (most > sizes[best]))
        for k in worth[np.argsort(-most[worth])].tolist():
            if most[k] <= size(largest.value):  # nor can those that follow
                break
            piece, row = self._place(k)
            begin, response = self.pieces[piece]
            rows = np.array([output, output @ response.A, output @ response.A @ response.A])
            after, value = response._turn(rows, row)
            if size(value) > size(largest.value):
                largest = Peak(begin + row * response.step + after, value)
        return largest

    def _place(self, sample: int) -> tuple[int, int]:
        """Piece and row in it of a sample of all."""
        piece = int(np.searchsorted(self._first, sample, side="right")) - 1
        return piece, sample - int(self._first[piece])


def _turn_of_quintic(rise: float, first: float, last: float, bend: float, other: float) -> float:
    """Where in 0..1 the quintic turns that has these slopes and second derivatives at 0 and 1, and rises by so much.

    Its slopes have different signs at the ends: some steps of Newton's method from where their chord is zero, which is
    the answer where they lead outside.
    """
    # Coefficients of the slope, a quartic, by powers.
    short, tilt, curve = rise - first - 0.5 * bend, last - first - bend, other - bend
    cubic = 10 * short - 4 * tilt + 0.5 * curve
    quartic = -15 * short + 7 * tilt - curve
    quintic = 6 * short - 3 * tilt + 0.5 * curve
    at = first / (first - last)
    for _ in range(3):
        slope = first + at * (bend + at * (3 * cubic + at * (4 * quartic + at * 5 * quintic)))
        bent = bend + at * (6 * cubic + at * (12 * quartic + at * 20 * quintic))
        at -= slope / bent if bent else 0.0
    return at if 0 <= at <= 1 else first / (first - last)


def with_harmonics(
    A: np.ndarray, shape: np.ndarray, rates: Sequence[float], amplitude: float, constant: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Append sum of amplitude * sin(rate t) plus a constant as states that drive the system through `shape`.

    Parameters
    ----------
    A : ndarray, shape (n, n)
    shape : ndarray, shape (n,)
        How the scalar signal enters.
    rates : sequence of float
        rad/s.
    amplitude, constant : float

    Returns
    -------
    A : ndarray, shape (n + 2 len(rates) + 1,) * 2
        The further states are sin, cos of every rate, then one.
    start : ndarray
        Start of the further states at time 0.

    Raises
    ------
    InputError
        If an entry is not finite or shapes do not fit.
    """
    A, shape, turns = real_array(A, "A"), real_array(shape, "shape"), real_array(rates, "rates")
    amplitude, constant = real_number(amplitude, "amplitude"), real_number(constant, "constant")
    if turns.ndim != 1 or shape.ndim != 1 or A.shape != (len(shape), len(shape)):
        sizes = (A.shape, shape.shape, turns.shape)
        raise InputError("", field="A, shape, rates", value=sizes, expected="shapes (n, n), (n,) and (k,)")
    n, k = A.shape[0], len(turns)
    whole = np.zeros((n + 2 * k + 1, n + 2 * k + 1))
    whole[:n, :n] = A
    start = np.zeros(2 * k + 1)
    for i, rate in enumerate(turns):
        s = n + 2 * i
        whole[s, s + 1], whole[s + 1, s] = rate, -rate
        whole[:n, s] = amplitude * shape
        start[2 * i + 1] = 1.0
    whole[:n, -1] = constant * shape
    start[-1] = 1.0
    return whole, start

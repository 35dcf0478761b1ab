"""Many flights of one system at once: one collocation over all starts, with the tolerance kept for each of them.

x' = M x + N g(t, x), where g varies little over a step: a step is solved for all flights by products of matrices. It is
as long as the polynomial of every flight resolves its solution, so that states between steps are as good as those at
their ends. Flights come in segments of time, so that memory stays bounded however long they are.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from gainsay.errors import ComputationError, InputError
from gainsay.exact.floats import real_array, real_number
from gainsay.simulation.radau import Radau, Step

#: g(times (s,), states (s, m, n)) -> (s, m, q)
Rest = Callable[[np.ndarray, np.ndarray], np.ndarray]
#: (states (k, n), times (k,)) -> values (k,)
Output = Callable[[np.ndarray, np.ndarray], np.ndarray]

_GOLDEN = (np.sqrt(5) - 1) / 2
_HALVINGS = 60
_RULE = Radau(8)
#: part of the tolerance to which the iteration of a step settles, and the most iterations before the step is halved
_SETTLED, _MOST_ITERATIONS = 0.01, 12
#: part of the tolerance that lets the next step be twice as long: the highest terms grow by up to 2^s
_EASY = 2.0 ** -(_RULE.stages + 1)
#: shortest step, as a part of the whole
_SHORTEST = 1e-12
_TINY = 1e-300
#: parts of a time to which peaks and crossings are located
_PEAK, _CROSSING = 1e-9, 1e-12


@dataclass(frozen=True)
class Segment:
    """All flights over a stretch of time.

    Attributes
    ----------
    steps : ndarray, shape (k + 1,)
        Ends of the integrator's steps from the first to the last time of the segment, s.
    starts : ndarray, shape (k, n, m)
        States of m flights before each step.
    slopes : ndarray, shape (k, s, n, m)
        Slopes at the points of each step.
    """

    steps: np.ndarray
    starts: np.ndarray
    slopes: np.ndarray

    def grid(self, refine: int) -> np.ndarray:
        """Return so many times a step, and the last time, s."""
        inner = self.steps[:-1, None] + np.arange(refine) / refine * np.diff(self.steps)[:, None]
        return np.append(inner.ravel(), self.steps[-1])

    def __call__(self, times: np.ndarray) -> np.ndarray:
        """Return the states of all flights at some times, shape (len(times), m, n)."""
        step, weights = self._places(np.asarray(times, dtype=float))
        (k, s, n, m), order = self.slopes.shape, np.argsort(step, kind="stable")
        states, slopes = self.starts[step].reshape(-1, n * m), self.slopes.reshape(k, s, n * m)
        seen, first = np.unique(step[order], return_index=True)
        for one, at in zip(seen, np.split(order, first[1:]), strict=False):  # of no times there is one empty part
            states[at] += weights[at] @ slopes[one]
        return states.reshape(-1, n, m).swapaxes(1, 2)

    def outputs(self, C: np.ndarray) -> "Segment":
        """Return the segment of the outputs C x of all flights, C of shape (p, n): p states in place of n."""
        return Segment(self.steps, C @ self.starts, C @ self.slopes)

    def chosen(self, flights: np.ndarray) -> "Segment":
        """Return the segment of some of the flights."""
        return Segment(self.steps, self.starts[..., flights], self.slopes[..., flights])

    def bounds(self) -> np.ndarray:
        """Return what no state of a flight exceeds in modulus over the segment, shape (m, n); cheap and wide."""
        lengths = np.diff(self.steps)[:, None, None]
        reach = np.abs(self.starts) + lengths * _RULE.amplification * np.abs(self.slopes).max(axis=1)
        return reach.max(axis=0).T

    def of(self, flights: np.ndarray, times: np.ndarray) -> np.ndarray:
        """Return the states of chosen flights, each at a time of its own, shape (len(flights), n)."""
        step, weights = self._places(times)
        return self.starts[step, :, flights] + np.einsum("ks,ksn->kn", weights, self.slopes[step, :, :, flights])

    def _places(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The step in which each time lies, and the weights of the slopes of that step."""
        step = np.clip(np.searchsorted(self.steps, times) - 1, 0, len(self.steps) - 2)
        h = np.diff(self.steps)[step]
        return step, h[:, None] * _RULE.integrals((times - self.steps[step]) / h)


def segments(
    linear: np.ndarray,
    entry: np.ndarray,
    rest: Rest,
    starts: np.ndarray,
    end: float,
    *,
    rtol: float,
    atol: np.ndarray,
    length: float,
) -> Iterator[Segment]:
    """Integrate x' = linear x + entry g(t, x) for all flights from 0 to `end` and yield them segment by segment.

    Parameters
    ----------
    linear, entry : ndarray
        Shapes (n, n) and (n, q); the linear part may be stiff.
    rest : callable
        g(times (s,), states (s, m, n)) -> (s, m, q), smooth.
    starts : ndarray, shape (m, n)
    end : float
        s.
    rtol : float
        Relative tolerance of each flight, per step: the root mean square, over its states, of what the two highest
        Legendre polynomials of a step add to it stays below.
    atol : ndarray, shape (n,)
        Absolute tolerances.
    length : float
        Length of a segment, s.

    Raises
    ------
    InputError
        If there is no flight, a length, the end or a tolerance is not positive, shapes disagree, or what should be
        numbers is not.
    ComputationError
        If the steps become too short to go on, or g is not a number, with the time.
    """
    linear, entry, starts, atol = (
        real_array(value, name)
        for name, value in (("linear", linear), ("entry", entry), ("starts", starts), ("atol", atol))
    )
    if starts.ndim != 2 or not starts.size:
        raise InputError("flights", field="starts", value=starts.shape, expected="shape (m, n)")
    n = starts.shape[1]
    if linear.shape != (n, n) or entry.ndim != 2 or len(entry) != n:
        raise InputError("flights", field="linear, entry", value=(linear.shape, entry.shape), expected=f"{n} rows")
    for name, value in (("end", end), ("length", length), ("rtol", rtol)):
        if not real_number(value, name) > 0:
            raise InputError("flights", field=name, value=value, expected="above 0")
    if atol.shape != (n,) or not (atol >= 0).all():
        raise InputError("flights", field="atol", value=atol.tolist(), expected="one number a state, >= 0")
    stepper = Stepper(linear, entry, rest, rtol, atol[:, None], min(length, end), _SHORTEST * end)
    time, state = 0.0, starts.T
    while time < end:
        part, state = stepper.segment(time, state, min(time + length, end))
        yield part
        time = float(part.steps[-1])


@dataclass
class Stepper:
    """Steps of all flights, of states (n, m).

    Parameters
    ----------
    linear, entry, rest, rtol
        As in `segments`.
    atol : ndarray, shape (n, 1)
    h, shortest : float
        Length of the next step, and the shortest there may be, s.
    """

    linear: np.ndarray
    entry: np.ndarray
    rest: Rest
    rtol: float
    atol: np.ndarray
    h: float
    shortest: float
    latest: np.ndarray | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self.maps = lru_cache(maxsize=64)(lambda h: Step.of(_RULE, h, self.linear, self.entry))

    def segment(self, time: float, state: np.ndarray, stop: float) -> tuple[Segment, np.ndarray]:
        """Steps from a state at one time to another, and the state there."""
        steps, before, slopes = [time], [], []
        while time < stop:
            taken = min(self.h, stop - time)
            slope, following, size = self.tried(time, state, taken)
            if not size <= 1:
                self.h = taken / 2
                if self.h < self.shortest:
                    raise ComputationError("flights", f"the steps become too short at t = {time!r} s")
                continue
            # a step that ends a segment may be a short one: it says nothing against the length of the others
            if size < _EASY and taken == self.h:
                self.h = 2 * taken
            time = stop if taken == stop - time else time + taken
            steps.append(time)
            before.append(state)
            slopes.append(slope)
            state = following
        return Segment(np.array(steps), np.array(before), np.array(slopes)), state

    def tried(self, time: float, state: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray, float]:
        """Slopes (s, n, m) and state at the end of a step, and the size of its highest terms in tolerances.

        The size is not a number where the iteration does not settle.
        """
        s, (n, m) = _RULE.stages, state.shape
        maps, times = self.maps(h), time + h * _RULE.nodes
        # whatever leaves double precision is of a step that is too long
        with np.errstate(over="ignore", invalid="ignore"):
            by_state, by_rest = maps.states
            free = by_state @ state
            points = free if self.latest is None else free + by_rest @ np.tile(self.latest, (s, 1))
            for _ in range(_MOST_ITERATIONS):
                rest = self._rest(times, points.reshape(s, n, m))
                before, points = points, free + by_rest @ rest
                if self._size((points - before).reshape(s, n, m), state) <= _SETTLED:
                    break
            else:
                return points, state, float("nan")
            slopes = (maps.slopes[0] @ state + maps.slopes[1] @ rest).reshape(s, n, m)
            highest = h * np.tensordot(_RULE.highest, slopes, 1)
            size = self._size(highest, state)
        if size <= 1:
            self.latest = rest[-self.entry.shape[1] :]
        return slopes, points[-n:], size

    def _size(self, changes: np.ndarray, state: np.ndarray) -> float:
        """Root mean square over the states of a change in tolerances, where it is largest; changes are (k, n, m)."""
        scaled = changes / (self.atol + self.rtol * np.abs(state) + _TINY)
        return float(np.sqrt((scaled**2).mean(axis=1).max()))

    def _rest(self, times: np.ndarray, points: np.ndarray) -> np.ndarray:
        """The rest at the points of a step, one below the other, shape (s q, m)."""
        (s, _, m), q = points.shape, self.entry.shape[1]
        given = real_array(self.rest(times, points.swapaxes(1, 2)), "rest", finite=False)
        if given.shape != (s, m, q):
            raise InputError("flights", field="rest", value=given.shape, expected=f"shape {(s, m, q)}")
        if np.isnan(given).any() and np.isfinite(points).all():
            raise ComputationError("flights", f"the rest is not a number at t = {float(times[0])!r} s")
        return given.swapaxes(1, 2).reshape(s * q, m)


def _least_size(segment: Segment) -> float:
    """Size of a time near zero, s: a second, or the end of a segment that ends before."""
    return min(1.0, float(segment.steps[-1]))


def polished_peak(
    segment: Segment, flights: np.ndarray, low: np.ndarray, high: np.ndarray, output: Output
) -> np.ndarray:
    """Return the largest value of an output between two times of each chosen flight, by golden sections.

    Parameters
    ----------
    segment : Segment
    flights : ndarray of int, shape (k,)
    low, high : ndarray, shape (k,)
        Times between which the output of each has one maximum, s.
    output : callable
        (states (k, n), times (k,)) -> (k,).
    """

    def value(times: np.ndarray) -> np.ndarray:
        return output(segment.of(flights, times), times)

    low, high = low.copy(), high.copy()
    best = np.maximum(value(low), value(high))
    inner, outer = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_inner, at_outer = value(inner), value(outer)
    for _ in range(_HALVINGS):
        left = at_inner > at_outer
        high, low = np.where(left, outer, high), np.where(left, low, inner)
        inner_next = np.where(left, high - _GOLDEN * (high - low), outer)
        outer_next = np.where(left, inner, low + _GOLDEN * (high - low))
        best = np.maximum(best, np.maximum(at_inner, at_outer))
        fresh = value(np.where(left, inner_next, outer_next))
        at_inner, at_outer = np.where(left, fresh, at_outer), np.where(left, at_inner, fresh)
        inner, outer = inner_next, outer_next
        if np.all(high - low <= _PEAK * np.maximum(high, _least_size(segment))):
            break
    return np.maximum(best, np.maximum(at_inner, at_outer))


def polished_crossing(
    segment: Segment, flights: np.ndarray, low: np.ndarray, high: np.ndarray, output: Output
) -> np.ndarray:
    """Return the time at which the output of each chosen flight turns from positive to negative, by bisection, s.

    Parameters as for `polished_peak`; the output is not negative at `low` and negative at `high`.
    """
    low, high = low.copy(), high.copy()
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        positive = output(segment.of(flights, middle), middle) >= 0
        low, high = np.where(positive, middle, low), np.where(positive, high, middle)
        if np.all(high - low <= _CROSSING * np.maximum(high, _least_size(segment))):
            break
    return 0.5 * (low + high)

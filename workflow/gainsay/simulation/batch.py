"""Many flights of one system at once: one integration over all starts, with the tolerance kept for each of them.

The error of a step is measured over all flights together; the tolerance is divided by the root of their number, so that
no single flight's error, in the same root mean square over its states, exceeds what was asked. Flights come in segments
of time, each with dense output, so that memory stays bounded however long they are.

References
----------
E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary Differential Equations I", 2nd ed., Springer, 1993, section II.4
(error control by a norm over the components), II.10 (DOP853 and its dense output).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy  # its packages are loaded when they are used

from gainsay.errors import ComputationError, InputError
from gainsay.exact.floats import real_array, real_number
from gainsay.simulation.ode import Guarded

if TYPE_CHECKING:
    from scipy.integrate import OdeSolution

#: f(t, states (m, n)) -> slopes (m, n)
Slopes = Callable[[float, np.ndarray], np.ndarray]
#: (states (k, n), times (k,)) -> values (k,)
Output = Callable[[np.ndarray, np.ndarray], np.ndarray]

_GOLDEN = (np.sqrt(5) - 1) / 2
_HALVINGS = 60


@dataclass(frozen=True)
class Segment:
    """All flights over a stretch of time.

    Attributes
    ----------
    steps : ndarray, shape (k,)
        Ends of the integrator's steps from the first to the last time of the segment, s.
    shape : tuple of int
        Number of flights, number of states.
    """

    steps: np.ndarray
    shape: tuple[int, int]
    _solution: "OdeSolution"

    def grid(self, refine: int) -> np.ndarray:
        """Return so many times a step, and the last time, s."""
        inner = self.steps[:-1, None] + np.arange(refine) / refine * np.diff(self.steps)[:, None]
        return np.append(inner.ravel(), self.steps[-1])

    def __call__(self, times: np.ndarray) -> np.ndarray:
        """Return the states of all flights at some times, shape (len(times), m, n)."""
        return self._solution(np.asarray(times)).T.reshape(-1, *self.shape)

    def of(self, flights: np.ndarray, times: np.ndarray) -> np.ndarray:
        """Return the states of chosen flights, each at a time of its own, shape (len(flights), n)."""
        states = np.empty((len(flights), self.shape[1]))
        steps = np.clip(np.searchsorted(self.steps, times) - 1, 0, len(self.steps) - 2)
        for step in np.unique(steps):
            at = steps == step
            states[at] = self._within(self._solution.interpolants[step], flights[at], times[at])
        return states

    def _within(self, step: Any, flights: np.ndarray, times: np.ndarray) -> np.ndarray:
        """The polynomial of one step (Hairer, II.6, as SciPy nests it) for the states of chosen flights alone."""
        share = ((times - step.t_old) / step.h)[:, None]
        value = np.zeros((len(flights), self.shape[1]))
        for number, part in enumerate(reversed(step.F)):
            value += part.reshape(self.shape)[flights]
            value *= 1 - share if number % 2 else share
        return value + step.y_old.reshape(self.shape)[flights]


def segments(
    slopes: Slopes, starts: np.ndarray, end: float, *, rtol: float, atol: np.ndarray, length: float
) -> Iterator[Segment]:
    """Integrate all flights from 0 to `end` and yield them segment by segment.

    Parameters
    ----------
    slopes : callable
        f(t, states (m, n)) -> slopes (m, n), smooth.
    starts : ndarray, shape (m, n)
    end : float
        s.
    rtol : float
        Relative tolerance of each flight, per step.
    atol : ndarray, shape (n,)
        Absolute tolerances.
    length : float
        Length of a segment, s.

    Raises
    ------
    InputError
        If there is no flight, a length, the end or a tolerance is not positive, or the slopes are no numbers.
    ComputationError
        If the integrator gives up or stands still, or a slope is no number, with the time.
    """
    starts, atol = real_array(starts, "starts"), real_array(atol, "atol")
    if starts.ndim != 2 or not starts.size:
        raise InputError("flights", field="starts", value=starts.shape, expected="shape (m, n)")
    for name, value in (("end", end), ("length", length), ("rtol", rtol)):
        if not real_number(value, name) > 0:
            raise InputError("flights", field=name, value=value, expected="above 0")
    if atol.shape != starts.shape[1:] or not (atol >= 0).all():
        raise InputError("flights", field="atol", value=atol.tolist(), expected="one number a state, >= 0")
    shape, share = starts.shape, 1 / np.sqrt(len(starts))
    flat_atol = np.tile(share * atol, len(starts))

    def flat(t: float, state: np.ndarray) -> np.ndarray:
        given = np.asarray(slopes(t, state.reshape(shape)))
        if given.shape != shape:
            raise InputError("flights", field="slopes", value=given.shape, expected=f"shape {shape}")
        return given.ravel()

    guarded = Guarded(flat, starts.size, end)
    time, state, first = 0.0, starts.ravel(), None
    while time < end:
        stop = min(time + length, end)
        solution = scipy.integrate.solve_ivp(
            guarded,
            (time, stop),
            state,
            "DOP853",
            rtol=share * rtol,
            atol=flat_atol,
            dense_output=True,
            first_step=None if first is None else min(first, stop - time),
        )
        if solution.status < 0 or not np.isfinite(solution.y[:, -1]).all():
            raise ComputationError(
                "flights", f"the integration ended at t = {float(solution.t[-1])!r} s: {solution.message}"
            )
        yield Segment(solution.t, shape, solution.sol)
        time, state = stop, solution.y[:, -1]
        first = float(np.diff(solution.t)[-2]) if len(solution.t) > 2 else None


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
        if np.all(high - low <= 1e-9 * np.maximum(high, 1.0)):
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
        if np.all(high - low <= 1e-12 * np.maximum(high, 1.0)):
            break
    return 0.5 * (low + high)

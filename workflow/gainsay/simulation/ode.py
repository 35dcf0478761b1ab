"""Adaptive integration of ordinary differential equations with dense output, located kinks, extremes and crossings.

References
----------
.. [1] E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary Differential Equations I", 2nd ed., Springer, 1993,
   section II.10 (DOP853 and its dense output of order 7).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy  # its packages are loaded when they are used

from gainsay.errors import ComputationError, InputError
from gainsay.exact.floats import real_array, real_number, real_row
from gainsay.simulation.summits import may_pass, polished, resolution, summits

if TYPE_CHECKING:
    from scipy.integrate import OdeSolution

Function = Callable[[float, np.ndarray], np.ndarray]
#: s by which a kink is left behind, and the part of an integration that is shorter than a second
_NUDGE = 1e-9
#: s, to which peaks and crossings are located, likewise
_PEAK, _CROSSING = 1e-10, 1e-12
#: what SciPy says of a matrix that it cannot factor
_NOT_FINITE = "infs or NaNs"
_MAX_KINKS = 10_000
#: so many kinks within this part of the whole are a solution that slides along one of them
_SLIDING, _TOGETHER = 200, 1e-6
#: most corrections of the time of a kink, and the part of a step that is none
_MOST_MOVES, _SETTLED = 4, 1e-9
METHODS = ("RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA")
#: evaluations of the right-hand side within which time must go on by more than this part of the whole
_STILL, _SMALLEST = 20_000, 1e-9
#: points looked at in every step of the integrator before peaks and crossings are polished on the dense output
_IN_A_STEP = 6
#: part of an output's spread by which a sample may miss the peak beside it
_CLOSE = 0.05


@dataclass(frozen=True)
class Trajectory:
    """A solution with dense output, in pieces between the kinks of the right-hand side.

    Attributes
    ----------
    ends : ndarray, shape (pieces + 1,)
        Times at which pieces begin and end, s.
    pieces : tuple of OdeSolution
    steps : ndarray
        All times at which the integrator ended a step.
    """

    ends: np.ndarray
    pieces: tuple["OdeSolution", ...]
    steps: np.ndarray

    def __call__(self, time: np.ndarray | float) -> np.ndarray:
        """Return the states, shape (states,) at a time or (len(time), states) at many; InputError outside the span."""
        time = real_array(time, "time", finite=False)
        if time.ndim > 1:
            raise InputError("", field="time", value=time.shape, expected="a time, or a list of times")
        self._require_inside(time)
        if time.ndim == 0:
            return self._piece(float(time))(float(time))
        owner = np.clip(np.searchsorted(self.ends, time, side="right") - 1, 0, len(self.pieces) - 1)
        states = np.empty((len(time), self.pieces[0](self.ends[0]).size))
        for index in np.unique(owner):
            chosen = owner == index
            states[chosen] = self.pieces[index](time[chosen]).T
        return states

    @cached_property
    def fine(self) -> tuple[np.ndarray, np.ndarray]:
        """Times, shape (N,), so many in every step of the integrator that an output's shape shows; and the states."""
        steps = np.unique(np.concatenate([self.steps, self.ends]))
        within = np.arange(_IN_A_STEP) / _IN_A_STEP * np.diff(steps)[:, None]
        grid = np.append((steps[:-1, None] + within).ravel(), steps[-1])
        return grid, self(grid)

    def _require_inside(self, time: np.ndarray) -> None:
        room = 1e-9 * self.ends[-1]
        if not ((time >= -room) & (time <= self.ends[-1] + room)).all():
            raise InputError("", field="time", value=time.tolist(), expected=f"0..{self.ends[-1]:g} s")

    def _piece(self, time: float) -> "OdeSolution":
        index = int(np.clip(np.searchsorted(self.ends, time, side="right") - 1, 0, len(self.pieces) - 1))
        return self.pieces[index]


def integrate(
    right_hand_side: Function,
    start: np.ndarray,
    end: float,
    *,
    rtol: float = 1e-12,
    atol: float | np.ndarray = 1e-12,
    method: str = "DOP853",
    kinks: Sequence[Callable[[float, np.ndarray], float]] = (),
) -> Trajectory:
    """Integrate from 0 to `end` with dense output, restarting at every kink.

    Parameters
    ----------
    right_hand_side : callable
        f(t, x) -> dx/dt, continuous, smooth between kinks.
    start : ndarray, shape (states,)
    end : float
        s.
    rtol, atol : float or ndarray
        Tolerances per step.
    method : str
        Of `scipy.integrate.solve_ivp`.
    kinks : sequence of callables
        Functions g(t, x) at whose zeros the right-hand side has a kink; a step never reaches across one.

    Returns
    -------
    Trajectory
        Called with times, shape (N,), it gives the states there, shape (N, states): ``found(time)``.

    Raises
    ------
    InputError
        If the start, its derivative or the end is not finite, the end does not lie after zero, a tolerance is not
        positive, the method is unknown, or the right-hand side or a kink gives what is no number.
    ComputationError
        If the integrator gives up or stands still, the state ceases to be finite, or the solution slides along a kink,
        with the time at which it did.
    """
    _require_start(right_hand_side, start, end)
    _require_tolerances(np.size(start), rtol, atol, method)
    kinks = [_Kink(kink) for kink in kinks]
    time, state = 0.0, np.asarray(start, dtype=float)
    ends, pieces, steps = [0.0], [], [np.array([0.0])]
    while time < end:
        guarded = Guarded(right_hand_side, np.size(start), end)
        try:
            # what leaves double precision is said in one line below
            with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
                leg = scipy.integrate.solve_ivp(
                    guarded, (time, end), state, method, rtol=rtol, atol=atol, dense_output=True, events=kinks or None
                )
        except (ValueError, np.linalg.LinAlgError) as error:  # of matrices that hold an infinite derivative or slope
            if guarded.infinite is None and _NOT_FINITE not in str(error):
                raise
            what = f"{method} left double precision" if guarded.infinite is None else "the derivative is infinite"
            place = guarded.latest if guarded.infinite is None else guarded.infinite
            raise ComputationError("integration", f"{what} at t = {place!r} s") from error
        if leg.status < 0:
            raise ComputationError("integration", f"{method} gave up at t = {float(leg.t[-1])!r} s: {leg.message}")
        if not np.isfinite(leg.y).all():
            lost = float(leg.t[~np.isfinite(leg.y).all(axis=0)][0])
            raise ComputationError("integration", f"the state is not finite at t = {lost!r} s")
        solution, times, reached = leg.sol, leg.t, leg.y[:, -1]
        if leg.status == 1 and times[-1] > times[-2]:
            last = _up_to_kink(guarded, leg, rtol, atol, method, kinks)
            solution = _joined(leg.sol, last.sol)
            times, reached = np.append(leg.t[:-1], last.t[1:]), last.y[:, -1]
        pieces.append(solution)
        steps.append(times[1:])
        time, state = float(times[-1]), reached
        if leg.status == 1:
            # One tiny explicit step leaves the kink's zero behind; its error, about 1e-18 f', is below rounding.
            nudge = max(resolution(_NUDGE, end), 8 * float(np.spacing(time)))
            state = state + nudge * guarded(time, state)
            time += nudge
        ends.append(min(time, end))
        if len(pieces) > _SLIDING and time - ends[-_SLIDING] < _TOGETHER * end:
            raise ComputationError("integration", f"the solution slides along a kink from t = {ends[-_SLIDING]!r} s")
        if len(pieces) > _MAX_KINKS:
            raise ComputationError("integration", f"more than {_MAX_KINKS} kinks before t = {time!r} s")
    return Trajectory(np.array(ends), tuple(pieces), np.concatenate(steps))


def _up_to_kink(
    right_hand_side: Function, leg: Any, rtol: float, atol: float | np.ndarray, method: str, kinks: Sequence
) -> Any:
    """Integrate the last step again up to the kink: the integrator looked beyond it, where another formula holds.

    The step ends where the function of the kink vanishes along the new solution, which is found by Newton's method.
    """
    kink = kinks[next(i for i, times in enumerate(leg.t_events) if len(times))]
    begin, start, stop = float(leg.t[-2]), leg.y[:, -2], float(leg.t[-1])
    for _ in range(_MOST_MOVES):
        last = scipy.integrate.solve_ivp(
            right_hand_side, (begin, stop), start, method, rtol=rtol, atol=atol, dense_output=True
        )
        if last.status < 0:
            raise ComputationError("integration", f"{method} gave up at t = {float(last.t[-1])!r} s: {last.message}")
        value, part = kink(stop, last.y[:, -1]), 1e-3 * (stop - begin)
        rate = (value - kink(stop - part, last.sol(stop - part))) / part
        move = -value / rate if rate else 0.0
        # A kink that is only touched, or a Newton's step out of the step: the place that was found stays.
        if abs(move) <= _SETTLED * (stop - begin) or not begin < stop + move <= stop + (stop - begin):
            return last
        stop += move
    return last


def _joined(before: "OdeSolution", last: "OdeSolution") -> "OdeSolution":
    """A solution whose last step is replaced."""
    return scipy.integrate.OdeSolution(
        np.append(before.ts[:-1], last.ts[1:]), [*before.interpolants[:-1], *last.interpolants]
    )


def _require_start(right_hand_side: Function, start: np.ndarray, end: float) -> None:
    if not real_number(end, "end") > 0:
        raise InputError("", field="end", value=end, expected="a finite time after 0 s")
    state = real_array(start, "start")
    if state.ndim != 1 or not len(state):
        raise InputError("", field="start", value=state.shape, expected="one number a state")
    slope = real_row(right_hand_side(0.0, state), len(state), "derivative at the start")
    if not np.isfinite(slope).all():
        raise InputError("", field="derivative at the start", value=slope.tolist(), expected="finite numbers")


def _require_tolerances(states: int, rtol: float, atol: float | np.ndarray, method: str) -> None:
    if not real_number(rtol, "rtol") > 0:
        raise InputError("", field="rtol", value=rtol, expected="a positive number")
    if np.shape(atol) not in ((), (states,)) or not (real_array(atol, "atol") >= 0).all():
        raise InputError("", field="atol", value=np.asarray(atol).tolist(), expected="one number, or one a state, >= 0")
    if method not in METHODS:
        raise InputError("", field="method", value=method, expected=" | ".join(METHODS))


class _Kink:
    """A function at whose zero the integrator stops; refused where it gives no number."""

    terminal = True  # solve_ivp's own convention

    def __init__(self, function: Callable[[float, np.ndarray], float]) -> None:
        self.function = function

    def __call__(self, t: float, x: np.ndarray) -> float:
        value = self.function(t, x)
        if not isinstance(value, Real):
            raise InputError("", field=f"kink at t = {float(t)!r} s", value=value, expected="a number")
        if math.isnan(value):
            raise ComputationError("integration", f"the function of a kink is not a number at t = {float(t)!r} s")
        return float(value)


class Guarded:
    """The right-hand side, which refuses a derivative that is none, and ends an integration that would go on for ever.

    That is one whose step has become nan, or so small that time stands still, as it does before a pole of the solution.
    Infinite trial values may still be rejected by the integrator.
    """

    def __init__(self, right_hand_side: Function, states: int, end: float) -> None:
        self.right_hand_side, self.states, self.end = right_hand_side, states, end
        self.infinite: float | None = None
        self.calls, self.latest, self.mark = 0, -np.inf, -np.inf

    def __call__(self, t: float, x: np.ndarray) -> np.ndarray:
        slope = real_row(self.right_hand_side(t, x), self.states, "derivative")
        if not np.isfinite(slope).all():
            if np.isnan(slope).any():
                raise ComputationError("integration", f"the derivative is not a number at t = {float(t)!r} s")
            self.infinite = float(t)
        self.calls += 1
        self.latest = max(self.latest, float(t))
        if self.calls % _STILL == 0:
            if self.latest - self.mark < _SMALLEST * self.end:
                raise ComputationError("integration", f"time stands still at t = {self.latest!r} s")
            self.mark = self.latest
        return slope


def largest(trajectory: Trajectory, output: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> tuple[float, float]:
    """Locate the largest value of an output over continuous time.

    Parameters
    ----------
    trajectory : Trajectory
    output : callable
        (times (N,), states (N, n)) -> (N,).

    Returns
    -------
    time, value : float

    Raises
    ------
    ComputationError
        If the output is not a number at some time.
    InputError
        If it does not give one number a time.
    """
    grid, values = _outputs(output, trajectory)
    best = int(np.argmax(values))
    time, value = float(grid[best]), float(values[best])
    if math.isinf(value):
        return time, value

    # A lower sample can lie beside a higher peak: every local maximum that comes close to the best is polished.
    for sample in summits(values, values >= value - _CLOSE * np.ptp(values)):
        peak, height = polished(_at(output, trajectory), grid, sample, resolution(_PEAK, float(grid[-1])))
        if height > value:
            time, value = peak, height
    return time, value


def _at(output: Callable, trajectory: Trajectory) -> Callable[[float], float]:
    """An output at one time."""
    return lambda t: float(output(np.array([t]), trajectory(np.array([t])))[0])


def _outputs(output: Callable, trajectory: Trajectory) -> tuple[np.ndarray, np.ndarray]:
    """Times and values of an output where the trajectory was looked at."""
    grid, states = trajectory.fine
    values = real_row(output(grid, states), len(grid), "output")
    if np.isnan(values).any():
        raise ComputationError("output", f"not a number at t = {float(grid[np.isnan(values)][0])!r} s")
    return grid, values


def last_crossing(trajectory: Trajectory, output: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> float:
    """Locate the time after which an output stays negative.

    Parameters
    ----------
    trajectory : Trajectory
    output : callable
        (times (N,), states (N, n)) -> (N,).

    Raises
    ------
    ComputationError
        If the output is not negative at the end, was never positive, or is not a number at some time.
    InputError
        If it does not give one number a time.
    """
    grid, values = _outputs(output, trajectory)
    positive = np.flatnonzero(values >= 0)
    if len(positive) == 0 or positive[-1] == len(grid) - 1:
        raise ComputationError("crossing", "the output does not pass from positive to lastingly negative")
    last = int(positive[-1])
    low, high = float(grid[last]), float(grid[last + 1])
    # A later peak may pass zero between two samples alone.
    value_at, end = _at(output, trajectory), float(grid[-1])
    for sample in reversed(summits(values[last:], may_pass(values[last:], 0.0))):
        peak, height = polished(value_at, grid[last:], sample, resolution(_PEAK, end))
        if height > 0 and peak > low:
            low, high = peak, float(grid[np.searchsorted(grid, peak, side="right")])
            break
    return float(scipy.optimize.brentq(value_at, low, high, xtol=resolution(_CROSSING, end)))

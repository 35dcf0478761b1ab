"""Adaptive integration of ordinary differential equations with dense output, located kinks, extremes and crossings.

References
----------
.. [1] E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary Differential Equations I", 2nd ed., Springer, 1993,
   section II.10 (DOP853 and its dense output of order 7).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp
from scipy.optimize import brentq, minimize_scalar

from gainsay.errors import ComputationError, InputError

Function = Callable[[float, np.ndarray], np.ndarray]
_NUDGE = 1e-9
_MAX_KINKS = 10_000
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
    pieces: tuple[OdeSolution, ...]
    steps: np.ndarray

    def __call__(self, time: np.ndarray | float) -> np.ndarray:
        """Return the states, shape (states,) at a time or (len(time), states) at many."""
        if np.ndim(time) == 0:
            return self._piece(float(time))(float(time))
        time = np.asarray(time, dtype=float)
        owner = np.clip(np.searchsorted(self.ends, time, side="right") - 1, 0, len(self.pieces) - 1)
        states = np.empty((len(time), self.pieces[0](self.ends[0]).size))
        for index in np.unique(owner):
            chosen = owner == index
            states[chosen] = self.pieces[index](time[chosen]).T
        return states

    def _piece(self, time: float) -> OdeSolution:
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

    Raises
    ------
    InputError
        If the start, its derivative or the end is not finite, or the end does not lie after zero.
    ComputationError
        If the integrator gives up or the state ceases to be finite, with the time at which it did.
    """
    _require_start(right_hand_side, start, end)
    for kink in kinks:
        kink.terminal = True  # type: ignore[attr-defined]  # solve_ivp's own convention
    time, state = 0.0, np.asarray(start, dtype=float)
    ends, pieces, steps = [0.0], [], [np.array([0.0])]
    while time < end:
        found = solve_ivp(
            _guarded(right_hand_side),
            (time, end),
            state,
            method,
            rtol=rtol,
            atol=atol,
            dense_output=True,
            events=kinks or None,
        )
        if found.status < 0:
            raise ComputationError("integration", f"{method} gave up at t = {float(found.t[-1])!r} s: {found.message}")
        if not np.isfinite(found.y).all():
            lost = float(found.t[~np.isfinite(found.y).all(axis=0)][0])
            raise ComputationError("integration", f"the state is not finite at t = {lost!r} s")
        pieces.append(found.sol)
        steps.append(found.t[1:])
        time, state = float(found.t[-1]), found.y[:, -1]
        if found.status == 1:
            # One tiny explicit step leaves the kink's zero behind; its error, about 1e-18 f', is below rounding.
            state = state + _NUDGE * right_hand_side(time, state)
            time += _NUDGE
        ends.append(min(time, end))
        if len(pieces) > _MAX_KINKS:
            raise ComputationError("integration", f"more than {_MAX_KINKS} kinks before t = {time!r} s")
    return Trajectory(np.array(ends), tuple(pieces), np.concatenate(steps))


def _require_start(right_hand_side: Function, start: np.ndarray, end: float) -> None:
    if not (np.isfinite(end) and end > 0):
        raise InputError("", field="end", value=end, expected="a finite time after 0 s")
    state = np.asarray(start, dtype=float)
    if state.ndim != 1 or not np.isfinite(state).all():
        raise InputError("", field="start", value=state.tolist(), expected="one finite number a state")
    slope = np.asarray(right_hand_side(0.0, state), dtype=float)
    if slope.shape != state.shape or not np.isfinite(slope).all():
        raise InputError(
            "", field="derivative at the start", value=slope.tolist(), expected="one finite number a state"
        )


def _guarded(right_hand_side: Function) -> Function:
    """The right-hand side, which ends the integration where a time or state that is not a number is asked for.

    An integrator whose step has become nan would go on for ever; infinite trial values may still be rejected by it.
    """

    def guarded(t: float, x: np.ndarray) -> np.ndarray:
        slope = right_hand_side(t, x)
        if np.isnan(slope).any():
            raise ComputationError("integration", f"the derivative is not a number at t = {float(t)!r} s")
        return slope

    return guarded


def largest(
    trajectory: Trajectory, output: Callable[[np.ndarray, np.ndarray], np.ndarray], *, refine: int = 6
) -> tuple[float, float]:
    """Locate the largest value of an output over continuous time.

    Parameters
    ----------
    trajectory : Trajectory
    output : callable
        (times (N,), states (N, n)) -> (N,).
    refine : int
        Points looked at in every step of the integrator before the best are polished on the dense output.

    Returns
    -------
    time, value : float
    """
    steps = np.unique(np.concatenate([trajectory.steps, trajectory.ends]))
    fractions = np.arange(refine) / refine
    grid = np.append((steps[:-1, None] + fractions * np.diff(steps)[:, None]).ravel(), steps[-1])
    values = output(grid, trajectory(grid))
    best = int(np.argmax(values))
    time, value = float(grid[best]), float(values[best])

    def negative(t: float) -> float:
        return -float(output(np.array([t]), trajectory(np.array([t])))[0])

    # A lower sample can lie beside a higher peak: every local maximum that comes close to the best is polished.
    padded = np.concatenate([[-np.inf], values, [-np.inf]])
    before, after = padded[:-2], padded[2:]
    summits = (values >= before) & (values >= after) & ((values > before) | (values > after))  # no plateau
    summits &= values >= value - _CLOSE * np.ptp(values)
    for index in np.flatnonzero(summits):
        low, high = float(grid[max(index - 1, 0)]), float(grid[min(index + 1, len(grid) - 1)])
        polished = minimize_scalar(negative, bounds=(low, high), method="bounded", options={"xatol": 1e-10})
        if -polished.fun > value:
            time, value = float(polished.x), -float(polished.fun)
    return time, value


def last_crossing(
    trajectory: Trajectory, output: Callable[[np.ndarray, np.ndarray], np.ndarray], *, refine: int = 6
) -> float:
    """Locate the time after which an output stays negative.

    Parameters
    ----------
    trajectory : Trajectory
    output : callable
        (times (N,), states (N, n)) -> (N,).

    Raises
    ------
    ComputationError
        If the output is not negative at the end, or was never positive.
    """
    steps = np.unique(np.concatenate([trajectory.steps, trajectory.ends]))
    grid = np.append((steps[:-1, None] + np.arange(refine) / refine * np.diff(steps)[:, None]).ravel(), steps[-1])
    values = output(grid, trajectory(grid))
    positive = np.flatnonzero(values >= 0)
    if len(positive) == 0 or positive[-1] == len(grid) - 1:
        raise ComputationError("crossing", "the output does not pass from positive to lastingly negative")
    low, high = float(grid[positive[-1]]), float(grid[positive[-1] + 1])
    return float(brentq(lambda t: float(output(np.array([t]), trajectory(np.array([t])))[0]), low, high, xtol=1e-12))

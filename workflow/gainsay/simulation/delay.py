"""Linear systems with a time-varying delay that may touch zero: Gauss collocation on a mesh through the breakpoints.

x'(t) = A x(t) + Bd Cd x(t - d(t)) + f(t), constant history. The solution is a polynomial of degree s on every interval,
its derivative matching at the s Gauss points. The delayed signal is read off that polynomial, also where t - d(t) falls
into the interval being solved, so a vanishing delay needs no special step. A constant history leaves a kink in x' at
the start, which t - d(t) carries on to later breakpoints, smoother by one each time; the first ones are mesh points.
The order is s + 1, in between and at the mesh (Bellen and Zennaro, Numerical Methods for Delay Differential Equations,
2003, chapter 6: superconvergence is lost where delayed arguments fall between mesh points).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gainsay.errors import ComputationError, InputError
from gainsay.exact.floats import real_array, real_number
from gainsay.simulation.delay_steps import Collocation, Reading, Steps
from gainsay.simulation.summits import resolution

# intervals prepared at once; the first ones, between close breakpoints, see many rows
_FIRST, _CHUNK = 64, 1024
#: s, and the part of a delay or a run that is shorter than a second, below which two times of a mesh are one
_TOGETHER = 1e-9


@dataclass(frozen=True)
class DelayLaw:
    """A delay d(t) with the bounds it promises.

    Parameters
    ----------
    value : callable
        d(t) in s, for an array of times in s.
    high : float
        Bound d_M: 0 <= d(t) <= high.
    rate : float
        Bound mu on d'(t), below 1, so that t - d(t) increases.

    Raises
    ------
    InputError
        If a bound is no finite number, the first negative or the second not below 1.
    """

    value: Callable[[np.ndarray], np.ndarray]
    high: float
    rate: float

    def __post_init__(self) -> None:
        if not real_number(self.high, "high") >= 0:
            raise InputError("", field="high", value=self.high, expected="a finite time >= 0 s")
        if not real_number(self.rate, "rate") < 1:
            raise InputError("", field="rate", value=self.rate, expected="below 1")

    def __call__(self, t: np.ndarray | float) -> np.ndarray:
        """Delay at t, s; InputError where the law does not give one number a time."""
        times = np.asarray(t, dtype=float)
        delays = real_array(self.value(times), "delay", finite=False)
        if delays.shape != times.shape:
            raise InputError("", field="delay", value=delays.shape, expected="one number a time")
        return delays

    def check(self, times: np.ndarray) -> None:
        """Refuse a law that leaves [0, high] or grows faster than its rate on an increasing grid.

        Parameters
        ----------
        times : ndarray
            s, strictly increasing.

        Raises
        ------
        InputError
            Naming the first time at which a bound is broken, to the grid's resolution and then bisected.
        """
        slack = 4e-16 * (1 + self.high)
        delays = self(times)
        if not np.isfinite(delays).all():
            lost = float(times[~np.isfinite(delays)][0])
            raise InputError(f"delay at t = {lost:.9g} s", field="d", value="not finite", expected="a finite time")
        low, high = delays < -slack, delays > self.high + slack
        # A chord steeper than the rate proves that d' exceeds it somewhere between; rounding of t is allowed for.
        rounding = 1e-15 * (1 + np.abs(times[1:]))
        steep = np.append(False, np.diff(delays) > self.rate * np.diff(times) + rounding)
        bad = np.flatnonzero(low | high | steep)
        if not bad.size:
            return
        k = bad[0]
        if low[k] or high[k]:
            outside = lambda t: not -slack <= float(self(t)) <= self.high + slack  # noqa: E731
            time = times[0] if k == 0 else _first(outside, times[k - 1], times[k])
            bound = f"within 0..{self.high:g} s"
            raise InputError(f"delay at t = {time:.9g} s", field="d", value=float(self(time)), expected=bound)
        slope = (delays[k] - delays[k - 1]) / (times[k] - times[k - 1])
        raise InputError(
            f"delay rate near t = {times[k - 1]:.9g} s",
            field="d'",
            value=float(slope),
            expected=f"at most {self.rate:g}",
        )

    def breakpoints(self, start: float, count: int) -> list[float]:
        """Return xi_1 < xi_2 < ... after the start with xi_k - d(xi_k) = xi_{k-1}, xi_0 = start.

        Parameters
        ----------
        start : float
            s.
        count : int
            How many at most; those closer to the one before than 1e-9 s, or that part of a `high` below 1 s, are left
            out (the delay vanishes there).
        """
        points, before = [], start
        for _ in range(count):
            low, high = before, before + self.high
            for _ in range(200):
                middle = (low + high) / 2
                if middle in (low, high):
                    break
                if middle - float(self(middle)) < before:
                    low = middle
                else:
                    high = middle
            if high - before <= resolution(_TOGETHER, self.high):
                break
            points.append(high)
            before = high
        return points


def _first(outside: Callable[[float], bool], low: float, high: float) -> float:
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if outside(middle) else (middle, high)
    return high


@dataclass(frozen=True)
class DelaySolution:
    """A piecewise polynomial solution.

    Attributes
    ----------
    mesh : ndarray, shape (m + 1,)
        s, increasing.
    states : ndarray, shape (m + 1, n)
        At the mesh.
    slopes : ndarray, shape (m, s, n)
        Derivatives at the Gauss points of every interval.
    rule : Collocation
    """

    mesh: np.ndarray
    states: np.ndarray
    slopes: np.ndarray
    rule: Collocation

    def __call__(self, times: np.ndarray) -> np.ndarray:
        """Return the state at times at or after the first mesh point, shape (k, n); before it the constant history."""
        return self._evaluate(times, derivative=False)

    def derivative(self, times: np.ndarray) -> np.ndarray:
        """Return x'(t), shape (k, n); zero before the first mesh point."""
        return self._evaluate(times, derivative=True)

    def _evaluate(self, times: np.ndarray, derivative: bool) -> np.ndarray:
        times = np.atleast_1d(real_array(times, "time", finite=False))
        if times.ndim > 1:
            raise InputError("", field="time", value=times.shape, expected="a time, or a list of times")
        if times.size and not times.max() <= self.mesh[-1] + 1e-12 * np.abs(self.mesh[[0, -1]]).max():
            raise InputError("", field="time", value=float(times.max()), expected=f"at most {self.mesh[-1]:g} s")
        k = np.clip(np.searchsorted(self.mesh, times, side="right") - 1, 0, len(self.mesh) - 2)
        h = self.mesh[k + 1] - self.mesh[k]
        theta = (times - self.mesh[k]) / h
        before = times < self.mesh[0]
        if derivative:
            value = np.einsum("ks,ksn->kn", self.rule.lagrange(theta), self.slopes[k])
            value[before] = 0
            return value
        value = self.states[k] + np.einsum("ks,ksn->kn", h[:, None] * self.rule.partial(theta), self.slopes[k])
        value[before] = self.states[0]
        return value

    def integral(
        self, density: Callable[[np.ndarray, np.ndarray], np.ndarray], times: np.ndarray, start: float | None = None
    ) -> np.ndarray:
        """Integral of a function of time and state from a start to given times.

        Parameters
        ----------
        density : callable
            density(times (k,), states (k, n)) -> (k,).
        times : array_like, shape (m,)
            s, at or after the start.
        start : float, optional
            s; the first mesh point where left out. Not the difference of two integrals, which cancels where a
            disturbance has died out.

        Returns
        -------
        ndarray, shape (m,)
            By the Gauss rule on every interval, exact for densities of degree 2 s - 1 between mesh points.
        """
        times = np.atleast_1d(np.asarray(times, dtype=float))
        start = self.mesh[0] if start is None else start
        mesh = np.concatenate([[start], self.mesh[self.mesh > start]])
        whole = np.concatenate([[0.0], np.cumsum(self._pieces(density, mesh[:-1], mesh[1:]))])
        k = np.clip(np.searchsorted(mesh, times, side="right") - 1, 0, len(mesh) - 2)
        return whole[k] + self._pieces(density, mesh[k], times)

    def _pieces(self, density: Callable, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        points = low[:, None] + (high - low)[:, None] * self.rule.nodes
        values = density(points.ravel(), self(points.ravel())).reshape(points.shape)
        return (high - low) * (values @ self.rule.weights)


def delay_mesh(
    law: DelayLaw, start: float, end: float, step: float, stages: int, jumps: Sequence[float] = ()
) -> tuple[np.ndarray, np.ndarray]:
    """Mesh of nearly even steps that contains the breakpoints which the scheme can feel.

    Parameters
    ----------
    law : DelayLaw
    start, end, step : float
        s.
    stages : int
        A jump in the k-th derivative with k > 2 s + 1 is below the order of the scheme.
    jumps : sequence of float, optional
        s: further times at which the right-hand side is not smooth; they, too, are carried on by the delay.

    Returns
    -------
    mesh : ndarray, shape (m + 1,)
        s.
    steps : ndarray, shape (m,)
        Nominal steps: equal ones are equal to the last bit, which differences of the mesh are not.
    """
    start, end, step = (real_number(v, n) for v, n in ((start, "start"), (end, "end"), (step, "step")))
    if not (end > start and step > 0):
        raise InputError("", field="start, end, step", value=(start, end, step), expected="start < end, step > 0")
    kinks = real_array(jumps, "jumps")
    if kinks.ndim != 1:
        raise InputError("", field="jumps", value=kinks.shape, expected="a list of times")
    origins = [start, *sorted(kinks.tolist())]
    if not all(start <= t <= end for t in origins):
        raise InputError("", field="jumps", value=origins[1:], expected=f"times within {start:g}..{end:g} s")
    points = [start, *(t for t in law.breakpoints(start, 2 * stages + 1) if t < end), end]
    apart = resolution(_TOGETHER, end - start)
    for jump in origins[1:]:
        carried = [t for t in law.breakpoints(jump, 2 * stages + 1) if all(abs(t - p) >= apart for p in points)]
        points = sorted({*points, jump, *(t for t in carried if t < end)})
    pieces, steps = [np.array([start])], []
    for a, b in pairwise(points):
        count = max(1, int(np.ceil((b - a) / step - 1e-9)))
        pieces.append(a + (b - a) * np.arange(1, count + 1) / count)
        steps.append(np.full(count, (b - a) / count))
    return np.concatenate(pieces), np.concatenate(steps)


def simulate_delay(
    A: np.ndarray,
    Bd: np.ndarray,
    Cd: np.ndarray,
    law: DelayLaw,
    initial: np.ndarray,
    end: float,
    *,
    forcing: Callable[[np.ndarray], np.ndarray] | None = None,
    start: float = 0.0,
    step: float = 0.01,
    stages: int = 5,
    jumps: Sequence[float] = (),
) -> DelaySolution:
    """Solve x' = A x + Bd Cd x(t - d(t)) + f(t) with x(t) = initial for t <= start.

    Parameters
    ----------
    A, Bd, Cd : ndarray
        Shapes (n, n), (n, r), (r, n).
    law : DelayLaw
        Checked over the whole run before anything is computed.
    initial : ndarray, shape (n,)
    end : float
        s.
    forcing : callable, optional
        f(times (k,)) -> (k, n), smooth between the `jumps`: it is read at the Gauss points, and what is narrower than a
        step would go unseen.
    start, step : float
        s.
    stages : int
        Gauss points s; the order is s + 1.
    jumps : sequence of float, optional
        s: times at which the forcing or the delay jumps or has a kink, such as both ends of a pulse.

    Returns
    -------
    DelaySolution

    Raises
    ------
    InputError
        If the law leaves its bounds (with the time), shapes disagree, an entry is not finite, or a jump not in the run.
    ComputationError
        If the state leaves the range of double precision.
    """
    parts = (("A", A), ("Bd", Bd), ("Cd", Cd), ("initial", initial))
    A, Bd, Cd, initial = (real_array(value, name) for name, value in parts)
    n, r = Bd.shape if Bd.ndim == 2 else (0, 0)
    if A.shape != (n, n) or Cd.shape != (r, n) or initial.shape != (n,):
        raise InputError("shapes", field="A, Bd, Cd, initial", value=(A.shape, Bd.shape, Cd.shape, initial.shape))
    rule = Collocation.gauss(stages)
    mesh, h = delay_mesh(law, start, end, step, stages, jumps)
    times = mesh[:-1, None] + h[:, None] * rule.nodes
    law.check(np.unique(np.append(mesh, times)))
    reading = Reading.of(law, rule, mesh, h, times)
    # A row an interval: the state at its right end, then the delayed signal's polynomial on it (value at the left end,
    # h times its slopes). Rows of the constant history stand before the first.
    history, width = int(reading.reach.max(initial=1)), n + (stages + 1) * r
    rows = np.zeros((history + len(h), width))
    rows[:history, :n], rows[:history, n : n + r] = initial, Cd @ initial
    slopes = np.empty((len(h), stages, n))
    ends = [0, *range(min(_FIRST, len(h)), len(h), _CHUNK), len(h)]
    for first, last in pairwise(ends):
        block = slice(first, last)
        f = np.zeros(((last - first) * stages, n))
        if forcing is not None:
            given = real_array(forcing(times[block].ravel()), "forcing")
            if given.shape != f.shape:
                raise InputError("", field="forcing", value=given.shape, expected=f"shape (k, {n}) at k times")
            f = given
        steps = Steps.of(A, Bd, Cd, rule, h[block], f.reshape(last - first, stages, n), reading[block])
        steps.run(rows[history + first - steps.depth : history + last])
        slopes[block] = steps.slopes(rows[history + first - steps.depth : history + last - 1])
        if not np.all(np.isfinite(rows[history + last - 1])):
            raise ComputationError("delay simulation", f"state leaves double precision before {mesh[last]:g} s")
    return DelaySolution(mesh, np.vstack([initial, rows[history:, :n]]), slopes, rule)

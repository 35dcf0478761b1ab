"""Linear systems with periodic or piecewise constant gains, without stepping through every period.

x' = A(t) x with A(t + T) = A(t): the fundamental matrices over one period (fourth-order Magnus steps) and their
product, the monodromy matrix, give the state at every node of every period by matrix products. Sinusoidal
disturbances are states of their own (`with_oscillators`), so that no input is ever interpolated.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy  # its packages are loaded when they are used

from gainsay.errors import ComputationError, InputError
from gainsay.exact.floats import real_array, real_number, real_row
from gainsay.simulation.summits import may_pass, polished, resolution, summits

_GAUSS = np.sqrt(3) / 6
#: s, to which peaks are located, and the part of a solution that is shorter than a second
_LOCATED = 1e-10
#: part of the largest value, or of the spread of the values, by which a node may miss the peak beside it
_CLOSE = 0.05
# norm up to which the series of an exponential is summed, most parts of such a norm, and a term below rounding
_LONGEST, _MOST_PARTS, _ROUNDING = 4.0, 16, 1e-18


def magnus_step(A: Callable, t: float, h: float) -> np.ndarray:
    """Fundamental matrix of x' = A(t) x from t to t + h, fourth-order Magnus at the two Gauss points.

    Parameters
    ----------
    A : callable
        t -> ndarray, shape (n, n).
    t, h : float
        Start and length of the step, s; h may be zero.

    References
    ----------
    S. Blanes, F. Casas, J. A. Oteo, J. Ros, The Magnus expansion and some of its applications, Phys. Rep. 470 (2009).
    """
    first, second = A(t + (0.5 - _GAUSS) * h), A(t + (0.5 + _GAUSS) * h)
    commutator = second @ first - first @ second
    return scipy.linalg.expm(0.5 * h * (first + second) + np.sqrt(3) / 12 * h * h * commutator)


def with_oscillators(A: np.ndarray, shapes: np.ndarray, rate: float) -> np.ndarray:
    """State matrix of x' = A x + shapes [cos(rate t), sin(rate t), 1] with the three signals as further states.

    Parameters
    ----------
    A : ndarray, shape (n, n)
    shapes : ndarray, shape (n, 3)
        How the three signals enter.
    rate : float
        rad/s.

    Returns
    -------
    ndarray, shape (n + 3, n + 3)
        The further states start from (1, 0, 1).
    """
    A, shapes, rate = real_array(A, "A"), real_array(shapes, "shapes"), real_number(rate, "rate")
    n = len(shapes) if shapes.ndim else 0
    if A.shape != (n, n) or shapes.shape != (n, 3):
        raise InputError(field="shapes", value=shapes.shape, expected=f"shape ({n}, 3) beside a square A")
    whole = np.zeros((n + 3, n + 3))
    whole[:n, :n] = A
    whole[:n, n:] = shapes
    whole[n, n + 1], whole[n + 1, n] = -rate, rate
    return whole


@dataclass(frozen=True)
class Extreme:
    """Largest value of a function along a solution: when, how large, and the state there."""

    time: float
    value: float
    state: np.ndarray


class PeriodicSolution:
    """Solution of x' = A(t) x, A(t + T) = A(t), on [0, periods * T].

    Parameters
    ----------
    A : callable
        t -> ndarray, shape (n, n), periodic.
    period : float
        T, s.
    start : ndarray, shape (n,)
        x(0).
    periods : int
        Number of periods.
    steps : int, optional
        Magnus steps a period.

    Attributes
    ----------
    times : ndarray, shape (periods * steps + 1,)
    states : ndarray, shape (periods * steps + 1, n)
    monodromy : ndarray, shape (n, n)
        Fundamental matrix over one period; its eigenvalues are the Floquet multipliers.

    Raises
    ------
    InputError
        If the period, the start or A(t) is not finite or their shapes do not fit, or a count is below one.
    ComputationError
        If the state leaves double precision.
    """

    def __init__(self, A: Callable, period: float, start: np.ndarray, periods: int, steps: int = 40) -> None:
        if not real_number(period, "period") > 0:
            raise InputError(field="period", value=period, expected="above 0 s")
        for name, count in (("periods", periods), ("steps", steps)):
            if not isinstance(count, int | np.integer) or count < 1:
                raise InputError(field=name, value=count, expected="a whole number, at least 1")
        start = real_array(start, "start")
        if start.ndim != 1 or not len(start):
            raise InputError(field="start", value=start.shape, expected="one number a state")
        n = len(start)

        def checked(t: float) -> np.ndarray:
            matrix = real_array(A(t), "A(t)")
            if matrix.shape != (n, n):
                raise InputError(field=f"A({float(t)!r})", value=matrix.shape, expected=f"shape ({n}, {n})")
            return matrix

        self.A, self.period, self.step = checked, float(period), float(period) / steps
        with np.errstate(over="ignore", invalid="ignore"):  # what leaves double precision is refused below
            maps = np.empty((steps, n, n))
            total = np.eye(n)
            for j in range(steps):
                maps[j] = total
                total = magnus_step(self.A, j * self.step, self.step) @ total
            self.monodromy = total
            starts = np.empty((periods + 1, n))
            starts[0] = start
            for k in range(periods):
                starts[k + 1] = total @ starts[k]
            inner = np.einsum("jab,kb->kja", maps, starts[:-1], optimize=True)
            self.states = np.vstack([inner.reshape(periods * steps, n), starts[-1]])
        self.times = np.arange(periods * steps + 1) * self.step
        if not np.isfinite(self.states).all():
            lost = float(self.times[~np.isfinite(self.states).all(axis=1)][0])
            raise ComputationError("periodic solution", f"the state leaves double precision before {lost:g} s")

    def error(self) -> np.ndarray:
        """Estimate the error of the states at the nodes: the difference to half the steps, from which it is 1/15 off.

        Returns
        -------
        ndarray, shape (periods * steps + 1, n)
            Modulus of 16/15 of the difference to the solution with twice the steps a period. It is an estimate, good
            once the steps resolve A, and no bound; where A is constant both solutions are exact and it is rounding.
        """
        steps = round(self.period / self.step)
        periods = (len(self.times) - 1) // steps
        finer = PeriodicSolution(self.A, self.period, self.states[0], periods, 2 * steps)
        return np.abs(self.states - finer.states[::2]) * (16 / 15)

    def state(self, t: float) -> np.ndarray:
        """State at any time of the interval: one Magnus step of less than a full one from the node before."""
        if not 0 <= real_number(t, "t") <= self.times[-1] + 1e-9 * self.period:
            raise InputError(field="t", value=t, expected=f"0..{self.times[-1]}")
        j = min(int(t / self.step), len(self.times) - 1)
        rest = t - self.times[j]
        return magnus_step(self.A, self.times[j] % self.period, rest) @ self.states[j]

    def largest(self, function: Callable, after: float = 0.0) -> Extreme:
        """Largest value over continuous time of a function of the state.

        Parameters
        ----------
        function : callable
            (t, x) -> value for one time and state, or arrays (K,), (K, n) -> (K,).
        after : float, optional
            Only from this time on, s.

        Notes
        -----
        Every local maximum of the nodes, ends included, that comes within 5 % of the largest (of its size, or of the
        spread of the values where that is more) is refined by Brent's method between its neighbours; a peak narrower
        than two steps could be missed, so the steps must resolve the fastest motion.
        """
        keep = self.times >= real_number(after, "after") - 1e-9 * self.step
        if not keep.any():
            raise InputError(field="after", value=after, expected=f"0..{self.times[-1]}")
        t, values = self.times[keep], self._values(function, keep)
        best = int(np.argmax(values))
        top = Extreme(float(t[best]), float(values[best]), self.states[keep][best])
        floor = values[best] - _CLOSE * max(abs(values[best]), np.ptp(values))
        for sample in reversed(summits(values, values >= floor)):
            time, value = self._polished(function, t, sample)
            if value > top.value:
                top = Extreme(time, value, self.state(time))
        return top

    def _polished(self, function: Callable, times: np.ndarray, sample: int) -> tuple[float, float]:
        """Time and value of the maximum beside a node."""
        within = resolution(_LOCATED, float(self.times[-1]))
        return polished(lambda s: float(function(s, self.state(s))), times, sample, within)

    def _values(self, function: Callable, keep: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Values of a function at the nodes."""
        times = self.times[keep]
        values = real_row(function(times, self.states[keep]), len(times), "function")
        if np.isnan(values).any():
            lost = float(times[np.isnan(values)][0])
            raise ComputationError("periodic solution", f"the function is not a number at {lost:g} s")
        return values

    def last_exit(self, function: Callable, level: float) -> float:
        """Last time at which a function of the state is above a level (0 where it never is), s.

        Located between nodes by bisection to 1e-9 of a step. A peak that passes the level between two nodes alone is
        seen too, as long as it rises above its node by less than this falls beside it.
        """
        values = self._values(function)
        above = np.flatnonzero(values > real_number(level, "level"))
        last = int(above[-1]) if len(above) else -1
        if last == len(self.times) - 1:
            return float(self.times[-1])
        ends = (self.times[last], self.times[last + 1]) if len(above) else None
        first = max(last, 0)
        for sample in reversed(summits(values[first:], may_pass(values[first:], level))):
            time, value = self._polished(function, self.times[first:], sample)
            if value > level:
                ends = time, self.times[np.searchsorted(self.times, time, side="right")]
                break
        if ends is None:
            return 0.0
        low, high = ends
        for _ in range(40):
            middle = 0.5 * (low + high)
            if float(function(middle, self.state(middle))) > level:
                low = middle
            else:
                high = middle
        return float(high)


def piecewise(loops: np.ndarray, hold: float, start: np.ndarray, inner: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Solution of x' = A_k x on [k hold, (k + 1) hold): gains redrawn and held, exact at every node.

    Parameters
    ----------
    loops : ndarray, shape (K, ..., n, n)
        State matrices, one an interval; further axes between are of runs side by side.
    hold : float
        Length of an interval, s.
    start : ndarray, shape (n,) or (..., n)
        Of all runs, or of each.
    inner : int, optional
        Nodes an interval.

    Returns
    -------
    times : ndarray, shape (K * inner + 1,)
    states : ndarray, shape (K * inner + 1, ..., n)

    Raises
    ------
    InputError
        If an entry is not finite, shapes do not fit, there are no loops, or a length or count is not positive.
    ComputationError
        If the state leaves double precision.

    Notes
    -----
    Where many runs have one node an interval, no exponential is formed: its series is applied to their states at once.
    """
    if not real_number(hold, "hold") > 0 or not isinstance(inner, int | np.integer) or inner < 1:
        raise InputError("hold and inner must be positive", value=(hold, inner))
    loops, start = real_array(loops, "loops"), real_array(start, "start")
    n = start.shape[-1] if start.ndim else 0
    shape = (*loops.shape[1:-2], n)
    if loops.ndim < 3 or not loops.size or loops.shape[-2:] != (n, n) or start.shape not in ((n,), shape):
        raise InputError(field="loops", value=loops.shape, expected=f"shape (K, ..., n, n), K >= 1, n = {n}")
    step = hold / inner
    states = np.empty((len(loops) * inner + 1, *shape))
    states[0] = start
    row, one_run = 0, loops[0].size == n * n
    for block in np.array_split(loops, max(1, len(loops) // 500)):
        through = states[row : row + inner * len(block) + 1]
        row += inner * len(block)
        with np.errstate(over="ignore", invalid="ignore"):  # what leaves double precision is refused below
            if inner > 1 or one_run or not _by_series(block * step, through):
                _by_exponentials(scipy.linalg.expm(block * step), through)
        if not np.isfinite(states[row]).all():
            raise ComputationError("held gains", f"the state leaves double precision before {row * step:g} s")
    return np.arange(len(states)) * step, states


def _by_exponentials(exponentials: np.ndarray, states: np.ndarray) -> None:
    """Fill states[1:] from states[0] by one exponential after the other, each used for as many nodes."""
    nodes = (len(states) - 1) // len(exponentials)
    for row in range(len(states) - 1):
        states[row + 1] = (exponentials[row // nodes] @ states[row, ..., None])[..., 0]


def _by_series(exponents: np.ndarray, states: np.ndarray) -> bool:
    """Fill states[1:] from states[0] by the series of the exponential, one exponent after the other; False if too long.

    Parameters
    ----------
    exponents : ndarray, shape (K, ..., n, n)
    states : ndarray, shape (K + 1, ..., n)

    Notes
    -----
    In the units of the states, powers of two, that balance the first exponent: norms are small there. Each exponent is
    cut into parts of a norm of at most `_LONGEST`, and the series where what is left out is below rounding.
    """
    n = exponents.shape[-1]
    units = scipy.linalg.matrix_balance(exponents.reshape(-1, n, n)[0], permute=False, separate=True)[1][0]
    scaled = exponents * (units / units[:, None])
    norm = float(np.abs(scaled).sum(axis=-1).max())
    if not norm <= _LONGEST * _MOST_PARTS:
        return False
    parts = max(1, int(np.ceil(norm / _LONGEST)))
    sizes = np.cumprod(norm / parts / np.arange(1, 100))  # of the terms, over that of the state
    terms = 1 + int(np.argmax(sizes < _ROUNDING))
    scaled /= parts
    x = (states[0] / units)[..., None]
    for k, matrices in enumerate(scaled):
        for _ in range(parts):
            term = x
            for j in range(1, terms + 1):
                term = matrices @ term
                term /= j
                x = x + term
        states[k + 1] = x[..., 0] * units
    return True

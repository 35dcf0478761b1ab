"""Responses of the closed loops: release at 0.6 on every axis (24) and disturbing torques (25), linear and nonlinear.

Linear responses are matrix exponentials; the torques of (25) are states of their own, switched at 1000 s and 4000 s.
The state is (phi, theta, psi) and the rates of these angles; the control is u = -K x.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from gainsay.dynamics import attitude
from gainsay.simulation.linear import Consecutive, Peak, Response, with_harmonics
from gainsay.simulation.ode import Trajectory, integrate
from gainsay.tables import Case
from papers.pinheiro2013.plant import GROUPS, Satellite, linear_model

#: time constants after which a mode has died out, and the step over a mode's own time
LASTS, FINE = 14.0, 0.1
#: an angle has settled once it stays below this share of its peak
SETTLED = 0.02


@dataclass(frozen=True)
class Disturbance:
    """Torque (25) on one axis: sum over k of amplitude sin(k n t), plus a step between two times.

    Attributes
    ----------
    amplitude, step : float
        N m.
    start, end : float
        Times of the step, s.
    harmonics : int
        Last k of the sum.
    """

    amplitude: float
    step: float
    start: float
    end: float
    harmonics: int

    def torque(self, time: ArrayLike, n: float) -> np.ndarray:
        """Torque at a time or many, N m."""
        time = np.asarray(time, dtype=float)
        waves = sum(np.sin(k * n * time) for k in range(1, self.harmonics + 1))
        return self.amplitude * waves + self.step * ((time >= self.start) & (time < self.end))


def disturbance(case: Case, harmonics: int | None = None) -> Disturbance:
    """Read (25) from the tables."""
    return Disturbance(
        case.number("sine_amplitude"),
        case.number("step_amplitude"),
        case.number("step_start"),
        case.number("step_end"),
        harmonics or int(case.number("harmonics")),
    )


def release_state(case: Case, axes: Sequence[str] = GROUPS["all"]) -> np.ndarray:
    """Start (24) for the given axes, with 0.6 in the unit assumed: angles, then their rates."""
    index = ["xyz".index(axis) for axis in axes]
    factor = np.pi / 180 if case.choice("rate_unit") == "deg/s" else 1.0
    rates = case.matrix("initial_rates")[index, 0] * factor
    return np.concatenate([case.matrix("initial_angles")[index, 0], rates])


def loop_matrix(actual: Satellite, group: str, K: np.ndarray) -> np.ndarray:
    """State matrix of the actual satellite under u = -K x."""
    A, B = linear_model(actual, group)
    return A - B @ K


def stages(poles: np.ndarray, length: float, step: float = np.inf) -> list[tuple[float, int]]:
    """Durations and numbers of steps that follow every mode while it lasts: a slow mode must not hide a fast one.

    Parameters
    ----------
    poles : ndarray
        Of a stable system, 1/s.
    length : float
        s.
    step : float, optional
        Longest step, s.
    """
    modes = poles[np.argsort(poles.real, kind="stable")]
    intervals, begin = [], 0.0
    for i, mode in enumerate(modes):
        end = min(LASTS / -mode.real, length)
        if end > begin:
            longest = min(FINE / np.abs(modes[i:]).max(), step)
            intervals.append((end - begin, int(np.ceil((end - begin) / longest))))
            begin = end
    if begin < length:
        intervals.append((length - begin, max(int(np.ceil((length - begin) / min(step, length))), 1)))
    return intervals


class Transient:
    """Free response of a stable system until its slowest mode has died out, sampled stage by stage.

    Parameters
    ----------
    A : ndarray
    start : ndarray
    """

    def __init__(self, A: np.ndarray, start: np.ndarray) -> None:
        pieces: list[tuple[float, Response]] = []
        poles = np.linalg.eigvals(A)
        begin, length = 0.0, LASTS / -poles.real.max()
        for duration, steps in stages(poles, length):
            response = Response(A, start, duration, steps)
            pieces.append((begin, response))
            begin, start = begin + duration, response.states[-1]
        self.whole = Consecutive(pieces)

    def peak(self, output: np.ndarray) -> Peak:
        """Largest modulus of a linear output."""
        return self.whole.peak(output)

    def last_above(self, output: np.ndarray, level: float) -> float:
        """Time after which |c x| stays below a level, s."""
        return self.whole.last_above(output, level)


class Disturbed:
    """Linear response to (25) from rest, piece by piece between the switching times.

    Parameters
    ----------
    satellite : Satellite
    group : str
    K : ndarray
    torque : Disturbance
    end : float
        s.
    axes : sequence of bool, optional
        On which axes of the group it acts; every one by default.
    step : float
        Sampling, s.
    fine : bool, optional
        Whether to sample every mode of the loop after each switching time, as `stages` does.
    """

    def __init__(
        self,
        satellite: Satellite,
        group: str,
        K: np.ndarray,
        torque: Disturbance,
        end: float,
        axes: np.ndarray | None = None,
        step: float = 1.0,
        fine: bool = False,
    ) -> None:
        _, B = linear_model(satellite, group)
        acting = np.ones(B.shape[1]) if axes is None else np.asarray(axes, dtype=float)
        A, shape = loop_matrix(satellite, group, K), B @ acting
        rates = [k * satellite.n for k in range(1, torque.harmonics + 1)]
        self.size, poles = A.shape[0], np.linalg.eigvals(A)
        pieces: list[tuple[float, Response]] = []
        marks = [0.0, *(t for t in (torque.start, torque.end) if t < end), end]
        state = np.zeros(self.size)
        for begin, stop in pairwise(marks):
            constant = torque.step if torque.start <= begin < torque.end else 0.0
            whole, extra = with_harmonics(A, shape, rates, torque.amplitude, constant)
            for i, rate in enumerate(rates):
                extra[2 * i], extra[2 * i + 1] = np.sin(rate * begin), np.cos(rate * begin)
            length = stop - begin
            parts = stages(poles, length, step) if fine else [(length, max(int(np.ceil(length / step)), 1))]
            joined = np.concatenate([state, extra])
            for duration, steps in parts:
                response = Response(whole, joined, duration, steps)
                pieces.append((begin, response))
                begin, joined = begin + duration, response.states[-1]
            state = joined[: self.size]
        self.whole = Consecutive(pieces)

    def samples(self) -> tuple[np.ndarray, np.ndarray]:
        """Times and states of the satellite."""
        times = [begin + r.time[: -1 if last else None] for begin, r, last in self._marked()]
        states = [r.states[: -1 if last else None, : self.size] for _, r, last in self._marked()]
        return np.concatenate(times), np.concatenate(states)

    def _marked(self) -> list[tuple[float, Response, bool]]:
        pieces = self.whole.pieces
        return [(begin, r, i + 1 < len(pieces)) for i, (begin, r) in enumerate(pieces)]

    def peak(self, output: np.ndarray) -> Peak:
        """Largest modulus of a linear output of the satellite's state."""
        return self.whole.peak(np.concatenate([output, np.zeros(len(self.whole.pieces[0][1].A) - self.size)]))


def paired(nominal: np.ndarray, other: np.ndarray, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """State matrix and start of two loops from the same start, their states one above the other."""
    n = len(start)
    A = np.zeros((2 * n, 2 * n))
    A[:n, :n], A[n:, n:] = nominal, other
    return A, np.concatenate([start, start])


def difference(nominal: np.ndarray, other: np.ndarray, start: np.ndarray, end: float, steps: int) -> Response:
    """Response of two loops from the same start, their states one above the other."""
    return Response(*paired(nominal, other, start), end, steps)


def nonlinear(
    satellite: Satellite,
    K: np.ndarray,
    start: np.ndarray,
    end: float,
    *,
    limit: float | None = None,
    torque: Disturbance | None = None,
    rtol: float = 1e-10,
    method: str = "DOP853",
) -> Trajectory:
    """Integrate the nonlinear motion (1) to (5) with the full gravity gradient under u = -K x.

    Parameters
    ----------
    satellite : Satellite
        As it is.
    K : ndarray, shape (3, 6)
    start : ndarray, shape (6,)
        Angles, then their rates.
    end : float
        s.
    limit : float, optional
        Largest modulus of each wheel's torque, N m.
    torque : Disturbance, optional
        On every axis.
    rtol, method
        See `gainsay.simulation.ode.integrate`.

    Returns
    -------
    Trajectory
        States are the angles and the inertial rate in body components.
    """
    n, inertia = satellite.n, np.array(satellite.inertia)

    def control(x: np.ndarray) -> np.ndarray:
        rates = attitude.euler_rates(x[:3], x[3:], n)
        return -K @ np.concatenate([x[:3], rates])

    def slope(t: float, x: np.ndarray) -> np.ndarray:
        u = control(x)
        if limit is not None:
            u = np.clip(u, -limit, limit)
        if torque is not None:
            u = u + torque.torque(t, n)
        return attitude.derivative(x, inertia, n, u)

    kinks = []
    if limit is not None:
        kinks = [_kink(control, axis, sign * limit) for axis in range(3) for sign in (-1, 1)]
    begin = np.concatenate([start[:3], attitude.rate_body(start[:3], start[3:], n)])
    return integrate(slope, begin, end, rtol=rtol, atol=1e-13, kinks=kinks, method=method)


def _kink(control: Callable[[np.ndarray], np.ndarray], axis: int, level: float) -> Callable[[float, np.ndarray], float]:
    return lambda t, x: control(x)[axis] - level


def angle_rates(states: np.ndarray, n: float) -> np.ndarray:
    """Angles and their rates, shape (N, 6), from angles and body rates."""
    rates = [attitude.euler_rates(x[:3], x[3:], n) for x in states]
    return np.hstack([states[:, :3], np.array(rates)])

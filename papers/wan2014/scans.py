"""What the figures say, over every start of the observer: the paper gives none (Figures 2 to 5)."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from gainsay.errors import ComputationError
from gainsay.results import Results, task
from gainsay.scans import corners, plausible, sample, scans
from gainsay.simulation.batch import Segment, polished_crossing, polished_peak, segments
from gainsay.simulation.ode import Trajectory, largest, last_crossing
from gainsay.tables import Case
from papers.wan2014.plant import ESTIMATE, POSITION, VELOCITY, ClosedLoop

#: the transient in which the largest thrust falls whatever the start, s
TRANSIENT = 120.0
#: what the paper calls initial fluctuations of the thrust is looked for in this first part, s
FLUCTUATION = 20.0
#: the velocity estimate has settled once its error stays below this part of the chaser's first speed
SETTLED = 0.01
#: capture means that the range stays below this, m
CAPTURE_RADIUS = 10.0
RTOL = 1e-9
#: a peak within this part of the largest so far is polished
PEAK_WORTH = 0.05
SAMPLES = 256


def start(case: Case, position_share: float, velocity_share: float) -> np.ndarray:
    """Return a start of the estimate, shape (6,): parts of the true position (m) and velocity (m/s)."""
    x0 = case.matrix("x0").ravel()
    return np.concatenate([position_share * x0[:3], velocity_share * x0[3:]])


def settling_time(case: Case, trajectory: Trajectory) -> float:
    """Return the time after which the velocity error stays below `SETTLED` times the first speed, s; 0 if it always is.

    Raises
    ------
    ComputationError
        If it is not below at the end.
    """
    bound = SETTLED * float(np.linalg.norm(case.matrix("x0").ravel()[3:]))

    def excess(_: np.ndarray, states: np.ndarray) -> np.ndarray:
        return np.linalg.norm(states[:, VELOCITY] - states[:, ESTIMATE][:, 3:], axis=1) - bound

    if largest(trajectory, excess)[1] < 0:
        return 0.0
    return last_crossing(trajectory, excess)


def thrust_ratio(loop: ClosedLoop, trajectory: Trajectory) -> float:
    """Return the largest thrust over its bound of (5), all axes, over continuous time."""
    return largest(trajectory, lambda t, x: np.max(np.abs(loop.thrust(x[:, ESTIMATE])) / loop.limits, axis=1))[1]


def fluctuation(loop: ClosedLoop, trajectory: Trajectory) -> float:
    """Return the total variation of f_x between samples 0.05 s apart over the first part of a run, N."""
    time = np.arange(0, FLUCTUATION + 0.025, 0.05)
    return float(np.sum(np.abs(np.diff(loop.thrust(trajectory(time)[:, ESTIMATE])[:, 0]))))


@dataclass(frozen=True)
class Flight:
    """What the sentences on the figures speak of, for one start of the observer.

    Attributes
    ----------
    thrust_ratio : float
        Largest thrust over its bound.
    range_3000s, final_range : float
        m.
    final_speed : float
        m/s.
    settling_share : float
        Settling time of the estimate over the capture time.
    fluctuation : float
        N.
    """

    thrust_ratio: float
    range_3000s: float
    final_range: float
    final_speed: float
    settling_share: float
    fluctuation: float


#: length of a stretch of flights that is looked at at once, s
STRETCH = 500.0
#: points looked at in every step of the integrator before peaks and crossings are polished
REFINE = 12


class Flights:
    """The printed controller from many starts of the observer at once, over the horizon.

    Parameters
    ----------
    case : Case
    shares : sequence of (float, float)
        Parts of the true position and velocity that the estimates start with.
    """

    def __init__(self, case: Case, shares: Sequence[tuple[float, float]]) -> None:
        self.case, self.loop = case, ClosedLoop(case, case.matrix("K"), case.matrix("L"))
        self.count = len(shares)
        x0 = case.matrix("x0").ravel()
        self.starts = np.array([np.concatenate([x0, start(case, *pair)]) for pair in shares])
        self._thrust_over_bounds = np.zeros((3, 12))
        self._thrust_over_bounds[:, ESTIMATE] = -self.loop.K / self.loop.limits[:, None]
        self.speed = SETTLED * float(np.linalg.norm(x0[3:]))
        self.ratio, self.range_3000s = np.zeros(self.count), np.full(self.count, np.nan)
        self.fluctuations = np.full(self.count, np.nan)
        self.capture, self.settled = np.full(self.count, np.nan), np.zeros(self.count)
        self._far, self._off = np.ones(self.count, dtype=bool), np.ones(self.count, dtype=bool)

    def _largest_axis(self, thrust: np.ndarray, times: np.ndarray) -> np.ndarray:
        x, y, z = np.moveaxis(np.abs(thrust), -1, 0)
        return np.maximum(np.maximum(x, y), z)  # a reduction along an axis of three takes ten times as long

    def _beyond(self, states: np.ndarray, times: np.ndarray) -> np.ndarray:
        return np.linalg.norm(states[..., POSITION], axis=-1) - CAPTURE_RADIUS

    def _error(self, states: np.ndarray, times: np.ndarray) -> np.ndarray:
        return np.linalg.norm(states[..., VELOCITY] - states[..., ESTIMATE][..., 3:], axis=-1) - self.speed

    def _last_crossing(
        self,
        part: Segment,
        grid: np.ndarray,
        values: np.ndarray,
        output: Callable[[np.ndarray, np.ndarray], np.ndarray],
        still: np.ndarray,
        times: np.ndarray,
    ) -> np.ndarray:
        """Locate the last time at which each output turns negative; return which are not negative at the end."""
        positive = values >= 0
        last = len(grid) - 1 - np.argmax(positive[::-1], axis=0)
        turned = np.flatnonzero(positive.any(axis=0) & (last < len(grid) - 1))
        if len(turned):
            low, high = grid[last[turned]], grid[last[turned] + 1]
            times[turned] = polished_crossing(part, turned, low, high, output)
        # an output that turned between two stretches turned at their common end
        fell = np.flatnonzero(still & ~positive.any(axis=0))
        times[fell] = grid[0]
        return positive[-1]

    def _look_at_thrust(self, part: Segment) -> None:
        thrust = part.outputs(self._thrust_over_bounds)
        worth = np.flatnonzero(thrust.bounds().max(axis=1) > self.ratio)
        if not len(worth):
            return
        grid, thrust = part.grid(REFINE), thrust.chosen(worth)
        values = self._largest_axis(thrust(grid), grid)
        peaked = np.flatnonzero(values.max(axis=0) > (1 - PEAK_WORTH) * self.ratio[worth])
        best = values.argmax(axis=0)[peaked]
        low, high = grid[np.maximum(best - 1, 0)], grid[np.minimum(best + 1, len(grid) - 1)]
        peaks = polished_peak(thrust, peaked, low, high, self._largest_axis)
        self.ratio[worth[peaked]] = np.maximum(self.ratio[worth[peaked]], peaks)

    def _look(self, part: Segment) -> None:
        self._look_at_thrust(part)
        grid = part.grid(REFINE)
        states = part(grid)
        self._far = self._last_crossing(part, grid, self._beyond(states, grid), self._beyond, self._far, self.capture)
        self._off = self._last_crossing(part, grid, self._error(states, grid), self._error, self._off, self.settled)
        if grid[0] <= 3000.0 <= grid[-1]:
            self.range_3000s = np.linalg.norm(part(np.array([3000.0]))[0][:, POSITION], axis=1)
        if grid[0] == 0.0:
            thrust = self.loop.thrust(part(np.arange(0, FLUCTUATION + 0.025, 0.05))[..., ESTIMATE])[..., 0]
            self.fluctuations = np.abs(np.diff(thrust, axis=0)).sum(axis=0)

    def _parts(self) -> Iterator[Segment]:
        """Integrate all flights, stretch by stretch."""
        end, atol = self.case.number("horizon"), RTOL * np.tile([1.0] * 3 + [1e-2] * 3, 2)
        return segments(*self.loop.many_flights(), self.starts, end, rtol=RTOL, atol=atol, length=STRETCH)

    def thrust_ratios(self) -> np.ndarray:
        """Integrate all flights and return the largest thrust over its bound of each, and nothing else of them."""
        for part in self._parts():
            self._look_at_thrust(part)
        return self.ratio

    def fly(self) -> list[Flight]:
        """Integrate all flights and return what the sentences speak of, in the order of the starts.

        Raises
        ------
        ComputationError
            If a flight is not captured or its estimate not settled at the end of the horizon.
        """
        part = None
        for part in self._parts():
            self._look(part)
        if part is None or self._far.any() or self._off.any():
            raise ComputationError("Figures 2 to 5", "a flight is not captured or settled at the end of the horizon")
        final = part(np.array([self.case.number("horizon")]))[0]
        distance = np.linalg.norm(final[:, POSITION], axis=1)
        speed = np.linalg.norm(final[:, VELOCITY], axis=1)
        columns = (self.ratio, self.range_3000s, distance, speed, self.settled / self.capture, self.fluctuations)
        return [Flight(*(float(x) for x in row)) for row in zip(*columns, strict=True)]


#: quantity -> what it reads from a flight and from the one that starts without error
READINGS: dict[str, Callable[[Flight, Flight], float]] = {
    "audit.thrust_ratio": lambda f, exact: f.thrust_ratio,
    "audit.error_settling_share": lambda f, exact: f.settling_share,
    "audit.final_range": lambda f, exact: f.final_range,
    "audit.final_speed": lambda f, exact: f.final_speed,
    "audit.fluctuation_share": lambda f, exact: exact.fluctuation / f.fluctuation,
}


@task("Figures 2 to 5")
def over_starts(case: Case, results: Results) -> None:
    """Scan every sentence on the figures over the plausible starts of the observer."""
    inputs = [plausible(case, "estimate_position_share"), plausible(case, "estimate_velocity_share")]
    flown: dict[tuple[float, float], Flight] = {}

    def fly(points: Sequence[Mapping]) -> list[Flight]:
        """Fly what was not flown before, all at once."""
        shares = [(float(p["estimate_position_share"]), float(p["estimate_velocity_share"])) for p in points]
        new = list(dict.fromkeys(pair for pair in shares if pair not in flown))
        if new:
            flown.update(zip(new, Flights(case, new).fly(), strict=True))
        return [flown[pair] for pair in shares]

    def one(position: float, velocity: float) -> Flight:
        return fly([{"estimate_position_share": position, "estimate_velocity_share": velocity}])[0]

    fly([*sample(inputs, SAMPLES, 0), *corners(inputs)])
    exact = one(1.0, 1.0)

    def together(points: Sequence[Mapping]) -> list[dict[str, float]]:
        return [{quantity: read(flight, exact) for quantity, read in READINGS.items()} for flight in fly(points)]

    for scan in scans(case, list(READINGS), inputs, samples=SAMPLES, together=together, parts=32):
        results.scan(scan)
        results.say(f"{scan.quantity}, over the starts", scan.note)
    measured = one(1.0, 0.0)
    results.quantity(
        "audit.thrust_ratio",
        measured.thrust_ratio,
        source="Figure 4",
        method="largest thrust over its bound, estimate starting at the measured position",
    )
    results.quantity(
        "audit.fluctuation_share",
        exact.fluctuation / measured.fluctuation,
        source="Figure 4",
        method="total variation of f_x over 20 s, without initial error over with it",
    )


def transient_ratio(case: Case, position_share: float) -> float:
    """Return the largest thrust over its bound when a part of the position and no velocity is known at the start."""
    loop = ClosedLoop(case, case.matrix("K"), case.matrix("L"))
    trajectory = loop.simulate(start(case, position_share, 0.0), TRANSIENT, rtol=RTOL)
    return thrust_ratio(loop, trajectory)


@task("Figure 4, (5)")
def start_boundary(case: Case, results: Results) -> None:
    """Locate the part of the position that the observer must know at the start for the thrust bounds to hold."""
    if not transient_ratio(case, 1.0) < 1 < transient_ratio(case, 0.0):
        raise ComputationError("Figure 4", "the thrust bounds do not turn between no position known and all of it")
    boundary = scipy.optimize.brentq(lambda share: transient_ratio(case, share) - 1, 0.0, 1.0, xtol=1e-9)
    method = "root of the thrust ratio less one over the known part of the position, no velocity known"
    results.quantity("audit.start_boundary", boundary, method=method, source="Figure 4")
    results.say("Figure 4, (5)", f"bounds hold where the estimate starts with {boundary:.4f} of the position or more")

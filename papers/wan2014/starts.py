"""What the figures say, over every start of the observer: the paper gives none (Figures 2 to 5)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.optimize import brentq

from gainsay.errors import ComputationError
from gainsay.simulation.ode import Trajectory, largest, last_crossing
from gainsay.tables import Case
from gainsay.tables.results import Results, task
from gainsay.verdicts.scan import plausible, scan
from papers.wan2014.plant import ESTIMATE, POSITION, VELOCITY, ClosedLoop, capture_time

#: the transient in which the largest thrust falls whatever the start, s
TRANSIENT = 120.0
#: what the paper calls initial fluctuations of the thrust is looked for in this first part, s
FLUCTUATION = 20.0
#: the velocity estimate has settled once its error stays below this part of the chaser's first speed
SETTLED = 0.01
#: capture means that the range stays below this, m
CAPTURE_RADIUS = 10.0
RTOL = 1e-9


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


def fly(case: Case, position_share: float, velocity_share: float) -> Flight:
    """Simulate the printed controller from one start of the observer over the horizon."""
    loop = ClosedLoop(case, case.matrix("K"), case.matrix("L"))
    end = case.number("horizon")
    trajectory = loop.simulate(start(case, position_share, velocity_share), end, rtol=RTOL, method="LSODA")
    final = trajectory(end)
    return Flight(
        thrust_ratio=thrust_ratio(loop, trajectory),
        range_3000s=float(np.linalg.norm(trajectory(3000.0)[POSITION])),
        final_range=float(np.linalg.norm(final[POSITION])),
        final_speed=float(np.linalg.norm(final[VELOCITY])),
        settling_share=settling_time(case, trajectory) / capture_time(trajectory, CAPTURE_RADIUS),
        fluctuation=fluctuation(loop, trajectory),
    )


#: claim -> quantity, what it reads from a flight, and the largest value with which the claim holds
READINGS: dict[str, tuple[str, Callable[[Flight, Flight], float], str]] = {
    "fig4-bounds": ("audit.thrust_ratio", lambda f, exact: f.thrust_ratio, "every thrust within its bound of (5)"),
    "fig2-convergence": ("audit.error_settling_share", lambda f, exact: f.settling_share, "settled in a twentieth"),
    "fig3-fig5-positions": ("audit.final_range", lambda f, exact: f.final_range, "range below 0.1 m at the end"),
    "fig3-fig5-velocities": ("audit.final_speed", lambda f, exact: f.final_speed, "speed below 1 mm/s at the end"),
    "fig5-rendezvous": ("audit.range_3000s", lambda f, exact: f.range_3000s, "range of at most 10 m at 3000 s"),
    "fig4-fluctuations": ("audit.fluctuation_share", lambda f, exact: exact.fluctuation / f.fluctuation,
                          "thrust moves no less than without estimation error"),
}  # fmt: skip


@task("Figures 2 to 5")
def over_starts(case: Case, results: Results) -> None:
    """Scan every sentence on the figures over the plausible starts of the observer."""
    inputs = [plausible(case, "estimate_position_share"), plausible(case, "estimate_velocity_share")]
    flown = cache(lambda position, velocity: fly(case, position, velocity))
    exact = flown(1.0, 1.0)
    for claim, (quantity, read, criterion) in READINGS.items():
        limit = float(case.claims[claim].published)

        def evaluate(point: Mapping, read: Callable = read) -> float:
            return read(flown(point["estimate_position_share"], point["estimate_velocity_share"]), exact)

        found = scan(claim, quantity, inputs, evaluate, lambda value, limit=limit: value <= limit, criterion=criterion)
        results.scan(found)
        results.say(case.claims[claim].where, found.note)
    measured = flown(1.0, 0.0)
    results.quantity("audit.thrust_ratio", measured.thrust_ratio, source="Figure 4",
                     method="largest thrust over its bound, estimate starting at the measured position")  # fmt: skip
    results.quantity("audit.fluctuation_share", exact.fluctuation / measured.fluctuation, source="Figure 4",
                     method="total variation of f_x over 20 s, without initial error over with it")  # fmt: skip


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
    boundary = brentq(lambda share: transient_ratio(case, share) - 1, 0.0, 1.0, xtol=1e-9)
    method = "root of the thrust ratio less one over the known part of the position, no velocity known"
    results.quantity("audit.start_boundary", boundary, method=method, source="Figure 4")
    results.say("Figure 4, (5)", f"bounds hold where the estimate starts with {boundary:.4f} of the position or more")

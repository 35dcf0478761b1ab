"""Simulation of the flexible loop of zhang2013 under a time-varying delay, and the numbers read off a solution."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import scipy

from gainsay.errors import InputError
from gainsay.simulation.delay import DelayLaw, DelaySolution, simulate_delay
from gainsay.tables import Case
from papers.zhang2013.plant import Rows, Spacecraft

STARTS = ("zero", "matched")
"""Start of the observer's own state: p(0) = 0, or p(0) = -L x(0), for which the first estimate is zero."""
STEP, STAGES = 0.02, 5
ESTIMATION_WINDOW = 50.0


def delay_law(case: Case) -> DelayLaw:
    """d(t) = mean + amplitude sin(frequency t) within 0..d_M and d' <= mu."""
    mean, amplitude, frequency = (case.number(f"delay_{name}") for name in ("mean", "amplitude", "frequency"))
    return DelayLaw(lambda t: mean + amplitude * np.sin(frequency * t), case.number("d_M"), case.number("mu"))


def external_torque(case: Case, frequency: float | None = None) -> Callable[[np.ndarray], np.ndarray]:
    """w1(t), N m: amplitude (3 cos wt + 1.5 sin wt); printed with w = 1 rad/s."""
    size, c, s = (case.number(f"w1_{name}") for name in ("amplitude", "cosine", "sine"))
    w = case.number("w1_frequency") if frequency is None else frequency
    return lambda t: size * (c * np.cos(w * t) + s * np.sin(w * t))


@dataclass(frozen=True)
class Flight:
    """One closed loop on the flexible plant and its solution.

    Attributes
    ----------
    solution : DelaySolution
        State (theta, theta', eta1, eta2, eta1', eta2') and w2hat where there is an observer.
    K : ndarray, shape (2,)
    vibration : ndarray, shape (4,)
        Row of w2 over (eta, eta').
    law : DelayLaw
    mode : str
    """

    solution: DelaySolution
    K: np.ndarray
    vibration: np.ndarray
    law: DelayLaw
    mode: str

    def w2(self, states: np.ndarray) -> np.ndarray:
        """Torque of the flexible modes on the body, N m."""
        return states[:, 2:6] @ self.vibration

    def estimate(self, states: np.ndarray) -> np.ndarray:
        """w2hat, N m; zero without observer."""
        return np.zeros(len(states)) if self.mode == "no_observer" else states[:, 6]

    def error(self, states: np.ndarray) -> np.ndarray:
        """w2 - w2hat, N m."""
        return self.w2(states) - self.estimate(states)

    def root_mean_square(self, signal: Callable[[np.ndarray], np.ndarray], start: float, end: float) -> float:
        """Root of the mean of the square of a function of the states between two times, s."""
        square = self.solution.integral(lambda t, x: signal(x) ** 2, np.array([end]), start)[0]
        return float(np.sqrt(square / (end - start)))

    def torque(self, times: np.ndarray, states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The two parts of (6) as applied, N m: K x and -w2hat."""
        late = self.solution(times - self.law(times))
        return late[:, :2] @ self.K, -self.estimate(late if self.mode == "all" else states)


def fly(
    case: Case,
    K: Rows,
    L: Rows,
    mode: str,
    start: str,
    *,
    law: DelayLaw | None = None,
    w1_frequency: float | None = None,
    horizon: float | None = None,
    step: float = STEP,
    stages: int = STAGES,
) -> Flight:
    """Simulate the flexible loop over the horizon.

    Parameters
    ----------
    K, L : ndarray, shape (1, 2)
    mode : str
        One of `papers.zhang2013.plant.MODES`.
    start : str
        One of `STARTS`. In mode "all" the estimate before t = 0, which the delayed input still sees, is that of t = 0.
    law, w1_frequency, horizon : optional
        Instead of those of the tables.
    step, stages : optional
        Of the collocation.
    """
    if start not in STARTS:
        raise InputError("start of the observer", value=start, expected=", ".join(STARTS))
    craft, law, w1 = Spacecraft.of(case), law or delay_law(case), external_torque(case, w1_frequency)
    loop = craft.flexible_loop(K, L, mode)
    x0 = np.array([case.number("theta0"), case.number("rate0")])
    initial = np.zeros(loop.order)
    initial[:2] = x0
    if mode != "no_observer" and start == "zero":
        initial[6] = (np.asarray(L) @ x0).item()
    push = loop.B[:, 0]
    solution = simulate_delay(
        loop.A,
        loop.Bd,
        loop.Cd,
        law,
        initial,
        horizon or case.number("horizon"),
        forcing=lambda t: w1(t)[:, None] * push,
        step=step,
        stages=stages,
    )
    return Flight(solution, np.asarray(K, dtype=float).ravel(), craft.vibration[0].astype(float), law, mode)


def lowest_angle(flight: Flight) -> tuple[float, float]:
    """Time (s) and value (rad) of the least angle over the whole run, between samples too."""
    solution = flight.solution
    times = np.linspace(solution.mesh[0], solution.mesh[-1], 4 * len(solution.mesh))
    k = int(np.argmin(solution(times)[:, 0]))
    low, high = times[max(k - 1, 0)], times[min(k + 1, len(times) - 1)]

    def rate(t: float) -> float:
        return float(solution(np.array([t]))[0, 1])

    if rate(low) < 0 < rate(high):  # theta' is a state: its zero is the minimum
        time = float(scipy.optimize.brentq(rate, low, high, xtol=1e-13))
        return time, float(solution(np.array([time]))[0, 0])
    return float(times[k]), float(solution(times[k])[0, 0])


def last_outside(flight: Flight, radius: float) -> float:
    """Last time at which |theta| is at least the radius, s, to the grid of a quarter of the mesh and then bisected."""
    solution = flight.solution
    times = np.linspace(solution.mesh[0], solution.mesh[-1], 4 * len(solution.mesh))
    outside = np.flatnonzero(np.abs(solution(times)[:, 0]) >= radius)
    if not outside.size:
        return 0.0
    k = outside[-1]
    if k == len(times) - 1:
        return float(times[-1])
    return float(scipy.optimize.brentq(lambda t: abs(solution(t)[0, 0]) - radius, times[k], times[k + 1], xtol=1e-12))


def numbers(flight: Flight) -> dict[str, tuple[float, float, str]]:
    """Return the located numbers of a run: name -> (time, value, unit)."""
    solution = flight.solution
    end = float(solution.mesh[-1])
    window, early = min(ESTIMATION_WINDOW, end), min(10.0, end)
    at_early, at_end = (solution(np.array([t]))[0] for t in (early, end))
    angle = solution.integral(lambda t, x: x[:, 0] ** 2, np.array([end]))[0]
    time, lowest = lowest_angle(flight)
    values = {
        "theta_10s": (early, float(at_early[0]), "rad"),
        "theta_min": (time, lowest, "rad"),
        "theta_end": (end, float(at_end[0]), "rad"),
        "rate_end": (end, float(at_end[1]), "rad/s"),
        "squared_angle": (end, float(angle), "rad^2 s"),
        "vibration_rms_50s": (window, flight.root_mean_square(flight.w2, 0.0, window), "N m"),
        "vibration_rms_end": (end, flight.root_mean_square(flight.w2, end - window, end), "N m"),
    }
    settled = last_outside(flight, 1e-3)
    values["settling_1mrad"] = (settled, settled, "s")
    if flight.mode != "no_observer":
        values["estimation_error_rms_50s"] = (window, flight.root_mean_square(flight.error, 0.0, window), "N m")
        values["estimation_error_rms_end"] = (end, flight.root_mean_square(flight.error, end - window, end), "N m")
    return values


def admissible(case: Case, point: Mapping) -> bool:
    """Tell whether a plausible delay law keeps within 0..d_M and mu."""
    mean, amplitude = point["delay_mean"], point["delay_amplitude"]
    inside = amplitude <= mean and mean + amplitude <= case.number("d_M")
    return inside and amplitude * point["delay_frequency"] <= case.number("mu")


def scan_numbers(case: Case, point: Mapping) -> dict[str, float]:
    """Quantities of the printed gains for one choice of what the text leaves out, by the ids of the quantities.

    Parameters
    ----------
    point : mapping
        delay_mean, delay_amplitude, delay_frequency, w1_frequency, delay_mode, observer_start, horizon.
    """
    mean, amplitude, frequency = (point[f"delay_{name}"] for name in ("mean", "amplitude", "frequency"))
    law = DelayLaw(lambda t: mean + amplitude * np.sin(frequency * t), case.number("d_M"), case.number("mu"))
    K, L = case.printed("K").exact, case.printed("L").exact

    def run(mode: str, until: float) -> Flight:
        return fly(
            case,
            K,
            L,
            mode,
            point["observer_start"],
            law=law,
            w1_frequency=point["w1_frequency"],
            horizon=until,
            step=0.2,
            stages=7,
        )

    end, window = point["horizon"], ESTIMATION_WINDOW
    flight = run(point["delay_mode"], max(end, 100.0))
    vibration = flight.root_mean_square(flight.w2, 0.0, window)
    bare = run("no_observer", window)
    late = np.abs(flight.solution(np.linspace(90.0, 100.0, 501))[:, 0]).max()
    angle, rate = flight.solution(np.array([end]))[0, :2]
    return {
        "audit.rejection": flight.root_mean_square(flight.error, 0.0, window) / vibration,
        "audit.vibration_ratio": vibration / bare.root_mean_square(bare.w2, 0.0, window),
        "audit.convergence": float(late / case.number("theta0")),
        "run.theta_end": float(angle),
        "run.rate_end": float(rate),
        "run.estimation_error_rms_end": flight.root_mean_square(flight.error, end - window, end),
    }

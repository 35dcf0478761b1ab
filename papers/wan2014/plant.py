"""The spacecraft of the paper: design model (1)-(3) and the two-body closed loop that its section 4 simulates."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gainsay.dynamics.relative_orbit import KeplerOrbit, clohessy_wiltshire, relative_acceleration, thrust_input
from gainsay.simulation.ode import Trajectory, integrate, largest, last_crossing
from gainsay.tables import Case

#: positions of the states of `ClosedLoop` in its state vector
POSITION, VELOCITY, ESTIMATE = slice(0, 3), slice(3, 6), slice(6, 12)
ANOMALY, COST, DELTA_V, SQUARED_ERROR = 12, 13, 14, 15
#: position of the force behind the states of plant and observer
FORCE = slice(12, 15)
AXES = ("x", "y", "z")


@dataclass(frozen=True)
class DesignModel:
    """Model (1) without its uncertainty: dx/dt = A x + B u, with position (m) and velocity (m/s) in LVLH as states.

    Attributes
    ----------
    A : ndarray, shape (6, 6)
    B : ndarray, shape (6, 3)
    """

    A: np.ndarray
    B: np.ndarray


def design_model(case: Case) -> DesignModel:
    """Return the model that the paper designs with: (2) at the printed n and m."""
    return DesignModel(clohessy_wiltshire(case.number("mean_motion")), thrust_input(case.number("mass")))


def noncircular_part(eccentricity: float, rate: float, mean_anomaly: float) -> np.ndarray:
    """Return Delta A of (2), 6x6, as printed."""
    e, n, sine, cosine = eccentricity, rate, math.sin(mean_anomaly), math.cos(mean_anomaly)
    delta = np.zeros((6, 6))
    delta[3, [0, 1, 4]] = 10 * e * n**2 * cosine, -2 * e * n**2 * sine, 4 * e * n * cosine
    delta[4, [0, 1, 3]] = 2 * e * n**2 * sine, e * n**2 * cosine, -4 * e * n * cosine
    delta[5, 2] = -3 * e * n**2 * cosine
    return delta


def target_orbit(case: Case) -> KeplerOrbit:
    """Return the target's orbit from its perigee radius and eccentricity."""
    e = case.number("eccentricity")
    return KeplerOrbit(case.number("gravitational_parameter"), case.number("perigee_radius") / (1 - e), e)


def thrust_limits(case: Case) -> np.ndarray:
    """Return the thrust bounds of (5), shape (3,), N."""
    return np.array([case.number(f"thrust_max_{axis}") for axis in AXES])


def observer_start(case: Case, choice: str | None = None) -> np.ndarray:
    """Return the start of the estimate, shape (6,), by name of the choice in the parameter table."""
    x0 = case.matrix("x0").ravel()
    measured = np.concatenate([x0[:3], np.zeros(3)])
    return {"measured_position": measured, "exact": x0, "zero": np.zeros(6)}[choice or case.choice("observer_start")]


@dataclass(frozen=True)
class ClosedLoop:
    """Plant, observer (7) and control law (10), with the integrals of cost, velocity increment and squared error.

    Attributes
    ----------
    case : Case
    K, L : ndarray, shapes (3, 6) and (6, 3)
    linear : bool
        Plant (1) with the printed n instead of the two-body problem.
    clipped : bool
        Thrust clipped at (5); the observer knows the thrust applied.
    """

    case: Case
    K: np.ndarray
    L: np.ndarray
    linear: bool = False
    clipped: bool = False

    @cached_property
    def model(self) -> DesignModel:
        """The design model behind the observer."""
        return design_model(self.case)

    @cached_property
    def limits(self) -> np.ndarray:
        """The thrust bounds of (5), N."""
        return thrust_limits(self.case)

    def thrust(self, estimate: np.ndarray) -> np.ndarray:
        """Return the thrust applied, (..., 3) N, for estimates (..., 6)."""
        commanded = estimate @ self._feedback
        return np.clip(commanded, -self.limits, self.limits) if self.clipped else commanded

    @cached_property
    def _feedback(self) -> np.ndarray:
        return -self.K.T

    def right_hand_side(self) -> Callable[[float, np.ndarray], np.ndarray]:
        """Return f(t, x) for the 16 states; see the slices of this module."""
        orbit, mass = target_orbit(self.case), self.case.number("mass")
        Q, R, C = self.case.matrix("Q"), self.case.matrix("R"), self.case.matrix("C")
        e, n = self.case.number("eccentricity"), self.case.number("mean_motion")
        start_anomaly, A = self.case.number("mean_anomaly_at_start"), self.model.A
        h = orbit.angular_momentum
        # All that is linear in state, estimate and force, in one product: rows of the position, of the velocity by the
        # force and of the estimate (7); the weights of the cost; the error.
        linear = np.zeros((37, 15))
        linear[POSITION, VELOCITY] = np.eye(3)
        linear[ESTIMATE, :6], linear[ESTIMATE, ESTIMATE] = self.L @ C, self.model.A - self.L @ C
        linear[VELOCITY, FORCE], linear[ESTIMATE, FORCE] = np.eye(3) / mass, self.model.B
        linear[16:22, :6], linear[28:31, FORCE] = Q, R
        linear[31:, :6], linear[31:, ESTIMATE] = np.eye(6), -np.eye(6)
        z = np.zeros(15)

        def linear_acceleration(t: float, x: np.ndarray) -> np.ndarray:
            return ((A + noncircular_part(e, n, n * t + start_anomaly)) @ x)[3:]

        def two_body_acceleration(x: list[float], anomaly: float) -> tuple[float, float, float]:
            return relative_acceleration(orbit, anomaly, x[:3], x[3:])

        def derivative(t: float, state: np.ndarray) -> np.ndarray:
            x, anomaly, force = state[:6], float(state[ANOMALY]), self.thrust(state[ESTIMATE])
            z[:12], z[FORCE] = state[:12], force
            found = linear @ z
            slope, weighted, error = found[:16], found[16:31], found[31:]
            slope[VELOCITY] += linear_acceleration(t, x) if self.linear else two_body_acceleration(x.tolist(), anomaly)
            slope[ANOMALY] = h / orbit.radius(anomaly) ** 2
            slope[COST] = z @ weighted
            slope[DELTA_V] = math.sqrt(force @ force) / mass
            slope[SQUARED_ERROR] = error @ error
            return slope

        return derivative

    def many_flights(self) -> tuple[np.ndarray, np.ndarray, Callable[[np.ndarray, np.ndarray], np.ndarray]]:
        """Return (7), (10) and the two-body plant as `linear`, `entry` and `rest` of `simulation.batch.segments`.

        The states are [x; estimate], the thrust is not clipped. Linear are the plant (1) with the printed n and the
        observer; the rest is what the acceleration of the two-body problem has beyond (1).
        """
        orbit, C, A, B = target_orbit(self.case), self.case.matrix("C"), self.model.A, self.model.B
        start = self.case.number("mean_anomaly_at_start")
        linear = np.block([[A, -B @ self.K], [self.L @ C, A - self.L @ C - B @ self.K]])

        def rest(times: np.ndarray, states: np.ndarray) -> np.ndarray:
            anomalies = [true_anomaly(start + orbit.mean_motion * t, orbit.eccentricity) for t in times.tolist()]
            position, velocity = np.moveaxis(states[..., POSITION], -1, 0), np.moveaxis(states[..., VELOCITY], -1, 0)
            free = relative_acceleration(orbit, np.array(anomalies)[:, None], position, velocity)
            return np.stack(free, axis=-1) - states[..., :6] @ A[VELOCITY].T

        return linear, np.eye(12)[:, VELOCITY], rest

    def kinks(self) -> tuple:
        """Return the functions at whose zeros clipping begins or ends."""
        if not self.clipped:
            return ()
        return tuple(
            (lambda t, state, i=i, side=side: -self.K[i] @ state[ESTIMATE] - side * self.limits[i])
            for i in range(3)
            for side in (1, -1)
        )

    def simulate(self, estimate: np.ndarray, end: float, *, rtol: float = 1e-11, method: str = "DOP853") -> Trajectory:
        """Integrate from the printed initial state.

        Parameters
        ----------
        estimate : ndarray, shape (6,)
            Start of the observer.
        end : float
            s.
        rtol : float
            Relative tolerance; the absolute ones are rtol times the size of each state.
        """
        x0 = self.case.matrix("x0").ravel()
        anomaly = true_anomaly(self.case.number("mean_anomaly_at_start"), self.case.number("eccentricity"))
        start = np.concatenate([x0, estimate, [anomaly, 0.0, 0.0, 0.0]])
        size = np.concatenate([np.full(3, 1.0), np.full(3, 1e-2), np.full(3, 1.0), np.full(3, 1e-2), [1, 1e6, 1, 1e3]])
        return integrate(
            self.right_hand_side(), start, end, rtol=rtol, atol=rtol * size, method=method, kinks=self.kinks()
        )


def true_anomaly(mean_anomaly: float, eccentricity: float) -> float:
    """Solve Kepler's equation by Newton's iteration; angles in rad."""
    E = mean_anomaly
    for _ in range(50):
        step = (E - eccentricity * math.sin(E) - mean_anomaly) / (1 - eccentricity * math.cos(E))
        E -= step
        if abs(step) < 1e-15:
            break
    half = math.sqrt((1 + eccentricity) / (1 - eccentricity)) * math.tan(E / 2)
    return 2 * math.atan(half) + 2 * math.pi * math.floor((E + math.pi) / (2 * math.pi))


def distance(time: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return the range to the target, (N,) m, for states (N, 16)."""
    return np.linalg.norm(states[:, POSITION], axis=1)


def peak_thrust(loop: ClosedLoop, trajectory: Trajectory, axis: int) -> tuple[float, float]:
    """Return time (s) and size (N) of the largest thrust along an axis over continuous time."""
    return largest(trajectory, lambda t, x: np.abs(loop.thrust(x[:, ESTIMATE])[:, axis]))


def capture_time(trajectory: Trajectory, radius: float) -> float:
    """Return the time after which the range stays below a radius (m), s."""
    return last_crossing(trajectory, lambda t, x: distance(t, x) - radius)


def closed_loop_cost(case: Case, K: np.ndarray, L: np.ndarray, start: str = "measured_position") -> float:
    """Return J of (4) over the horizon, two-body plant, unclipped thrust."""
    loop = ClosedLoop(case, K, L)
    end = case.number("horizon")
    return float(loop.simulate(observer_start(case, start), end)(end)[COST])

"""The full loop (6) with (8) in time: Table 1's start and disturbance, periodic or redrawn gains."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from gainsay.simulation.periodic import Extreme, PeriodicSolution, piecewise, with_oscillators
from gainsay.tables import Case
from papers.li2021 import plant

ANGLES, RATES, MODES, CONTROLLER = slice(0, 3), slice(3, 6), slice(6, 10), slice(14, 20)
#: delta_i of each choice of `inertia_case`; Delta J2 is printed negative
INERTIAS = {"nominal": (0, 0, 0), "heavy": (1, -1, 1), "light": (-1, 1, -1)}
#: the end of a run in which its residuals are read, s
WINDOW = 100.0
#: how long the drawn factors of the gains are held, as `redrawn` has it, by reading of Figures 8 and 9
HOLDS = {"constant": "constant", "fast": "0.1", "slow": "1"}
#: state matrices of redrawn gains that are assembled at once
_AT_ONCE = 3000
#: maps a period of the variation
STEPS = 40
METHOD = f"Magnus maps, {STEPS} steps a period, continuous time; band: twice the change at half the step"
#: an angle has settled once it stays below this part of the largest one at the start
SETTLED = 0.05


def angle_size(t: np.ndarray, state: np.ndarray) -> np.ndarray:
    """Largest modulus of the three angles, rad."""
    return np.abs(state[..., ANGLES]).max(axis=-1)


def rate_size(t: np.ndarray, state: np.ndarray) -> np.ndarray:
    """Largest modulus of the three Euler rates, rad/s."""
    return np.abs(state[..., RATES]).max(axis=-1)


def mode_size(t: np.ndarray, state: np.ndarray) -> np.ndarray:
    """Largest modulus of the modal coordinates, kg^0.5 m."""
    return np.abs(state[..., MODES]).max(axis=-1)


class FlexibleLoop:
    """Flexible plant with a controller, disturbance as three further states: 14 + 6 + 3 states.

    Parameters
    ----------
    case : gainsay.tables.Case
    gains : Gains
    amplitude : float, optional
        Of the common sine of all twelve gain channels; the paper's delta_m where left out.
    phase : float, optional
        rad.
    delta : tuple of float, optional
        Normalised inertia perturbations.
    modes : float, optional
        Every modal coordinate at the start, kg^0.5 m; at rest. The paper's tables where left out.
    """

    def __init__(
        self,
        case: Case,
        gains: plant.Gains,
        amplitude: float | None = None,
        phase: float | None = None,
        delta: Sequence[float] | None = None,
        modes: float | None = None,
    ) -> None:
        self.k = plant.constants(case)
        self.gains, self.case = gains, case
        self.amplitude = case.number("delta_m") if amplitude is None else amplitude
        self.modes = case.number("modal_start") if modes is None else modes
        self.phase = case.number("variation_phase") if phase is None else phase
        delta = INERTIAS[case.choice("inertia_case")] if delta is None else delta
        self.plant = plant.flexible(self.k, delta)
        self.rate = 2 * np.pi * case.number("variation_frequency")
        self.nominal = self._with_disturbance(np.ones(12))
        self.slope = self._with_disturbance(np.full(12, 2.0)) - self.nominal

    def _with_disturbance(self, factors: np.ndarray) -> np.ndarray:
        shapes = np.zeros((20, 3))
        shapes[:14] = self.plant.B @ plant.disturbance(self.case, self.k)
        return with_oscillators(self.state_matrix(factors), shapes, self.k.orbital_rate)

    def state_matrix(self, factors: np.ndarray) -> np.ndarray:
        """State matrix (20, 20) for twelve gain factors."""
        return plant.closed_loop(self.plant, self.gains, factors[:6], factors[6:9], factors[9:])

    def variation(self, t: ArrayLike) -> np.ndarray:
        """Common gain variation at time t (s)."""
        return self.amplitude * np.sin(self.rate * np.asarray(t) + self.phase)

    def __call__(self, t: float) -> np.ndarray:
        """State matrix (23, 23) at time t."""
        return self.nominal + self.variation(t) * self.slope

    def start(self) -> np.ndarray:
        """Table 1's angles and rates; modal rates and controller zero."""
        state = np.zeros(23)
        state[:6] = self.case.matrix("x0").ravel()
        state[MODES], state[CONTROLLER] = self.modes, self.case.number("controller_start")
        state[[20, 22]] = 1
        return state

    def solve(self, steps: int = STEPS) -> PeriodicSolution:
        """Solution over the horizon, by fundamental-matrix maps over one period of the variation."""
        period = 2 * np.pi / self.rate
        return PeriodicSolution(self, period, self.start(), round(self.case.number("horizon") / period), steps)

    def torque(self, t: ArrayLike, state: np.ndarray) -> np.ndarray:
        """Control torque C_Delta_f x_f at times and states, shape (..., 3), N m."""
        return (1 + self.variation(t))[..., None] * (state[..., CONTROLLER] @ self.gains.C.T)

    def torque_size(self, t: ArrayLike, state: np.ndarray) -> np.ndarray:
        """Euclidean norm of the torque, N m."""
        return np.linalg.norm(self.torque(t, state), axis=-1)

    def peak(self, solution: PeriodicSolution) -> Extreme:
        """Largest norm of the torque over continuous time."""
        return solution.largest(self.torque_size)

    def extremes(self, solution: PeriodicSolution) -> dict[str, tuple[float, float, str]]:
        """Located numbers of a run: name -> (time, value, unit)."""
        torque = self.peak(solution)
        first = float(np.abs(self.start()[ANGLES]).max())
        end = float(solution.times[-1])
        settled = solution.last_exit(angle_size, SETTLED * first)
        residual = solution.largest(angle_size, after=end - WINDOW)
        rate = solution.largest(rate_size, after=end - WINDOW)
        modes, quiet = solution.largest(mode_size), solution.largest(mode_size, after=end - WINDOW)
        return {
            "peak_torque": (torque.time, torque.value, "N m"),
            "first_angle": (0.0, first, "rad"),
            "residual_angle": (residual.time, residual.value, "rad"),
            "first_rate": (0.0, float(np.abs(self.start()[RATES]).max()), "rad/s"),
            "residual_rate": (rate.time, rate.value, "rad/s"),
            "settling_time": (settled, settled, "s"),
            "peak_mode": (modes.time, modes.value, "kg^0.5 m"),
            "residual_mode": (quiet.time, quiet.value, "kg^0.5 m"),
            # what is left in the last 100 s of the largest value of the run
            "angle_share": (residual.time, residual.value / solution.largest(angle_size).value, "1"),
            "rate_share": (rate.time, rate.value / solution.largest(rate_size).value, "1"),
            "mode_share": (quiet.time, quiet.value / modes.value, "1"),
        }


def redrawn(
    loop: FlexibleLoop, hold: str, generators: Sequence[np.random.Generator], *, node: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions with twelve factors 1 + U(0, 1), drawn once or redrawn every `hold` seconds and held.

    Parameters
    ----------
    loop : FlexibleLoop
    hold : str
        ``constant``, or the length of an interval in seconds.
    generators : sequence of numpy.random.Generator
        One a run.
    node : float
        Largest distance of the times that are returned, s; the solutions at them are exact whatever it is.

    Returns
    -------
    times : ndarray, shape (N,)
    states : ndarray, shape (N, runs, 23)
    """
    horizon = loop.case.number("horizon")
    interval = horizon if hold == "constant" else float(hold)
    count, inner = round(horizon / interval), max(1, round(interval / node))
    factors = 1 + np.stack([generator.random((count, 12)) for generator in generators], axis=1)
    states = [np.tile(loop.start(), (1, len(generators), 1))]
    for block in np.array_split(factors, -(-count * len(generators) // _AT_ONCE)):
        # the state matrix is affine in the products of channels, so every draw is assembled by itself
        stack = np.tile(loop.nominal, (*block.shape[:2], 1, 1))
        channels = block[..., :6], block[..., 6:9], block[..., 9:]
        stack[..., :20, :20] = plant.closed_loop(loop.plant, loop.gains, *channels)
        states.append(piecewise(stack, interval, states[-1][-1], inner)[1][1:])
    return np.arange(count * inner + 1) * (interval / inner), np.concatenate(states)

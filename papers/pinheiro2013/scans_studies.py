"""The three designs of the paper at one point of the inputs that it leaves out, and what they do."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache, cached_property
from itertools import product

import numpy as np

from gainsay.errors import ComputationError
from gainsay.systems.norms import h2_norm
from gainsay.tables import Case
from papers.pinheiro2013 import conditions as mixed
from papers.pinheiro2013 import conditions_gains as gains
from papers.pinheiro2013 import response as responses
from papers.pinheiro2013.plant import (
    GROUPS,
    GeneralizedPlant,
    Satellite,
    generalized_plant,
    linear_model,
    perturbed,
)

LEVELS = ("hinf", "mixed", "h2")
SEPARATE = ("pitch", "roll_yaw")
#: corners of the uncertainty (11)
_CORNERS = np.array(list(product((-1, 1), repeat=3)))
#: longest step under (25), s: its tenth harmonic turns in 500 s and more
_LONGEST_STEP = 10.0


def base(case: Case, name: str) -> float | str:
    """Value of an input at reconstruction A, at which the printed levels can hold."""
    if name in ("disturbance_axes", "rate_unit", "norm_inputs"):
        return case.choice(name)
    return case.number(f"inertia_a_{name[-1]}" if name.startswith("inertia") else name)


class Filled(dict):
    """A point whose missing inputs are read from reconstruction A when they are asked for.

    Parameters
    ----------
    case : gainsay.tables.Case
    point : mapping
    """

    def __init__(self, case: Case, point: Mapping) -> None:
        super().__init__(point)
        self._case = case

    def __missing__(self, name: str) -> float | str:
        return base(self._case, name)


def read_inputs(plant: GeneralizedPlant, reading: str) -> GeneralizedPlant:
    """Plant with the input w, one for both norms as (19) and (21) have it, as the text is read.

    Parameters
    ----------
    plant : GeneralizedPlant
    reading : {"both", "d_alone", "channels_alone"}
        w holds the uncertainty channels and d; or d alone; or the channels alone, so that d enters no norm.
    """
    q = len(plant.channels)
    columns = {"both": slice(None), "d_alone": slice(q, None), "channels_alone": slice(q)}[reading]
    return replace(plant, B1=plant.B1[:, columns], D11=plant.D11[:, columns], channels=())


def per_axis(measure: Callable[[str, int], float]) -> np.ndarray:
    """Measure for pitch, roll, yaw: measure(group, index of the axis in it)."""
    return np.array([measure("pitch", 0), measure("roll_yaw", 0), measure("roll_yaw", 1)])


def gains_of(designs: Sequence["Designs"]) -> list[dict[tuple[str, str], np.ndarray]]:
    """Find the gains of the three levels for many points at once, by level and group.

    Raises
    ------
    ComputationError
        If a gain does not meet the first-order condition.
    """
    gain_of: list[dict[tuple[str, str], np.ndarray]] = [{} for _ in designs]
    for group in SEPARATE:
        plants = [(d.plants[group], d.gamma(level, group)) for d in designs for level in LEVELS]
        limits = [mixed.limit_gain(plant) for plant, _ in plants]
        stacked = gains.stack([plant for plant, _ in plants], [gamma for _, gamma in plants], limits)
        K, _ = gains.least_trace_gains(stacked)
        for i, of_one in enumerate(gain_of):
            of_one.update({(level, group): K[len(LEVELS) * i + j] for j, level in enumerate(LEVELS)})
    return gain_of


class Designs:
    """The three designs at one point of the inputs that shape them, and their release at 0.6 deg/s.

    Everything is computed when asked for; a release at another rate is as much larger.

    Parameters
    ----------
    case : gainsay.tables.Case
    point : mapping
        Values of inputs; what is missing is taken from reconstruction A.
    """

    def __init__(self, case: Case, point: Mapping) -> None:
        self.case, self.point = case, Filled(case, point)

    @cached_property
    def satellite(self) -> Satellite:
        """Satellite at the point."""
        point = self.point
        moments = tuple(point[f"inertia_{axis}"] for axis in "xyz")
        weights = (point["angle_weight"], point["rate_weight"], 1.0)
        return Satellite(moments, point["orbital_rate"], self.case.number("inertia_change"), weights)

    @cached_property
    def plants(self) -> dict[str, GeneralizedPlant]:
        """Generalized plant by group, its input w as read."""
        reading = self.point["norm_inputs"]
        return {group: read_inputs(plant, reading) for group, plant in self.whole_plants.items()}

    @cached_property
    def whole_plants(self) -> dict[str, GeneralizedPlant]:
        """Generalized plant by group, with all its inputs."""
        return {group: generalized_plant(self.satellite, group) for group in SEPARATE}

    def gamma(self, level: str, group: str) -> float:
        """Level at which a design is made, as printed.

        Raises
        ------
        ComputationError
            If no state feedback reaches it.
        """
        printed = {"hinf": "gamma_min", "mixed": "gamma_mixed", "h2": "gamma_max"}[level]
        gamma, least = self.case.number(printed), mixed.gamma_min(self.plants[group])
        if not gamma > least:
            raise ComputationError("(21)", f"no state feedback of {group} reaches {gamma!r}, the infimum is {least!r}")
        return gamma

    @cached_property
    def gains(self) -> dict[tuple[str, str], np.ndarray]:
        """Gain by level and group."""
        return gains_of([self])[0]

    @cached_property
    def releases(self) -> dict[tuple[str, str], tuple[responses.Transient, list[responses.Transient]]]:
        """Response of the nominal plant, and beside plants 1 and 2, by level and group."""
        releases = {}
        for (level, group), K in self.gains.items():
            rates = self.case.matrix("initial_rates")[["xyz".index(a) for a in GROUPS[group]], 0] * np.pi / 180
            A, start = responses.loop_matrix(self.satellite, group, K), np.concatenate([np.zeros(len(rates)), rates])
            others = [responses.loop_matrix(p, group, K) for p in perturbed(self.case, self.satellite, group)]
            releases[level, group] = (
                responses.Transient(A, start),
                [responses.Transient(*responses.paired(A, other, start)) for other in others],
            )
        return releases

    @cache  # noqa: B019 (designs live as long as the scans)
    def peak_angle(self, level: str) -> np.ndarray:
        """Largest modulus of each angle after release, rad."""
        return per_axis(lambda g, i: abs(self.releases[level, g][0].peak(np.eye(2 * len(GROUPS[g]))[i]).value))

    @cache  # noqa: B019
    def peak_torque(self, level: str) -> np.ndarray:
        """Largest modulus of each control torque after release, N m."""
        return per_axis(lambda g, i: abs(self.releases[level, g][0].peak(self.gains[level, g][i]).value))

    @cache  # noqa: B019
    def settling(self, level: str) -> np.ndarray:
        """Time after which each angle stays below a share of its peak, s."""
        peaks = self.peak_angle(level)

        def measure(group: str, i: int) -> float:
            peak = peaks[0] if group == "pitch" else peaks[1 + i]
            output = np.eye(2 * len(GROUPS[group]))[i]
            return self.releases[level, group][0].last_above(output, responses.SETTLED * peak)

        return per_axis(measure)

    @cache  # noqa: B019
    def difference(self, level: str) -> np.ndarray:
        """Largest difference of each angle between the nominal plant and the worse of plants 1 and 2, rad."""

        def measure(group: str, i: int) -> float:
            unit = np.eye(2 * len(GROUPS[group]))[i]
            both = self.releases[level, group][1]
            return max(abs(response.peak(np.concatenate([unit, -unit])).value) for response in both)

        return per_axis(measure)

    @cached_property
    def h2_gains(self) -> dict[str, np.ndarray]:
        """Gain of the H2 limit by group."""
        return {group: mixed.h2_gain(plant)[0] for group, plant in self.plants.items()}

    def gamma_min(self) -> float:
        """Infimum of the level over all axes, for the input w as read."""
        return max(mixed.gamma_min(plant) for plant in self.plants.values())

    def h2_limit_meets(self, gamma: float) -> list[bool]:
        """Say of each group of axes whether the gain of the H2 limit meets a level, by its Riccati equation."""
        return [
            bool(np.isfinite(mixed.trace_of_gain(plant, self.h2_gains[group], gamma)))
            for group, plant in self.plants.items()
        ]

    def h2_excess(self) -> float:
        """Excess of the H2 norm at gamma = 100 over its optimum, the larger of the two groups."""
        excesses = []
        for group, plant in self.plants.items():
            norms = []
            for K in (self.gains["h2", group], self.h2_gains[group]):
                A, B, _, _, C2 = plant.closed(K)
                norms.append(h2_norm(A, B, C2))
            excesses.append(norms[0] / norms[1] - 1)
        return max(excesses)

    def stable_range(self, level: str) -> float:
        """Largest share, in hundredths below 1, by which all moments may change with every loop stable at its corners.

        The moments change independently of each other, as in (11), by up to this share of each.
        """
        if self._stable(level, 99):
            return 0.99
        low, high = 0, 99
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if self._stable(level, middle) else (low, middle)
        return 0.01 * low

    def _stable(self, level: str, hundredths: int) -> bool:
        """Say whether every loop of a level is stable at all corners of a change of the moments."""
        loops = ((self._corners(group, hundredths), K) for (of, group), K in self.gains.items() if of == level)
        return all(bool((np.linalg.eigvals(A - B @ K).real < 0).all()) for (A, B), K in loops)

    @cache  # noqa: B019
    def _corners(self, group: str, hundredths: int) -> tuple[np.ndarray, np.ndarray]:
        """A and B2 at the corners, stacked; closed by the uncertainty (11), whose corners no rigid body need have."""
        plant = self.whole_plants[group]
        corners = [plant.uncertain(0.01 * hundredths / self.satellite.change * signs) for signs in _CORNERS]
        return np.array([A for A, _ in corners]), np.array([B for _, B in corners])

    def worst_abscissa(self) -> float:
        """Largest real part of the poles of all designs at the corners of the uncertainty (11), 1/s."""
        corners = (1 + self.satellite.change * _CORNERS) * self.satellite.inertia
        # A corner that no rigid body can have is none of the plants.
        plants = [replace(self.satellite, inertia=tuple(m)) for m in corners if 2 * m.max() <= m.sum()]
        models = {group: [linear_model(plant, group) for plant in plants] for group in SEPARATE}
        loops = (np.array([A - B @ K for A, B in models[group]]) for (_, group), K in self.gains.items())
        return max(float(np.linalg.eigvals(stack).real.max()) for stack in loops)


class Study:
    """The three designs at one point of the plausible inputs, and what they do.

    Parameters
    ----------
    case : gainsay.tables.Case
    point : mapping
        Values of inputs; what is missing is taken from reconstruction A.
    designs : Designs, optional
        Where they are known from a study of the same design inputs.
    """

    def __init__(self, case: Case, point: Mapping, designs: Designs | None = None) -> None:
        self.case, self.point = case, Filled(case, point)
        self.designs = Designs(case, point) if designs is None else designs

    @property
    def satellite(self) -> Satellite:
        """Satellite at the point."""
        return self.designs.satellite

    @property
    def plants(self) -> dict[str, GeneralizedPlant]:
        """Generalized plant by group."""
        return self.designs.plants

    @property
    def faster(self) -> float:
        """Rates of (24) over those of the designs' release."""
        return {"deg/s": 1.0, "rad/s": 180 / np.pi}[self.point["rate_unit"]]

    @property
    def gains(self) -> dict[tuple[str, str], np.ndarray]:
        """Gain by level and group."""
        return self.designs.gains

    def peak_angle(self, level: str) -> np.ndarray:
        """Largest modulus of each angle after release, rad."""
        return self.faster * self.designs.peak_angle(level)

    def peak_torque(self, level: str) -> np.ndarray:
        """Largest modulus of each control torque after release, N m."""
        return self.faster * self.designs.peak_torque(level)

    def settling(self, level: str) -> np.ndarray:
        """Time after which each angle stays below a share of its peak, s."""
        return self.designs.settling(level)

    def difference(self, level: str) -> np.ndarray:
        """Largest difference of each angle between the nominal plant and the worse of plants 1 and 2, rad."""
        return self.faster * self.designs.difference(level)

    @cached_property
    def disturbed(self) -> dict[str, np.ndarray]:
        """Largest modulus under (25) by level: of each angle, rad, then of each control torque, N m; shape (2, 3)."""
        torque, end = responses.disturbance(self.case, int(self.point["harmonics"])), self.point["disturbance_horizon"]
        peaks = {level: np.zeros((2, 3)) for level in LEVELS}
        for (level, group), K in self.gains.items():
            size = len(GROUPS[group])
            one = self.point["disturbance_axes"] == "one_axis" and size > 1
            for acting in range(size) if one else (-1,):
                axes = np.ones(size) if acting < 0 else np.eye(size)[acting]
                response = responses.Disturbed(
                    self.satellite, group, K, torque, end, axes=axes, step=_LONGEST_STEP, fine=True
                )
                for i in range(size) if acting < 0 else (acting,):
                    column = 0 if group == "pitch" else 1 + i
                    for row, output in enumerate((np.eye(2 * size)[i], K[i])):
                        peaks[level][row, column] = abs(response.peak(output).value)
        return peaks

    def disturbed_angle(self, level: str) -> np.ndarray:
        """Largest modulus of each angle under (25), rad."""
        return self.disturbed[level][0]

    def disturbed_torque(self, level: str) -> np.ndarray:
        """Largest modulus of each control torque under (25), N m."""
        return self.disturbed[level][1]

    def peak_momentum(self) -> float:
        """Largest angular momentum of an axis at the start of the release, N m s."""
        rates = self.faster * self.case.matrix("initial_rates")[:, 0] * np.pi / 180
        moments = [self.point[f"inertia_{axis}"] for axis in "xyz"]
        return float(np.max(np.abs(rates) * moments))

"""What the paper says of its three designs, over every plausible value of the inputs that it leaves out.

Scans that need designs share their samples of moments of inertia, orbital rate, weights and reading of w; the unit of
the rates, or the harmonics, axes and duration of (25), come beside them where they matter. At each, (21) is
solved for pitch and for roll and yaw at gamma = 0.2, 2 and 100: for all points together, by the first-order condition,
which one gain alone meets (see `conditions_gains`). Points are those at which what the paper prints of the three
levels can hold (see `as_printed`); whether each of these prints holds is scanned without it. Responses to (24) are
judged over all t >= 0, whatever the lost time axes showed of them.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import product

import numpy as np

from gainsay.errors import ComputationError
from gainsay.exact.digits import PrintedNumber
from gainsay.results import task
from gainsay.systems.norms import h2_norm
from gainsay.verdicts.scan import Plausible, plausible, scan
from papers.pinheiro2013 import conditions as mixed
from papers.pinheiro2013 import conditions_gains as gains
from papers.pinheiro2013 import response as responses
from papers.pinheiro2013.plant import GROUPS, GeneralizedPlant, Satellite, generalized_plant, perturbed

LEVELS = ("hinf", "mixed", "h2")
SEPARATE = ("pitch", "roll_yaw")
#: longest step under (25), s: its tenth harmonic turns in 500 s and more
_LONGEST_STEP = 10.0


#: inputs that shape the designs, and those that matter beside them
DESIGN = ("inertia_x", "inertia_y", "inertia_z", "orbital_rate", "angle_weight", "rate_weight", "norm_inputs")
RELEASE = (*DESIGN, "rate_unit")
TORQUES = (*DESIGN, "harmonics", "disturbance_axes", "disturbance_horizon")
LEVEL = (*DESIGN[:4], "norm_inputs")
MOMENTUM = (*DESIGN[:3], "rate_unit")
#: prints of the levels that a point must bear out: 0.2 is gamma_min; 100 gives pure H2 control and 2 does not
BOTH_ENDS = ("gamma_min", "gamma_max")
_LOGARITHMIC = ("orbital_rate", "angle_weight", "rate_weight")


def inputs(case, names: tuple[str, ...], printed: tuple[str, ...] = ()) -> tuple[Plausible, ...]:
    """Inputs that the paper leaves out, with the ranges of the table.

    Parameters
    ----------
    case : gainsay.tables.Case
    names : tuple of str
    printed : tuple of str
        See `as_printed`: where it is empty, the moments are those of any microsatellite, the range of reconstruction B;
        else those that bear out the printed levels, the range of reconstruction A.
    """
    found = []
    for name in names:
        entry = f"inertia_{'a' if printed else 'b'}_{name[-1]}" if name.startswith("inertia") else name
        found.append(replace(plausible(case, entry, logarithmic=name in _LOGARITHMIC), name=name, parameter=entry))
    return tuple(found)


def base(case, name: str) -> float | str:
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

    def __init__(self, case, point: Mapping) -> None:
        super().__init__(point)
        self._case = case

    def __missing__(self, name: str) -> float | str:
        return base(self._case, name)


def rigid(case) -> Callable[[Mapping], bool]:
    """Return the test whether a rigid body can have the three moments, and those of all plants with uncertainty."""
    changes = np.vstack([np.zeros(3), 0.01 * case.matrix("pitch_changes"), 0.01 * case.matrix("roll_yaw_changes")])

    def test(point: Mapping) -> bool:
        moments = (1 + changes) * [point[f"inertia_{axis}"] for axis in "xyz"]
        return bool(np.all(2 * moments.max(axis=1) <= moments.sum(axis=1)))

    return test


def as_printed(case, printed: tuple[str, ...]) -> Callable[[Mapping], bool]:
    """Return the test whether a rigid body can have the moments, and whether the levels can be what the paper prints.

    Parameters
    ----------
    case : gainsay.tables.Case
    printed : tuple of str
        ``gamma_min``: the infimum of the level over all axes rounds to the printed 0.2, and 0.2 lies above it, by as
        much as a design near the infimum is taken above it. ``gamma_max``: the loop of the H2 limit meets the printed
        100, so that this level gives pure H2 control, and does not meet the printed 2 on either group of axes, so that
        this one gives another.
    """
    possible = rigid(case)
    least = float(PrintedNumber(case.parameters["gamma_min"].value).low)
    level, between, most = (case.number(name) for name in ("gamma_min", "gamma_mixed", "gamma_max"))

    @cache
    def of_designs(*values: float | str) -> bool:
        designs = Designs(case, dict(zip(DESIGN, values, strict=True)))
        if "gamma_min" in printed and not least <= designs.gamma_min() <= level / mixed.ABOVE:
            return False
        return "gamma_max" not in printed or (
            all(designs.h2_limit_meets(most)) and not any(designs.h2_limit_meets(between))
        )

    def test(point: Mapping) -> bool:
        return possible(point) and (not printed or of_designs(*(point[name] for name in DESIGN)))

    return test


def read_inputs(plant: GeneralizedPlant, reading: str) -> GeneralizedPlant:
    """Plant with the input w, one for both norms as (19) and (21) have it, as the text is read.

    Parameters
    ----------
    plant : GeneralizedPlant
    reading : {"both", "d_alone", "channels_alone"}
        w holds the uncertainty channels and d; or d alone; or the channels alone, so that d enters no norm.
    """
    q = len(plant.channels)
    taken = {"both": slice(None), "d_alone": slice(q, None), "channels_alone": slice(q)}[reading]
    return replace(plant, B1=plant.B1[:, taken], D11=plant.D11[:, taken], channels=())


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
    found: list[dict[tuple[str, str], np.ndarray]] = [{} for _ in designs]
    for group in SEPARATE:
        plants = [(d.plants[group], d.gamma(level, group)) for d in designs for level in LEVELS]
        limits = [mixed.limit_gain(plant) for plant, _ in plants]
        K, _ = gains.least_trace_gains(gains.stack(*zip(*plants, strict=True), limits))
        for i, of_one in enumerate(found):
            of_one.update({(level, group): K[len(LEVELS) * i + j] for j, level in enumerate(LEVELS)})
    return found


class Designs:
    """The three designs at one point of the inputs that shape them, and their release at 0.6 deg/s.

    Everything is computed when asked for; a release at another rate is as much larger.

    Parameters
    ----------
    case : gainsay.tables.Case
    point : mapping
        Values of inputs; what is missing is taken from reconstruction A.
    """

    def __init__(self, case, point: Mapping) -> None:
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
        return {group: read_inputs(generalized_plant(self.satellite, group), reading) for group in SEPARATE}

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
        found = {}
        for (level, group), K in self.gains.items():
            rates = self.case.matrix("initial_rates")[["xyz".index(a) for a in GROUPS[group]], 0] * np.pi / 180
            A, start = responses.loop_matrix(self.satellite, group, K), np.concatenate([np.zeros(len(rates)), rates])
            others = [responses.loop_matrix(p, group, K) for p in perturbed(self.case, self.satellite, group)]
            found[level, group] = (
                responses.Transient(A, start),
                [responses.Transient(*responses.paired(A, other, start)) for other in others],
            )
        return found

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

    def gamma_min(self) -> float:
        """Infimum of the level over all axes, for the input w as read."""
        return max(mixed.gamma_min(plant) for plant in self.plants.values())

    def h2_limit_meets(self, gamma: float) -> list[bool]:
        """Say of each group of axes whether the gain of the H2 limit meets a level, by its Riccati equation."""
        gains_of_limit = ((plant, mixed.h2_gain(plant)[0]) for plant in self.plants.values())
        return [bool(np.isfinite(mixed.trace_of_gain(plant, K, gamma))) for plant, K in gains_of_limit]

    def h2_excess(self) -> float:
        """Excess of the H2 norm at gamma = 100 over its optimum, the larger of the two groups."""
        found = []
        for group, plant in self.plants.items():
            norms = []
            for K in (self.gains["h2", group], mixed.h2_gain(plant)[0]):
                A, B, _, _, C2 = plant.closed(K)
                norms.append(h2_norm(A, B, C2))
            found.append(norms[0] / norms[1] - 1)
        return max(found)

    def stable_range(self, level: str) -> float:
        """Largest share, in hundredths below 1, by which all moments may change with every loop stable at its corners.

        The moments change independently of each other, as in (11), by up to this share of each.
        """
        signs = np.array(list(product((-1, 1), repeat=3)))

        plants = {group: generalized_plant(self.satellite, group) for group in SEPARATE}

        def stable(hundredths: int) -> bool:
            # Closed by the uncertainty of (11), whose corners no rigid body need have.
            delta = 0.01 * hundredths / self.satellite.change * signs
            loops = ((plants[g].uncertain(d), K) for (of, g), K in self.gains.items() if of == level for d in delta)
            return max(float(np.linalg.eigvals(A - B @ K).real.max()) for (A, B), K in loops) < 0

        if stable(99):
            return 0.99
        low, high = 0, 99
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if stable(middle) else (low, middle)
        return 0.01 * low

    def worst_abscissa(self) -> float:
        """Largest real part of the poles of all designs at the corners of the uncertainty (11), 1/s."""
        corners = (1 + self.satellite.change * np.array(list(product((-1, 1), repeat=3)))) * self.satellite.inertia
        # A corner that no rigid body can have is none of the plants.
        plants = [replace(self.satellite, inertia=tuple(m)) for m in corners if 2 * m.max() <= m.sum()]
        loops = (responses.loop_matrix(p, group, K) for (_, group), K in self.gains.items() for p in plants)
        return max(float(np.linalg.eigvals(A).real.max()) for A in loops)


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

    def __init__(self, case, point: Mapping, designs: Designs | None = None) -> None:
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
        found = {level: np.zeros((2, 3)) for level in LEVELS}
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
                        found[level][row, column] = abs(response.peak(output).value)
        return found

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


@dataclass(frozen=True)
class Question:
    """A quantity that is scanned.

    Attributes
    ----------
    quantity : str
    value : callable
        Study -> float.
    inputs : tuple of str
        The inputs that matter.
    printed : tuple of str
        What the paper prints of the levels that a point must bear out, see `as_printed`.
    """

    quantity: str
    value: Callable[[Study], float]
    inputs: tuple[str, ...] = DESIGN
    printed: tuple[str, ...] = BOTH_ENDS


def _ratio(of: str, smaller: str, larger: str) -> Callable[[Study], float]:
    """Ratio of a measure of two levels, largest over the axes; of a release it is that of the designs' own."""

    def value(s: Study) -> float:
        measure = getattr(s.designs, of, None) or getattr(s, of)
        return float(np.max(measure(smaller) / measure(larger)))

    return value


def _disturbed_ratio(s: Study) -> float:
    return max(_ratio("disturbed_angle", "hinf", other)(s) for other in ("mixed", "h2"))


def _robustness_ratio(s: Study) -> float:
    of = s.designs
    relative = {level: of.difference(level) / of.peak_angle(level) for level in ("hinf", "h2")}
    return float(np.max(relative["hinf"] / relative["h2"]))


def _difference_against(level: str) -> Callable[[Study], float]:
    return lambda s: float(np.max(s.designs.difference("hinf") / s.designs.peak_angle(level)))


QUESTIONS = (
    Question("scan.gamma_min", lambda s: s.designs.gamma_min(), LEVEL, ()),
    Question("scan.h2_excess", lambda s: s.designs.h2_excess(), printed=BOTH_ENDS[:1]),
    Question("scan.worst_abscissa", lambda s: s.designs.worst_abscissa()),
    Question("scan.range_ratio", lambda s: s.designs.stable_range("hinf") / s.designs.stable_range("mixed")),
    Question("scan.relative_difference", _difference_against("hinf")),
    Question("scan.drawn_difference", _difference_against("h2")),
    Question("scan.difference_ratio", _ratio("difference", "hinf", "h2")),
    Question("scan.torque_ratio", _ratio("peak_torque", "h2", "hinf")),
    Question("scan.mixed_torque_ratio", _ratio("peak_torque", "mixed", "hinf")),
    Question("scan.mixed_settling_ratio", _ratio("settling", "mixed", "h2")),
    Question("scan.mixed_torque", lambda s: float(np.max(s.peak_torque("mixed"))), RELEASE),
    Question("scan.hinf_torque", lambda s: float(np.max(s.peak_torque("hinf"))), RELEASE),
    Question("scan.momentum", Study.peak_momentum, MOMENTUM, ()),
    Question("scan.peak_angle", lambda s: float(max(np.max(s.peak_angle(level)) for level in LEVELS)), RELEASE),
    Question("scan.disturbed_ratio", _disturbed_ratio, TORQUES),
    Question("scan.mixed_disturbed_ratio", _ratio("disturbed_angle", "mixed", "h2"), TORQUES),
    Question("scan.disturbed_torque_ratio", _ratio("disturbed_torque", "h2", "hinf"), TORQUES),
    Question("scan.robustness_ratio", _robustness_ratio),
    Question("scan.settling_ratio", _ratio("settling", "hinf", "h2")),
)


class Shared:
    """Studies at the points of all scans; what two of them share is computed once.

    Parameters
    ----------
    case : gainsay.tables.Case
    """

    def __init__(self, case) -> None:
        self.case = case
        self._designs: dict[tuple, Designs] = {}
        self._studies: dict[tuple, Study] = {}
        self._admissible: dict[tuple[str, ...], Callable[[Mapping], bool]] = {}

    def admissible(self, printed: tuple[str, ...]) -> Callable[[Mapping], bool]:
        """Return the test of `as_printed`, which remembers its answers over all scans."""
        return self._admissible.setdefault(printed, as_printed(self.case, printed))

    def studies(self, points: Iterable[Mapping], names: Iterable[str]) -> list[Study]:
        """Return the study of each point; where the inputs shape the designs, their gains are found together."""
        keys = [tuple(sorted(point.items())) for point in points]
        for key in keys:
            if key not in self._studies:
                shape = tuple((name, value) for name, value in key if name in DESIGN)
                if shape not in self._designs:
                    self._designs[shape] = Designs(self.case, dict(shape))
                self._studies[key] = Study(self.case, dict(key), self._designs[shape])
        found = [self._studies[key] for key in keys]
        new = [designs for designs in dict.fromkeys(s.designs for s in found) if "gains" not in vars(designs)]
        if new and set(DESIGN) <= set(names):
            for designs, of_one in zip(new, gains_of(new), strict=True):
                designs.gains = of_one
        return found


def ask(case, results, question: Question, shared: Shared) -> None:
    """Scan one quantity, and compute it at reconstruction A, or B where the scan is over moments of any satellite."""

    def together(points: Sequence[Mapping]) -> list[float]:
        return [question.value(study) for study in shared.studies(points, question.inputs)]

    found = scan(
        case, question.quantity, inputs(case, question.inputs, question.printed), together=together, parts=4,
        admissible=shared.admissible(question.printed),
        samples=int(case.number("scan_samples")), seed=int(case.number("scan_seed")),
    )  # fmt: skip
    results.scan(found)
    name = "A" if question.printed else "B"
    here = {} if question.printed else {f"inertia_{axis}": case.number(f"inertia_b_{axis}") for axis in "xyz"}
    results.quantity(
        question.quantity, question.value(Study(case, here)), lower=None, upper=None, source=f"reconstruction {name}",
        method=f"at reconstruction {name}; scanned: {found.note}",
    )  # fmt: skip
    results.say(f"scan {question.quantity}", found.note)


@task("scan over missing inputs")
def missing_inputs(case, results):
    """Scan every quantity whose claims may hang on what the paper leaves out."""
    shared, broken = Shared(case), []
    for question in QUESTIONS:
        with results.apart():
            try:
                ask(case, results, question, shared)
            except ComputationError as error:
                broken.append(str(error))
    if broken:
        raise ComputationError("scan over missing inputs", "; ".join(broken))


SCANS = (missing_inputs,)

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
from functools import cache

import numpy as np

from gainsay.errors import ComputationError
from gainsay.exact.digits import PrintedNumber
from gainsay.results import Results, task
from gainsay.scans import Plausible, plausible, scan
from gainsay.tables import Case
from papers.pinheiro2013 import conditions as mixed
from papers.pinheiro2013.scans_studies import LEVELS, Designs, Study, gains_of

#: inputs that shape the designs, and those that matter beside them
DESIGN = ("inertia_x", "inertia_y", "inertia_z", "orbital_rate", "angle_weight", "rate_weight", "norm_inputs")
RELEASE = (*DESIGN, "rate_unit")
TORQUES = (*DESIGN, "harmonics", "disturbance_axes", "disturbance_horizon")
LEVEL = (*DESIGN[:4], "norm_inputs")
MOMENTUM = (*DESIGN[:3], "rate_unit")
#: prints of the levels that a point must bear out: 0.2 is gamma_min; 100 gives pure H2 control and 2 does not
LEVELS_PRINTED = ("gamma_min", "gamma_mixed", "gamma_max")
_LOGARITHMIC = ("orbital_rate", "angle_weight", "rate_weight")


def inputs(case: Case, names: tuple[str, ...], printed: tuple[str, ...] = ()) -> tuple[Plausible, ...]:
    """Inputs that the paper leaves out, with the ranges of the table.

    Parameters
    ----------
    case : gainsay.tables.Case
    names : tuple of str
    printed : tuple of str
        See `as_printed`: where it is empty, the moments are those of any microsatellite, the range of reconstruction B;
        else those that bear out the printed levels, the range of reconstruction A.
    """
    ranges = []
    for name in names:
        entry = f"inertia_{'a' if printed else 'b'}_{name[-1]}" if name.startswith("inertia") else name
        ranges.append(replace(plausible(case, entry, logarithmic=name in _LOGARITHMIC), name=name, parameter=entry))
    return tuple(ranges)


def rigid(case: Case) -> Callable[[Mapping], bool]:
    """Return the test whether a rigid body can have the three moments, and those of all plants with uncertainty."""
    changes = np.vstack([np.zeros(3), 0.01 * case.matrix("pitch_changes"), 0.01 * case.matrix("roll_yaw_changes")])

    def test(point: Mapping) -> bool:
        moments = (1 + changes) * [point[f"inertia_{axis}"] for axis in "xyz"]
        return bool(np.all(2 * moments.max(axis=1) <= moments.sum(axis=1)))

    return test


def as_printed(
    case: Case, printed: tuple[str, ...], designs_at: Callable[[Mapping], Designs] | None = None
) -> Callable[[Mapping], bool]:
    """Return the test whether a rigid body can have the moments, and whether the levels can be what the paper prints.

    Parameters
    ----------
    case : gainsay.tables.Case
    printed : tuple of str
        ``gamma_min``: the infimum of the level over all axes rounds to the printed 0.2, and 0.2 lies above it, by as
        much as a design near the infimum is taken above it. ``gamma_max``: the loop of the H2 limit meets the printed
        100, so that this level gives pure H2 control. ``gamma_mixed``: it does not meet the printed 2 on either group
        of axes, so that this level gives another.
    designs_at : callable, optional
        Values of `DESIGN` -> designs, where they are kept for other uses.
    """
    possible = rigid(case)
    least = float(PrintedNumber(case.parameters["gamma_min"].value).low)
    level, between, most = (case.number(name) for name in ("gamma_min", "gamma_mixed", "gamma_max"))

    @cache
    def of_designs(*values: float | str) -> bool:
        point = dict(zip(DESIGN, values, strict=True))
        designs = designs_at(point) if designs_at else Designs(case, point)
        if "gamma_min" in printed and not least <= designs.gamma_min() <= level / mixed.ABOVE:
            return False
        if "gamma_max" in printed and not all(designs.h2_limit_meets(most)):
            return False
        return "gamma_mixed" not in printed or not any(designs.h2_limit_meets(between))

    def test(point: Mapping) -> bool:
        return possible(point) and (not printed or of_designs(*(point[name] for name in DESIGN)))

    return test


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
    printed: tuple[str, ...] = LEVELS_PRINTED


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
    Question("scan.h2_excess", lambda s: s.designs.h2_excess(), printed=LEVELS_PRINTED[:1]),
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

    def __init__(self, case: Case) -> None:
        self.case = case
        self._designs: dict[tuple, Designs] = {}
        self._studies: dict[tuple, Study] = {}
        self._admissible: dict[tuple[str, ...], Callable[[Mapping], bool]] = {}

    def admissible(self, printed: tuple[str, ...]) -> Callable[[Mapping], bool]:
        """Return the test of `as_printed`, which remembers its answers over all scans."""
        return self._admissible.setdefault(printed, as_printed(self.case, printed, self.designs))

    def designs(self, point: Mapping) -> Designs:
        """Return the designs at a point, one object for all scans."""
        shape = tuple(sorted((name, value) for name, value in point.items() if name in DESIGN))
        return self._designs.setdefault(shape, Designs(self.case, dict(shape)))

    def studies(self, points: Iterable[Mapping], names: Iterable[str]) -> list[Study]:
        """Return the study of each point; where the inputs shape the designs, their gains are found together."""
        keys = [tuple(sorted(point.items())) for point in points]
        for key in keys:
            if key not in self._studies:
                self._studies[key] = Study(self.case, dict(key), self.designs(dict(key)))
        studies = [self._studies[key] for key in keys]
        new = [designs for designs in dict.fromkeys(s.designs for s in studies) if "gains" not in vars(designs)]
        if new and set(DESIGN) <= set(names):
            for designs, of_one in zip(new, gains_of(new), strict=True):
                designs.gains = of_one
        return studies


def ask(case: Case, results: Results, question: Question, shared: Shared) -> None:
    """Scan one quantity, and compute it at reconstruction A, or B where the scan is over moments of any satellite."""

    def together(points: Sequence[Mapping]) -> list[float]:
        return [question.value(study) for study in shared.studies(points, question.inputs)]

    answer = scan(
        case,
        question.quantity,
        inputs(case, question.inputs, question.printed),
        together=together,
        parts=4,
        admissible=shared.admissible(question.printed),
        bears_out=question.printed,
        samples=int(case.number("scan_samples")),
        seed=int(case.number("scan_seed")),
    )
    results.scan(answer)
    name = "A" if question.printed else "B"
    here = {} if question.printed else {f"inertia_{axis}": case.number(f"inertia_b_{axis}") for axis in "xyz"}
    results.quantity(
        question.quantity,
        question.value(Study(case, here)),
        lower=None,
        upper=None,
        source=f"reconstruction {name}",
        method=f"at reconstruction {name}; scanned: {answer.note}",
    )
    results.say(f"scan {question.quantity}", answer.note)


@task("scan over missing inputs")
def missing_inputs(case: Case, results: Results) -> None:
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

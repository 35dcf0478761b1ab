"""Runs of pinheiro2013: release at 0.6 deg/s and the torques (25), three designs, two reconstructions, every plant."""

from collections.abc import Iterator, Mapping

import numpy as np

from gainsay.dynamics import attitude
from gainsay.logs import (
    Body,
    Bound,
    Line,
    Log,
    LogWriter,
    Measure,
    Measured,
    Plot,
    RunSpec,
    Scene,
    Simulate,
    default_layout,
    lines,
    located,
    tab,
)
from gainsay.simulation.linear import Response
from gainsay.simulation.ode import integrate, largest
from gainsay.tables import Case
from papers.pinheiro2013 import response as responses
from papers.pinheiro2013.plant import RECONSTRUCTIONS, Satellite, perturbed, reconstruction

DESIGNS = {"hinf": ("gamma_0.2", "0.2"), "mixed": ("gamma_2", "2"), "h2": ("gamma_100", "100")}
NAMES = ("roll", "pitch", "yaw")
ANGLES = dict.fromkeys(NAMES, "rad")
RATES = dict.fromkeys(NAMES, "rad/s")
TORQUES = dict.fromkeys("xyz", "N m")
STEP = 0.1
#: band of a located extreme beside the difference of the two methods: rounding of the exponentials
ROUNDING = 1e-12


def _log(
    log: LogWriter, where: str, time: np.ndarray, states: np.ndarray, K: np.ndarray, limit: float | None = None
) -> None:
    torque = -states @ K.T
    if limit is not None:
        torque = np.clip(torque, -limit, limit)
    log.signal(f"/{where}/angles", ANGLES, time, states[:, :3], shown="deg")
    log.signal(f"/{where}/rates", RATES, time, states[:, 3:])
    log.signal(f"/{where}/torque", TORQUES, time, torque, shown="mN m")


def _plants(case: Case, satellite: Satellite) -> list[list[Satellite]]:
    """Plants 1 and 2 for each of roll, pitch, yaw: list (ii), list (i), list (ii)."""
    return [list(perturbed(case, satellite, group)) for group in ("roll_yaw", "pitch", "roll_yaw")]


def _second(A: np.ndarray, start: np.ndarray, end: float, output: np.ndarray) -> float:
    """Largest modulus of an output by an adaptive integrator, as a second method."""
    trajectory = integrate(lambda t, x: A @ x, start, end, rtol=1e-12, atol=1e-14)
    return largest(trajectory, lambda t, x: np.abs(x @ output))[1]


def release(reconstructed: str, design: str) -> Simulate:
    """Return the simulation of a release at the rates of (24)."""

    def simulate(case: Case, designs: Mapping, log: LogWriter) -> None:
        satellite, K = reconstruction(case, reconstructed), designs[f"{reconstructed}_{design}"]["K"]
        end, limit = case.number("horizon"), case.number("wheel_torque")
        start = responses.release_state(case)
        A = responses.loop_matrix(satellite, "all", K)
        nominal = Response(A, start, end, round(end / STEP))
        _log(log, "nominal", nominal.time, nominal.states, K)
        plants = _plants(case, satellite)
        for i, name in enumerate(NAMES):
            angle, torque = np.eye(6)[i], -K[i]
            for what, output, unit in (("angle", angle, "rad"), ("torque", torque, "N m")):
                peak = nominal.peak(output)
                second, wheel = _second(A, start, end, output), limit if what == "torque" else None
                log.extreme(f"peak_{what}_{name}", peak.time, abs(peak.value), unit, second=second, limit=wheel)
            settled = nominal.last_above(angle, responses.SETTLED * abs(nominal.peak(angle).value))
            log.extreme(f"settling_{name}", settled, settled, "s")
            for k in (0, 1):
                other = responses.loop_matrix(plants[i][k], "all", K)
                both = responses.difference(A, other, start, end, round(end / STEP))
                apart = both.peak(np.concatenate([angle, -angle]))
                second = _second(both.A, both.states[0], end, np.concatenate([angle, -angle]))
                log.extreme(f"difference_{name}_plant_{k + 1}", apart.time, abs(apart.value), "rad", second=second)
        for k in (0, 1):
            states = np.empty_like(nominal.states)
            for i in range(3):
                # Each axis is taken from the list that the paper gives for it.
                other = responses.loop_matrix(plants[i][k], "all", K)
                states[:, [i, i + 3]] = Response(other, start, end, round(end / STEP)).states[:, [i, i + 3]]
            _log(log, f"plant_{k + 1}", nominal.time, states, K)
        for where, wheel in (("nonlinear", None), ("nonlinear_limited", limit)):
            flight = responses.nonlinear(satellite, K, start, end, limit=wheel)
            states = responses.angle_rates(flight(nominal.time), satellite.n)
            _log(log, where, nominal.time, states, K, wheel)
            for mark in flight.ends[1:-1]:
                log.event(float(mark), "saturation", f"{where}: a wheel torque passes {limit:g} N m", level="warning")
        for k in (0, 1):
            states = np.empty_like(nominal.states)
            for i in range(3):
                flight = responses.nonlinear(plants[i][k], K, start, end)
                whole = responses.angle_rates(flight(nominal.time), satellite.n)
                states[:, [i, i + 3]] = whole[:, [i, i + 3]]
            _log(log, f"nonlinear_plant_{k + 1}", nominal.time, states, K)
        log.bound("wheel_torque", "mN m", lower=-1e3 * limit, upper=1e3 * limit)
        _scene(log, nominal.time, nominal.states, -nominal.states @ K.T)

    return simulate


def disturbed(reconstructed: str, design: str) -> Simulate:
    """Return the simulation of the response to (25) from rest."""

    def simulate(case: Case, designs: Mapping, log: LogWriter) -> None:
        satellite, K = reconstruction(case, reconstructed), designs[f"{reconstructed}_{design}"]["K"]
        end, torque = case.number("disturbance_horizon"), responses.disturbance(case)
        linear = responses.Disturbed(satellite, "all", K, torque, end)
        coarse = responses.Disturbed(satellite, "all", K, torque, end, step=0.5)
        time, states = linear.samples()
        shown = time % 5 == 0
        _log(log, "nominal", time[shown], states[shown], K)
        log.signal(
            "/disturbance/torque",
            {"each_axis": "N m"},
            time[shown],
            torque.torque(time[shown], satellite.n)[:, None],
            shown="mN m",
        )
        for i, name in enumerate(NAMES):
            for what, output, unit in (("angle", np.eye(6)[i], "rad"), ("torque", -K[i], "N m")):
                peak = linear.peak(output)
                second = abs(coarse.peak(output).value)
                log.extreme(f"peak_{what}_{name}", peak.time, abs(peak.value), unit, second=second)
        flight = responses.nonlinear(satellite, K, np.zeros(6), end, torque=torque, rtol=1e-8, method="LSODA")
        whole = responses.angle_rates(flight(time[shown]), satellite.n)
        _log(log, "nonlinear", time[shown], whole, K)
        for instant, what in ((torque.start, "begins"), (torque.end, "ends")):
            log.event(instant, "step", f"the constant torque of (25) {what}")
        _scene(log, time[shown], states[shown], -states[shown] @ K.T)

    return simulate


def _scene(log: LogWriter, time: np.ndarray, states: np.ndarray, torque: np.ndarray) -> None:
    # Angles of fractions of a degree are invisible: they are drawn larger, and the text page says so.
    factor = 0.3 / max(np.abs(states[:, :3]).max(), 1e-12)
    keep = np.unique(np.linspace(0, len(time) - 1, 600).astype(int))
    rotation = np.array([_quaternion(factor * x) for x in states[keep, :3]])
    log.transform("lvlh", "body", time[keep], np.zeros((len(keep), 3)), rotation)
    log.body("satellite", "body", Body((0.6, 0.6, 0.6)))
    log.arrows("torque", "body", time[keep], torque[keep], 0.8 / max(np.abs(torque).max(), 1e-12), "thrust")
    log.axes("lvlh", 1.1, labels=("velocity", "against orbit normal", "Earth"), name="LVLH")
    log.axes("body", 0.8, labels=("roll", "pitch", "yaw"))
    log.summary("drawn_angle_factor", factor, "1")


def _quaternion(angles: np.ndarray) -> np.ndarray:
    """Quaternion x, y, z, w that turns body components into LVLH components."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(attitude.direction_cosines(angles).T).as_quat()


def _measured(log: Log, name: str) -> Measured:
    return located(log, name, "matrix exponential, extreme located; band: an adaptive integrator", rounding=ROUNDING)


def _relative(difference: Measured, peak: Measured) -> Measured:
    """Quotient of two measured positive numbers with the band that theirs give."""
    method = "worse of the two plants over the nominal peak, both located"
    bands = (difference.lower, difference.upper, peak.lower, peak.upper)
    least, most, lowest, highest = (np.nan if end is None else end for end in bands)
    return Measured(difference.value / peak.value, method, least / highest, most / lowest)


def measure_release(reconstructed: str, design: str) -> Measure:
    """Return the function that reads a release's quantities from its log."""

    def measure(case: Case, log: Log) -> dict[str, Measured]:
        prefix, numbers = f"{reconstructed}.{DESIGNS[design][0]}", {}
        for name in NAMES:
            angle, torque = _measured(log, f"peak_angle_{name}"), _measured(log, f"peak_torque_{name}")
            worst = max((_measured(log, f"difference_{name}_plant_{k}") for k in (1, 2)), key=lambda m: m.value)
            numbers[f"{prefix}.peak_angle.{name}"] = angle
            numbers[f"{prefix}.peak_torque.{name}"] = torque
            numbers[f"{prefix}.absolute_difference.{name}"] = worst
            numbers[f"{prefix}.relative_difference.{name}"] = _relative(worst, angle)
            numbers[f"{prefix}.settling.{name}"] = Measured(
                log.extremes[f"settling_{name}"].value, f"last time above {responses.SETTLED:.0%} of the peak, located"
            )
            for where in ("nonlinear", "nonlinear_limited"):
                apart = log[f"/{where}/angles"].column(name) - log["/nominal/angles"].column(name)
                numbers[f"{prefix}.{where}_difference.{name}"] = Measured(
                    float(np.abs(apart).max()) / angle.value,
                    f"largest difference at samples {STEP} s apart, over the peak",
                )
        momentum = np.abs(log["/nominal/rates"].values) * np.array(reconstruction(case, reconstructed).inertia)
        numbers[f"{prefix}.peak_momentum"] = Measured(float(momentum.max()), "largest I times rate at the samples")
        return numbers

    return measure


def measure_disturbed(reconstructed: str, design: str) -> Measure:
    """Return the function that reads the quantities of a response to (25) from its log."""

    def measure(case: Case, log: Log) -> dict[str, Measured]:
        prefix, numbers = f"{reconstructed}.{DESIGNS[design][0]}.disturbed", {}
        for name in NAMES:
            for what in ("angle", "torque"):
                numbers[f"{prefix}.peak_{what}.{name}"] = _measured(log, f"peak_{what}_{name}")
        return numbers

    return measure


def _specs() -> Iterator[RunSpec]:
    for name in RECONSTRUCTIONS:
        for design in DESIGNS:
            yield RunSpec(f"{name}_{design}_release", release(name, design), measure_release(name, design))
            yield RunSpec(f"{name}_{design}_disturbed", disturbed(name, design), measure_disturbed(name, design))


RUNS = tuple(_specs())
RELEASES = tuple(run.name for run in RUNS if run.name.endswith("release"))
DISTURBED = tuple(run.name for run in RUNS if run.name.endswith("disturbed"))


def _compared(field: str) -> tuple[Line, ...]:
    return (
        Line("/nominal/angles_deg", field, "nominal", "nominal"),
        Line("/plant_1/angles_deg", field, "plant 1", "perturbed"),
        Line("/plant_2/angles_deg", field, "plant 2", "comparison"),
    )


ABOUT = """# Microsatellite attitude, Pinheiro and Gadelha de Souza 2013

Small angles from the LVLH frame (third axis down). Control u = -K x with K from the mixed H2/H-infinity LMIs (21),
their sign corrected. **Release**: every axis starts at 0.6 deg/s, as (24) is read; plants 1 and 2 change the moments of
inertia by 10 % as lists (i) and (ii) say; the bound is the wheel's 0.15 N m on each axis. **Disturbed**: the torques
(25) act on every axis from rest. The moments of inertia are not in the paper: reconstruction A or B stands in for them.

Bears on: what Figures 6 to 14 say of gamma = 0.2, 2 and 100. Angles in the picture are drawn larger than they are
(`drawn_angle_factor`).
"""

_SCENE = Scene(
    "Body axes against LVLH, angles drawn larger",
    "lvlh",
    elements=("satellite", "torque"),
    axes=("lvlh", "body"),
    direction=(2.6, 2.0, 1.4),
)
#: one wheel on each axis: the bound is that of all three curves
_WHEEL = (Bound("wheel_torque", "limit of Table 2"),)
LOOK = {
    **dict.fromkeys(RELEASES, "Look at: peak and settling of the angles; the torque against the wheel's limit."),
    **dict.fromkeys(DISTURBED, "Look at: the angle at the steps of (25), linear beside nonlinear."),
}


def _angles(title: str, where: str) -> Plot:
    return Plot(title, lines(f"/{where}/angles_deg", NAMES))


def _torques(title: str, where: str, bounds: tuple[Bound, ...] = ()) -> Plot:
    return Plot(title, lines(f"/{where}/torque_mN_m", "xyz"), bounds=bounds)


_DISTURBANCE = (Line("/disturbance/torque_mN_m", "each_axis", "each axis", "magnitude"),)

LAYOUT = default_layout(
    "pinheiro2013",
    ABOUT,
    tab(
        "Release",
        _angles("Euler angles [deg]", "nominal"),
        _torques("Control torque [mN m]", "nominal"),
        _torques("Control torque and the wheel's limit [mN m]", "nominal", _WHEEL),
        scene=_SCENE,
        runs=RELEASES,
    ),
    tab("Uncertainty", *(Plot(f"{name.capitalize()} angle [deg]", _compared(name)) for name in NAMES), runs=RELEASES),
    tab(
        "Nonlinear",
        _angles("Euler angles, nonlinear [deg]", "nonlinear"),
        _angles("Euler angles, wheels limited [deg]", "nonlinear_limited"),
        _torques("Control torque, wheels limited [mN m]", "nonlinear_limited", _WHEEL),
        runs=RELEASES,
    ),
    tab(
        "Disturbed",
        _angles("Euler angles [deg]", "nominal"),
        Plot("Disturbing torque [mN m]", _DISTURBANCE),
        scene=_SCENE,
        runs=DISTURBED,
    ),
    tab(
        "Nonlinear motion",
        _angles("Euler angles, nonlinear [deg]", "nonlinear"),
        _torques("Control torque, nonlinear [mN m]", "nonlinear"),
        runs=DISTURBED,
    ),
    look=LOOK,
)

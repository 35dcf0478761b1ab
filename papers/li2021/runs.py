"""The runs of Section IV: printed and own controllers on the full model, with periodic and with redrawn gains."""

from collections.abc import Mapping

import numpy as np

from gainsay.errors import ComputationError
from gainsay.logs import (
    Appendage,
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
    measuring,
    tab,
)
from gainsay.simulation.periodic import PeriodicSolution
from gainsay.tables import Case
from papers.li2021 import plant, response
from papers.li2021.response import ANGLES, METHOD, MODES, RATES, STEPS, WINDOW, FlexibleLoop

AXES = ("x", "y", "z")
ANGLE_FIELDS = {"roll": "rad", "pitch": "rad", "yaw": "rad"}
MODE_FIELDS = {f"eta_{i}": "kg^0.5 m" for i in (1, 2, 3, 4)}
#: samples of the log: dense in the transient, then sparse, s
DENSE_END, DENSE, SPARSE = 60.0, 0.025, 0.25
#: distance of the samples of the runs under random gains, s
NODE = 0.1


def sample(solution: PeriodicSolution) -> tuple[np.ndarray, np.ndarray]:
    """Thinned nodes of a solution for the log."""
    step = solution.step
    dense, sparse = max(1, round(DENSE / step)), max(1, round(SPARSE / step))
    split = round(DENSE_END / step)
    keep = np.unique(np.r_[0:split:dense, split : len(solution.times) : sparse, len(solution.times) - 1])
    return solution.times[keep], solution.states[keep]


def quaternions(angles: np.ndarray) -> np.ndarray:
    """Rotation from body to LVLH axes as x, y, z, w, from Euler 3-2-1 angles, shape (N, 4)."""
    half = angles / 2
    (cf, ct, cp), (sf, st, sp) = np.cos(half).T, np.sin(half).T
    return np.stack(
        [
            sf * ct * cp - cf * st * sp,
            cf * st * cp + sf * ct * sp,
            cf * ct * sp - sf * st * cp,
            cf * ct * cp + sf * st * sp,
        ],
        axis=1,
    )


def _panel(side: float, tip: tuple[float, ...]) -> Appendage:
    """Panel along plus or minus y; tip says how it bends with each modal coordinate."""
    return Appendage(
        root=(0.0, 0.3 * side, 0.0), along=(0.0, side, 0.0), normal=(1.0, 0.0, 0.0), length=1.6, width=0.5, tip=tip
    )


def record(
    case: Case, loop: FlexibleLoop, time: np.ndarray, states: np.ndarray, torque: np.ndarray, log: LogWriter
) -> None:
    """Write signals and the three-dimensional scene."""
    log.signal("/attitude/angles", ANGLE_FIELDS, time, states[:, ANGLES], shown="deg")
    log.signal("/attitude/rates", dict.fromkeys(ANGLE_FIELDS, "rad/s"), time, states[:, RATES], shown="deg/s")
    log.signal("/wheels/torque", dict.fromkeys(AXES, "N m"), time, torque)
    log.signal("/wheels/torque_size", {"size": "N m"}, time, np.linalg.norm(torque, axis=1)[:, None])
    log.signal("/modes/coordinates", MODE_FIELDS, time, states[:, MODES])
    log.bound("torque", "N m", lower=-case.number("u_max"), upper=case.number("u_max"))
    log.transform("lvlh", "body", time, np.zeros((len(time), 3)), quaternions(states[:, ANGLES]))
    log.body(
        "satellite",
        "body",
        Body(
            (0.6, 0.6, 0.6), appendages=(_panel(1.0, tip=(1.0, 0.0, 1.0, 0.0)), _panel(-1.0, tip=(0.0, 1.0, 0.0, 1.0)))
        ),
        time=time,
        modal=states[:, MODES],
    )
    # The largest torque of the run is drawn 1 m long.
    log.arrows("torque", "body", time, torque, 1.0 / max(np.linalg.norm(torque, axis=1).max(), 1e-12), "thrust")
    log.axes("lvlh", 1.5, name="LVLH")
    log.axes("body", 1.0, labels=("roll", "pitch", "yaw"))


def periodic(name: str) -> Simulate:
    """Simulation of Table 1's case: one common sine in all twelve gain channels."""

    def simulate(case: Case, designs: Mapping, log: LogWriter) -> None:
        loop = FlexibleLoop(case, plant.controller(case, name))
        solution, second = loop.solve(), loop.solve(2 * STEPS)
        time, states = sample(solution)
        record(case, loop, time, states, loop.torque(time, states), log)
        log.signal("/controller/variation", {"delta": "1"}, time, loop.variation(time)[:, None])
        log.extremes(loop.extremes(solution), loop.extremes(second), limits={"peak_torque": case.number("u_max")})
        log.event(0.0, "start", "angles and rates of Table 1; controller and appendages at rest")

    return simulate


def random_gains(name: str, hold: str) -> Simulate:
    """Simulation with twelve factors 1 + U(0, 1), drawn once or redrawn and held; the first draw of the campaign."""

    def simulate(case: Case, designs: Mapping, log: LogWriter) -> None:
        loop = FlexibleLoop(case, plant.controller(case, name), amplitude=0.0)
        time, states = response.redrawn(loop, hold, [np.random.default_rng((int(case.number("seed")), 0))], node=NODE)
        states = states[:, 0]
        stay = np.abs(states[:, ANGLES]).max(axis=1) < 10.0
        end = len(stay) if stay.all() else int(np.argmin(stay))
        if end < 3:
            raise ComputationError("Figures 8 and 9", "the run leaves the model at once")
        time, states = time[:end], states[:end]
        # the torque is logged with the nominal C_f: its drawn factors are the run's own
        record(case, loop, time, states, loop.torque(time, states), log)
        late = np.abs(states[time >= time[-1] - WINDOW][:, ANGLES]).max()
        log.summary("residual_angle", float(late), "rad")
        log.event(0.0, "start", f"gain factors 1 + U(0, 1), hold {hold}")
        if not stay.all():
            log.event(float(time[-1]), "diverged", "an angle passes 10 rad; the run ends", level="warning")

    return simulate


def measure(name: str, *more: str) -> Measure:
    """Return the function that reads a run's quantities from its log, banded by a second step size."""
    return measuring(f"audit.{name}", (*ALL, *more), METHOD, times=2)


ALL = (
    "peak_torque",
    "first_angle",
    "residual_angle",
    "first_rate",
    "residual_rate",
    "settling_time",
    "peak_mode",
    "residual_mode",
)
#: what is left at the end of the largest value, which the paper speaks of for its own gains alone
SHARES = ("angle_share", "rate_share", "mode_share")


def nothing(case: Case, log: Log) -> dict[str, Measured]:
    """No quantity: the campaign behind these runs is measured by the audit."""
    return {}


PERIODIC = ("proposed", "comparison", "repaired", "best")
RUNS = (
    *(RunSpec(name, periodic(name), measure(name, *(SHARES if name == "proposed" else ()))) for name in PERIODIC),
    *(
        RunSpec(f"{name}_{reading}", random_gains(name, hold), nothing)
        for name in ("proposed", "comparison", "repaired")
        for reading, hold in response.HOLDS.items()
    ),
)

ABOUT = """# Attitude of a flexible microsatellite, Li 2021

Body axes against LVLH, with two panels that bend with the modal coordinates (their shapes are ours: the paper gives
none), and the control torque as an arrow.

- **Angles and rates** (Figures 4 and 5): within a minute they come down to a small offset held by the constant part
  of the disturbance.
- **Torque** (Figure 6) and its norm with the bound u_max = 2 N m. The longest arrow is the run's largest torque.
- **Modal coordinates** (Figure 7): lightly damped, outside the disk that the reduced model keeps.
- Runs named `_constant`, `_slow`, `_fast` draw the twelve gain factors from 1 + U(0, 1), once, every second or every
  0.1 s: the paper does not say which its Figures 8 and 9 mean.
"""


ANGLES_SHOWN = lines("/attitude/angles_deg", tuple(ANGLE_FIELDS))
TORQUE_SHOWN = lines("/wheels/torque", AXES)
MODES_SHOWN = lines("/modes/coordinates", tuple(MODE_FIELDS))
#: what is shown at first: the transient, s
_SHOWN = 60.0
_VARIED = 10.0  # periods of a second
LOOK = {
    "": "Look at: the angles while the gains are redrawn; what comes after the first minute is under Whole run.",
    "proposed": "Look at: angles and rates within the first minute, and the norm of the torque against u_max.",
    "comparison": "Look at: angles and rates within the first minute; compare with `proposed`.",
    "repaired": "Look at: torque and time to settle; compare with `proposed`.",
    "best": "Look at: torque and time to settle; compare with `proposed`.",
}

_SIZE = Plot(
    "Norm of the torque [N m]",
    (Line("/wheels/torque_size", "size", "norm", "magnitude"),),
    bounds=(Bound("torque", "u_max", sides=("upper",)),),
    until=_SHOWN,
)
_SCENE = Scene(
    "Body axes against LVLH",
    "lvlh",
    elements=("satellite", "torque"),
    axes=("lvlh", "body"),
    direction=(4.0, 3.0, 2.0),
)
_VARIATION = (Line("/controller/variation", "delta", "delta", "perturbed"),)

LAYOUT = default_layout(
    "li2021",
    ABOUT,
    tab(
        "Attitude",
        Plot("Euler angles [deg]", ANGLES_SHOWN, until=_SHOWN),
        Plot("Euler rates [deg/s]", lines("/attitude/rates_deg_s", tuple(ANGLE_FIELDS)), until=_SHOWN),
        Plot("Control torque [N m]", TORQUE_SHOWN, until=_SHOWN),
        _SIZE,
        scene=_SCENE,
    ),
    tab(
        "Appendages",
        Plot("Modal coordinates, first minute [kg^0.5 m]", MODES_SHOWN, until=_SHOWN),
        Plot("Modal coordinates [kg^0.5 m]", MODES_SHOWN),
    ),
    tab(
        "Whole run",
        Plot("Euler angles, whole run [deg]", ANGLES_SHOWN),
        Plot("Control torque, whole run [N m]", TORQUE_SHOWN),
    ),
    tab("Gain variation", Plot("Common gain variation [1]", _VARIATION, until=_VARIED), runs=PERIODIC),
    look=LOOK,
)

"""The flights of the two-body problem end at the target from every plausible start of the observer: a proof.

The relative motion is r'' = G r + 2 w [y', -x', 0] + w^2 [x, y, 0] + w' [y, -x, 0] + f/m with the rate w of the true
anomaly and G the mean of the gravity gradient mu/d^3 (3 p p^T - I) on the way from the target to the chaser, p the unit
vector from the Earth. Within a range R of the target every entry lies between bounds that follow from the perigee, the
eccentricity and R, so that the flights are trajectories of a linear system with bounded, time-varying channels. A
quadratic function that decays on all of those keeps them within R, and bounds where they are at the horizon.

Reference: Boyd et al., Linear Matrix Inequalities in System and Control Theory, SIAM 1994, chapter 5.
"""

from typing import Any

import numpy as np

from gainsay.proof import Certificate, build
from gainsay.results import Results, task
from gainsay.statements import Stated, Statement, diagonal, read_constraint, scalar, symmetric
from gainsay.tables import Case
from papers.wan2014.statements import plant

#: range within which the motion is described, m, and rate at which the flights are proved to decay, 1/s
RANGE, RATE = "60000", "0.0008"
#: what is proved of range (m) and speed (m/s) at the horizon: far below the strictest settling bands of the claims
FINAL_RANGE, FINAL_SPEED = "0.1", "0.0001"
#: entry of the acceleration by state -> its least and greatest value
_ENTRIES = {
    (0, 0): ("slow + 2*weak - 3*strong*side**2", "fast + 2*strong"),
    (0, 1): ("-turn - 3*strong*side", "turn + 3*strong*side"),
    (0, 2): ("-3*strong*side", "3*strong*side"),
    (0, 4): ("2*sqrt(slow)", "2*sqrt(fast)"),
    (1, 0): ("-turn - 3*strong*side", "turn + 3*strong*side"),
    (1, 1): ("slow - strong", "fast - weak + 3*strong*side**2"),
    (1, 2): ("-3*strong*side**2", "3*strong*side**2"),
    (1, 3): ("-2*sqrt(fast)", "-2*sqrt(slow)"),
    (2, 0): ("-3*strong*side", "3*strong*side"),
    (2, 1): ("-3*strong*side**2", "3*strong*side**2"),
    (2, 2): ("-strong", "-weak + 3*strong*side**2"),
}
_CHANNELS = len(_ENTRIES)


def _middle(entry: tuple[int, int]) -> str:
    low, high = _ENTRIES.get(entry, ("0", "0"))
    return f"({low} + {high})/2"


def flights(case: Any) -> dict[str, str]:
    """Return the inclusion of all flights with the printed gains, in xi = [x; e], as formulas over the tables."""
    acceleration = [[_middle((i, j)) for j in range(6)] for i in range(3)]
    differences = [
        f"({high} - ({low}))/2*unit(12,{3 + i}) + ({high} - ({low}))/2*unit(12,{9 + i})"
        for (i, _), (low, high) in _ENTRIES.items()
    ]
    return {
        **plant(case),
        "K": "printed('K')",
        "mu": "number('gravitational_parameter')",
        "perigee": "number('perigee_radius')",
        "apogee": "perigee*(1 + number('eccentricity'))/(1 - number('eccentricity'))",
        # squares of the rate of the true anomaly, and the largest size of its derivative
        "slow": "mu*perigee*(1 + number('eccentricity'))/apogee**4",
        "fast": "mu*(1 + number('eccentricity'))/perigee**3",
        "turn": "2*mu*number('eccentricity')/perigee**3",
        # mu/d^3, and the sine of the angle at the Earth between target and chaser
        "weak": f"mu/(apogee + {RANGE})**3",
        "strong": f"mu/(perigee - {RANGE})**3",
        "side": f"{RANGE}/(perigee - {RANGE})",
        "Am": "col(row(zeros(3,3), eye(3)), [[" + "], [".join(", ".join(row) for row in acceleration) + "]])",
        "Acl": "[[Am - B@K, B@K], [Am - A, A - L@C]]",
        "H": f"row({', '.join(differences)})",
        "Cz": f"col({', '.join(f'unit(12,{j}).T' for _, j in _ENTRIES)})",
        "rate": RATE,
        "position": "[[eye(3), zeros(3,9)]]",
        "speed": "[[zeros(3,3), eye(3), zeros(3,6)]]",
        # xi(0) at the corners of the starts, whose convex hull holds all of them
        "corners": f"row({', '.join(_start(i, j) for i in range(2) for j in range(2))})",
    }


def _start(position: int, velocity: int) -> str:
    """Return xi(0) where the shares of position and velocity in the estimate are at an end of their ranges."""
    shares = f"(1 - ends('estimate_position_share')[0,{position}])*x0[0:3,0], "
    return f"col(x0, {shares}(1 - ends('estimate_velocity_share')[0,{velocity}])*x0[3:6,0])"


DECAY = Statement(
    "decay",
    "Figures 3 and 5",
    ("xi", "w"),
    {("xi", "xi"): "sym(P@Acl) + 2*rate*P + Cz.T@S@Cz", ("xi", "w"): "P@H", ("w", "w"): "-S"},
    {"P": symmetric(12), "S": diagonal(_CHANNELS), "level": scalar()},
    flights,
)


def decaying(case: Case) -> Stated:
    """Return the program of a quadratic function that decays along all flights, least at the corners of the starts."""
    started = [read_constraint(f"level - corners[0:12,{i}].T@P@corners[0:12,{i}] > 0", f"start {i}") for i in range(4)]
    # a metre counts as much as 7 mm/s, the speed at which the chaser crosses its range in the time of the approach
    reach = read_constraint("P - position.T@position - 20000*speed.T@speed > 0", "reach")
    return Stated(case, [DECAY < 0, reach, *started], minimise="level", label="decay of the flights")


def certificate(case: Case, P: np.ndarray, multipliers: np.ndarray) -> Certificate:
    """Range and speed at the horizon are small, and the range never leaves what is described."""
    at_the_end = "exp(-rate*number('horizon'))"
    return build.certificate(
        "quadratic_bound",
        id="flights-end-at-target",
        tables=case,
        statement=f"At the horizon every flight of the printed controller is within {FINAL_RANGE} m of the target and "
        f"slower than {FINAL_SPEED} m/s, whatever part of position and velocity the estimate starts with.",
        definitions=flights(case),
        fields={
            "A": "Acl + rate*eye(12)",
            "H": "H",
            "Cz": "Cz",
            "blocks": [["repeated", 1]] * _CHANNELS,
            "x0": "corners",
            "inputs": [
                {"of": "range", "row": "position", "bound": RANGE},
                {"of": "final_range", "row": f"{at_the_end}*position", "bound": FINAL_RANGE},
                {"of": "final_speed", "row": f"{at_the_end}*speed", "bound": FINAL_SPEED},
            ],
        },
        witness={"P": P} | {f"D{i}": [[float(x)]] for i, x in enumerate(multipliers, start=1)},
        quantities={"final_range": "audit.final_range", "final_speed": "audit.final_speed"},
        faith=(
            "That within this range of the target the relative motion of the two-body problem is x' = A(t) x + B u with"
            " entries of A(t) between the bounds from which Acl and H are formed.",
            "That exp(rate t) xi(t) is a solution of the system with rate I added, so that what bounds it bounds"
            " exp(-rate t) times as much of xi(t), at the horizon and, since the range stays within its bound, before.",
        ),
    )


@task("Figures 3 and 5, every start")
def flights_end_at_target(case: Case, results: Results) -> None:
    """Prove that every flight ends at the target, from whichever part of position and velocity the estimate starts."""
    values = decaying(case).solve().need("decay of the flights").values
    results.certificate(certificate(case, values["P"], np.diagonal(values["S"])))
    results.say("Figures 3 and 5", f"within {FINAL_RANGE} m and {FINAL_SPEED} m/s of the target at the horizon: proved")

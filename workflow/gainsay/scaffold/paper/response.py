"""The response of Section 4: simulated once for the run, and for every plausible initial rate in scans."""

import numpy as np

from gainsay.simulation.linear import Response
from gainsay.tables import Case
from papers.example.plant import closed_loop

#: rad; what the claim on settling means by settled
SETTLED = 0.01


def respond(case: Case, rate0: float, steps: int = 300) -> Response:
    """Return the response from the printed angle and an initial rate in rad/s, exact between its samples."""
    start = np.array([case.number("angle0"), rate0])
    return Response(closed_loop(case), start, case.number("horizon"), steps)


def numbers(case: Case, rate0: float, steps: int = 300) -> dict[str, float]:
    """Return the quantities of a run, by their ids in quantities.csv."""
    found = respond(case, rate0, steps)
    angle, torque = np.array([1.0, 0.0]), -case.matrix("K")[0]
    return {
        "run.settling": found.last_above(angle, SETTLED),
        "run.final_angle": abs(float(found.states[-1, 0])),
        "run.torque": abs(found.peak(torque).value),
    }

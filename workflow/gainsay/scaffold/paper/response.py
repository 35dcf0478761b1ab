"""The response of Section 4: simulated once for the run, and for every plausible initial rate in scans."""

import numpy as np

from gainsay.simulation.linear import Response
from gainsay.systems.loop_proofs import values
from gainsay.tables import Case
from papers.example.plant import LOOP

#: rad; what the claim on settling means by settled
SETTLED = 0.01


def respond(case: Case, rate0: float, steps: int = 300) -> Response:
    """Return the response from the printed angle and an initial rate in rad/s, exact between its samples."""
    (loop,) = values(case, ["Acl"], LOOP)
    return Response(loop, np.array([case.number("angle0"), rate0]), case.number("horizon"), steps)


def numbers(case: Case, response: Response) -> dict[str, float]:
    """Return what is said of a response, by ids in quantities.csv."""
    angle, torque = np.array([1.0, 0.0]), -case.matrix("K")[0]
    return {
        "run.settling": response.last_above(angle, SETTLED),
        "run.final_angle": abs(float(response.states[-1, 0])),
        "run.torque": abs(response.peak(torque).value),
    }

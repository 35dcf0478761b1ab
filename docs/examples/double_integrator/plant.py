"""A unit mass under a force: x'' = u, cost the integral of x^2 + u^2."""

import numpy as np

from gainsay.simulation.linear import Response
from gainsay.systems.loop_proofs import values
from gainsay.tables import Case

#: formulas over the tables, which the checker evaluates exactly
LOOP = {
    "A": "[[0, 1], [0, 0]]",
    "B": "[[0], [1]]",
    "K": "printed('K')",
    "P": "printed('P')",
    "Acl": "A - B@K",
}


def respond(case: Case, v0: float, steps: int = 400) -> Response:
    """Return the response from the printed displacement and a velocity in m/s."""
    (loop,) = values(case, ["Acl"], LOOP)
    return Response(loop, np.array([case.number("x0"), v0]), case.number("horizon"), steps)


def numbers(case: Case, response: Response) -> dict[str, float]:
    """Return what is said of a response: the excursion to the other side, m, and the cost x' P x of its start."""
    start, undershoot = response.states[0], response.largest(np.array([-1.0, 0.0]))
    return {"run.undershoot": undershoot.value, "run.cost": start @ case.matrix("P") @ start}

"""The controller of the mixed problem, from a common solution of both sets of inequalities."""

import numpy as np

from gainsay.statements import Stated
from gainsay.systems.norms import h2_norm
from gainsay.systems.statespace import StateSpace
from gainsay.tables import Case
from gainsay.tables.designs import FoundDesign
from papers.scherer1997.plant import plant
from papers.scherer1997.statements import MIXED


def mixed(case: Case) -> FoundDesign:
    """Undo the change of variables with M = I, N = I - Y X: Ak, Bk and Ck from Ah, Bh and Ch."""
    point = Stated(case, MIXED, label="mixed").solve().need("mixed")
    A, B2, C = (case.matrix(name) for name in ("A", "B2", "C"))
    X, Y, Ah, Bh, Ch = (np.asarray(point[name]) for name in ("X", "Y", "Ah", "Bh", "Ch"))
    N = np.eye(3) - Y @ X
    Ak, Bk = np.linalg.solve(N, Ah - Y @ A @ X - Y @ B2 @ Ch - Bh @ C @ X), np.linalg.solve(N, Bh)
    loop = plant(case, "2").with_controller(StateSpace(Ak, Bk, Ch))
    return FoundDesign(
        asked="one controller of order three with an H-infinity norm below gamma and an H2 norm below our level",
        method="a semidefinite program in the variables of the paper, and back to the controller",
        matrices={"Ak": Ak, "Bk": Bk, "Ck": Ch},
        converged=True,
        outcome={"h2": h2_norm(loop.A, loop.B, loop.C)},
    )


SEARCHES = {"mixed": mixed}

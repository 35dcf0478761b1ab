"""The loop of the plant and a controller x' = Ak x + Bk y, u = Ck x."""

import numpy as np

from gainsay.tables import Case
from papers.scherer1997.statements import PLANT

#: the loop with the controller of the mixed problem, in formulas
MIXED_LOOP = PLANT | {
    "Ak": "design('mixed', 'Ak')",
    "Bk": "design('mixed', 'Bk')",
    "Ck": "design('mixed', 'Ck')",
    "Al": "[[A, B2@Ck], [Bk@C, Ak]]",
    "Bl": "col(B1, Bk@D)",
    "Linf": "row(Cinf, Dinf@Ck)",
    "L2": "row(C2, D2@Ck)",
}


def loop(case: Case, Ak: np.ndarray, Bk: np.ndarray, Ck: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return A, B and the outputs of both norms, Cinf and C2, of the loop."""
    A, B1, B2, F, E, H, G, C, D = (case.matrix(name) for name in PLANT)
    return (
        np.block([[A, B2 @ Ck], [Bk @ C, Ak]]),
        np.vstack([B1, Bk @ D]),
        np.hstack([F, E @ Ck]),
        np.hstack([H, G @ Ck]),
    )

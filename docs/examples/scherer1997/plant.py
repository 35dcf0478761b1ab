"""The plant, and its loop with the controller of the mixed problem: x' = Ak x + Bk y, u = Ck x."""

from gainsay.systems.synthesis import StandardPlant
from gainsay.tables import Case
from papers.scherer1997.statements import PLANT

MIXED_LOOP = PLANT | {
    "Ak": "design('mixed', 'Ak')",
    "Bk": "design('mixed', 'Bk')",
    "Ck": "design('mixed', 'Ck')",
    "Al": "[[A, B2@Ck], [Bk@C, Ak]]",
    "Bl": "col(B1, Bk@D)",
    "Linf": "row(Cinf, Dinf@Ck)",
    "L2": "row(C2, D2@Ck)",
}


def plant(case: Case, norm: str) -> StandardPlant:
    """The plant with the outputs of one norm, "2" or "inf"."""
    A, B1, B2, Cz, C, Dz, D = (case.matrix(name) for name in ("A", "B1", "B2", f"C{norm}", "C", f"D{norm}", "D"))
    return StandardPlant(A, B1, B2, Cz, C, D12=Dz, D21=D)

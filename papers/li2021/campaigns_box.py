"""Disk of (10) with given gains over boxes of inertia and gain variation.

Inputs are the delta_i of (6), of which J, D and G depend, and the variation of A_f, B_f and C_f, each common to all
entries of its matrix: 1 + delta times the gain. With the mass matrix in front of the rates, (10) is affine in them.
"""

from gainsay.campaigns import once_a_case
from gainsay.campaigns.pencil import PencilBox
from gainsay.tables import Case
from papers.li2021.proofs import PRINTED_LOOP
from papers.li2021.statements import PLANT

INPUTS = ("inertia_1", "inertia_2", "inertia_3", "variation_a", "variation_b", "variation_c")
IN_THE_DISK = "the poles of (10) with the printed gains lie in the disk of the paper"
_PRINTED = tuple((name, PRINTED_LOOP[name]) for name in ("Af", "Bf", "Cf"))
#: mass @ x' = N @ x, x = (angles, rates, state of the controller)
_PENCIL = (
    ("I1", "J1 + d1 * inertia_1"),
    ("I2", "J2 + d2 * inertia_2"),
    ("I3", "J3 + d3 * inertia_3"),
    ("G", "n**2 * diag(4*(I2 - I3), 3*(I1 - I3), I2 - I1)"),
    ("D", "n * (I1 + I3 - I2) * turn - n * F.T @ F @ turn"),
    ("mass", "diag(eye(3), diag(I1, I2, I3) - F.T @ F, eye(6))"),
    ("Ad", "(1 + variation_a) * Af"),
    ("Bd", "(1 + variation_b) * Bf"),
    ("Cd", "(1 + variation_c) * Cf"),
    ("N", "[[zeros(3, 3), eye(3), 0], [-G, -D, Cd], [Bd, 0, Ad]]"),
)


@once_a_case
def gain_box(case: Case) -> PencilBox:
    """Disk of the printed gains over inertia and gain variation."""
    return PencilBox(case, INPUTS, "N", "mass", "a", "b", (*PLANT, *_PRINTED, *_PENCIL), IN_THE_DISK)

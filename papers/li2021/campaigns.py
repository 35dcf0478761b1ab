"""Campaigns of li2021: the map of (12) over lambda and gamma, random gains of Figures 8 and 9, a box of gain variation.

Certificates of map and boxes are over the printed digits; draws bound what floating point leaves out.
"""

from collections.abc import Mapping

import numpy as np

from gainsay.campaigns import Block, once_a_case
from gainsay.campaigns.box import over_boxes
from gainsay.campaigns.draws import counted_draws
from gainsay.campaigns.feasibility import feasibility_map
from gainsay.lmi.rounding import gamma
from gainsay.statements import Stated
from gainsay.systems.enclosed_spectra import INSIDE, OUTSIDE, UNRESOLVED, resolved
from gainsay.tables import Case
from papers.li2021 import plant, proofs
from papers.li2021.campaigns_box import IN_THE_DISK, INPUTS, gain_box

#: how often a cell of a box of gain variation is halved at most: of the one of Table 1, and of a wider one
HALVINGS, HALVINGS_WIDE = 12, 9
_Loop = tuple[plant.Plant, plant.Gains]


def equation_12(case: Case, point: Mapping[str, str]) -> Stated:
    """(12) over all gains at a lambda and a gamma, nominal A."""
    return proofs.lemma_3(case, lam=point["lambda"], g=f"({point['gamma']})**2")


def loops_of(case: Case, name: str, factors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(10) with the gains of a controller times factors, and a bound on what rounding leaves out, entry by entry.

    Parameters
    ----------
    case : Case
    name : str
        Of the controller.
    factors : ndarray, shape (m, 12)
        Of the columns of A_f and B_f and the rows of C_f, as in (9).

    Returns
    -------
    (loops, error) : tuple of ndarray, shapes (m, 12, 12)
    """
    near, sizes = _nearest(case, name)
    parts = factors[:, :6], factors[:, 6:9], factors[:, 9:]
    # every entry is a sum of at most three products of doubles, each the nearest to an exact number or a draw
    return plant.closed_loop(*near, *parts), gamma(12) * plant.closed_loop(*sizes, *parts)


@once_a_case
def _nearest(case: Case, name: str) -> tuple[_Loop, _Loop]:
    """Nearest doubles of the plant and of the gains of a controller, and their moduli."""
    of, gains = plant.rigid(plant.exact_constants(case)), plant.controller(case, name, exact=True)
    near = plant.Plant(*_doubles(of)), plant.Gains(*_doubles(gains))
    return near, (plant.Plant(*map(np.abs, _doubles(of))), plant.Gains(*map(np.abs, _doubles(gains))))


def _doubles(exact: plant.Plant | plant.Gains) -> list[np.ndarray]:
    return [np.array(matrix, dtype=float) for matrix in (exact.A, exact.B, exact.C)]


def random_gains(case: Case, block: Block) -> dict[str, tuple[int, int]]:
    """Count the unstable loops (10) among constant draws of the twelve factors of (9), both controllers alike."""
    (axis,) = block.plan.axes
    uniform = block.generator().random((block.size, 12))
    factors = axis.low + (axis.high - axis.low) * uniform
    counts = {}
    for name in ("proposed", "comparison"):
        loops, error = loops_of(case, name, factors)
        outcome = resolved(loops, lambda s: s.real, error)
        counts[name] = int((outcome == OUTSIDE).sum()), int((outcome == UNRESOLVED).sum())
        assert int((outcome == INSIDE).sum()) + sum(counts[name]) == block.size
    return counts


CAMPAIGNS = {
    "eq12-map": feasibility_map(
        ("lambda", "gamma"), equation_12, "solution of (12) over all gains at lambda = {lambda} and gamma = {gamma}"
    ),
    "random-gains": counted_draws(
        ("factor",),
        "unstable",
        {"proposed": "the proposed controller", "comparison": "the controller of [39]"},
        random_gains,
    ),
    "gain-box": over_boxes(INPUTS, gain_box, HALVINGS, IN_THE_DISK),
    "gain-box-wide": over_boxes(INPUTS, gain_box, HALVINGS_WIDE, IN_THE_DISK),
}

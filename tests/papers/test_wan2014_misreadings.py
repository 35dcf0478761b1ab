"""Could the scan be to blame? Every misreading of one entry of the observer gain (41), held against (40) and (14).

A scan misreads a digit, loses or makes a sign, or shifts the decimal point. What claims.csv says of this is computed
here: doubles and a solver, as a test of a sentence, not as a proof.
"""

from pathlib import Path

import cvxpy as cp
import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from gainsay.dynamics.relative_orbit import clohessy_wiltshire
from gainsay.tables import read_case
from papers.wan2014.audit import pole_points

CASE = read_case(Path(__file__).resolve().parents[2], "wan2014")
A, C, L = clohessy_wiltshire(CASE.number("mean_motion")), CASE.matrix("C"), CASE.matrix("L")


def misreadings(text: str) -> set[str]:
    """Return every decimal that a scan may make of another by one slip: a digit, the sign, the point by one or two."""
    sign, digits = ("-", text[1:]) if text.startswith("-") else ("", text)
    found = {sign + digits[:i] + d + digits[i + 1 :] for i, c in enumerate(digits) if c.isdigit() for d in "0123456789"}
    found |= {("" if sign else "-") + digits, *(f"{text}e{power}" for power in (-2, -1, 1, 2))}
    return found - {text}


def misread() -> list[tuple[tuple[int, int], str, np.ndarray]]:
    """Return entry, misreading and gain for every misreading of one entry of L."""
    gains = []
    for i, row in enumerate(CASE.printed("L").rows):
        for j, entry in enumerate(row):
            for text in sorted(misreadings(entry.text)):
                gain = L.copy()
                gain[i, j] = float(text)
                gains.append(((i, j), text, gain))
    return gains


def distance(gain: np.ndarray) -> float:
    """Return how far the poles of A - LC lie from (40), 1/s, in the best matching."""
    wanted = np.array([complex(float(re), float(im)) for re, im in pole_points(CASE)])
    apart = np.abs(np.linalg.eigvals(A - gain @ C)[:, None] - wanted[None])
    return apart[linear_sum_assignment(apart)].max()


def test_one_misreading_alone_places_the_poles():
    """Of all, one does: a lost zero in -0.0025."""
    found = misread()
    # 18 entries, each with five slips of sign and point and nine other digits a place: 18 * 5 + 9 * 89 digits.
    assert len(found) == 18 * 5 + 9 * sum(c.isdigit() for row in CASE.printed("L").rows for e in row for c in e.text)
    nearest = sorted(found, key=lambda one: distance(one[2]))
    assert nearest[0][0] == (1, 0) and float(nearest[0][1]) == -0.0025
    # Half a unit of every fourth decimal may move a pole by so much: the rounding of 18 entries over the condition of
    # the poles, 12 at most; the next misreading misses by ten times what the first does.
    assert distance(nearest[0][2]) < 1e-3 < 2e-3 < distance(nearest[1][2])


def multipliers(error: np.ndarray) -> float:
    """Return the largest l of multipliers V >= 0 of trace one that refute (14) with so much to spare.

    Rows 4 to 6 of V1 and V2 are equal, which frees (14) of Y, and A'V1 + V1 A + Ac'V3 + V3 Ac >= l I, where Ac is the
    matrix of the error's dynamics, A - LC.
    """
    V, spare = cp.Variable((12, 12), symmetric=True), cp.Variable()
    V1, V2, V3 = V[:6, :6], V[:6, 6:], V[6:, 6:]
    form = A.T @ V1 + V1 @ A + error.T @ V3 + V3 @ error
    problem = cp.Problem(cp.Maximize(spare), [V >> 0, cp.trace(V) == 1, V1[3:] == V2[3:], form >> spare * np.eye(6)])
    return float(problem.solve(solver="CLARABEL"))


def test_what_has_a_solution_has_no_multipliers():
    """Where velocities are measured too, A - LC = -I shares X with any state feedback: nothing refutes (14)."""
    assert multipliers(-np.eye(6)) < 1e-7 < 1e-4 < multipliers(A - L @ C)


@pytest.mark.slow
def test_no_misreading_of_one_entry_leaves_14_a_solution():
    """The rows with l above the solver's 1e-8: each of the misread gains is refuted as the printed one is."""
    assert min(multipliers(A - gain @ C) for _, _, gain in misread()) > 1e-7


def test_rows_4_to_6_of_the_printed_x_fail_by_different_entries():
    """One misread entry cannot mend three rows: each is positive by a product of its own entry of L and of X."""
    X = CASE.matrix("X")
    diagonal = 2 * np.diag((A - L @ C) @ X)
    assert (diagonal[3:] > 0).all()
    own = [-2 * L[i, i - 3] * X[i - 3, i] for i in (3, 4, 5)]
    assert all(term > 0.5 * whole for term, whole in zip(own, diagonal[3:], strict=True))

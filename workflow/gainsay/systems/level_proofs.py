"""Proofs that the gain of a delay system stays below a level at every frequency.

Either the level is nowhere a singular value of the response, which is a pencil without singular points on the imaginary
axis (in double precision, with every rounding bounded), or the axis is covered with balls.
"""

from collections.abc import Sequence

import numpy as np
from flint import acb, acb_mat, arb, fmpq
from numpy.typing import ArrayLike

from gainsay.errors import ComputationError
from gainsay.systems.delay import DelaySystem
from gainsay.systems.norm_bounds import ball_matrix
from gainsay.systems.pencils import DelayPencil, require_regular


def level_not_reached(system: DelaySystem, delay: ArrayLike, level: float) -> bool:
    """Prove that no frequency has `level` as a singular value of the response, which at infinity is below it."""
    n, (p, m) = system.order, system.D.shape
    direct = np.linalg.norm(system.D, 2) * (1 + 1e-14)
    if not level > direct:
        return False
    (undelayed, _), *late = system.terms(delay)
    size = sum((np.linalg.norm(part, "fro") for part, _ in late), np.linalg.norm(undelayed, "fro"))
    through = np.linalg.norm(system.C, "fro") * np.linalg.norm(system.B, "fro")
    top = 1.01 * (size + through / (level - direct))  # beyond: |G| <= |D| + |C| |B| / (w - size) < level
    # Singular pair (w, z) of the response: G w = level z and G* z = level w, with states of G and of its adjoint.
    H = np.zeros((2 * n + m + p, 2 * n + m + p))
    a, b, w, z = np.split(np.arange(2 * n + m + p), [n, 2 * n, 2 * n + m])
    scale = np.sqrt(level)
    H[np.ix_(a, a)], H[np.ix_(a, w)] = undelayed, system.B / scale
    H[np.ix_(b, b)], H[np.ix_(b, z)] = -undelayed.T, -system.C.T / scale
    H[np.ix_(z, a)], H[np.ix_(z, w)], H[np.ix_(z, z)] = system.C / scale, system.D / level, -np.eye(p)
    H[np.ix_(w, b)], H[np.ix_(w, z)], H[np.ix_(w, w)] = system.B.T / scale, system.D.T / level, -np.eye(m)
    terms = [(H, 0.0)]
    for part, d in late:
        ahead, back = np.zeros_like(H), np.zeros_like(H)
        ahead[np.ix_(a, a)], back[np.ix_(b, b)] = part, -part.T
        terms += [(ahead, d), (back, -d)]
    E = np.diag(np.concatenate([np.ones(2 * n), np.zeros(m + p)]))
    require_regular(DelayPencil(E, tuple(terms)), [0.0, complex(0.0, top)])
    return True


def covered_below(system: DelaySystem, delays: Sequence[fmpq], level: fmpq, limit: int) -> bool:
    """Decide by balls whether the gain to one output is below a level; raises as `gain_stays_below` does."""
    A, B, C, D = (ball_matrix(system.exact[k]) for k in ("A", "B", "C", "D"))
    chosen = {delay: [d == delay for d in delays] for delay in delays}
    late = [(ball_matrix(system.delayed(np.array(which))), arb(delay)) for delay, which in chosen.items()]
    n, m = system.B.shape
    unit = acb_mat([[int(i == j) for j in range(n)] for i in range(n)])
    bound = arb(level) ** 2

    def squared(w: arb) -> arb:
        matrix = unit * acb(0, w) - A
        for part, d in late:
            matrix = matrix - part * acb(0, -w * d).exp()
        gain = C * matrix.solve(B) + D
        return sum((gain[0, j].real ** 2 + gain[0, j].imag ** 2 for j in range(m)), arb(0))

    size = sum((_rows(part) for part, _ in late), _rows(A))
    # Beyond w = 2^k: |G| <= |D| + |C| |B| / (w - size) in the row-sum norm, the columns being summed in |B|.
    top = 1.0
    while not (_rows(D) + _rows(C) * _rows(B) / (arb(top) - size)) ** 2 < bound or not arb(top) > size:
        top *= 2
        if top > 2.0**60:
            raise ComputationError("gain bound", "no bound at high frequencies below the level")
    todo, tried = [(0.0, top)], 0
    while todo:
        low, high = todo.pop()
        tried += 1
        if tried > limit:
            raise ComputationError("gain bound", f"{limit} intervals do not settle it near {low:.9g} rad/s")
        middle = (low + high) / 2
        try:
            value = squared(arb(middle, (high - low) / 2))
        except ZeroDivisionError:
            value = arb.pos_inf()
        if value < bound:
            continue
        if squared(arb(middle)) >= bound:
            return False
        todo += [(middle, high), (low, middle)]
    return True


def _rows(matrix: acb_mat) -> arb:
    """Largest absolute row sum."""
    sums = [sum((abs(matrix[i, j]) for j in range(matrix.ncols())), arb(0)) for i in range(matrix.nrows())]
    worst = sums[0]
    for value in sums[1:]:
        worst = worst.max(value)
    return worst

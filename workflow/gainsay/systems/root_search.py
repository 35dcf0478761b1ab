"""Characteristic roots of a delay system: candidates from collocation, polished by Newton, then proved complete.

The argument principle along a contour that loses no turn says how many roots lie right of a line.
"""

import numpy as np
from numpy.typing import ArrayLike

from gainsay.errors import ComputationError
from gainsay.systems.collocation import finite_system
from gainsay.systems.delay import DelaySystem
from gainsay.systems.pencils import DelayPencil, roots_right_of, turning
from gainsay.systems.spectrum import roots

_BOXES = (1e-9, 1e-8, 1e-7, 1e-6, 1e-5)  # half widths in which a multiple root is sought, relative to its size


def characteristic(system: DelaySystem, delay: ArrayLike) -> DelayPencil:
    """The characteristic matrix s I - A - sum_k H_k exp(-s d_k) as a pencil."""
    return DelayPencil(np.eye(system.order), system.terms(delay))


def _polish(system: DelaySystem, delay: np.ndarray, guess: complex) -> complex | None:
    """Newton on [M(s) v; c v - 1] = 0; None where it does not settle."""
    n, longest = system.order, delay.max()
    s = complex(guess)
    if -s.real * longest > 600:  # exp(-s d) leaves double precision
        return None
    _, _, right = np.linalg.svd(system.characteristic_matrix(s, delay))
    v = right[-1].conj()
    c = v.conj()
    for _ in range(30):
        M = system.characteristic_matrix(s, delay)
        dM = np.eye(n) + (system.Bd * (delay * np.exp(-s * delay))) @ system.Cd
        jacobian = np.block([[M, (dM @ v)[:, None]], [c[None, :], np.zeros((1, 1))]])
        try:
            step = np.linalg.solve(jacobian, -np.append(M @ v, c @ v - 1))
        except np.linalg.LinAlgError:
            return None
        v, s = v + step[:n], s + step[n]
        if not (np.isfinite(s) and -s.real * longest <= 600):
            return None
        if abs(step[n]) <= 1e-14 * (1 + abs(s)):
            return complex(s)
    return None


def exact_roots(system: DelaySystem, delay: np.ndarray) -> list | None:
    """Roots of a polynomial in disjoint balls where nothing is delayed or a common delay does not matter, else None."""
    quasi = system.quasi_polynomial
    if not delay.any():
        return roots(quasi.undelayed())
    return roots(quasi.coefficients[0]) if np.ptp(delay) == 0 and not any(quasi.coefficients[1:]) else None


def candidate_roots(system: DelaySystem, delay: np.ndarray, nodes: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Distinct polished roots of the upper half plane, and candidates on which Newton does not settle."""
    collocated = upper_half(np.linalg.eigvals(finite_system(system, delay, nodes)[0]))[: count + 4]
    others = [upper_half(np.linalg.eigvals(matrix)) for matrix in (system.A, system.A + system.A1)]
    settled = [_polish(system, delay, guess) for guess in np.concatenate([collocated, *others])]
    doubtful = [guess for guess, root in zip(collocated, settled, strict=False) if root is None]
    polished = [root for root in settled if root is not None]
    distinct: list[complex] = []
    for root in upper_half(np.array([s if s.imag >= 0 else s.conjugate() for s in polished], dtype=complex)):
        if all(abs(root - other) > 1e-9 * (1 + abs(other)) for other in distinct):
            distinct.append(root)
    return np.array(distinct, dtype=complex), upper_half(np.array(doubtful, dtype=complex))


def complete_roots(
    pencil: DelayPencil, delay: float, roots: np.ndarray, doubtful: np.ndarray, count: int
) -> np.ndarray | None:
    """Rightmost roots, multiple ones repeated, if the argument principle says that they are all; else None."""
    line = _line(np.concatenate([roots, doubtful]), delay, count)
    if line is None:
        return None
    number = roots_right_of(pencil, line)
    right = roots[roots.real > line]
    if not number:  # the line lies too far to the right
        return None
    if pairs_counted(right) == number:
        return right
    # Multiple roots, on which Newton need not settle: counted in small boxes, which must not meet.
    counted: list[complex] = []
    for group in _groups(np.concatenate([right, doubtful[doubtful.real > line]])):
        centre = complex(group.mean().real, 0.0 if np.any(group.imag == 0) else group.mean().imag)
        counted += [centre] * _multiplicity(pencil, centre)
    return upper_half(np.array(counted)) if pairs_counted(np.array(counted)) == number else None


def _line(candidates: np.ndarray, delay: float, count: int) -> float | None:
    """Abscissa in the gap behind the first `count` candidates, conjugates counted apart; None without candidates."""
    ordered = upper_half(candidates)
    if not len(ordered):
        return None
    have = np.cumsum(np.where(ordered.imag == 0, 1, 2))
    last = min(int(np.searchsorted(have, count)), len(ordered) - 1)
    while last + 1 < len(ordered):
        gap = ordered[last].real - ordered[last + 1].real
        if gap > 1e-5 * (1 + abs(ordered[last])):
            return float(ordered[last].real - min(gap / 2, 0.5 / delay + 0.1 * abs(ordered[last].real)))
        last += 1
    return float(ordered[last].real - 0.5 / delay)


def _groups(candidates: np.ndarray) -> list[np.ndarray]:
    """Candidates that lie together."""
    left, groups = upper_half(candidates), []
    while len(left):
        near = np.abs(left - left[0]) <= 1e-4 * (1 + np.abs(left[0]))
        groups.append(left[near])
        left = left[~near]
    return groups


def _multiplicity(pencil: DelayPencil, centre: complex) -> int:
    """Number of roots in the smallest box about a point on whose edge no root is felt."""
    for size in _BOXES:
        half = size * (1 + abs(centre))
        corners = [centre + half * z for z in (1 - 1j, 1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j)]
        try:
            turns = turning(pencil, corners, limit=5000) / (2 * np.pi)
        except ComputationError:
            continue
        if round(turns) > 0:
            return round(turns)
    return 0


def pairs_counted(upper: np.ndarray) -> int:
    """Number of roots, both of each conjugate pair counted, of which the upper halves are given."""
    return int(np.where(upper.imag == 0, 1, 2).sum()) if len(upper) else 0


def upper_half(values: np.ndarray) -> np.ndarray:
    """One of each conjugate pair, by decreasing real part."""
    kept = values[values.imag >= -1e-12 * (1 + np.abs(values))]
    kept = np.where(np.abs(kept.imag) <= 1e-12 * (1 + np.abs(kept)), kept.real + 0j, kept)
    return kept[np.lexsort((kept.imag, -kept.real))]


def mirrored(upper: np.ndarray, count: int) -> np.ndarray:
    """Both of each conjugate pair, the one above the axis first."""
    pairs = [[s] if s.imag == 0 else [s, s.conjugate()] for s in upper]
    return np.array([s for pair in pairs for s in pair][:count])

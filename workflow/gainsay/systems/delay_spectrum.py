"""Rightmost roots and H-infinity norm of a linear system with one constant delay.

The delayed signal is carried by a Chebyshev collocation of its past (spectral discretisation of the solution operator's
generator; Breda, Maset and Vermiglio, SIAM J. Sci. Comput. 27, 2005), which gives candidates; every root is then
polished by Newton on the exact characteristic matrix, every peak on the exact frequency response (Michiels and
Gumussoy, SIAM J. Matrix Anal. Appl. 31, 2010). The norm is enclosed by ball arithmetic over all frequencies.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from flint import acb, acb_mat, arb, ctx, fmpq
from scipy.optimize import minimize_scalar

from gainsay.errors import ComputationError, InputError
from gainsay.systems.delay import DelaySystem

_NODES = (12, 24, 48, 96)


@dataclass(frozen=True)
class Peak:
    """The H-infinity norm and where it is attained.

    Attributes
    ----------
    value : float
        Largest singular value over all frequencies.
    frequency : float
        rad/s.
    """

    value: float
    frequency: float


def chebyshev(nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Chebyshev extreme points on [-1, 1] from 1 down to -1 and their differentiation matrix.

    Parameters
    ----------
    nodes : int
        Degree N; N + 1 points.

    Returns
    -------
    x : ndarray, shape (N + 1,)
    D : ndarray, shape (N + 1, N + 1)
        Trefethen, Spectral Methods in MATLAB, chapter 6.
    """
    k = np.arange(nodes + 1)
    x = np.cos(np.pi * k / nodes)
    weight = np.where((k == 0) | (k == nodes), 2.0, 1.0) * (-1.0) ** k
    difference = x[:, None] - x[None, :] + np.eye(nodes + 1)
    D = np.outer(weight, 1 / weight) / difference
    return x, D - np.diag(D.sum(axis=1))


def discretised(system: DelaySystem, delay: float, nodes: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Finite-dimensional (A, B, C) that replaces the delay line by collocation at Chebyshev points.

    Parameters
    ----------
    system : DelaySystem
    delay : float
        s, positive.
    nodes : int
        Collocation degree.

    Returns
    -------
    A, B, C : ndarray
        Shapes (n + r N, n + r N), (n + r N, m), (p, n + r N).
    """
    n, r = system.order, system.Bd.shape[1]
    _, D = chebyshev(nodes)
    D = D * (2 / delay)
    size = n + r * nodes
    A = np.zeros((size, size))
    A[:n, :n] = system.A
    A[:n, size - r :] = system.Bd
    A[n:, :n] = np.kron(D[1:, :1], system.Cd)
    A[n:, n:] = np.kron(D[1:, 1:], np.eye(r))
    B = np.vstack([system.B, np.zeros((r * nodes, system.B.shape[1]))])
    C = np.hstack([system.C, np.zeros((system.C.shape[0], r * nodes))])
    return A, B, C


def _check_delay(delay: float) -> None:
    if not (np.isfinite(delay) and delay >= 0):
        raise InputError("", field="delay", value=delay, expected="a finite time >= 0 s")


def _polish(system: DelaySystem, delay: float, guess: complex) -> complex | None:
    """Newton on [M(s) v; c v - 1] = 0; None where it does not settle."""
    n = system.order
    s = complex(guess)
    _, _, right = np.linalg.svd(system.characteristic_matrix(s, delay))
    v = right[-1].conj()
    c = v.conj()
    for _ in range(30):
        M = system.characteristic_matrix(s, delay)
        dM = np.eye(n) + delay * system.A1 * np.exp(-s * delay)
        jacobian = np.block([[M, (dM @ v)[:, None]], [c[None, :], np.zeros((1, 1))]])
        try:
            step = np.linalg.solve(jacobian, -np.append(M @ v, c @ v - 1))
        except np.linalg.LinAlgError:
            return None
        v, s = v + step[:n], s + step[n]
        if not np.isfinite(s):
            return None
        if abs(step[n]) <= 1e-14 * (1 + abs(s)):
            return complex(s)
    return None


def rightmost_roots(system: DelaySystem, delay: float, count: int = 6) -> np.ndarray:
    """Characteristic roots with the largest real parts under a constant delay.

    Parameters
    ----------
    system : DelaySystem
    delay : float
        s.
    count : int
        How many, conjugates counted apart.

    Returns
    -------
    ndarray, shape (count,), complex
        By decreasing real part, 1/s; fewer where the system has fewer, or where the others lie so far left that a
        short delay leaves them beyond what the collocation resolves.

    Raises
    ------
    InputError
        If the delay is negative or not finite.
    ComputationError
        If the collocation at two successive degrees does not agree on the roots after Newton.
    """
    _check_delay(delay)
    if delay == 0:
        return _mirrored(_upper(np.linalg.eigvals(system.A + system.A1)), count)
    before, attempts = None, []
    for nodes in _NODES:
        candidates = _upper(np.linalg.eigvals(_finite(system, delay, nodes)[0]))[:count]
        # Collocation of degree N follows exp(s t) over the delay while |s| d is well below N.
        candidates = candidates[np.abs(candidates) * delay < nodes / 2]
        roots = [_polish(system, delay, s) for s in candidates]
        if all(s is not None and abs(s - c) < 1e-2 * (1 + abs(c)) for s, c in zip(roots, candidates, strict=True)):
            now = _upper(np.array(roots))
            settled = before is not None and len(before) > 0 and _same(before, now[: len(before)])
            if settled and (len(before) == count or nodes == _NODES[-1]):
                return _mirrored(before, count)
            before = now
        attempts.append({"nodes": nodes, "candidates": [str(s) for s in candidates]})
    raise ComputationError("rightmost roots", f"collocation does not settle at delay {delay:.6g} s", attempts)


def _finite(system: DelaySystem, delay: float, nodes: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Collocated system; the undelayed one where the delay is far below every time constant of the loop."""
    if delay * (np.linalg.norm(system.A, 2) + np.linalg.norm(system.A1, 2)) < 1e-12:
        return system.A + system.A1, system.B, system.C
    return discretised(system, delay, nodes)


def _upper(roots: np.ndarray) -> np.ndarray:
    """One of each conjugate pair, by decreasing real part."""
    kept = roots[roots.imag >= -1e-12 * (1 + np.abs(roots))]
    kept = np.where(np.abs(kept.imag) <= 1e-12 * (1 + np.abs(kept)), kept.real + 0j, kept)
    return kept[np.lexsort((kept.imag, -kept.real))]


def _mirrored(upper: np.ndarray, count: int) -> np.ndarray:
    """Both of each conjugate pair, the one above the axis first."""
    pairs = [[s] if s.imag == 0 else [s, s.conjugate()] for s in upper]
    return np.array([s for pair in pairs for s in pair][:count])


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    return a.shape == b.shape and bool(np.all(np.abs(a - b) <= 1e-9 * (1 + np.abs(b))))


def spectral_abscissa(system: DelaySystem, delay: float) -> float:
    """Largest real part of a characteristic root under a constant delay (s), 1/s."""
    return float(rightmost_roots(system, delay, count=2)[0].real)


def unstable_root_count(system: DelaySystem, delay: float) -> int:
    """Count the roots in the right half plane by the winding of the quasi-polynomial along a half disk.

    The radius bounds every root with Re s >= 0, for |s| <= |A| + |Bd Cd| there. Independent of any discretisation of
    the delay. The contour is refined until no step turns the value by more than an eighth.

    Raises
    ------
    ComputationError
        If refinement does not end: a root lies on the contour, that is on the imaginary axis.
    """
    _check_delay(delay)
    radius = 1.0 + np.linalg.norm(system.A, 2) + np.linalg.norm(system.A1, 2)
    polynomials = [
        np.array([float(c.p) / float(c.q) for c in reversed(p.coeffs())] or [0.0])
        for p in system.quasi_polynomial.coefficients
    ]

    def value(path: np.ndarray) -> np.ndarray:
        return sum(np.polyval(p, path) * np.exp(-k * path * delay) for k, p in enumerate(polynomials))

    arc = radius * np.exp(1j * np.linspace(-np.pi / 2, np.pi / 2, 4000))
    path = np.concatenate([arc, 1j * np.linspace(radius, -radius, 20_000)])
    values = value(path)
    for _ in range(60):
        turns = np.angle(values[1:] / values[:-1])
        coarse = np.flatnonzero(np.abs(turns) > np.pi / 4)
        if not coarse.size:
            return round(float(turns.sum() / (2 * np.pi)))
        middle = (path[coarse] + path[coarse + 1]) / 2
        path = np.insert(path, coarse + 1, middle)
        values = np.insert(values, coarse + 1, value(middle))
    raise ComputationError("root count", f"a root on the imaginary axis at delay {delay:.6g} s")


def _gain(system: DelaySystem, delay: float, frequency: float) -> float:
    return float(np.linalg.norm(system.response(frequency, delay), 2))


def _local_peak(system: DelaySystem, delay: float, low: float, high: float) -> Peak:
    best = minimize_scalar(
        lambda w: -_gain(system, delay, w), bounds=(low, high), method="bounded", options={"xatol": 1e-10 * (1 + high)}
    )
    return max((Peak(_gain(system, delay, w), float(w)) for w in (low, best.x, high)), key=lambda p: p.value)


def hinf_norm(system: DelaySystem, delay: float, nodes: int = 24) -> Peak:
    """Least upper bound of the gain from w to y under a constant delay, the loop being stable there.

    Level sets of the collocated system (imaginary eigenvalues of its Hamiltonian matrix) say where the gain may be
    larger than the best found so far; the gain itself is always that of the exact response.

    Parameters
    ----------
    system : DelaySystem
        With B, C and D.
    delay : float
        s.
    nodes : int
        Collocation degree of the candidates.

    Raises
    ------
    InputError
        If the loop is not stable at this delay (the norm would be infinite), or has no inputs or outputs.
    """
    _check_delay(delay)
    if not system.B.shape[1] or not system.C.shape[0]:
        raise InputError("a norm needs inputs and outputs", field="B, C", value=(system.B.shape, system.C.shape))
    if (abscissa := spectral_abscissa(system, delay)) >= 0:
        raise InputError("unstable loop", field="spectral abscissa", value=abscissa, expected="below 0")
    A, B, C = _finite(system, delay, nodes)
    starts = [0.0, *np.abs(rightmost_roots(system, delay, count=system.order).imag)]
    best = max((Peak(_gain(system, delay, w), w) for w in starts), key=lambda p: p.value)
    best = max(best, Peak(float(np.linalg.norm(system.D, 2)), float("inf")), key=lambda p: p.value)
    for _ in range(50):
        level = best.value * (1 + 1e-9)
        edges = _level_set(A, B, C, system.D, level)
        pieces = [_local_peak(system, delay, a, b) for a, b in pairwise(edges)]
        found = max(pieces, key=lambda p: p.value, default=best)
        if found.value <= level:
            return max(best, found, key=lambda p: p.value)
        best = found
    raise ComputationError("H-infinity norm", f"level sets do not close at {best.value:.9g}")


def _level_set(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, level: float) -> np.ndarray:
    """Frequencies >= 0 at which a singular value of C (jw - A)^-1 B + D equals the level (Boyd, Balakrishnan 1989)."""
    R = level**2 * np.eye(D.shape[1]) - D.T @ D
    solve = np.linalg.solve
    top = A + B @ solve(R, D.T @ C)
    S = np.eye(D.shape[0]) + D @ solve(R, D.T)
    hamiltonian = np.block([[top, B @ solve(R, B.T)], [-C.T @ S @ C, -top.T]])
    eigenvalues = np.linalg.eigvals(hamiltonian)
    size = np.abs(eigenvalues)
    # Generous: a wrong candidate costs one more local search, a missed one the answer.
    near = np.abs(eigenvalues.real) <= 1e-6 * (1 + size)
    return np.unique(np.append(0.0, np.abs(eigenvalues.imag[near]))) if near.any() else np.array([])


def gain_stays_below(system: DelaySystem, delay: fmpq, level: fmpq, limit: int = 200_000) -> bool:
    """Prove that the gain from w to y is below a level at every frequency, by covering the axis with balls.

    Says nothing about stability; that is for the margin to prove.

    Parameters
    ----------
    system : DelaySystem
        With one output; its matrices are taken exactly as given.
    delay, level : fmpq
        Constant delay in s; the level.
    limit : int
        Most intervals to try.

    Returns
    -------
    bool
        True is a proof; False says that some frequency reaches the level.

    Raises
    ------
    ComputationError
        If the intervals run out, as they must when the level is the norm itself.
    """
    if system.C.shape[0] != 1:
        raise InputError("", field="C", value=system.C.shape, expected="one output row")
    kept, ctx.prec = ctx.prec, 128
    try:
        return _covered(system, delay, level, limit)
    finally:
        ctx.prec = kept


def _ball_matrix(exact: np.ndarray) -> acb_mat:
    return acb_mat([[acb(arb(fmpq(v.numerator, v.denominator))) for v in row] for row in exact])


def _covered(system: DelaySystem, delay: fmpq, level: fmpq, limit: int) -> bool:
    A, B, C, D = (_ball_matrix(system.exact[k]) for k in ("A", "B", "C", "D"))
    A1 = _ball_matrix(system.exact["Bd"]) * _ball_matrix(system.exact["Cd"])
    n, m = system.B.shape
    unit = acb_mat([[int(i == j) for j in range(n)] for i in range(n)])
    d, bound = arb(delay), arb(level) ** 2

    def squared(w: arb) -> arb:
        matrix = unit * acb(0, w) - A - A1 * acb(0, -w * d).exp()
        gain = C * matrix.solve(B) + D
        return sum((gain[0, j].real ** 2 + gain[0, j].imag ** 2 for j in range(m)), arb(0))

    size = _rows(A) + _rows(A1)
    # Beyond w = 2^k: |G| <= |D| + |C| |B| / (w - |A| - |A1|) in the row-sum norm, the columns being summed in |B|.
    top = 1.0
    while not (_rows(D) + _rows(C) * _rows(B) / (arb(top) - size)) ** 2 < bound or not arb(top) > size:
        top *= 2
        if top > 2.0**60:
            return False
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

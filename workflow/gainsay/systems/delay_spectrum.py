"""Rightmost roots and H-infinity norm of a linear system with constant delays, each with a proof of completeness.

One delay for all delayed signals, or one a signal; whether they are commensurate makes no difference here. The delayed
signals are carried by Chebyshev collocations of their past, which gives candidates; every root is then polished by
Newton on the exact characteristic matrix, every peak on the exact frequency response (W. Michiels, S. Gumussoy, SIAM J.
Matrix Anal. Appl. 31, 2010). That no root is missing is proved by counting the roots right of a line with the argument
principle; that no frequency has a larger gain, by the absence of singular points of a pencil on the imaginary axis.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np
from flint import ctx, fmpq
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar

from gainsay.errors import ComputationError, InputError
from gainsay.systems.collocation import finite_system
from gainsay.systems.delay import DelaySystem
from gainsay.systems.level_proofs import covered_below, level_not_reached
from gainsay.systems.norm_bounds import hinf_bounds
from gainsay.systems.pencils import NearRoot, roots_right_of
from gainsay.systems.root_search import (
    candidate_roots,
    characteristic,
    complete_roots,
    exact_roots,
    mirrored,
    pairs_counted,
    upper_half,
)
from gainsay.systems.spectrum import rational

_NODES = (12, 24, 48, 96, 192)
_ENOUGH = 48  # nodes after which fewer roots than wanted will do
_NEAR_ONE = 10  # rates within 2^-10 to 2^10 1/s are taken as they are


@dataclass(frozen=True)
class Peak:
    """The H-infinity norm and where it is attained.

    Attributes
    ----------
    value : float
        Largest singular value over all frequencies; the gain at `frequency`, so a lower end but for rounding.
    frequency : float
        rad/s.
    upper : float
        No frequency has a gain above it, which is proved; within 1e-6 of the value where it can be.
    """

    value: float
    frequency: float
    upper: float = float("inf")


def _in_own_time(system: DelaySystem, delay: ArrayLike) -> tuple[DelaySystem, np.ndarray, float]:
    """The same system in another unit of time where all its rates are far from one; its delays, and that unit (1/s).

    A power of two, so that nothing is rounded: tolerances below are meant for rates of about one.
    """
    delay = system.delays(delay)
    size = sum(float(np.linalg.norm(H)) for H, _ in system.terms(delay))
    if size == 0 or not delay.any():
        return system, delay, 1.0
    powers = [round(float(np.log2(size))), round(float(-np.log2(delay.max())))]
    exponent = min(powers) if min(powers) > 0 else min(max(powers), 0)
    if abs(exponent) <= _NEAR_ONE:
        return system, delay, 1.0
    exact, factor = system.exact, Fraction(2) ** -exponent
    faster = (exact["A"] * factor, exact["Bd"] * factor, exact["Cd"], exact["B"] * factor, exact["C"], exact["D"])
    return DelaySystem(*faster), delay * 2.0**exponent, 2.0**exponent


def rightmost_roots(system: DelaySystem, delay: ArrayLike, count: int = 6) -> np.ndarray:
    """Characteristic roots with the largest real parts under constant delays.

    Parameters
    ----------
    system : DelaySystem
    delay : float or array_like, shape (r,)
        s: one for all delayed signals, or one a signal.
    count : int
        How many, conjugates counted apart.

    Returns
    -------
    ndarray, shape (count,), complex
        By decreasing real part, 1/s, multiple ones repeated; fewer where the system has fewer, or where the others lie
        so far left that their number cannot be proved.

    Raises
    ------
    InputError
        If a delay is negative or not finite, or the count below one.
    ComputationError
        If the roots found are not provably all that lie right of a line just left of them.

    Examples
    --------
    x' = -0.5 x(t - 1) - 0.5 x(t - 2):

    >>> two = DelaySystem([[0]], [[-0.5, -0.5]], [[1], [1]])
    >>> rightmost_roots(two, [1, 2], 2).round(6)
    array([-0.074384+0.983602j, -0.074384-0.983602j])
    """
    if count < 1:
        raise InputError("", field="count", value=count, expected="at least 1")
    system, delay, unit = _in_own_time(system, delay)
    exact = exact_roots(system, delay)
    if exact is not None:
        values = [complex(float(b.real.mid()), float(b.imag.mid())) for b, times in exact for _ in range(times)]
        return unit * mirrored(upper_half(np.array(values)), count)
    pencil, longest, attempts, best = characteristic(system, delay), float(delay.max()), [], np.array([])
    for nodes in _NODES:
        roots, doubtful = candidate_roots(system, delay, nodes, count)
        for wanted in dict.fromkeys((count, 1)):
            try:
                proved = complete_roots(pencil, longest, roots, doubtful, wanted)
                error = "roots missing"
            except ComputationError as broken:
                proved, error = None, str(broken)
            if proved is not None:
                best = max(best, proved, key=len)
                break
            attempts.append({"nodes": nodes, "wanted": wanted, "error": error})
        if pairs_counted(best) >= count or (len(best) and nodes >= _ENOUGH):
            return unit * mirrored(best, count)
    message = f"not provably complete at {_told(delay / unit)}: {attempts[-1]['error']}"
    raise ComputationError("rightmost roots", message, attempts)


def _told(delay: np.ndarray) -> str:
    """Delays as a message has them."""
    return f"delay {', '.join(f'{d:.6g}' for d in np.unique(delay))} s"


def spectral_abscissa(system: DelaySystem, delay: ArrayLike) -> float:
    """Largest real part of a characteristic root under constant delays (s, one for all or one a signal), 1/s."""
    return float(rightmost_roots(system, delay, count=1)[0].real)


def unstable_root_count(system: DelaySystem, delay: ArrayLike) -> int:
    """Count the roots in the right half plane, independently of any discretisation of the delays.

    Without delay the roots of the exact characteristic polynomial are isolated; else the argument principle is applied
    to a box that holds every root with Re s >= 0.

    Raises
    ------
    InputError
        If a delay is negative or not finite.
    ComputationError
        If a root cannot be told from the imaginary axis.
    """
    system, delay, _ = _in_own_time(system, delay)
    exact = exact_roots(system, delay)
    if exact is None:
        return roots_right_of(characteristic(system, delay), 0.0)
    if any(not ball.real > 0 and not ball.real < 0 for ball, _ in exact):
        raise ComputationError("root count", f"a root on the imaginary axis at {_told(delay)}")
    return sum(times for ball, times in exact if ball.real > 0)


def _gain(system: DelaySystem, delay: np.ndarray, frequency: float) -> float:
    return float(np.linalg.norm(system.response(frequency, delay), 2))


def _local_peak(system: DelaySystem, delay: np.ndarray, low: float, high: float) -> Peak:
    best = minimize_scalar(
        lambda w: -_gain(system, delay, w), bounds=(low, high), method="bounded", options={"xatol": 1e-10 * (1 + high)}
    )
    return max((Peak(_gain(system, delay, w), float(w)) for w in (low, best.x, high)), key=lambda p: p.value)


def hinf_norm(system: DelaySystem, delay: ArrayLike, nodes: int = 24) -> Peak:
    """Least upper bound of the gain from w to y under constant delays, the loop being stable there.

    Level sets of the collocated system (imaginary eigenvalues of its Hamiltonian matrix) say where the gain may be
    larger than the best found so far; the gain itself is always that of the exact response, and the upper end is proved
    on the exact response too.

    Parameters
    ----------
    system : DelaySystem
        With B, C and D.
    delay : float or array_like, shape (r,)
        s: one for all delayed signals, or one a signal.
    nodes : int
        Collocation degree of the candidates.

    Returns
    -------
    Peak

    Raises
    ------
    InputError
        If the loop is not stable at these delays (the norm would be infinite), or has no inputs or outputs.
    ComputationError
        If stability or the upper end cannot be proved.
    """
    if not system.B.shape[1] or not system.C.shape[0]:
        raise InputError("a norm needs inputs and outputs", field="B, C", value=(system.B.shape, system.C.shape))
    faster, own_delay, unit = _in_own_time(system, delay)
    if unit != 1:
        peak = hinf_norm(faster, own_delay, nodes)
        return Peak(peak.value, unit * peak.frequency, peak.upper)
    delay = own_delay
    if unstable := unstable_root_count(system, delay):
        raise InputError("unstable loop", field="roots in the right half plane", value=unstable, expected="none")
    if not any(H.any() for H, _ in system.terms(delay)[1:]):
        closed = rational(system.exact["A"] + system.delayed(delay == 0))
        bounds = hinf_bounds(
            closed, rational(system.exact["B"]), rational(system.exact["C"]), rational(system.exact["D"])
        )
        return Peak(bounds.lower, bounds.frequency, bounds.upper)
    A, B, C = finite_system(system, delay, nodes)
    upper_roots = rightmost_roots(system, delay, count=system.order)
    starts = {0.0, *np.abs(upper_roots.imag).tolist(), *np.abs(np.linalg.eigvals(system.A).imag).tolist()}
    best = max((Peak(_gain(system, delay, w), w) for w in sorted(starts)), key=lambda p: p.value)
    best = max(best, Peak(float(np.linalg.norm(system.D, 2)), float("inf")), key=lambda p: p.value)
    if best.value == 0 and not system.C.any():
        return Peak(0.0, 0.0, 0.0)
    for _ in range(50):
        level = best.value * (1 + 1e-9)
        edges = _level_set(A, B, C, system.D, level)
        pieces = [_local_peak(system, delay, a, b) for a, b in pairwise(edges)]
        largest = max(pieces, key=lambda p: p.value, default=best)
        if largest.value > level:
            best = largest
            continue
        best = max(best, largest, key=lambda p: p.value)
        better = _proved_or_better(system, delay, best)
        if np.isfinite(better.upper):
            return better
        best = better
    raise ComputationError("H-infinity norm", f"level sets do not close at {best.value:.9g}")


def _proved_or_better(system: DelaySystem, delay: np.ndarray, best: Peak) -> Peak:
    """The peak with a proved upper end, or a higher peak at a frequency where the proof broke down."""
    place, error = None, None
    for width in (1e-6, 1e-5):
        upper = best.value * (1 + width)
        try:
            if level_not_reached(system, delay, upper):
                return Peak(best.value, best.frequency, upper)
        except NearRoot as found:
            place, error = abs(found.place.imag), found
    if place is not None:
        higher = _local_peak(system, delay, place * (1 - 1e-3), place * (1 + 1e-3))
        if higher.value > best.value * (1 + 1e-9):
            return higher
    raise ComputationError("H-infinity norm", f"no proof above {best.value!r}: {error or 'its level is that of D'}")


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


def gain_stays_below(system: DelaySystem, delay: fmpq | Sequence[fmpq], level: fmpq, limit: int = 200_000) -> bool:
    """Prove that the gain from w to y is below a level at every frequency, by covering the axis with balls.

    Says nothing about stability; that is for the margin to prove.

    Parameters
    ----------
    system : DelaySystem
        With one output; its matrices are taken exactly as given.
    delay : fmpq or sequence of fmpq
        Constant delay in s: one for all delayed signals, or one a signal.
    level : fmpq
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
    if system.C.shape[0] != 1 or not system.B.shape[1]:
        raise InputError("", field="B, C", value=(system.B.shape, system.C.shape), expected="inputs, one output row")
    count = system.Bd.shape[1]
    delays = list(delay) if isinstance(delay, Sequence) else [delay] * count
    if len(delays) != count or not all(isinstance(d, fmpq | int) and d >= 0 for d in delays):
        raise InputError(
            "", field="delay", value=str(delay), expected=f"a rational time >= 0 s, or {count}: one a signal"
        )
    if not level > 0:
        raise InputError("", field="level", value=str(level), expected="above 0")
    kept, ctx.prec = ctx.prec, 128
    try:
        return covered_below(system, delays, level, limit)
    finally:
        ctx.prec = kept

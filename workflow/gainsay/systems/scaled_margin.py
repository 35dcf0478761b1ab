"""Delay margin of a loop with several delays that grow together, in fixed proportions.

With the delays f d_k, i w is a root if and only if it is an eigenvalue of A + sum_k H_k exp(-i t d_k), t = f w: so all
first crossings lie on curves in one number t, whether the delays are commensurate or not.

Reference: K. Gu, V. L. Kharitonov, J. Chen, Stability of Time-Delay Systems, Birkhauser 2003, chapter 4 (frequency
sweeping).
"""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import fmpq
from numpy.typing import ArrayLike

from gainsay.errors import ComputationError, InputError
from gainsay.exact.ball import precision
from gainsay.exact.budget import BudgetError, budget
from gainsay.exact.floats import real_array
from gainsay.proof.checker import WORK
from gainsay.proof.delayed import DelayedLoop, NotSettled, Range
from gainsay.systems.delay import DelaySystem
from gainsay.systems.delay_spectrum import unstable_root_count
from gainsay.systems.norm_bounds import ball_matrix

_STEP = 0.02  # rad, of the phase of the longest delay between two places of the sweep
_MOST = 400_000  # places
_BATCH = 2_000


@dataclass(frozen=True)
class ScaledMargin:
    """The factor of the delays at which a loop first loses stability, between proved ends.

    Attributes
    ----------
    lower : float
        The loop is stable for every factor from 0 to it; 0 where it is unstable without delay.
    upper : float
        It is unstable there; infinity where it is stable up to the largest factor that was asked for, `lower` then.
    frequency : float
        Where roots cross, rad/s; nan where none do.
    """

    lower: float
    upper: float
    frequency: float


def scaled_delay_margin(system: DelaySystem, delay: ArrayLike, largest: float, *, width: float = 1e-6) -> ScaledMargin:
    """Largest common factor of the delays below which a loop is stable.

    Parameters
    ----------
    system : DelaySystem
    delay : array_like, shape (r,)
        Delays of the signals at the factor one, s.
    largest : float
        Factor up to which is looked.
    width : float
        Relative distance of the ends.

    Returns
    -------
    ScaledMargin

    Raises
    ------
    InputError
        If a delay is negative or all are zero, or `largest` is not positive and finite.
    ComputationError
        If an end cannot be proved: where roots touch the axis and return, or cross faster than the sweep sees.

    Examples
    --------
    x' = -x(t - f) - x(t - 2 f): s = j w with w f = pi/3 needs w = sin(pi/3) + sin(2 pi/3).

    >>> margin = scaled_delay_margin(DelaySystem([[0]], [[-1, -1]], [[1], [1]]), [1, 2], 10)
    >>> round(margin.lower, 5), round(np.pi / 3 / np.sqrt(3), 5)
    (0.6046, 0.6046)
    """
    delays = system.delays(delay)
    if not delays.any():
        raise InputError("", field="delay", value=delays.tolist(), expected="one above 0 s")
    last = float(real_array(largest, "largest"))
    if not last > 0:
        raise InputError("", field="largest", value=last, expected="above 0")
    if unstable_root_count(system, 0.0):
        return ScaledMargin(0.0, 0.0, float("nan"))
    factor, frequency = min(_crossings(system, delays, last), default=(np.inf, np.nan))
    if not factor < last:
        _prove_stable(system, delays, last)
        return ScaledMargin(last, float("inf"), float("nan"))
    lower, upper = factor * (1 - width / 2), factor * (1 + width / 2)
    _prove_stable(system, delays, lower)
    if not unstable_root_count(system, upper * delays):
        raise ComputationError("delay margin", f"roots touch the axis and return at the factor {factor:.9g}")
    return ScaledMargin(lower, upper, frequency)


def _crossings(system: DelaySystem, delays: np.ndarray, last: float) -> list[tuple[float, float]]:
    """Factors up to `last` at which roots cross the axis, as far as the sweep sees, and the frequencies in rad/s."""
    terms = system.terms(delays)
    radius = np.linalg.norm(sum(np.abs(H) for H, _ in terms), 2)
    count = int(np.ceil(last * radius * delays.max() / _STEP)) + 1
    if count > _MOST:
        raise ComputationError("delay margin", f"a sweep of {count} places, at most {_MOST}: {last:.3g} is too large")
    places = np.linspace(0, last * radius, count)
    crossings = []
    right = np.concatenate([_right(terms, part) for part in np.array_split(places, count // _BATCH + 1)])
    for k in np.flatnonzero(np.diff(right)):
        low, high = places[k], places[k + 1]
        while (middle := (low + high) / 2) not in (low, high):
            low, high = (middle, high) if _right(terms, np.array([middle]))[0] == right[k] else (low, middle)
        roots = np.linalg.eigvals(_matrices(terms, np.array([low]))[0])
        frequency = float(roots[np.abs(roots.real).argmin()].imag)
        if frequency > 0:
            crossings.append((float(low / frequency), frequency))
    return crossings


def _matrices(terms: tuple[tuple[np.ndarray, float], ...], places: np.ndarray) -> np.ndarray:
    """A + sum_k H_k exp(-i t d_k) at places t, shape (k, n, n)."""
    return sum(np.exp(-1j * places * d)[:, None, None] * H for H, d in terms)


def _right(terms: tuple[tuple[np.ndarray, float], ...], places: np.ndarray) -> np.ndarray:
    """Numbers of eigenvalues with a positive real part at places t."""
    return (np.linalg.eigvals(_matrices(terms, places)).real > 0).sum(axis=1)


def _prove_stable(system: DelaySystem, delays: np.ndarray, factor: float) -> None:
    """Prove that the loop is stable for every factor of its delays from 0 to one."""
    late = np.unique(delays[delays > 0])
    loop = DelayedLoop(
        ball_matrix(system.exact["A"] + system.delayed(delays == 0)),
        tuple(ball_matrix(system.delayed(delays == d)) for d in late),
        Range(fmpq(0), _exact(factor)),
        tuple(Range(_exact(d), _exact(d)) for d in late),
    )
    try:
        with precision(), budget(WORK):
            if loop.roots_right():
                raise ComputationError("delay margin", "unstable without delay")
            loop.keeps_off()
    except (NotSettled, BudgetError) as error:
        raise ComputationError(
            "delay margin", f"stability up to the factor {factor:.9g} is not proved: {error}"
        ) from error


def _exact(value: float) -> fmpq:
    ratio = Fraction(value)
    return fmpq(ratio.numerator, ratio.denominator)

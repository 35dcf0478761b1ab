"""Local maxima of a function of time that is known at samples: which may matter, and where each lies between them."""

from collections.abc import Callable

import numpy as np
import scipy  # its packages are loaded when they are used


def resolution(length: float, end: float) -> float:
    """Return a length of time, s, or as small a part of a run that is shorter than a second."""
    return length * min(1.0, end)


def summits(values: np.ndarray, near: np.ndarray) -> list[int]:
    """Return the numbers of all samples that are local maxima, ends included, and near enough to matter; no plateau."""
    padded = np.concatenate([[-np.inf], values, [-np.inf]])
    before, behind = padded[:-2], padded[2:]
    local = (values >= before) & (values >= behind) & ((values > before) | (values > behind))
    return [int(k) for k in np.flatnonzero(local & near)]


def may_pass(values: np.ndarray, level: float) -> np.ndarray:
    """Say of each sample whether a peak beside it may reach a level: it rises by less than the values fall there."""
    drops = np.abs(np.diff(values))
    return values + np.maximum(np.append(0.0, drops), np.append(drops, 0.0)) >= level


def polished(function: Callable[[float], float], times: np.ndarray, sample: int, within: float) -> tuple[float, float]:
    """Return time and value of the maximum between the neighbours of a sample, by Brent's method.

    Parameters
    ----------
    function : callable
        Value at a time.
    times : ndarray
        Of the samples, s.
    sample : int
    within : float
        Distance to which the time is found, s.
    """
    found = scipy.optimize.minimize_scalar(
        lambda t: -function(t),
        bounds=(float(times[max(sample - 1, 0)]), float(times[min(sample + 1, len(times) - 1)])),
        method="bounded",
        options={"xatol": within},
    )
    return float(found.x), -float(found.fun)

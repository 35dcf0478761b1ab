"""How often a signal is logged: as often as it moves."""

import numpy as np

#: samples of a stretch that is thinned alike, and the strides that are tried in it
_STRETCH, _STRIDES = 256, (64, 32, 16, 8, 4, 2)


def moving_samples(values: np.ndarray, *, share: float = 0.01, floor: float = 1e-9) -> np.ndarray:
    """Choose samples of signals so that straight lines between them follow all of them.

    The samples are split into stretches of 256; in each the widest even stride is taken at which no signal departs
    from the line between the samples that are kept by more than `share` of its own range there. Located extremes are
    logged exactly on their own and do not depend on this.

    Parameters
    ----------
    values : (N, k) ndarray
        Signals at N times one step apart.
    share : float
        Largest departure, as part of a signal's range within a stretch; 0.01 keeps some twenty samples of a period.
    floor : float
        Departures below this part of a signal's largest modulus never count: rounding has no shape.

    Returns
    -------
    (M,) ndarray of int
        Rows to keep, ascending, the first and the last among them.

    Examples
    --------
    >>> import numpy as np
    >>> line = np.linspace(0.0, 1.0, 513)[:, None]
    >>> moving_samples(line).tolist()
    [0, 64, 128, 192, 256, 320, 384, 448, 512]
    """
    values = np.asarray(values, dtype=float)
    last = len(values) - 1
    kept = [np.array([0, max(last, 0)])]
    least = floor * np.abs(values).max(axis=0, initial=0.0)
    for start in range(0, last, _STRETCH):
        part = values[start : min(start + _STRETCH, last) + 1]
        allowed = np.maximum(share * np.ptp(part, axis=0), least)
        stride = next((s for s in _STRIDES if s < len(part) and (_departure(part, s) <= allowed).all()), 1)
        kept.append(start + np.arange(0, len(part), stride))
    return np.unique(np.concatenate(kept))


def _departure(part: np.ndarray, stride: int) -> np.ndarray:
    """Largest distance of each signal from the lines between every `stride`-th sample and the last one."""
    row = np.arange(len(part))
    low = row // stride * stride
    high = np.minimum(low + stride, len(part) - 1)
    weight = ((row - low) / np.maximum(high - low, 1))[:, None]
    return np.abs(part - (1.0 - weight) * part[low] - weight * part[high]).max(axis=0)

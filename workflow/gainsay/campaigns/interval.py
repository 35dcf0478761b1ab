"""The exact binomial interval of a share, its ends proved on the safe side."""

from fractions import Fraction

from flint import arb

from gainsay.errors import InputError
from gainsay.exact.ball import precision
from gainsay.exact.rational import to_fmpq

_BITS = 256
# relative step by which an end moves outwards until it is proved
_STEP = 1e-13


def clopper_pearson(count: int, draws: int, unresolved: int = 0, level: float = 0.95) -> tuple[float, float]:
    """Interval that covers a probability with at least the level, whatever the probability is.

    Draws that could not be resolved widen it: the lower end counts none of them, the upper end all.

    Parameters
    ----------
    count, draws, unresolved : int
        Draws that are counted, all draws, and those in which it could not be told.
    level : float
        Confidence level as the decimal it is written as, the rest being shared by the two sides.

    Returns
    -------
    (lower, upper) : tuple of float
        Ends at which the tail is proved to be at most (1 - level) / 2, within 1e-12 of the exact ends.

    Raises
    ------
    InputError
        If the counts do not fit each other or the level is not between 0 and 1.

    References
    ----------
    C. J. Clopper, E. S. Pearson, "The use of confidence or fiducial limits illustrated in the case of the binomial",
    Biometrika 26 (1934) 404-413.

    Examples
    --------
    >>> low, high = clopper_pearson(0, 10)
    >>> low, round(high, 6)
    (0.0, 0.308498)
    """
    if not (0 <= count and 0 <= unresolved and count + unresolved <= draws and draws > 0):
        raise InputError("counts", value=(count, draws, unresolved), expected="count + unresolved of 1 or more draws")
    if not 0 < level < 1:
        raise InputError("level", value=level, expected="between 0 and 1")
    return _lower(count, draws, level), 1 - _lower_complement(draws - count - unresolved, draws, level)


def _lower(count: int, draws: int, level: float) -> float:
    from scipy.stats import beta

    if count == 0:
        return 0.0
    end = float(beta.ppf((1 - level) / 2, count, draws - count + 1))
    while not _tail_is_small(count, draws, end, level):
        end *= 1 - _STEP
    return end


def _lower_complement(missed: int, draws: int, level: float) -> float:
    """Lower end of the complement, one unit in the last place of 1 further out than the rounding of 1 - end needs."""
    end = _lower(missed, draws, level)
    return max(end - 2.3e-16, 0.0)


def _tail_is_small(count: int, draws: int, probability: float, level: float) -> bool:
    """Prove that at least so many of the draws have probability of at most half of what the level leaves."""
    with precision(_BITS):
        tail = arb(probability).beta_lower(count, draws - count + 1, regularized=True)
        return bool(tail <= arb(to_fmpq((1 - Fraction(repr(level))) / 2)))

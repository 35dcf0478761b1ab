"""Doubles from outside: what holds anything but real numbers is refused, not converted."""

from math import isfinite
from numbers import Real
from typing import Any

import numpy as np

from gainsay.errors import InputError

__all__ = ["real_array", "real_number", "real_row"]


def real_array(value: Any, field: str, *, finite: bool = True) -> np.ndarray:
    """Array of doubles from numbers, fractions or nested lists of them.

    Parameters
    ----------
    value : array_like
    field : str
        Its name in messages.
    finite : bool, optional
        Whether nan and infinite entries are refused too.

    Raises
    ------
    InputError
        If an entry is no real number (numpy would drop imaginary parts and read texts), or rows differ in length.
    """
    try:
        raw = np.asarray(value)
        if raw.dtype.kind not in "biufO" or (raw.dtype == object and any(_is_none(x) for x in raw.flat)):
            raise TypeError(raw.dtype)
        array = raw.astype(float)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError("", field=field, value=type(value).__name__, expected="an array of real numbers") from error
    if finite and not np.isfinite(array).all():
        raise InputError("", field=field, value=array.tolist(), expected="finite entries")
    return array


def _is_none(value: Any) -> bool:
    return value is None or isinstance(value, str | bytes)


def real_row(value: Any, count: int, field: str) -> np.ndarray:
    """So many doubles, nan and infinite ones too; refused as `real_array` does, and in no time where it is one already.

    For right-hand sides, which are asked many thousand times, and whose trial steps may have left every range.
    """
    if type(value) is np.ndarray and value.dtype == float and value.shape == (count,):
        return value
    array = real_array(value, field, finite=False)
    if array.shape != (count,):
        raise InputError("", field=field, value=array.shape, expected=f"{count} numbers")
    return array


def real_number(value: Any, field: str) -> float:
    """A finite double from a real number; anything else raises InputError."""
    # a double first: asking an abstract class takes longer than a step of many an integrator
    if not isinstance(value, (float, Real)) or not isfinite(value):
        raise InputError("", field=field, value=value, expected="a finite number")
    return float(value)

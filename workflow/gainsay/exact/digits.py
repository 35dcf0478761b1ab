"""Numbers exactly as a paper prints them, with the interval that their digits stand for."""

import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from gainsay.errors import InputError

# ASCII digits only (\d alone takes those of other scripts); the exponent stays within what a double can hold
_DECIMAL = re.compile(r"[+-]?(?P<whole>\d+)(?:\.(?P<decimals>\d+))?(?:[eE](?P<exponent>[+-]?\d{1,2}))?", re.ASCII)
_LONGEST = 250  # a hundred digits and zeros of an exponent; thousands are an attack on whoever converts them
EXPECTED = "a decimal number such as -8.8129e-4"


@dataclass(frozen=True)
class PrintedNumber:
    """A decimal number with its printed digits.

    Parameters
    ----------
    text : str
        Digits with an optional sign, decimals and exponent (``-8.8129e-4``); nothing else.

    Raises
    ------
    InputError
        If the text is anything but such a number, or longer than 250 characters.
    """

    text: str

    def __post_init__(self) -> None:
        if len(self.text) > _LONGEST or _DECIMAL.fullmatch(self.text) is None:
            raise InputError("printed number", value=self.text, expected=EXPECTED)

    @cached_property
    def value(self) -> Fraction:
        """The digits as an exact rational."""
        return Fraction(self.text)

    @cached_property
    def half_unit(self) -> Fraction:
        """Half a unit of the last printed digit: the largest rounding error of a correct print."""
        match = _DECIMAL.fullmatch(self.text)
        assert match, "checked when made"
        decimals = len(match["decimals"] or "")
        return Fraction(10) ** (int(match["exponent"] or 0) - decimals) / 2

    @property
    def low(self) -> Fraction:
        """Smallest number that rounds to these digits."""
        return self.value - self.half_unit

    @property
    def high(self) -> Fraction:
        """Largest number that rounds to these digits."""
        return self.value + self.half_unit

    def __float__(self) -> float:
        return float(self.value)


_DOUBLE = re.compile(r"-?(\d{1,25}(\.\d{1,25})?(e[+-]\d{2,3})?|inf)|nan", re.ASCII)


def double(text: str) -> float:
    """Return the double that a text stands for as `repr` writes one; also ``nan``, ``inf`` and ``-inf``.

    Raises
    ------
    InputError
        If it is anything else, such as `1_5` or digits of another script, which `float` would read.

    Examples
    --------
    >>> double("-8.8129e-04")
    -0.00088129
    """
    if _DOUBLE.fullmatch(text) is None:
        raise InputError("number", value=text, expected="a number as `repr` writes it")
    return float(text)

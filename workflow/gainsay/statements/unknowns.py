"""Unknowns of a statement: what shape and structure they have, for the solver and for the checker alike."""

from dataclasses import dataclass
from typing import Any

from gainsay import lmi
from gainsay.lmi import Variable

__all__ = ["Unknown", "diagonal", "matrix", "positive", "scalar", "symmetric"]


@dataclass(frozen=True)
class Unknown:
    """Shape and structure of an unknown.

    Parameters
    ----------
    rows, columns : int
    structure : {"full", "symmetric", "diagonal"}
    positive : bool
        Whether a number is kept above zero: a program states this as a constraint of its own.
    """

    rows: int
    columns: int
    structure: str = "full"
    positive: bool = False

    def variable(self, name: str) -> Variable:
        """Return the unknown of the solver's program."""
        if self.structure == "symmetric":
            return lmi.symmetric(name, self.rows)
        if self.structure == "diagonal":
            return lmi.diagonal(name, self.rows)
        if (self.rows, self.columns) == (1, 1):
            return lmi.scalar(name)
        return lmi.matrix(name, self.rows, self.columns)

    def entry(self) -> dict[str, Any]:
        """Return the entry of a certificate's unknowns."""
        return {"shape": [self.rows, self.columns], "structure": self.structure}


def symmetric(size: int) -> Unknown:
    """Return a symmetric matrix of `size` rows."""
    return Unknown(size, size, "symmetric")


def matrix(rows: int, columns: int) -> Unknown:
    """Return a matrix without structure."""
    return Unknown(rows, columns)


def diagonal(size: int) -> Unknown:
    """Return a diagonal matrix of `size` rows."""
    return Unknown(size, size, "diagonal")


def positive() -> Unknown:
    """Return a positive number."""
    return Unknown(1, 1, positive=True)


def scalar() -> Unknown:
    """Return a number of either sign."""
    return Unknown(1, 1)

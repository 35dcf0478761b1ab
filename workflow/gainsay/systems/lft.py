"""Linear fractional transformations: a matrix closed by another one above or below, and the star product of two.

References
----------
K. Zhou, J. C. Doyle, K. Glover, Robust and Optimal Control, Prentice Hall, 1996, chapter 10.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from gainsay.errors import ComputationError, InputError


@dataclass(frozen=True, eq=False)
class Lft:
    """A partitioned matrix [[M11, M12], [M21, M22]] whose first block row and column face an uncertainty.

    Attributes
    ----------
    M11 : ndarray, shape (q, r)
        From the uncertainty's output to its input.
    M12 : ndarray, shape (q, m)
        From the outer input to the uncertainty's input.
    M21 : ndarray, shape (p, r)
        From the uncertainty's output to the outer output.
    M22 : ndarray, shape (p, m)
        From the outer input to the outer output, without uncertainty.

    Raises
    ------
    InputError
        If the blocks do not fit together.
    """

    M11: np.ndarray
    M12: np.ndarray
    M21: np.ndarray
    M22: np.ndarray

    def __post_init__(self) -> None:
        for name in ("M11", "M12", "M21", "M22"):
            object.__setattr__(self, name, np.atleast_2d(np.asarray(getattr(self, name), dtype=float)))
        (q, r), (p, m) = self.M11.shape, self.M22.shape
        for name, shape in (("M12", (q, m)), ("M21", (p, r))):
            if getattr(self, name).shape != shape:
                raise InputError(
                    "block of the wrong shape", field=name, value=getattr(self, name).shape, expected=str(shape)
                )

    @classmethod
    def split(cls, M: ArrayLike, rows: int, columns: int) -> "Lft":
        """Partition a matrix after its first rows and columns."""
        M = np.asarray(M, dtype=float)
        return cls(M[:rows, :columns], M[:rows, columns:], M[rows:, :columns], M[rows:, columns:])

    @property
    def matrix(self) -> np.ndarray:
        """The whole matrix."""
        return np.block([[self.M11, self.M12], [self.M21, self.M22]])

    def close(self, delta: ArrayLike) -> np.ndarray:
        """Close the upper loop: M22 + M21 Delta (I - M11 Delta)^-1 M12.

        Parameters
        ----------
        delta : array_like, shape (r, q)
            The uncertainty.

        Returns
        -------
        ndarray, shape (p, m)

        Raises
        ------
        InputError
            If the uncertainty has another shape.
        ComputationError
            If the loop is not well posed, I - M11 Delta being singular.
        """
        return self.M22 + self.M21 @ _loop(np.asarray(delta, dtype=float), self.M11, self.M12)

    def star(self, other: "Lft") -> "Lft":
        """Redheffer star product: the lower loop of this one closed by the upper loop of the other.

        Parameters
        ----------
        other : Lft
            Its M11 has the shape (m, p) where M22 of this one has (p, m).

        Returns
        -------
        Lft
            Closing it above equals closing this one above and the other one by the result.
        """
        inner = _loop(other.M11, self.M22, self.M21)
        through = _solve(np.eye(self.M22.shape[0]) - self.M22 @ other.M11, self.M22 @ other.M12)
        return Lft(
            self.M11 + self.M12 @ inner,
            self.M12 @ _solve(np.eye(other.M11.shape[0]) - other.M11 @ self.M22, other.M12),
            other.M21 @ _solve(np.eye(self.M22.shape[0]) - self.M22 @ other.M11, self.M21),
            other.M22 + other.M21 @ through,
        )


def _loop(K: np.ndarray, inner: np.ndarray, entry: np.ndarray) -> np.ndarray:
    """K (I - inner K)^-1 entry."""
    if K.shape != inner.shape[::-1]:
        raise InputError("loop of the wrong shape", value=K.shape, expected=str(inner.shape[::-1]))
    return K @ _solve(np.eye(inner.shape[0]) - inner @ K, entry)


def _solve(M: np.ndarray, right: np.ndarray) -> np.ndarray:
    if M.size and 1 / np.linalg.cond(M) < 1e-14:
        raise ComputationError(
            "linear fractional transformation", "the loop is not well posed: I - M Delta is singular"
        )
    return np.linalg.solve(M, right)

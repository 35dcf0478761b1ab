"""Linear time-invariant systems in state-space form: dx/dt = A x + B w, z = C x + D w."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from gainsay.errors import InputError
from gainsay.exact.floats import real_array


def square(A: ArrayLike, name: str = "A") -> np.ndarray:
    """Return the matrix as a finite square float array, or raise InputError naming it."""
    array = finite(A, name)
    if array.shape[0] != array.shape[1] or array.shape[0] == 0:
        raise InputError("state matrix of the wrong shape", field=name, value=array.shape, expected="(n, n), n >= 1")
    return array


def finite(M: ArrayLike, name: str) -> np.ndarray:
    """Return the matrix as a finite two-dimensional float array, or raise InputError naming it."""
    array = real_array(M, name)
    if array.ndim != 2:
        raise InputError("not a matrix", field=name, value=array.shape, expected="two dimensions")
    return array


@dataclass(frozen=True, eq=False, init=False)
class StateSpace:
    """A state-space system with checked shapes.

    Attributes
    ----------
    A : ndarray, shape (n, n)
        State matrix.
    B : ndarray, shape (n, m)
        Input matrix.
    C : ndarray, shape (p, n)
        Output matrix.
    D : ndarray, shape (p, m)
        Feedthrough matrix; zero where None is given.

    Raises
    ------
    InputError
        If shapes do not fit together or an entry is not finite.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray

    def __init__(self, A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike | None = None) -> None:
        A, B, C = square(A, "A"), finite(B, "B"), finite(C, "C")
        states, inputs, outputs = A.shape[0], B.shape[1], C.shape[0]
        D = np.zeros((outputs, inputs)) if D is None else finite(D, "D")
        for name, matrix, shape in (
            ("B", B, (states, inputs)),
            ("C", C, (outputs, states)),
            ("D", D, (outputs, inputs)),
        ):
            if matrix.shape != shape:
                raise InputError("matrix of the wrong shape", field=name, value=matrix.shape, expected=str(shape))
        for name, matrix in zip("ABCD", (A, B, C, D), strict=True):
            object.__setattr__(self, name, matrix)

    def response(self, frequency: float) -> np.ndarray:
        """Frequency response C (j w I - A)^-1 B + D.

        Parameters
        ----------
        frequency : float
            Angular frequency w in rad/s; infinity gives D.

        Returns
        -------
        ndarray of complex, shape (p, m)
        """
        if np.isinf(frequency):
            return self.D.astype(complex)
        shifted = 1j * frequency * np.eye(self.A.shape[0]) - self.A
        return self.C @ np.linalg.solve(shifted, self.B) + self.D

    def gain(self, frequency: float) -> float:
        """Largest singular value of the response at an angular frequency in rad/s."""
        return float(np.linalg.norm(self.response(frequency), 2))

    def balanced(self) -> "StateSpace":
        """Return the same system with states rescaled by powers of two so that rows and columns weigh alike."""
        A, B, C = self.A.copy(), self.B.copy(), self.C.copy()
        for _ in range(20):
            changed = False
            for i in range(A.shape[0]):
                column = np.sqrt(np.sum(A[:, i] ** 2) - A[i, i] ** 2 + np.sum(C[:, i] ** 2))
                row = np.sqrt(np.sum(A[i] ** 2) - A[i, i] ** 2 + np.sum(B[i] ** 2))
                if not (row > 0 and column > 0):
                    continue
                factor = 2.0 ** np.round(0.5 * np.log2(row / column))
                if factor != 1.0:
                    A[:, i] *= factor
                    C[:, i] *= factor
                    A[i] /= factor
                    B[i] /= factor
                    changed = True
            if not changed:
                break
        return StateSpace(A, B, C, self.D)

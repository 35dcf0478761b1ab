"""Regions of the complex plane for poles: disks and half planes."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import fmpq_mat
from numpy.typing import ArrayLike
from scipy.linalg import solve_continuous_lyapunov, solve_discrete_lyapunov

from gainsay.errors import InputError
from gainsay.exact.floats import real_array, real_number
from gainsay.systems.spectrum import is_hurwitz, is_schur, rational, rounded_eigenvalues, spectral_abscissa
from gainsay.systems.statespace import square

# squarings of a Cayley transform; the square of the norm of a power above which the small differences that a later one
# hangs on may be lost, and nothing is read from it; matrices taken at once
_SQUARINGS, _LARGEST_POWER, _BLOCK = 12, 1e8, 500


@dataclass(frozen=True)
class Disk:
    """Disk |s + centre| < radius, D(a, b) of the literature on pole placement.

    Parameters
    ----------
    centre : float
        a, 1/s: the disk is centred at -a on the real axis.
    radius : float
        b, 1/s.

    Raises
    ------
    InputError
        If the radius is not positive or a number is not finite.
    """

    centre: float
    radius: float

    def __post_init__(self) -> None:
        real_number(self.centre, "centre")
        if not real_number(self.radius, "radius") > 0:
            raise InputError("disk", field="radius", value=self.radius, expected="above 0")

    def reach(self, A: ArrayLike) -> Any:
        """Largest modulus of s + centre over the eigenvalues s of A, 1/s, rounded; stacks of matrices give an array.

        Parameters
        ----------
        A : array_like, shape (..., n, n)
        """
        return _largest(np.abs(np.linalg.eigvals(_stack(A)) + self.centre))

    def holds(self, A: ArrayLike) -> bool:
        """Whether every eigenvalue of A, or of each matrix of a stack, lies in the disk; doubles are taken exactly."""
        return all(self._holds(M) for M in _listed(A))

    def _holds(self, A: np.ndarray) -> bool:
        poles, off = rounded_eigenvalues(A)
        room = self.radius - float(np.abs(poles + self.centre).max())
        if abs(room) > off + 1e-14 * (self.radius + abs(self.centre)):
            return room > 0
        moved = rational(A) + _shift(self.centre, len(A))
        return is_schur(moved / rational([[self.radius]])[0, 0])

    def lyapunov_matrix(self, A: ArrayLike) -> np.ndarray:
        """P > 0 with (A + aI)' P (A + aI) - b^2 P = -b^2 I: it proves that A has its eigenvalues in the disk.

        Raises
        ------
        InputError
            If they are not.
        """
        A = square(A)
        if not self.holds(A):
            raise InputError(
                "eigenvalues outside the disk: reach", value=self.reach(A), expected=f"below {self.radius}"
            )
        moved = (A + self.centre * np.eye(len(A))) / self.radius
        P = solve_discrete_lyapunov(moved.T, np.eye(len(A)))
        return (P + P.T) / 2


@dataclass(frozen=True)
class HalfPlane:
    """Half plane Re s < abscissa, 1/s; raises InputError unless that is a finite number."""

    abscissa: float = 0.0

    def __post_init__(self) -> None:
        real_number(self.abscissa, "abscissa")

    def reach(self, A: ArrayLike) -> Any:
        """Largest real part over the eigenvalues of A, 1/s, rounded; stacks of matrices give an array."""
        return _largest(np.linalg.eigvals(_stack(A)).real)

    def holds(self, A: ArrayLike) -> bool:
        """Whether every eigenvalue of A, or of each matrix of a stack, lies there; the doubles are taken exactly."""
        return all(self._holds(M) for M in _listed(A))

    def each(self, A: ArrayLike) -> np.ndarray:
        """Whether every eigenvalue of each matrix of a stack lies there, as far as rounding lets one see.

        Parameters
        ----------
        A : array_like, shape (..., n, n)

        Returns
        -------
        ndarray of bool, shape (...)

        Notes
        -----
        By powers of the Cayley transform C of A, which cost a third of eigenvalues: with rho the spectral radius of C,
        rho^N is at most the norm of C^N, and n rho^N at least the modulus of its trace. The few matrices that
        neither decides are left to their eigenvalues.
        """
        A = _stack(A)
        listed = A.reshape(-1, *A.shape[-2:])
        blocks = [listed[k : k + _BLOCK] for k in range(0, len(listed), _BLOCK)]  # each fits into a processor's cache
        answers = [_left_of_axis(block - self.abscissa * np.eye(A.shape[-1])) for block in blocks]
        return np.concatenate([*answers, np.zeros(0, dtype=bool)]).reshape(A.shape[:-2])

    def _holds(self, A: np.ndarray) -> bool:
        poles, off = rounded_eigenvalues(A)
        room = self.abscissa - float(poles.real.max())
        if abs(room) > off + 1e-14 * abs(self.abscissa):
            return room > 0
        return is_hurwitz(rational(A) - _shift(self.abscissa, len(A)))

    def lyapunov_matrix(self, A: ArrayLike) -> np.ndarray:
        """P > 0 with (A - alpha I)' P + P (A - alpha I) = -I; raises InputError where there is none."""
        A = square(A)
        if not self.holds(A):
            raise InputError(
                "eigenvalues outside the half plane: abscissa",
                value=spectral_abscissa(A),
                expected=f"below {self.abscissa}",
            )
        P = solve_continuous_lyapunov((A - self.abscissa * np.eye(len(A))).T, -np.eye(len(A)))
        return (P + P.T) / 2


def _stack(A: ArrayLike) -> np.ndarray:
    A = real_array(A, "matrix")
    if A.ndim < 2 or A.shape[-1] != A.shape[-2] or A.shape[-1] == 0:
        raise InputError("matrix", value=A.shape, expected="square matrices")
    return A


def _listed(A: ArrayLike) -> np.ndarray:
    A = _stack(A)
    return A.reshape(-1, *A.shape[-2:])


def _shift(value: float, size: int) -> fmpq_mat:
    """A rational multiple of the unit matrix."""
    return rational(np.eye(size, dtype=int)) * rational([[value]])[0, 0]


def _left_of_axis(A: np.ndarray) -> np.ndarray:
    """Whether the eigenvalues of each of k matrices have negative real parts, see `HalfPlane.each`."""
    n = A.shape[-1]
    inside, left, powers = np.zeros(len(A), dtype=bool), np.arange(len(A)), _cayley(A)
    undecided = []
    for _ in range(_SQUARINGS):
        powers = powers @ powers
        size, trace = np.einsum("kij,kij->k", powers, powers), np.abs(np.einsum("kii->k", powers))
        small, sound = size < 0.25, size < _LARGEST_POWER
        inside[left[small]] = True
        undecided.append(left[~sound])
        going = sound & ~small & (trace < 2 * n)
        if not going.all():
            powers, left = powers[going], left[going]
    rest = np.concatenate([*undecided, left])
    inside[rest] = np.linalg.eigvals(A[rest]).real.max(axis=-1) < 0
    return inside


def _cayley(A: np.ndarray) -> np.ndarray:
    """(c I - A)^-1 (c I + A) of each of k matrices, c of its size; no numbers where one has no such inverse."""
    n = A.shape[-1]
    size = np.linalg.norm(A, axis=(-2, -1)) / np.sqrt(n)
    units = np.where(size > 0, size, 1.0)[:, None, None] * np.eye(n)
    try:
        return np.linalg.solve(units - A, units + A)
    except np.linalg.LinAlgError:
        return np.full_like(A, np.nan)


def _largest(values: np.ndarray) -> Any:
    largest = values.max(axis=-1)
    return float(largest) if largest.ndim == 0 else largest

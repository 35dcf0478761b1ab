"""Regions of the complex plane for poles: disks and half planes."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from flint import fmpq_mat
from numpy.typing import ArrayLike
from scipy.linalg import solve_continuous_lyapunov, solve_discrete_lyapunov

from gainsay.errors import InputError
from gainsay.exact.floats import real_array, real_number
from gainsay.systems.spectrum import is_hurwitz, is_schur, rational, rounded_eigenvalues, spectral_abscissa
from gainsay.systems.statespace import square

# squarings of a matrix, and those after which its inverse is worth its time; the square of the norm of a power above
# which the small differences that a later one hangs on may be lost, and nothing is read from it; matrices taken at once
_SQUARINGS, _FIRST_SQUARINGS, _LARGEST_POWER, _BLOCK = 12, 8, 1e8, 500
# the share of a stack whose reach is looked at before the rest is held against it: one in so many
_LOOKED_AT = 61
# radius of a disk that stands for its centre alone
_TINY = 1e-300


class Region(ABC):
    """A region of the plane: what is asked of one matrix, or of each of a stack."""

    @property
    @abstractmethod
    def edge(self) -> float:
        """What the reach of a matrix stays below if its eigenvalues lie in the region, 1/s."""

    @abstractmethod
    def with_edge(self, edge: float) -> Self:
        """The region of the same kind and place with another edge."""

    @abstractmethod
    def reach(self, A: ArrayLike) -> Any:
        """How far the eigenvalues of A reach, rounded; stacks of matrices give an array."""

    def holds(self, A: ArrayLike) -> bool:
        """Whether every eigenvalue of A, or of each matrix of a stack, lies there; the doubles are taken exactly."""
        return all(self._holds(M) for M in _listed(A))

    def each(self, A: ArrayLike) -> np.ndarray:
        """Whether every eigenvalue of each matrix of a stack lies in the region, as far as rounding lets one see.

        Parameters
        ----------
        A : array_like, shape (..., n, n)

        Returns
        -------
        ndarray of bool, shape (...)

        Notes
        -----
        By powers of a matrix C whose eigenvalues lie in the unit disk if those of A lie in the region, which cost a
        tenth of eigenvalues: with rho the spectral radius of C, rho^N is at most the norm of C^N, and n rho^N at least
        the modulus of its trace. The few matrices that neither decides are left to their eigenvalues.
        """
        A = _stack(A)
        answers = [np.zeros(0, dtype=bool)]
        for block in _blocks(A.reshape(-1, *A.shape[-2:])):
            inside, unknown = self._by_powers(block)
            inside[unknown] = self.reach(block[unknown]) < self.edge
            answers.append(inside)
        return np.concatenate(answers).reshape(A.shape[:-2])

    def farthest(self, A: ArrayLike) -> tuple[float, int]:
        """Largest reach over a stack of matrices, and the index of the one that has it.

        Eigenvalues are taken of some, and then of those that powers do not show within what these reach; see `each`.

        Parameters
        ----------
        A : array_like, shape (k, n, n), k >= 1

        Returns
        -------
        (reach, index) : tuple of float and int
        """
        A = _stack(A)
        some = np.arange(0, len(A), _LOOKED_AT)
        reaches = self.reach(A[some])
        within = self.with_edge(float(reaches.max()))
        outside = np.concatenate([~within._by_powers(block)[0] for block in _blocks(A)])
        looked_at = np.union1d(some[reaches.argmax()], np.flatnonzero(outside))
        reaches = self.reach(A[looked_at])
        best = int(reaches.argmax())
        return float(reaches[best]), int(looked_at[best])

    @abstractmethod
    def _by_powers(self, A: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Whether the eigenvalues of each of k matrices lie in the region, and whether powers leave that open."""

    @abstractmethod
    def _holds(self, A: np.ndarray) -> bool:
        """Whether every eigenvalue of A lies in the region."""


@dataclass(frozen=True)
class Disk(Region):
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

    @property
    def edge(self) -> float:
        """The radius, 1/s."""
        return self.radius

    def with_edge(self, edge: float) -> "Disk":
        """The disk of the same centre with another radius, a tiny one in place of none."""
        return Disk(self.centre, max(edge, _TINY))

    def reach(self, A: ArrayLike) -> Any:
        """Largest modulus of s + centre over the eigenvalues s of A, 1/s, rounded; stacks of matrices give an array.

        Parameters
        ----------
        A : array_like, shape (..., n, n)
        """
        return _largest(np.abs(np.linalg.eigvals(_stack(A)) + self.centre))

    def _by_powers(self, A: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return _in_unit_disk((A + self.centre * np.eye(A.shape[-1])) / self.radius)

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
class HalfPlane(Region):
    """Half plane Re s < abscissa, 1/s; raises InputError unless that is a finite number."""

    abscissa: float = 0.0

    def __post_init__(self) -> None:
        real_number(self.abscissa, "abscissa")

    @property
    def edge(self) -> float:
        """The abscissa, 1/s."""
        return self.abscissa

    def with_edge(self, edge: float) -> "HalfPlane":
        """The half plane to the left of another abscissa."""
        return HalfPlane(edge)

    def reach(self, A: ArrayLike) -> Any:
        """Largest real part over the eigenvalues of A, 1/s, rounded; stacks of matrices give an array."""
        return _largest(np.linalg.eigvals(_stack(A)).real)

    def _by_powers(self, A: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        # First in a disk that touches the edge of the half plane from inside, since that takes no inverse; where this
        # does not tell, by the Cayley transform, which maps the half plane onto the unit disk.
        moved = A - self.abscissa * np.eye(A.shape[-1])
        sizes = _sizes(moved)
        inside, unknown = _in_unit_disk(moved / sizes + np.eye(A.shape[-1]), _FIRST_SQUARINGS)
        rest = np.flatnonzero(~inside)
        inside[rest], unknown[rest] = _in_unit_disk(_cayley(moved[rest], sizes[rest]))
        return inside, unknown

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


def _blocks(A: np.ndarray) -> list[np.ndarray]:
    """A stack in parts that fit into a processor's cache."""
    return [A[k : k + _BLOCK] for k in range(0, len(A), _BLOCK)]


def _in_unit_disk(powers: np.ndarray, squarings: int = _SQUARINGS) -> tuple[np.ndarray, np.ndarray]:
    """Whether the eigenvalues of each of k matrices have moduli below one, and whether that stays open."""
    n = powers.shape[-1]
    inside, unknown, left = np.zeros(len(powers), dtype=bool), np.zeros(len(powers), dtype=bool), np.arange(len(powers))
    for _ in range(squarings):
        powers = powers @ powers
        size, trace = np.einsum("kij,kij->k", powers, powers), np.abs(np.einsum("kii->k", powers))
        small, sound = size < 0.25, size < _LARGEST_POWER
        inside[left[small]] = True
        unknown[left[~sound]] = True
        going = sound & ~small & (trace < 2 * n)
        if not going.all():
            powers, left = powers[going], left[going]
    unknown[left] = True
    return inside, unknown


def _sizes(A: np.ndarray) -> np.ndarray:
    """About the largest modulus of eigenvalues of each of k matrices, by its eighth power; above zero, (k, 1, 1)."""
    norm = np.linalg.norm(A, axis=(-2, -1), keepdims=True)
    norm = np.where(norm > 0, norm, 1.0)
    power = A / norm
    for _ in range(3):
        power = power @ power
    size = norm * np.linalg.norm(power, axis=(-2, -1), keepdims=True) ** (1 / 8)
    return np.where(size > 0, size, norm)


def _cayley(A: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """(c I - A)^-1 (c I + A) of each of k matrices, c its size; no numbers where one has no such inverse."""
    units = sizes * np.eye(A.shape[-1])
    try:
        return np.linalg.solve(units - A, units + A)
    except np.linalg.LinAlgError:
        return np.full_like(A, np.nan)


def _largest(values: np.ndarray) -> Any:
    largest = values.max(axis=-1)
    return float(largest) if largest.ndim == 0 else largest

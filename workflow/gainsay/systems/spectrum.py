"""Eigenvalues of a real matrix enclosed in balls, whatever its scaling: roots of the exact characteristic polynomial.

The entries are taken as the rational numbers that the doubles are. Multiple eigenvalues come out as such, since the
polynomial is made squarefree exactly; a mode at 1e-8 rad/s beside one at 1e8 costs nothing.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import acb, ctx, fmpq, fmpq_mat, fmpq_poly
from numpy.typing import ArrayLike

from gainsay.errors import ComputationError, InputError
from gainsay.systems.statespace import square

#: bits to which roots are isolated: those of light modes lie close together relative to their size
ROOT_BITS = 160


def rational(matrix: ArrayLike) -> fmpq_mat:
    """The matrix of doubles (or fractions) as exact rational numbers."""
    rows = np.asarray(matrix, dtype=object)
    exact = [[Fraction(x) for x in row] for row in rows.tolist()]
    if not exact or not exact[0]:
        return fmpq_mat(*rows.shape)
    return fmpq_mat([[fmpq(x.numerator, x.denominator) for x in row] for row in exact])


def isolated_roots(polynomial: fmpq_poly) -> list[tuple[acb, int]]:
    """Return the roots of a rational polynomial as `roots` does, at the precision in force."""
    found: Any = polynomial.numer().complex_roots()  # pairs, whatever the stubs of the library say
    return [(acb(root), int(count)) for root, count in found]


def roots(polynomial: fmpq_poly) -> list[tuple[acb, int]]:
    """Return the roots of a rational polynomial in disjoint balls, each with its multiplicity.

    A real root has an imaginary part of exactly zero.
    """
    with ctx.workprec(ROOT_BITS):
        return isolated_roots(polynomial)


@dataclass(frozen=True)
class Eigenvalue:
    """An eigenvalue in a ball of its own.

    Attributes
    ----------
    ball : acb
        Encloses it, 1/s.
    count : int
        Its multiplicity.
    """

    ball: acb
    count: int

    @property
    def value(self) -> complex:
        """The middle of the ball."""
        return complex(float(self.ball.real.mid()), float(self.ball.imag.mid()))


def eigenvalues(A: ArrayLike) -> list[Eigenvalue]:
    """Return every distinct eigenvalue of a real square matrix, enclosed, by decreasing real part.

    Parameters
    ----------
    A : array_like, shape (n, n)

    Raises
    ------
    InputError
        If the matrix is empty, not square or not finite.

    Examples
    --------
    >>> [(e.value, e.count) for e in eigenvalues([[-1.0, 1.0], [0.0, -1.0]])]
    [((-1+0j), 2)]
    """
    found = [Eigenvalue(root, count) for root, count in roots(rational(square(A)).charpoly())]
    return sorted(found, key=lambda e: (-e.value.real, -e.value.imag))


def require_hurwitz(A: ArrayLike, what: str) -> None:
    """Refuse a matrix unless every eigenvalue provably has a negative real part.

    Raises
    ------
    InputError
        If one provably has not.
    ComputationError
        If one cannot be told from the imaginary axis.
    """
    for eigenvalue in eigenvalues(A):
        if eigenvalue.ball.real >= 0:
            value = eigenvalue.value.real
            raise InputError(f"{what} of an unstable system: spectral abscissa", value=value, expected="below 0")
        if not eigenvalue.ball.real < 0:
            _undecided(what, "the imaginary axis", eigenvalue)


def require_schur(A: ArrayLike, what: str) -> None:
    """Refuse a matrix unless every eigenvalue provably has a modulus below one; raises as `require_hurwitz`."""
    for eigenvalue in eigenvalues(A):
        with ctx.workprec(ROOT_BITS):
            size = abs(eigenvalue.ball)
        if size >= 1:
            value = abs(eigenvalue.value)
            raise InputError(f"{what} of an unstable system: spectral radius", value=value, expected="below 1")
        if not size < 1:
            _undecided(what, "the unit circle", eigenvalue)


def _undecided(what: str, boundary: str, eigenvalue: Eigenvalue) -> None:
    raise ComputationError(what, f"an eigenvalue near {eigenvalue.value:.9g} cannot be told from {boundary}")

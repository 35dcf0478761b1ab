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
    isolated: Any = polynomial.numer().complex_roots()  # pairs, whatever the stubs of the library say
    return [(acb(root), int(count)) for root, count in isolated]


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
    values = [Eigenvalue(root, count) for root, count in roots(rational(square(A)).charpoly())]
    return sorted(values, key=lambda e: (-e.value.real, -e.value.imag))


def rounded_eigenvalues(A: np.ndarray) -> tuple[np.ndarray, float]:
    """Eigenvalues by LAPACK, and how far off they may be (Bauer, Fike; infinite for a matrix that is defective)."""
    poles, T = np.linalg.eig(A)
    with np.errstate(over="ignore", invalid="ignore"):
        condition = np.linalg.cond(T)
    off = 10 * len(A) * np.finfo(float).eps * np.linalg.norm(A) * condition
    return poles, float(off) if np.isfinite(off) else np.inf


def spectral_abscissa(A: ArrayLike) -> float:
    """Largest real part among the eigenvalues of a square matrix.

    Parameters
    ----------
    A : array_like, shape (n, n)
        State matrix, 1/s.

    Returns
    -------
    float
        The spectral abscissa, 1/s; negative for an asymptotically stable system. Right to 1e-9 relative: where rounding
        could have done more, the eigenvalues are isolated exactly.

    Raises
    ------
    InputError
        If the matrix is empty, not square or not finite.
    """
    A = square(A)
    poles, off = rounded_eigenvalues(A)
    abscissa = float(poles.real.max())
    return abscissa if off <= 1e-9 * abs(abscissa) else max(e.value.real for e in eigenvalues(A))


def is_hurwitz(exact: fmpq_mat) -> bool:
    """Whether every eigenvalue of a rational matrix has a negative real part: Routh's table, exactly.

    Reference: F. R. Gantmacher, The Theory of Matrices, vol. 2, Chelsea 1959, chapter XV.
    """
    coefficients = list(reversed(exact.charpoly().coeffs()))
    upper, lower = coefficients[::2], coefficients[1::2]
    while lower:
        if not lower[0] > 0:
            return False
        factor = upper[0] / lower[0]
        padded = [*lower, *[fmpq(0)] * (len(upper) - len(lower))]
        upper, lower = lower, [u - factor * v for u, v in zip(upper[1:], padded[1:], strict=True)]
    return True


def is_schur(exact: fmpq_mat) -> bool:
    """Whether every eigenvalue of a rational matrix lies inside the unit circle: (A - I)(A + I)^-1 is Hurwitz."""
    unit = rational(np.eye(exact.nrows(), dtype=int))
    try:
        return is_hurwitz((exact - unit) * (exact + unit).inv())
    except ZeroDivisionError:  # an eigenvalue of -1
        return False


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

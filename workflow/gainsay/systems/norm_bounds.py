"""H-infinity and H2 norms enclosed: both ends proved from the matrices as exact numbers, whatever their scaling.

The lower end of the H-infinity norm is the gain at one frequency, in balls. The upper end is a level at which the
Hamiltonian matrix, formed in rational numbers, has no eigenvalue on the imaginary axis: the squares of its eigenvalues
are the roots of a rational polynomial, and its real roots are isolated. The H2 norm comes from an exact Gramian.

References
----------
Boyd, Balakrishnan, Kabamba, Mathematics of Control, Signals and Systems 2 (1989) 207-219: the Hamiltonian test.
Bruinsma, Steinbuch, Systems & Control Letters 14 (1990) 287-293: the two-step iteration.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np
from flint import acb, acb_mat, arb, ctx, fmpq, fmpq_mat, fmpq_poly

from gainsay.errors import ComputationError
from gainsay.systems.spectrum import ROOT_BITS, roots

_BITS = 256
_ROUNDS = 60


@dataclass(frozen=True)
class NormBounds:
    """A norm between two proved ends.

    Attributes
    ----------
    lower, upper : float
        The norm lies between them.
    frequency : float
        Where the gain is `lower`, rad/s (or rad a sample); infinity where it is that of D, nan for an H2 norm.
    """

    lower: float
    upper: float
    frequency: float


def ball_matrix(exact: np.ndarray | fmpq_mat) -> acb_mat:
    """A matrix of exact numbers in balls of the working precision."""
    if isinstance(exact, fmpq_mat):
        return acb_mat(exact)
    return acb_mat([[acb(arb(fmpq(v.numerator, v.denominator))) for v in row] for row in exact])


def below(value: arb) -> float:
    """The largest convenient float not above a ball; the number itself where the ball is one."""
    end = float(value.mid())
    while not arb(end) <= value:
        end = float(np.nextafter(min(end, float(value.lower())), -np.inf))
    return end


def above(value: arb) -> float:
    """The least convenient float not below a ball."""
    return -below(-value)


def gain_below(A: fmpq_mat, B: fmpq_mat, C: fmpq_mat, D: fmpq_mat, frequency: arb) -> float:
    """A float not above the largest singular value of C (jw - A)^-1 B + D at a frequency in rad/s, and near to it.

    Raises
    ------
    ComputationError
        If j w cannot be told from an eigenvalue of A.
    """
    with ctx.workprec(_BITS):
        if not frequency.is_finite():
            response = acb_mat(D)
        else:
            shifted = acb_mat(A) * acb(-1)
            for i in range(A.nrows()):
                shifted[i, i] = shifted[i, i] + acb(0, frequency)
            try:
                response = acb_mat(C) * shifted.solve(acb_mat(B)) + acb_mat(D)
            except ZeroDivisionError:
                raise ComputationError("gain", f"a pole near {float(frequency):.9g} rad/s") from None
        values = np.array([[complex(x) for x in row] for row in response.tolist()])
        largest = np.abs(values).max()
        if not np.isfinite(largest):
            raise ComputationError("gain", f"the response at {float(frequency):.9g} rad/s leaves double precision")
        if largest == 0:
            return 0.0
        left, _, right = np.linalg.svd(values / largest)
        # |u* G v| / (|u| |v|) is below the norm for any u and v, here those of the rounded response
        u = acb_mat([[acb(*map(float, (x.real, -x.imag))) for x in left[:, 0]]])
        v = acb_mat([[acb(*map(float, (x.real, -x.imag)))] for x in right[0]])
        size = _length(u.tolist()[0]) * _length([row[0] for row in v.tolist()])
        return max(below(abs((u * response * v)[0, 0]) / size), 0.0)


def _length(vector: list[acb]) -> arb:
    return sum((x.real**2 + x.imag**2 for x in vector), arb(0)).sqrt()


def level_frequencies(A: fmpq_mat, B: fmpq_mat, C: fmpq_mat, D: fmpq_mat, level: fmpq) -> list[arb] | None:
    """Frequencies w >= 0, ascending, at which some singular value of the response is `level`: all of them.

    Returns
    -------
    list of arb, or None
        In rad/s, the middles of their balls; empty proves that no frequency has it. None where `level` is a singular
        value of D itself: the test says nothing there.
    """
    m, p = B.ncols(), C.nrows()
    Dt, Bt, Ct = D.transpose(), B.transpose(), C.transpose()
    R = identity(m) * level**2 - Dt * D
    try:
        inverse = R.inv()
    except ZeroDivisionError:
        return None
    top = A + B * inverse * Dt * C
    corner = B * inverse * Bt
    S = Ct * (identity(p) + D * inverse * Dt) * C
    rows = [list(a) + list(b) for a, b in zip(top.tolist(), corner.tolist(), strict=True)]
    rows += [[-x for x in a] + [-x for x in b] for a, b in zip(S.tolist(), top.transpose().tolist(), strict=True)]
    coefficients = fmpq_mat(rows).charpoly().coeffs()
    squares = fmpq_poly(coefficients[::2])  # the eigenvalues come in pairs s, -s; here s^2
    with ctx.workprec(ROOT_BITS):
        frequencies = []
        for root, _ in roots(squares):
            if root.imag.is_zero() and not root.real > 0:
                frequencies.append((-root.real).max(arb(0)).sqrt().mid())
            elif not root.imag.is_zero() and root.imag.contains(0):
                raise ComputationError(
                    "H-infinity norm", "a level that touches the gain cannot be told from a crossing"
                )
        return sorted(frequencies, key=float)


def identity(size: int) -> fmpq_mat:
    """Unit matrix in rational numbers."""
    return fmpq_mat(size, size, [fmpq(int(i == j)) for i in range(size) for j in range(size)])


def hinf_bounds(
    A: fmpq_mat, B: fmpq_mat, C: fmpq_mat, D: fmpq_mat, guesses: Sequence[float] = (), *, width: float = 1e-9
) -> NormBounds:
    """Enclose the H-infinity norm of a system whose stability is known.

    Parameters
    ----------
    A, B, C, D : fmpq_mat
        Shapes (n, n), (n, m), (p, n), (p, m).
    guesses : sequence of float
        Frequencies in rad/s that may be near the peak.
    width : float
        Relative width of the enclosure.

    Raises
    ------
    ComputationError
        If the ends do not meet.
    """
    starts = [arb(0), arb.pos_inf(), *map(arb, guesses)]
    best, frequency = _highest(A, B, C, D, starts)
    if best == 0:  # zeros at these frequencies are not yet a response of zero
        if _is_zero(A, B, C, D):
            return NormBounds(0.0, 0.0, 0.0)
        sizes = [float(abs(root).mid()) for root, _ in roots(A.charpoly())]
        best, frequency = _highest(A, B, C, D, [arb(f * w) for w in (*sizes, 1.0) for f in (0.5, 1.1, 3.0)])
    for _ in range(_ROUNDS):
        upper = float(np.nextafter(best * (1 + width), np.inf))
        if not np.isfinite(upper) or upper < 1e-300:
            break
        level = Fraction(upper)
        crossings = level_frequencies(A, B, C, D, fmpq(level.numerator, level.denominator))
        if crossings == []:
            return NormBounds(best, upper, float(frequency))
        if crossings is None:  # the level is a singular value of D: step over it
            width *= 1.5
            continue
        gain, place = _highest(A, B, C, D, _between(crossings))
        if not gain > best:
            break
        best, frequency = gain, place
    at = f"{float(frequency):.9g} rad/s"
    raise ComputationError("H-infinity norm", f"the ends do not meet above the gain {best!r} at {at}")


def _highest(A: fmpq_mat, B: fmpq_mat, C: fmpq_mat, D: fmpq_mat, places: list[arb]) -> tuple[float, arb]:
    gains = [gain_below(A, B, C, D, place) for place in places]
    best = int(np.argmax(gains))
    return gains[best], places[best]


def _between(crossings: list[arb]) -> list[arb]:
    """The crossings and the middles between them, of both kinds: they may lie many powers of ten apart."""
    with ctx.workprec(ROOT_BITS):
        arithmetic = [((a + b) / 2).mid() for a, b in pairwise(crossings)]
        geometric = [(a * b).sqrt().mid() for a, b in pairwise(crossings)]
        return [*crossings, *arithmetic, *geometric, (2 * crossings[-1] + 1).mid()]


def _is_zero(A: fmpq_mat, B: fmpq_mat, C: fmpq_mat, D: fmpq_mat) -> bool:
    """Whether the response is zero at every frequency: D and all Markov parameters are zero."""
    block, terms = B, [D]
    for _ in range(A.nrows()):
        terms.append(C * block)
        block = A * block
    return not any(any(x != 0 for x in term.entries()) for term in terms)


def h2_bounds(A: fmpq_mat, B: fmpq_mat, C: fmpq_mat, D: fmpq_mat, *, discrete: bool = False) -> NormBounds:
    """Enclose the H2 norm of a stable system to rounding, from the exact controllability Gramian.

    Parameters
    ----------
    A, B, C, D : fmpq_mat
        D counts in discrete time only.
    discrete : bool
        Whether the system is one of discrete time.

    Raises
    ------
    ComputationError
        If the Lyapunov equation is singular.
    """
    P = _gramian(A, B, discrete)
    square = _trace(C * P * C.transpose()) + (_trace(D * D.transpose()) if discrete else 0)
    with ctx.workprec(_BITS):
        value = arb(square).sqrt()
        return NormBounds(max(below(value), 0.0), above(value), float("nan"))


def _trace(matrix: fmpq_mat) -> fmpq:
    return sum((matrix[i, i] for i in range(matrix.nrows())), fmpq(0))


def _gramian(A: fmpq_mat, B: fmpq_mat, discrete: bool) -> fmpq_mat:
    """P with A P + P A' + B B' = 0 (P = A P A' + B B'), exactly: a linear system for the entries of one triangle."""
    n = A.nrows()
    place = {(i, j): k for k, (i, j) in enumerate((i, j) for i in range(n) for j in range(i + 1))}
    rows = [[fmpq(0)] * len(place) for _ in place]
    entry, load = A.tolist(), B * B.transpose()

    def add(row: int, a: int, b: int, factor: fmpq) -> None:
        column = place[max(a, b), min(a, b)]
        rows[row][column] = rows[row][column] + factor

    for (i, j), row in place.items():
        for k in range(n):
            if discrete:
                for other in range(n):
                    add(row, k, other, entry[i][k] * entry[j][other])
            else:
                add(row, k, j, entry[i][k])
                add(row, i, k, entry[j][k])
        if discrete:
            add(row, i, j, fmpq(-1))
    right = fmpq_mat(len(place), 1, [-load[i, j] for i, j in place])
    try:
        entries = fmpq_mat(rows).solve(right)
    except ZeroDivisionError:
        raise ComputationError("H2 norm", "the Lyapunov equation is singular") from None
    return fmpq_mat([[entries[place[max(i, j), min(i, j)], 0] for j in range(n)] for i in range(n)])

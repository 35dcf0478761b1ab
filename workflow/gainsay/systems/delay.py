"""Linear systems with constant delays: characteristic quasi-polynomial and exact delay margins.

Every delayed signal may have a delay of its own in what is computed of roots and norms; the quasi-polynomial and the
margin are those of one delay common to all (`gainsay.systems.scaled_margin` has that of several that grow together).
Retarded equations alone: nothing that is delayed is a derivative.

The coefficients of the quasi-polynomial are formed in rational arithmetic, its imaginary-axis crossings are isolated as
roots of an integer polynomial, and the delays at which they happen are enclosed in balls. So a margin comes with bounds
that hold for the matrices as given; give fractions rather than floats where the data are decimal.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from flint import acb, arb, ctx, fmpq, fmpq_mat, fmpq_poly
from numpy.typing import ArrayLike

from gainsay.errors import ComputationError, InputError
from gainsay.exact.floats import real_array
from gainsay.systems.spectrum import isolated_roots

_PRECISION = 160  # bits: the roots of light modes lie close together relative to their size


def _entries(matrix: object, name: str) -> np.ndarray:
    """Return a 2-D object array of exact numbers (ints, fractions or floats taken at their binary value)."""
    array = np.array(matrix, dtype=object)
    if array.ndim != 2:
        raise InputError("a delay system takes matrices", field=name, value=array.shape, expected="two dimensions")
    exact = np.empty(array.shape, dtype=object)
    for index, value in np.ndenumerate(array):
        try:
            exact[index] = Fraction(value)
        except (TypeError, ValueError, OverflowError):
            raise InputError("", field=f"{name}{list(index)}", value=value, expected="a finite number") from None
    return exact


def _doubles(exact: np.ndarray, name: str) -> np.ndarray:
    """Exact numbers rounded."""
    try:
        return exact.astype(float)
    except OverflowError:
        raise InputError("", field=name, value="an entry", expected="within the range of doubles") from None


def _flint(matrix: np.ndarray) -> fmpq_mat:
    if not matrix.size:
        return fmpq_mat(*matrix.shape)
    return fmpq_mat([[fmpq(v.numerator, v.denominator) for v in row] for row in matrix])


class DelaySystem:
    """x'(t) = A x(t) + sum_i Bd[:, i] v_i(t - d_i) + B w(t), v = Cd x, y(t) = C x(t) + D w(t).

    The delayed term is kept in factors: its rank is what the quasi-polynomial grows with. The delays are no part of the
    system: wherever one is asked for, it is one number for all the signals v_i, or one a signal. So the equation
    x' = A x + A1 x(t - d1) + A2 x(t - d2) has Bd = [A1 A2], Cd = [I; I] and the delays d1, ..., d1, d2, ..., d2.

    Parameters
    ----------
    A : array_like, shape (n, n)
        Undelayed dynamics; entries may be fractions.
    Bd : array_like, shape (n, r)
        Where the delayed signals enter.
    Cd : array_like, shape (r, n)
        The signals that are delayed.
    B, C, D : array_like, optional
        Input (n, m), output (p, n) and feedthrough (p, m); needed for the norm alone.

    Raises
    ------
    InputError
        If shapes disagree or an entry is not a finite number.
    """

    def __init__(self, A: object, Bd: object, Cd: object, B: object = None, C: object = None, D: object = None) -> None:
        self.exact = {name: _entries(value, name) for name, value in (("A", A), ("Bd", Bd), ("Cd", Cd))}
        n = self.exact["A"].shape[0]
        if n == 0:
            raise InputError("a delay system has states", field="A", value=(0, 0), expected="(n, n), n >= 1")
        rank = self.exact["Bd"].shape[1]
        self.exact["B"] = _entries(np.zeros((n, 0)) if B is None else B, "B")
        inputs = self.exact["B"].shape[1]
        self.exact["C"] = _entries(np.zeros((0, n)) if C is None else C, "C")
        outputs = self.exact["C"].shape[0]
        self.exact["D"] = _entries(np.zeros((outputs, inputs)) if D is None else D, "D")
        wanted = {"A": (n, n), "Bd": (n, rank), "Cd": (rank, n), "B": (n, inputs), "C": (outputs, n)}
        wanted["D"] = (outputs, inputs)
        for name, shape in wanted.items():
            if self.exact[name].shape != shape:
                raise InputError("shape", field=name, value=self.exact[name].shape, expected=str(shape))
        floats = {name: _doubles(value, name) for name, value in self.exact.items()}
        self.A, self.Bd, self.Cd = floats["A"], floats["Bd"], floats["Cd"]
        self.B, self.C, self.D = floats["B"], floats["C"], floats["D"]
        self.A1 = _doubles(self.delayed(np.ones(rank, dtype=bool)), "Bd Cd")

    @property
    def order(self) -> int:
        """Number of states n."""
        return self.A.shape[0]

    def delays(self, delay: ArrayLike) -> np.ndarray:
        """Delay of each delayed signal, s, shape (r,), from one for all or one a signal.

        Raises
        ------
        InputError
            If a delay is negative or not finite, or their number is neither one nor r.
        """
        values, rank = real_array(delay, "delay"), self.Bd.shape[1]
        if values.ndim > 1 or (values.ndim == 1 and len(values) != rank):
            raise InputError("", field="delay", value=values.shape, expected=f"one time, s, or {rank}: one a signal")
        if not (values >= 0).all():
            raise InputError("", field="delay", value=values.tolist(), expected="a finite time >= 0 s")
        return np.broadcast_to(values, (rank,))

    def terms(self, delay: ArrayLike) -> tuple[tuple[np.ndarray, float], ...]:
        """The (H_k, d_k) of x' = sum_k H_k x(t - d_k), d_0 = 0: the products of factors exact and rounded once.

        Signals of equal delays stand together, and what is not delayed stands in H_0.
        """
        delays = self.delays(delay)
        late = [(_doubles(self.delayed(delays == d), "Bd Cd"), float(d)) for d in np.unique(delays[delays > 0])]
        return ((_doubles(self.exact["A"] + self.delayed(delays == 0), "A + Bd Cd"), 0.0), *late)

    def delayed(self, chosen: np.ndarray) -> np.ndarray:
        """Sum of Bd[:, i] Cd[i] over chosen signals, shape (n, n), exact."""
        none = np.full(self.A.shape, Fraction(0), dtype=object)
        return self.exact["Bd"][:, chosen] @ self.exact["Cd"][chosen] if np.any(chosen) else none

    def characteristic_matrix(self, s: complex, delay: ArrayLike) -> np.ndarray:
        """Return s I - A - Bd diag(exp(-s d_i)) Cd, shape (n, n)."""
        return s * np.eye(self.order) - self.A - (self.Bd * np.exp(-s * np.asarray(delay))) @ self.Cd

    def response(self, frequency: float, delay: ArrayLike) -> np.ndarray:
        """Return the transfer matrix from w to y at s = j frequency (rad/s), shape (p, m)."""
        return self.C @ np.linalg.solve(self.characteristic_matrix(1j * frequency, delay), self.B) + self.D

    @cached_property
    def quasi_polynomial(self) -> "QuasiPolynomial":
        """det(s I - A - z Bd Cd) with z = exp(-s d) of one delay common to all, coefficients exact."""
        A, Bd, Cd = (_flint(self.exact[name]) for name in ("A", "Bd", "Cd"))
        if not Bd.ncols():  # nothing is delayed
            return QuasiPolynomial((A.charpoly(),))
        degree = min(Bd.rank(), Cd.rank())
        # det is a polynomial of degree `degree` in z: interpolate it at z = 0..degree.
        samples = [(A + Bd * Cd * fmpq(z)).charpoly() for z in range(degree + 1)]
        coefficients = [fmpq_poly([0])] * (degree + 1)
        for i, sample in enumerate(samples):
            basis = fmpq_poly([1])
            for j in range(degree + 1):
                if j != i:
                    basis = basis * fmpq_poly([fmpq(-j, i - j), fmpq(1, i - j)])
            padded = list(basis.coeffs()) + [fmpq(0)] * (degree + 1)
            coefficients = [c + sample * padded[k] for k, c in enumerate(coefficients)]
        return QuasiPolynomial(tuple(coefficients))


@dataclass(frozen=True)
class Crossing:
    """A pair of roots +-j frequency on the imaginary axis, enclosed.

    Attributes
    ----------
    frequency : arb
        rad/s.
    delay : arb
        The least nonnegative delay at which it happens, s; it recurs every 2 pi / frequency.
    """

    frequency: arb
    delay: arb


@dataclass(frozen=True)
class DelayMargin:
    """First loss of stability as the delay grows from zero.

    Attributes
    ----------
    delay : float
        s; 0 where the system is unstable without delay, inf where no delay destabilises it.
    lower, upper : float
        Proved bounds of it.
    frequency : float
        rad/s at which the roots cross; nan where none do.
    crossings : tuple of Crossing
        All crossings, by delay.
    """

    delay: float
    lower: float
    upper: float
    frequency: float
    crossings: tuple[Crossing, ...]


@dataclass(frozen=True)
class QuasiPolynomial:
    """sum_k coefficients[k](s) exp(-k s d) with exact rational polynomials.

    Parameters
    ----------
    coefficients : tuple of fmpq_poly
        Of z^0, z^1, ...; the first one monic.
    """

    coefficients: tuple[fmpq_poly, ...]

    def __call__(self, s: complex, delay: float) -> complex:
        """Value at s (1/s) for one delay (s), in double precision."""
        powers = np.exp(-s * delay * np.arange(len(self.coefficients)))
        return complex(sum(z * np.polyval(_floats(p), s) for z, p in zip(powers, self.coefficients, strict=True)))

    def undelayed(self) -> fmpq_poly:
        """Return the characteristic polynomial at zero delay."""
        return sum(self.coefficients[1:], self.coefficients[0])

    def stable_without_delay(self) -> bool:
        """Tell whether every root at zero delay has a negative real part (proved, roots isolated in balls)."""
        with _precision():
            return hurwitz(self.undelayed())

    def crossings(self) -> tuple[Crossing, ...]:
        """Every way in which roots can lie on the imaginary axis for some delay >= 0, by delay.

        With one delayed channel, P(jw) + Q(jw) e^{-jwd} = 0 needs |P(jw)|^2 = |Q(jw)|^2, a polynomial in w^2 whose real
        roots are isolated; the delay is then the argument of -Q(jw)/P(jw) over w (Walton and Marshall, 1987).

        Raises
        ------
        ComputationError
            If more than one channel is delayed, or a crossing is degenerate (a root at s = 0, or P and Q with a common
            root on the axis).
        """
        if len(self.coefficients) == 1:
            return ()
        if len(self.coefficients) > 2:
            raise ComputationError("delay margin", f"delayed term of rank {len(self.coefficients) - 1}, only 1 is done")
        p, q = self.coefficients
        even = _squared_modulus(p) - _squared_modulus(q)
        if even.is_zero():
            raise ComputationError("delay margin", "|P(jw)| = |Q(jw)| at every frequency")
        if even(fmpq(0)) == 0 and self.undelayed()(fmpq(0)) == 0:
            raise ComputationError("delay margin", "a root at s = 0 for every delay")
        with _precision():
            crossings = [_crossing(p, q, x) for x in _positive_roots(even)]
        return tuple(sorted(crossings, key=lambda c: float(c.delay.mid())))

    def margin(self) -> DelayMargin:
        """First loss of stability as the delay grows from zero, with proved bounds.

        Roots enter the right half plane only across the imaginary axis, and for a retarded equation none come from
        infinity as the delay leaves zero; so the least crossing delay is the margin of a system stable without delay.
        """
        if not self.stable_without_delay():
            return DelayMargin(0.0, 0.0, 0.0, float("nan"), ())
        crossings = self.crossings()
        if not crossings:
            return DelayMargin(float("inf"), float("inf"), float("inf"), float("nan"), ())
        with _precision():
            lower = min(_down(c.delay) for c in crossings)
            upper = min(_up(c.delay) for c in crossings)
        first = crossings[0]
        return DelayMargin(float(first.delay.mid()), lower, upper, float(first.frequency.mid()), crossings)


class _precision:
    """Flint's working precision raised for a block and put back."""

    def __enter__(self) -> None:
        self._kept, ctx.prec = ctx.prec, _PRECISION

    def __exit__(self, *error: object) -> None:
        ctx.prec = self._kept


def _floats(polynomial: fmpq_poly) -> np.ndarray:
    """Coefficients as floats, highest power first."""
    return np.array([float(Fraction(int(c.p), int(c.q))) for c in reversed(polynomial.coeffs())] or [0.0])


def _squared_modulus(polynomial: fmpq_poly) -> fmpq_poly:
    """|p(jw)|^2 as a polynomial in x = w^2."""
    mirrored = fmpq_poly([c if k % 2 == 0 else -c for k, c in enumerate(polynomial.coeffs())])
    product = (polynomial * mirrored).coeffs()
    return fmpq_poly([c if k % 2 == 0 else -c for k, c in enumerate(product[::2])])  # s^2 = -x


def hurwitz(polynomial: fmpq_poly) -> bool:
    """Tell whether every root has a negative real part, from isolating balls.

    Raises
    ------
    ComputationError
        If a root cannot be told from the imaginary axis.
    """
    verdict = True
    for root, _ in isolated_roots(polynomial):
        real = root.real
        if real >= 0:
            verdict = False
        elif not real < 0:
            raise ComputationError("stability", f"a root within {float(real.rad()):.1e} of the imaginary axis")
    return verdict


def _positive_roots(polynomial: fmpq_poly) -> Iterable[arb]:
    for value, _ in isolated_roots(polynomial):
        if value.imag.contains(0) and not value.imag.is_zero():
            raise ComputationError("delay margin", "a root in w^2 that is neither real nor complex at this precision")
        if value.imag.is_zero() and value.real > 0:
            yield value.real


def _crossing(p: fmpq_poly, q: fmpq_poly, x: arb) -> Crossing:
    frequency = x.sqrt()
    s = acb(0, frequency)
    top, bottom = _horner(q, s), _horner(p, s)
    if bottom.abs_lower().contains(0):
        raise ComputationError("delay margin", f"P and Q vanish together near {float(frequency.mid()):.6g} rad/s")
    angle = (-top / bottom).arg()  # e^{jwd} = -Q/P
    if not (angle > 0 or angle < 0):
        raise ComputationError("delay margin", f"delay 0 or 2 pi/w near {float(frequency.mid()):.6g} rad/s")
    if angle < 0:
        angle = angle + 2 * arb.pi()
    return Crossing(frequency, angle / frequency)


def _horner(polynomial: fmpq_poly, s: acb) -> acb:
    value = acb(0)
    for c in reversed(polynomial.coeffs()):
        value = value * s + acb(arb(c))
    return value


def _down(ball: arb) -> float:
    """Largest convenient float below the ball."""
    return float(np.nextafter(float(ball.lower()), -np.inf))


def _up(ball: arb) -> float:
    return float(np.nextafter(float(ball.upper()), np.inf))

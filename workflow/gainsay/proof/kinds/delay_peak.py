"""An output of a loop with a varying delay stays within a bound from a time on, under a bounded disturbance.

Theorem (small gain in the peak norm): let x' = A x + Bd v(t - d(t)) + B w(t) with v = Cd x a number and x(t) = x(0) for
t < 0, where d and w are measurable, 0 <= d(t) <= D and |w(t)| <= W. Beside it let xi' = (v - xi)/T, xi(0) = v(0), be v
behind a lag T > 0. With z = (x, xi), q = v' and u = v(t - d(t)) - xi,

    z' = F z + G u + Bw w,     F = [[A, Bd], [Cd/T, -1/T]],     G = (Bd, 0),     Bw = (B, 0),
    q  = H z + Cd Bd u + Cd B w,     H = [Cd A, Cd Bd],
    u(t) = integral over 0 < s < t of (exp(-s/T) - 1[s < d(t)]) q(t - s),

since v(t) - v(t - d) is the integral of q over the last d seconds, q being zero before t = 0. Fix a rate r >= 0 with
r T < 1 and F + r I Hurwitz, and let |f|_1 be the integral of exp(r t) |f(t)|, |f|_p the supremum of exp(r t) |f(t)|.
Then |u|_p <= kappa |q|_p, with kappa the larger of the weighted integrals of the kernel at d = 0 and at d = D (the
integral falls and then grows with d). Without w, if

    g kappa < 1,     g = |H exp(F t) G|_1 + |Cd Bd|,

then |q|_p <= |H exp(F t) z(0)|_p / (1 - g kappa), over every [0, t] and so over all t >= 0, and

    |C x(t)| <= exp(-r t) (sup over s >= t of exp(r s) |[C, 0] exp(F s) z(0)| + |[C, 0] exp(F t) G|_1 kappa |q|_p).

What w adds from rest is bounded in the same way at r = 0: |q| <= (|H exp(F t) Bw|_1 + |Cd B|) W / (1 - g kappa), and
|C x| <= |[C, 0] exp(F t) Bw|_1 W + |[C, 0] exp(F t) G|_1 kappa |q|. The loop is linear under each d: the two add, and
the bound for two starts is one for every start between them.

Every f here is a sum of exponentials, from the poles of F (all simple) and the residues there. On a cell of width h it
lies within h^2/8 max |f''| of its chord, and its integral within h^3/12 max |f''|; beyond the last cell the sizes of
the exponentials are added up.

Fields: ``A``, ``Bd``, ``Cd`` (formulas, or lists of equal length: the same is proved of each loop), ``delay`` (D),
``x0`` (a column for each start), ``outputs`` (list of {"of", "row", "from", "bound"}: C, a time within the cells, and
what bounds |C x| from then on), ``rate`` (r), ``lag`` (T), ``step`` (h), ``cells``; for a disturbance ``B`` and ``w``
(W). No witness.
Reference: C. A. Desoer, M. Vidyasagar, Feedback Systems: Input-Output Properties, Academic Press 1975, chapter 4.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from flint import acb, arb, fmpq_mat, fmpq_poly

from gainsay.exact.ball import upper
from gainsay.exact.blocks import block
from gainsay.exact.budget import spend
from gainsay.exact.matrix import Matrix, zeros
from gainsay.exact.rational import to_fmpq, to_text
from gainsay.proof.inequalities import bounds, vertices
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "small gain in the peak norm, a varying delay against a lag"
REQUIRED = ("A", "Bd", "Cd", "delay", "x0", "outputs", "rate", "lag", "step", "cells")
OPTIONAL = ("B", "w")
LEVELS = ("outputs.bound",)
FOUND = ("rate", "lag", "step", "cells")

MOST_CELLS = 100_000


@dataclass(frozen=True)
class Size:
    """Bounds on a weighted signal: its integral over all times, and its peak on each cell and beyond the last."""

    integral: arb
    peaks: tuple[arb, ...]

    def peak(self, since: int = 0) -> arb:
        """Peak from the beginning of a cell on."""
        largest = arb(0)
        for peak in self.peaks[since:]:
            largest = largest.max(peak)
        return largest


@dataclass(frozen=True)
class Responses:
    """Responses of z' = F z, weighted by exp(`rate` t), in cells of a width.

    Attributes
    ----------
    F : fmpq_mat
    poles : tuple of acb
        Of F, one of each conjugate pair; every one left of -`rate`.
    rate, step : Fraction
    cells : int
    """

    F: fmpq_mat
    poles: tuple[acb, ...]
    rate: Fraction
    step: Fraction
    cells: int

    @cached_property
    def exponents(self) -> tuple[acb, ...]:
        """Poles, moved by the rate."""
        return tuple(pole + _ball(self.rate) for pole in self.poles)

    @cached_property
    def exponentials(self) -> list[list[acb]]:
        """Exponentials at the end of each cell.

        Each is computed from the start: a product for each cell would turn a ball, which is a square, and so grow it.
        """
        h = _ball(self.step)
        return [[(m * (h * cell)).exp() for m in self.exponents] for cell in range(1, self.cells + 1)]

    def size(self, row: fmpq_mat, column: fmpq_mat) -> Size:
        """Size of exp(rate t) row exp(F t) column.

        With p the characteristic polynomial, row adj(s I - F) column = det(s I - F + column row) - p(s), and the
        residue at a simple pole is its value there over that of p'.
        """
        below = self.F.charpoly()
        above, slope = (self.F - column * row).charpoly() - below, below.derivative()
        residues = [_at(above, pole) / _at(slope, pole) * (1 if pole.imag == 0 else 2) for pole in self.poles]
        h = _ball(self.step)
        bends = [abs(r) * abs(m) ** 2 for r, m in zip(residues, self.exponents, strict=True)]
        shrinks = [(m.real * h).exp() for m in self.exponents]
        integral, peaks = arb(0), []
        start = abs(_sum(r.real for r in residues))
        for exponentials in self.exponentials:
            end = abs(_sum((r * e).real for r, e in zip(residues, exponentials, strict=True)))
            bend = _sum(bends)
            integral += h * (start + end) / 2 + h**3 * bend / 12
            peaks.append(start.max(end) + h**2 * bend / 8)
            start, bends = end, [b * shrink for b, shrink in zip(bends, shrinks, strict=True)]
        rest = [abs(r * e) for r, e in zip(residues, self.exponentials[-1], strict=True)]
        integral += _sum(size / -m.real for size, m in zip(rest, self.exponents, strict=True))
        return Size(integral, (*peaks, _sum(rest)))


def _ball(value: Fraction) -> arb:
    return arb(to_fmpq(value))


def _sum(values: Iterable[arb]) -> arb:
    return sum(values, arb(0))


def _at(polynomial: fmpq_poly, point: acb) -> acb:
    total = acb(0)
    for coefficient in reversed(polynomial.coeffs()):
        total = total * point + arb(coefficient)
    return total


def kernel(delay: Fraction, lag: Fraction, rate: Fraction) -> arb:
    """Largest weighted integral over s of |exp(-s/T) - 1[s < d]| for 0 <= d <= D: at d = 0 or at d = D."""
    D, r = _ball(delay), _ball(rate)
    fall = 1 / _ball(lag) - r
    passed = D if rate == 0 else ((r * D).exp() - 1) / r
    return (1 / fall).max(passed - (1 - 2 * (-fall * D).exp()) / fall)


@dataclass(frozen=True)
class Output:
    """C x, the time from which it is bounded, and the bound."""

    of: str
    row: Matrix
    since: Fraction
    bound: Fraction


@dataclass(frozen=True)
class Frame:
    """What all loops share: the delay, the lag and the rate, and the cells."""

    delay: Fraction
    lag: Fraction
    rate: Fraction
    step: Fraction
    cells: int


def _poles(scope: Scope, F: fmpq_mat, rate: Fraction) -> tuple[acb, ...]:
    """Poles of F that are real or have a positive imaginary part: simple, and left of -rate."""
    poles: Any = F.charpoly().complex_roots()  # pairs of a root and its multiplicity
    if any(count > 1 for _, count in poles):
        raise scope.fail("a pole of F is multiple")
    for pole, _ in poles:
        if not pole.real + _ball(rate) < 0:
            raise scope.fail(f"F + {to_text(rate)} I is not proved to be Hurwitz")
        if pole.imag != 0 and pole.imag.contains(0):
            raise scope.fail("a pole of F is neither real nor proved not to be")
    return tuple(pole for pole, _ in poles if pole.imag == 0 or pole.imag > 0)


def _exact(scope: Scope, value: Matrix, name: str, shape: tuple[int | None, int | None]) -> Matrix:
    """Return a matrix of the fields: exact, and of the shape that the others ask for (None: any)."""
    if not value.is_exact:
        raise scope.fail(f"field {name!r}: expected exact numbers, found a {value.ring}")
    if any(wanted not in (None, size) for size, wanted in zip(value.shape, shape, strict=True)):
        wanted = " x ".join("any" if size is None else str(size) for size in shape)
        raise scope.fail(f"field {name!r} has shape {value.shape}, expected {wanted}")
    return value


class Loop:
    """One loop beside its lag: z' = F z + G u + Bw w, q = H z + Cd Bd u + Cd B w."""

    def __init__(self, scope: Scope, parts: tuple[Matrix, Matrix, Matrix], frame: Frame) -> None:
        A, Bd, Cd = parts
        n = _exact(scope, A, "A", (None, A.shape[0])).shape[0]
        _exact(scope, Bd, "Bd", (n, 1))
        _exact(scope, Cd, "Cd", (1, n))
        slow = Matrix.number(1 / frame.lag)
        self.scope, self.frame, self.order, self.Cd = scope, frame, n, Cd
        self.F = block([[A, Bd], [Cd.scaled(slow), -slow]]).data
        self.G, self.H = block([[Bd], [zeros(1, 1)]]).data, block([[Cd @ A, Cd @ Bd]]).data
        self.direct = abs(arb((Cd @ Bd).entry(0, 0)))
        spend(1e4 * n * frame.cells, "the exponentials of a response")
        self.decaying = self._responses(frame.rate)
        self.still = self._responses(Fraction(0))

    def _responses(self, rate: Fraction) -> Responses:
        return Responses(self.F, _poles(self.scope, self.F, rate), rate, self.frame.step, self.frame.cells)

    def size(self, responses: Responses, row: fmpq_mat, column: fmpq_mat) -> Size:
        """Size of a response, its work counted."""
        spend(500.0 * self.order * self.frame.cells, "a response in cells")
        return responses.size(row, column)

    def row(self, row: Matrix) -> fmpq_mat:
        """C as a row over z."""
        return block([[_exact(self.scope, row, "outputs.row", (1, self.order)), zeros(1, 1)]]).data

    def gain(self, responses: Responses) -> arb:
        """Return kappa / (1 - g kappa): how much larger |u| is at most than what drives q."""
        kappa = kernel(self.frame.delay, self.frame.lag, responses.rate)
        room = 1 - (self.size(responses, self.H, self.G).integral + self.direct) * kappa
        if not room > 0:
            raise self.scope.fail(f"g kappa < 1 is not proved at the rate {to_text(responses.rate)}")
        return kappa / room

    def free(self, x0: Matrix, outputs: list[Output]) -> list[arb]:
        """Bound each output from every start, without disturbance."""
        z0 = block([[x0], [self.Cd @ x0]]).data
        starts = [fmpq_mat([[z0[i, j]] for i in range(z0.nrows())]) for j in range(z0.ncols())]
        gain = self.gain(self.decaying)
        driven = [gain * self.size(self.decaying, self.H, start).peak() for start in starts]
        sizes = []
        for output in outputs:
            row, decay = self.row(output.row), (-_ball(self.frame.rate * output.since)).exp()
            through = self.size(self.decaying, row, self.G).integral
            cell = int(output.since / self.frame.step)
            worst = arb(0)
            for start, u in zip(starts, driven, strict=True):
                worst = worst.max(decay * (self.size(self.decaying, row, start).peak(cell) + through * u))
            sizes.append(worst)
        return sizes

    def forced(self, B: Matrix, w: Fraction, outputs: list[Output]) -> list[arb]:
        """Bound what a disturbance of at most w adds to each output from rest."""
        push = block([[_exact(self.scope, B, "B", (self.order, 1))], [zeros(1, 1)]]).data
        W = _ball(w)
        drives = self.size(self.still, self.H, push).integral + abs(arb((self.Cd @ B).entry(0, 0)))
        u = self.gain(self.still) * drives * W
        rows = [self.row(output.row) for output in outputs]
        return [
            self.size(self.still, row, push).integral * W + self.size(self.still, row, self.G).integral * u
            for row in rows
        ]


def _frame(scope: Scope) -> Frame:
    names = ("delay", "lag", "rate", "step", "cells")
    delay, lag, rate, step, cells = (scope.number(scope.field(name)) for name in names)
    if delay < 0 or rate < 0 or not lag > 0 or not rate * lag < 1 or not step > 0:
        raise scope.fail("expected delay and rate >= 0, lag and step > 0, rate * lag < 1")
    if cells.denominator != 1 or not 0 < cells <= MOST_CELLS:
        raise scope.fail(f"field 'cells': expected an integer from 1 to {MOST_CELLS}")
    return Frame(delay, lag, rate, step, int(cells))


def _outputs(scope: Scope, frame: Frame) -> list[Output]:
    raw = scope.field("outputs")
    if (
        not isinstance(raw, list)
        or not raw
        or any(
            not isinstance(one, dict)
            or set(one) != {"of", "row", "from", "bound"}
            or any(not isinstance(text, str) for text in one.values())
            for one in raw
        )
    ):
        raise scope.fail("field 'outputs': expected a list of of, row, from and bound")
    if len({one["of"] for one in raw}) < len(raw):
        raise scope.fail("field 'outputs': expected a different name for each output")
    outputs = [
        Output(one["of"], scope.evaluate(one["row"]), scope.number(one["from"]), scope.number(one["bound"]))
        for one in raw
    ]
    for output in outputs:
        if output.bound < 0 or not 0 <= output.since < frame.step * frame.cells:
            raise scope.fail(f"output {output.of!r}: expected a bound >= 0 from a time within the cells on")
    return outputs


def prove(scope: Scope) -> list[Proved]:
    """Bound the outputs of every loop from every start, and what the disturbance adds."""
    scope.fields_fit(("B", "w"))
    scope.define()
    frame = _frame(scope)
    outputs = _outputs(scope, frame)
    lists = [vertices(scope, name) for name in ("A", "Bd", "Cd")]
    if len({len(matrices) for matrices in lists}) > 1:
        raise scope.fail("fields 'A', 'Bd', 'Cd': expected lists of equal length")
    x0 = scope.evaluate(scope.field("x0"))
    for parts in zip(*lists, strict=True):
        loop = Loop(scope, parts, frame)
        reach = loop.free(_exact(scope, x0, "x0", (loop.order, None)), outputs)
        if "B" in scope.certificate.fields:
            low, w = bounds(scope, scope.evaluate(scope.field("w")), "w")
            if low < 0:
                raise scope.fail("field 'w': expected a bound that is not negative")
            added = loop.forced(scope.evaluate(scope.field("B")), w, outputs)
            reach = [a + b for a, b in zip(reach, added, strict=True)]
        for output, most in zip(outputs, reach, strict=True):
            if upper(most) > output.bound:
                reached = f"at most {float(upper(most)):.6g}"
                raise scope.fail(f"|{output.of}| <= {to_text(output.bound)} is not proved: {reached}")
    return [Proved(o.of, "inside", f"{to_text(-o.bound)}..{to_text(o.bound)}") for o in outputs]

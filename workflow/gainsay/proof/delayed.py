"""A loop with constant delays on the imaginary axis, in balls: its roots counted, kept off the axis, its gain bounded.

The loop is x' = A x + sum_k Ad_k x(t - f d_k) + B w, y = C x + D w, with a common factor f of its delays, and

    M(s) = s I - A - sum_k Ad_k exp(-s f d_k),     G(s) = C M(s)^-1 B + D.

The axis and the ranges of f and of the d_k make a box, which is cut until each part is settled as a whole: with X near
the inverse at its middle, X M = I + F, and the Perron root of a bound on |F| is below one. Of a retarded equation no
root with Re s >= 0 lies beyond |s| = r, the Perron root of |A| + sum_k |Ad_k|.

Reference: R. A. Horn, C. R. Johnson, Matrix Analysis, 2nd ed., Cambridge 2013, section 8.1 (Perron root, the bound of
Collatz and Wielandt).
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import pi, sin

from flint import acb, acb_mat, arb, arb_mat, ctx, fmpq

from gainsay.exact.budget import multiply_cost, spend
from gainsay.exact.definite import hermitian_positive_definite

__all__ = ["DelayedLoop", "NotSettled", "Range"]

_FINEST = 2.0**-48  # part of the axis, or of a range of delays, that is not cut again: its ends are exact doubles
_REGULAR = 0.99
_LARGEST_TURN = 2.8  # rad, of the determinant over a piece, below pi
_TAILS = 60  # halvings of the tail at which its gain is tried


class NotSettled(ArithmeticError):
    """A part of the axis that is too small to be cut again, and not settled: the loop may have a root there."""


@dataclass(frozen=True)
class Range:
    """Numbers from `low` to `high`, which may be equal, by the part in [0, 1] that has been passed."""

    low: fmpq
    high: fmpq

    def at(self, part: tuple[float, float]) -> arb:
        """Enclosure of what lies in a part."""
        if self.low == self.high:
            return arb(self.low)
        first, last = part
        return arb(self.low) + arb(self.high - self.low) * arb((first + last) / 2, (last - first) / 2)


@dataclass(frozen=True)
class DelayedLoop:
    """Matrices in balls, and the ranges of what may vary.

    Attributes
    ----------
    undelayed : acb_mat, shape (n, n)
        A.
    late : tuple of acb_mat, shape (n, n)
        Ad_k.
    factor : Range
        f.
    delays : tuple of Range
        d_k, s, not negative.
    """

    undelayed: acb_mat
    late: tuple[acb_mat, ...]
    factor: Range
    delays: tuple[Range, ...]

    @property
    def order(self) -> int:
        """Number of states n."""
        return self.undelayed.nrows()

    @cached_property
    def radius(self) -> fmpq:
        """A number that no root with Re s >= 0 exceeds in size, more than zero."""
        whole = [_sizes(part) for part in (self.undelayed, *self.late)]
        total = [[sum(entries, arb(0)) for entries in zip(*rows, strict=True)] for rows in zip(*whole, strict=True)]
        root = perron(total)
        if root is None:
            raise NotSettled("a matrix that is not finite")
        return (root * arb(1.01)).upper().fmpq() if root > 0 else fmpq(1)

    @property
    def varies(self) -> bool:
        """Whether more than one loop is meant."""
        thin = all(entry.is_exact() for part in (self.undelayed, *self.late) for entry in part.entries())
        return not thin or any(r.low != r.high for r in (self.factor, *self.delays))

    def matrix(self, frequency: arb, factor: arb, delays: Sequence[arb]) -> acb_mat:
        """M(i w)."""
        value = _unit(self.order) * acb(0, frequency) - self.undelayed
        for part, delay in zip(self.late, delays, strict=True):
            value = value - part * acb(0, -frequency * factor * delay).exp()
        return value

    def roots_right(self) -> int:
        """Number of roots with Re s > 0 of the loop in the middle of its matrices, with the least factor and delays.

        By the argument principle: det M turns by n pi / 2 - N pi from s = 0 to i infinity, N the number. Beyond a large
        i R what is left of it is the argument of det(M(i R) / (i R)), which is near one.
        """
        loop = DelayedLoop(
            self.undelayed.mid(),
            tuple(part.mid() for part in self.late),
            Range(self.factor.low, self.factor.low),
            tuple(Range(d.low, d.low) for d in self.delays),
        )
        small = _small_turn(self.order)
        end = arb(loop.radius) / arb(small)
        axis = Range(fmpq(0), end.upper().fmpq())
        factor, delays = arb(loop.factor.low), [arb(d.low) for d in loop.delays]
        turned = arb(0)
        for part, inverse in loop.settled(axis, small):
            for place, sign in zip(part, (-1, 1), strict=True):
                at = inverse * loop.matrix(axis.at((place, place)), factor, delays)
                turned = turned + sign * at.det().arg()
        top = arb(axis.high)
        left = (loop.matrix(top, factor, delays) * (1 / acb(0, top))).det().arg()
        number = arb(fmpq(self.order, 2)) + (left - turned) / arb.pi()
        whole = number.unique_fmpz()
        if whole is None:
            raise NotSettled("a count of roots that is not a whole number at this precision")
        return int(whole)

    def settled(
        self, axis: Range, most: float, holds: Callable[[acb_mat, acb_mat], bool] | None = None
    ) -> Iterator[tuple[tuple[float, float], acb_mat]]:
        """Cut the axis and what varies, and yield each part on which the Perron root of F is at most `most`.

        Parameters
        ----------
        axis : Range
            Frequencies, rad/s.
        most : float
        holds : callable, optional
            What is to be true of X and X M on every part too.

        Yields
        ------
        tuple
            The part of the axis, a pair of numbers in [0, 1], and X.

        Raises
        ------
        NotSettled
            If a part cannot be cut again.
        """
        ranges, unit_cost = (axis, self.factor, *self.delays), multiply_cost(ctx.prec, ctx.prec)
        todo = [tuple((0.0, 0.0 if r.low == r.high else 1.0) for r in ranges)]
        while todo:
            box = todo.pop()
            spend(40_000 + 15 * unit_cost * (2 + len(self.late)) * self.order**3, "a part of the axis")
            inverse = self._settles(ranges, box, most, holds)
            if inverse is None:
                todo += self.halves(ranges, box)
            else:
                yield box[0], inverse

    def _settles(
        self, ranges: Sequence[Range], box: tuple, most: float, holds: Callable[[acb_mat, acb_mat], bool] | None
    ) -> acb_mat | None:
        """X of a part, if it settles it."""
        frequency, factor, *delays = (r.at(part) for r, part in zip(ranges, box, strict=True))
        middle = self.matrix(frequency.mid(), factor.mid(), [d.mid() for d in delays]).mid()
        try:
            inverse = middle.inv().mid()
            near_one = inverse * self.matrix(frequency, factor, delays)
            root = perron(_sizes(near_one - _unit(self.order)))
            settled = root is not None and root <= most and (holds is None or holds(inverse, near_one))
        except ZeroDivisionError:
            return None
        return inverse if settled else None

    def halves(self, ranges: Sequence[Range], box: tuple) -> list[tuple]:
        """Both halves of a part, cut where M changes most over it.

        Raises
        ------
        NotSettled
            If it is too small to be cut.
        """
        frequency, factor, *delays = (float(r.at(part).abs_upper()) for r, part in zip(ranges, box, strict=True))
        sizes = [float(max(x for row in _sizes(part) for x in row)) for part in self.late]
        weight = sum(size * delay for size, delay in zip(sizes, delays, strict=True))
        slopes = [1 + factor * weight, frequency * weight, *(frequency * factor * size for size in sizes)]
        lengths = [float(arb(r.high - r.low)) * (last - first) for r, (first, last) in zip(ranges, box, strict=True)]
        effects = [slope * length for slope, length in zip(slopes, lengths, strict=True)]
        worst = effects.index(max(effects))
        first, last = box[worst]
        if last - first <= _FINEST:
            raise NotSettled(f"a root on the axis is not excluded near {frequency:.6g} rad/s, factor {factor:.6g}")
        middle = (first + last) / 2
        return [(*box[:worst], part, *box[worst + 1 :]) for part in ((middle, last), (first, middle))]

    def keeps_off(self) -> None:
        """Prove that no root lies on the axis, whichever loop of the ranges is meant."""
        for _ in self.settled(Range(fmpq(0), self.radius), _REGULAR):
            pass

    def stays_below(self, gamma: fmpq, inputs: acb_mat, outputs: acb_mat, through: acb_mat) -> None:
        """Prove that no root lies on the axis and that no singular value of G(i w) reaches gamma, infinity included."""
        level = arb(gamma) ** 2
        axis = Range(fmpq(0), self._tail(level, inputs, outputs, through))

        def below(inverse: acb_mat, near_one: acb_mat) -> bool:
            return _below(outputs * near_one.solve(inverse * inputs) + through, level)

        for _ in self.settled(axis, _REGULAR, below):
            pass

    def _tail(self, level: arb, inputs: acb_mat, outputs: acb_mat, through: acb_mat) -> fmpq:
        """A frequency beyond which the gain stays below a level, whatever the delays are."""
        if not _below(through, level):
            raise NotSettled("the gain at infinity, that of D, is not proved to be below the level")
        disk = acb(arb(0, 1), arb(0, 1))  # exp(-i w d) lies in it
        whole = self.undelayed
        for part in self.late:
            whole = whole + part * disk
        for halvings in range(1, _TAILS):
            end = self.radius * 2**halvings
            near = acb(0, arb(0, 1) / arb(end))  # i / w, both signs of w
            try:
                states = (_unit(self.order) + whole * near).solve(inputs)
                if _below(through - outputs * states * near, level):
                    return end
            except ZeroDivisionError:
                continue
        raise NotSettled("the gain at high frequencies is not proved to be below the level")


def _unit(size: int) -> acb_mat:
    return acb_mat([[int(i == j) for j in range(size)] for i in range(size)])


def _sizes(matrix: acb_mat) -> list[list[arb]]:
    """Moduli of the entries, from above."""
    return [[entry.abs_upper() for entry in row] for row in matrix.tolist()]


def _small_turn(size: int) -> float:
    """Perron root of F up to which the arguments of the eigenvalues of I + F do not add up to pi."""
    return min(_REGULAR, sin(min(_LARGEST_TURN / size, pi / 2)))


def perron(bound: list[list[arb]]) -> arb | None:
    """Upper bound on the spectral radius of a nonnegative matrix; None where it is not finite."""
    rows = [[float(x) for x in row] for row in bound]
    weights = [1.0] * len(rows)
    for _ in range(8):
        image = [sum(x * w for x, w in zip(row, weights, strict=True)) for row in rows]
        largest = max(image)
        if not 0 < largest < float("inf"):
            break
        # halfway to the image: periodic matrices settle too, and no weight reaches zero
        weights = [w / 2 + y / largest / 2 + 1e-9 for w, y in zip(weights, image, strict=True)]
    exact = [arb(w) for w in weights]
    products = (arb_mat(bound) * arb_mat([[w] for w in exact])).entries()
    most = arb(0)
    for product, weight in zip(products, exact, strict=True):
        most = most.max((product / weight).upper())
    return most if most.is_finite() else None


def _below(gain: acb_mat, level: arb) -> bool:
    """Prove that every singular value is below the root of a level."""
    adjoint = gain.conjugate().transpose()
    square = adjoint * gain if gain.ncols() <= gain.nrows() else gain * adjoint
    return hermitian_positive_definite(_unit(square.nrows()) * acb(level) - square)

"""Multipliers that exist exactly, near floats that satisfy their equations to a solver's tolerance.

They are proved to exist in one of two ways: the equations are solved by a small step inside the range of the
multipliers, which leaves them positive (`confined`); or by a small step of factors V_j of Z_j = V_j V_j', which are
positive whatever the step (`factored`). The step is bounded by a right inverse and its defect, all in floats with
proved rounding errors.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gainsay.lmi import scaling
from gainsay.lmi.affine import Definite, Entrywise, Equal
from gainsay.lmi.frames import assembled, congruent, independent, largest, most_lost, steps_of
from gainsay.lmi.points import is_strict
from gainsay.lmi.rounding import RightInverse, gamma, norm, power_of_two, proved_positive, residual, twofold

# most steps back onto the equations, and the part of a multiplier that one may take away
_RESTORING = 12
_PART = 0.7
# coefficients up to which residuals are formed in twice the digits where doubles do not do
_MOST_SHARP = 200_000


@dataclass(frozen=True)
class Multipliers:
    """Floats beside exact multipliers of ``sum <coefficients, Z_j> = cost``, scaled coordinates.

    Attributes
    ----------
    z : tuple of ndarray
    low, high : float
        Bounds on the sum of <constant part, Z_j> of the exact ones.
    distance : float
        Bound on the distance of all of z to the exact ones.
    strict : bool
        Whether a strict inequality is proved to carry weight.
    """

    z: tuple[np.ndarray, ...]
    low: float
    high: float
    distance: float
    strict: bool

    @property
    def refute(self) -> bool:
        """Whether multipliers of cost zero refute their program."""
        return self.high < 0 or (self.high <= 0 and self.strict)


class System:
    """The equations of the multipliers of a scaled program.

    Parameters
    ----------
    scaled : Scaled
    constraints : sequence of constraints
    cost : ndarray
        Right side; zero for a refutation.
    """

    def __init__(self, scaled: scaling.Scaled, constraints: Sequence, cost: np.ndarray) -> None:
        self.scaled, self.constraints, self.cost = scaled, constraints, cost
        flat = [t.reshape(-1, len(cost)) for t in scaled.tensors]
        stack = np.vstack(flat)
        self.sizes = np.linalg.norm(stack, axis=0) * (1 + gamma(len(stack)))
        self._kept = independent(stack, cost)

    def solvable(self) -> bool:
        """Whether the unknowns whose equations are left out are known to follow from the others."""
        return self._kept is not None

    @property
    def kept(self) -> np.ndarray:
        """Unknowns whose equations are solved: the others follow from them, where that is known."""
        assert self._kept is not None, "ask `solvable` first"
        return self._kept

    def confined(self, multipliers: Sequence[np.ndarray], cut: float) -> Multipliers | None:
        """Prove multipliers ``L (I + E) L'`` with a small E, L a factor of what the given ones have above a cut.

        Steps are measured by E, so that they leave a multiplier positive whatever the sizes of its entries.
        """
        stated = self._stated(multipliers, cut)
        if stated is None:
            return None
        for sharp in (False, True) if self._few() else (False,):
            corrected = self._corrected(*stated, sharp)
            if corrected is not None:
                return corrected
        return None

    def _few(self) -> bool:
        return sum(t.size for t in self.scaled.tensors) <= _MOST_SHARP

    def _corrected(
        self, frames: list[np.ndarray], mask: np.ndarray, units: np.ndarray, inverse: RightInverse, sharp: bool
    ) -> Multipliers | None:
        """The proof of `confined` within frames, by residuals in doubles or, sharp, in twice their digits."""
        cores = self._cores(frames)
        for number in range(3):
            z, wide = assembled(self.constraints, frames, cores)
            rest, bound = self._sharp_rest(frames, cores) if sharp else self._rest(z, wide)
            if number < 2:
                steps = steps_of(inverse.matrix @ (units * rest[mask]), cores)
                cores = [c - e for c, e in zip(cores, steps, strict=True)]
        reach = inverse.reach(norm(units * bound[mask]))
        strict, distance, linear, blur = False, 0.0, [], 0.0
        for constraint, constant, frame, core in zip(
            self.constraints, self.scaled.constants, frames, cores, strict=True
        ):
            if isinstance(constraint, Definite):
                if core.size and not proved_positive(core, reach * np.eye(len(core))):
                    return None
                strict = strict or (core.size > 0 and is_strict(constraint))
                distance += reach * norm(frame) ** 2
                linear.append(congruent(constant[..., None], frame).ravel())
                blur += 2 * gamma(2 * len(frame)) * norm(congruent(np.abs(constant)[..., None], np.abs(frame)))
            else:
                if isinstance(constraint, Entrywise) and core.size and core.min() < reach:
                    return None
                distance += reach * norm(frame)
                linear.append(frame.T @ constant)
                blur += gamma(len(frame)) * norm(np.abs(frame).T @ np.abs(constant))
        value = inverse.change(np.concatenate(linear), units * bound[mask]) + blur * reach
        return self._bounded(z, wide, distance, value, strict)

    def restored(self, multipliers: Sequence[np.ndarray]) -> list[np.ndarray] | None:
        """Floats inside the cones whose equations hold nearly, by steps that stay inside; None where they do not end.

        A solver that stalls leaves equations further from zero than its multipliers are from the edge of their cones.
        """
        z = list(multipliers)
        for _ in range(_RESTORING):
            stated = self._stated(z, 0.0)
            if stated is None:
                return None
            frames, mask, units, inverse = stated
            cores = self._cores(frames)
            z, wide = assembled(self.constraints, frames, cores)
            rest, _ = self._rest(z, wide)
            steps = steps_of(inverse.matrix @ (units * rest[mask]), cores)
            longest = max((most_lost(c, e) for c, e in zip(self.constraints, steps, strict=True)), default=0.0)
            part = min(1.0, _PART / longest) if longest > 0 else 1.0
            cores = [c - part * e for c, e in zip(cores, steps, strict=True)]
            z, _ = assembled(self.constraints, frames, cores)
            if part == 1:
                return z
        return None

    def _cores(self, frames: Sequence[np.ndarray]) -> list[np.ndarray]:
        return [
            np.eye(f.shape[1]) if isinstance(c, Definite) else np.ones(f.shape[1])
            for c, f in zip(self.constraints, frames, strict=True)
        ]

    def _needed(self, frames: Sequence[np.ndarray]) -> np.ndarray:
        """Whether each equation is to be solved: it holds something, or a right side."""
        return ~(self._met(frames) & (self.cost[self.kept] == 0))

    def _stated(
        self, multipliers: Sequence[np.ndarray], cut: float
    ) -> tuple[list[np.ndarray], np.ndarray, np.ndarray, RightInverse] | None:
        """The equations within the frames of multipliers: frames, equations to be solved, their units, an inverse."""
        frames = self._frames(multipliers, cut)
        if frames is None:
            return None
        mask = self._needed(frames)
        solved = self._within(frames, mask)
        return None if solved is None else (frames, mask, *solved)

    def _within(self, frames: Sequence[np.ndarray], mask: np.ndarray) -> tuple[np.ndarray, RightInverse] | None:
        """Equations in the cores of frames, in units that even them out: the units, and a right inverse."""
        columns, sizes = [], []
        for constraint, tensor, frame in zip(self.constraints, self._tensors(), frames, strict=True):
            part = tensor if mask.all() else tensor[..., mask]
            if isinstance(constraint, Definite):
                shape = (frame.shape[1] ** 2, part.shape[-1])
                columns.append(congruent(part, frame).reshape(shape))
                sizes.append(congruent(np.abs(part), np.abs(frame)).reshape(shape))
            else:
                columns.append(frame.T @ part)
                sizes.append(np.abs(frame).T @ np.abs(part))
        stack = np.vstack(columns)
        with np.errstate(over="ignore"):  # of multipliers that run away
            lengths = np.linalg.norm(stack, axis=0)
        if not (np.isfinite(lengths) & (lengths > 0)).all():
            return None
        units = power_of_two(1 / lengths)
        stack = stack * units
        longest = max((len(f) for f in frames), default=1)
        blur = 2 * gamma(2 * longest) * norm(np.vstack(sizes) * units)
        inverse = RightInverse.of(stack.T, blur)
        return None if inverse is None else (units, inverse)

    def _frames(self, multipliers: Sequence[np.ndarray], cut: float) -> list[np.ndarray] | None:
        """Factors L of matrices, Z = L L', and diagonal ones of lists, without what is below the cut."""
        top = largest(self.constraints, multipliers)
        frames = []
        for constraint, z in zip(self.constraints, multipliers, strict=True):
            if isinstance(constraint, Equal):
                frames.append(np.diag(np.maximum(np.abs(z), 1e-3 * top + 1e-300)))
            elif isinstance(constraint, Definite) and cut > 0:
                values, vectors = np.linalg.eigh(z)
                large = values > cut * top
                frames.append(vectors[:, large] * np.sqrt(values[large]))
            elif isinstance(constraint, Definite):
                try:
                    frames.append(np.linalg.cholesky(z))
                except np.linalg.LinAlgError:
                    return None
            else:
                frames.append(np.diag(z)[:, z > cut * top])
                if cut <= 0 and not (z > 0).all():
                    return None
        return frames

    def _rest(self, z: Sequence[np.ndarray], wide: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Residual of the equations, and a bound on it for all multipliers within `wide` of z."""
        total = -self.cost[self.kept]
        sizes = np.abs(total)
        spread = np.zeros(len(total))
        for tensor, m, error in zip(self._tensors(), z, wide, strict=True):
            axes = m.ndim
            total = total + np.tensordot(m, tensor, axes)
            large = np.abs(tensor)
            sizes = sizes + np.tensordot(np.abs(m), large, axes)
            spread = spread + np.tensordot(error, large, axes)
        count = sum(m.size for m in z) + len(z) + 2
        return total, np.abs(total) + gamma(count) * sizes + spread * (1 + gamma(count))

    def _sharp_rest(self, frames: Sequence[np.ndarray], cores: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Residual of the equations at the products of frames and cores themselves, and a bound on it."""
        high: list[np.ndarray] = []
        low: list[np.ndarray] = []
        sizes: list[np.ndarray] = []
        for frame, core in zip(frames, cores, strict=True):
            factors = (frame, core, frame.T) if core.ndim == 2 else (frame, core[:, None])
            product = twofold(*factors)
            large = np.abs(factors[0])
            for factor in factors[1:]:
                large = large @ np.abs(factor)
            for kept, part in zip((high, low, sizes), (*product, large), strict=True):
                kept.append(part.ravel())
        rows = np.vstack([t.reshape(-1, t.shape[-1]) for t in self._tensors()])
        cost = self.cost[self.kept]
        total = residual(np.vstack([rows, rows]).T, -cost, np.concatenate([*high, *low]))
        return total, np.abs(total) * (1 + gamma(1)) + 2.0**-98 * (
            np.abs(rows).T @ np.concatenate(sizes) + np.abs(cost)
        )

    def _met(self, frames: Sequence[np.ndarray]) -> np.ndarray:
        """Unknowns that no entry within the frames holds: their equations are met whatever the cores."""
        free = np.ones(len(self.kept), dtype=np.bool_)
        for tensor, frame in zip(self._tensors(), frames, strict=True):
            rows = np.abs(frame).sum(axis=1) > 0
            part = tensor[rows][:, rows] if tensor.ndim == 3 else tensor[rows]
            free &= ~part.any(axis=tuple(range(part.ndim - 1)))
        return free

    def factored(self, multipliers: Sequence[np.ndarray], cut: float) -> Multipliers | None:
        """Prove multipliers Z_j = V_j V_j' of the rank that `cut` leaves, by Gauss-Newton and a contraction."""
        top = largest(self.constraints, multipliers)
        factors: list[np.ndarray] = []
        for constraint, near in zip(self.constraints, multipliers, strict=True):
            if isinstance(constraint, Definite):
                values, vectors = np.linalg.eigh(near)
                large = values > cut * top
                factors.append(vectors[:, large] * np.sqrt(values[large]))
            elif isinstance(constraint, Equal):
                factors.append(np.array(near))
            else:
                factors.append(np.sqrt(np.where(near > cut * top, near, 0.0)))
        if sum(f.size for f in factors) < len(self.kept):
            return None
        for number in range(6):
            slope, residual, blur, bound = self._linearised(factors)
            lengths = np.linalg.norm(slope, axis=1)
            if not (lengths > 0).all():
                return None
            units = power_of_two(1 / lengths)
            inverse = RightInverse.of(slope * units[:, None], blur * float(units.max()))
            if inverse is None:
                return None
            step = inverse.reach(norm(units * bound), norm(self.sizes[self.kept] * units))
            if number > 1 and np.isfinite(step):
                break
            move, place = -inverse.matrix @ (units * residual), 0
            for i, f in enumerate(factors):
                factors[i] = f + move[place : place + f.size].reshape(f.shape)
                place += f.size
        if not np.isfinite(step):
            return None
        z: list[np.ndarray] = []
        wide: list[np.ndarray] = []
        strict, distance, value = False, 0.0, 0.0
        for constraint, constant, f in zip(self.constraints, self.scaled.constants, factors, strict=True):
            if isinstance(constraint, Definite):
                z.append(f @ f.T)
                wide.append(2 * gamma(f.shape[1]) * np.abs(f) @ np.abs(f).T)
                strict = strict or (is_strict(constraint) and float(np.linalg.norm(f)) > 2 * step)
                own = 2 * norm(f) * step + step**2
                value += 2 * norm(np.abs(constant) @ np.abs(f)) * step + norm(constant) * step**2
            elif isinstance(constraint, Equal):
                z.append(f)
                wide.append(np.zeros_like(f))
                own = step
                value += norm(constant) * step
            else:
                z.append(f**2)
                wide.append(gamma(1) * f**2)
                own = 2 * norm(f) * step + step**2
                value += norm(constant) * own
            distance += own
        return self._bounded(z, wide, distance, value * (1 + 1e-9), strict)

    def _tensors(self) -> Iterator[np.ndarray]:
        for tensor in self.scaled.tensors:
            yield tensor if len(self.kept) == tensor.shape[-1] else tensor[..., self.kept]

    def _linearised(self, factors: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
        """Slope and residual of the equations at factors; bounds on the slope's error and on the residual."""
        slopes, total = [], -self.cost[self.kept]
        sizes = np.abs(total)
        blur = 0.0
        for constraint, tensor, f in zip(self.constraints, self._tensors(), factors, strict=True):
            if isinstance(constraint, Definite):
                half = np.einsum("ijk,jr->irk", tensor, f, optimize=True)
                slopes.append(2 * half.reshape(f.size, len(self.kept)))
                total = total + np.einsum("irk,ir->k", half, f)
                weight = np.abs(f) @ np.abs(f).T
                sizes = sizes + np.einsum("ijk,ij->k", np.abs(tensor), weight)
                blur += 2 * gamma(len(f)) * norm(tensor) * norm(f)
            elif isinstance(constraint, Equal):
                slopes.append(tensor)
                total = total + f @ tensor
                sizes = sizes + np.abs(f) @ np.abs(tensor)
            else:
                slopes.append(2 * f[:, None] * tensor)
                total = total + f**2 @ tensor
                sizes = sizes + f**2 @ np.abs(tensor)
                blur += 2 * gamma(1) * norm(tensor) * norm(f)
        terms = sum(f.size for f in factors) + sum(len(c) for c in self.scaled.constants) + 4
        return np.vstack(slopes).T, total, blur, np.abs(total) + gamma(terms) * sizes

    def _bounded(
        self, z: Sequence[np.ndarray], wide: Sequence[np.ndarray], distance: float, value: float, strict: bool
    ) -> Multipliers:
        """Gather floats z: off by `wide` from what lies within `distance` of exact ones, of a value off by `value`."""
        middle = sizes = spread = 0.0
        for m, error, c in zip(z, wide, self.scaled.constants, strict=True):
            middle += float(np.sum(m * c))
            sizes += float(np.sum(np.abs(m) * np.abs(c)))
            spread += float(np.sum(error * np.abs(c)))
        count = sum(m.size for m in z) + len(z)
        spread = value + spread * (1 + gamma(count)) + gamma(count) * sizes
        distance += float(np.sqrt(sum(norm(e) ** 2 for e in wide)))
        return Multipliers(tuple(z), middle - spread, middle + spread, distance, strict)

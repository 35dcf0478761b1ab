"""Multipliers from the central path: inside their cones, in the shape that the program itself gives them.

One Newton step for ``cost . x / mu - sum log det F_j(x)`` from a point x leaves ``Z_j = mu (G - G dF_j G)``, G the
inverse of F_j(x) and dF_j its change: they satisfy the equations of the multipliers but for rounding, and are positive
where the step is short. A solver's multipliers lie on the edge; pushed inside by multiples of the identity they lose
their value where the cone of those that satisfy the equations is narrow in other directions.

Reference: S. Boyd, L. Vandenberghe, Convex Optimization, Cambridge 2004, sections 11.6 and 11.8.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from gainsay.lmi.affine import Definite, Equal
from gainsay.lmi.scaling import Scaled

__all__ = ["central_path", "is_small"]

# length of a Newton step, in the metric of the point, below which it is taken whole, and the next mu is tried
_SHORT = 0.3
_MOST_STEPS = 60
# least mu to begin with: points very near the optimum are far from the path in the metric of its end
_FIRST = 1e-3
# most that a step is lengthened
_FURTHEST = 100.0
# coefficients up to which a step costs less than a run of the solver
_MOST = 200_000
# a mu over the one before
_FALL = 0.2


def central_path(
    scaled: Scaled, constraints: Sequence, x: np.ndarray, least: float
) -> Iterator[tuple[float, np.ndarray, list[np.ndarray]]]:
    """Follow the central path from a point inside; end where a step fails.

    Parameters
    ----------
    scaled : Scaled
    constraints : sequence of constraints
    x : ndarray
        Where every inequality holds strictly.
    least : float
        Value of mu at which to end.

    Yields
    ------
    tuple of (mu, x, multipliers)
        The gap of the two is about mu times the rows of all inequalities. Floats, proved nothing.
    """
    equations = [
        (t, c) for t, c, of in zip(scaled.tensors, scaled.constants, constraints, strict=True) if isinstance(of, Equal)
    ]
    rows = np.vstack([t for t, _ in equations]) if equations else np.zeros((0, len(x)))
    right = np.concatenate([c for _, c in equations]) if equations else np.zeros(0)
    mu = None
    while mu is None or mu > least:
        for _ in range(_MOST_STEPS):
            seen = _Seen.of(scaled, constraints, x)
            if seen is None:
                return
            mu = max(seen.best_mu(scaled.cost), _FIRST) if mu is None else mu
            newton = seen.step(scaled.cost / mu, rows, rows @ x + right)
            if newton is None:
                return
            step, weights = newton
            length = seen.length(step)
            if not np.isfinite(length):
                return
            if length < _SHORT:
                break
            x = x + seen.part(step, float(scaled.cost @ step) / mu) * step
        else:
            return
        yield mu, x + step, seen.multipliers(mu, step, -mu * weights)
        x, mu = x + step, _FALL * mu


def is_small(scaled: Scaled) -> bool:
    """Whether following the central path costs no more than a few runs of a solver."""
    return sum(tensor.size for tensor in scaled.tensors) <= _MOST


def _kernel(rows: np.ndarray) -> np.ndarray:
    """Orthonormal basis of what the rows do not see."""
    values, vectors = np.linalg.svd(rows)[1:]
    return vectors[int((values > 1e-12 * values.max(initial=0.0)).sum()) :].T


class _Seen:
    """A program in the metric of a point: every inequality is the identity there."""

    def __init__(self, constraints: Sequence, back: list[np.ndarray | None], slopes: list[np.ndarray]) -> None:
        self.constraints, self.back = constraints, back
        self.slopes = slopes
        self.stack = np.vstack([s.reshape(-1, s.shape[-1]) for s in slopes])
        self.rise = np.concatenate([(np.eye(len(s)) if s.ndim == 3 else np.ones(len(s))).ravel() for s in slopes])

    @classmethod
    def of(cls, scaled: Scaled, constraints: Sequence, x: np.ndarray) -> "_Seen | None":
        """None where an inequality does not hold strictly."""
        back: list[np.ndarray | None] = []
        slopes = []
        for constraint, tensor, constant in zip(constraints, scaled.tensors, scaled.constants, strict=True):
            if isinstance(constraint, Equal):
                back.append(None)
                continue
            value = constant + tensor @ x
            if not np.isfinite(value).all():
                return None
            if isinstance(constraint, Definite):
                try:
                    inverse = np.linalg.inv(np.linalg.cholesky((value + value.T) / 2))
                except np.linalg.LinAlgError:
                    return None
                half = np.tensordot(inverse, tensor, (1, 0))
                slopes.append(np.tensordot(half, inverse, (1, 1)).transpose(0, 2, 1))
                back.append(inverse)
            else:
                if not (value > 0).all():
                    return None
                slopes.append(tensor / value[:, None])
                back.append(1 / value)
        return cls(constraints, back, slopes) if slopes else None

    def best_mu(self, cost: np.ndarray) -> float:
        """The mu at which the point is nearest to the central path."""
        units = 1 / np.maximum(np.linalg.norm(self.stack, axis=0), 1e-300)
        along = np.linalg.lstsq((self.stack * units).T, cost * units, rcond=None)[0]
        size = float(along @ along)
        towards = float(along @ self.rise)
        return size / towards if towards > 0 else float(np.sqrt(size))

    def step(self, cost: np.ndarray, rows: np.ndarray, rest: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """Newton's step onto the equations, and their weights; normal equations would lose half the digits."""
        units = 1 / np.maximum(np.linalg.norm(self.stack, axis=0), np.abs(rows).max(axis=0, initial=1e-300))
        stack, scaled, cost = self.stack * units, rows * units, cost * units
        try:
            onto = -np.linalg.lstsq(scaled, rest, rcond=None)[0] if len(rows) else np.zeros(len(units))
            free = _kernel(scaled) if len(rows) else np.eye(len(units))
            left, right = np.linalg.qr(stack @ free)
            down = left.T @ (self.rise - stack @ onto) - np.linalg.solve(right.T, free.T @ cost)
            step = onto + free @ np.linalg.solve(right, down)
            slope = stack.T @ (self.rise - stack @ step) - cost
            weights = np.linalg.lstsq(scaled.T, slope, rcond=None)[0] if len(rows) else np.zeros(0)
        except np.linalg.LinAlgError:
            return None
        return units * step, weights

    def length(self, step: np.ndarray) -> float:
        """Length of a step in the metric of the point."""
        return float(np.linalg.norm(self.stack @ step))

    def part(self, step: np.ndarray, slope: float) -> float:
        """The part of a step that goes furthest down along it, by halving; `slope` is that of the cost."""
        changes = [s @ step for s in self.slopes]
        along = np.concatenate([np.linalg.eigvalsh(c) if c.ndim == 2 else c for c in changes])
        low, high = 0.0, min(1 / max(-along.min(), 1e-300), _FURTHEST)
        for _ in range(40):
            middle = (low + high) / 2
            low, high = (low, middle) if slope > (along / (1 + middle * along)).sum() else (middle, high)
        return low

    def multipliers(self, mu: float, step: np.ndarray, weights: np.ndarray) -> list[np.ndarray]:
        """Multipliers that a step leaves; `weights` are those of all equations."""
        multipliers, place, slopes = [], 0, iter(self.slopes)
        for constraint, inverse in zip(self.constraints, self.back, strict=True):
            if inverse is None:
                size = int(np.prod(constraint.expression.shape))
                multipliers.append(weights[place : place + size])
                place += size
                continue
            change = next(slopes) @ step
            if inverse.ndim == 2:
                multipliers.append(mu * inverse.T @ (np.eye(len(change)) - change) @ inverse)
            else:
                multipliers.append(mu * inverse * (1 - change))
        return multipliers

"""The steps of the delay collocation, prepared in blocks: the Gauss rule, where stages read, and the maps of rows."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gainsay.errors import InputError


@dataclass(frozen=True)
class Collocation:
    """Gauss-Legendre collocation with s points on [0, 1].

    Attributes
    ----------
    nodes : ndarray, shape (s,)
    integrals : ndarray, shape (s, s)
        integrals[i, j]: integral of the j-th Lagrange polynomial from 0 to node i.
    weights : ndarray, shape (s,)
    powers : ndarray, shape (s, s)
        Monomial coefficients of the Lagrange polynomials, powers[j, k] of theta^k.
    """

    nodes: np.ndarray
    integrals: np.ndarray
    weights: np.ndarray
    powers: np.ndarray

    @classmethod
    def gauss(cls, stages: int) -> "Collocation":
        """Return the rule with the given number of points, 1..8."""
        if not isinstance(stages, int) or not 1 <= stages <= 8:
            raise InputError("", field="stages", value=stages, expected="1..8")
        x, w = np.polynomial.legendre.leggauss(stages)
        nodes = (1 + x) / 2
        powers = np.linalg.inv(np.vander(nodes, increasing=True)).T
        rule = cls(nodes, np.empty((0, 0)), w / 2, powers)
        return cls(nodes, rule.partial(nodes), w / 2, powers)

    def lagrange(self, theta: np.ndarray) -> np.ndarray:
        """Lagrange polynomials at theta; shape theta.shape + (s,)."""
        theta = np.asarray(theta, dtype=float)
        return theta[..., None] ** np.arange(len(self.nodes)) @ self.powers.T

    def partial(self, theta: np.ndarray) -> np.ndarray:
        """Integrals of the Lagrange polynomials from 0 to theta; shape theta.shape + (s,)."""
        theta = np.asarray(theta, dtype=float)
        k = np.arange(1, len(self.nodes) + 1)
        return (theta[..., None] ** k / k) @ self.powers.T


@dataclass(frozen=True)
class Reading:
    """Where every stage reads the delayed signal.

    Attributes
    ----------
    reach : ndarray of int, shape (m, s)
        How many intervals back, 0 for the stage's own; the history stands just before the first interval.
    weights : ndarray, shape (m, s, 1 + s)
        Of the value at that interval's left end and of h times its slopes.
    """

    reach: np.ndarray
    weights: np.ndarray

    @classmethod
    def of(cls, law: Callable, rule: Collocation, mesh: np.ndarray, h: np.ndarray, times: np.ndarray) -> "Reading":
        """Find what every stage at `times` reads on the mesh, whose intervals have the lengths h."""
        delayed = times - law(times)
        own = np.arange(len(h))[:, None]
        # a delay that vanishes to rounding may put t - d(t) a hair beyond its own interval
        at = np.minimum(np.searchsorted(mesh, delayed, side="right") - 1, own)
        theta = np.where(at < 0, 0.0, (delayed - mesh[at]) / h[np.maximum(at, 0)])
        return cls(own - at, np.concatenate([np.ones((*theta.shape, 1)), rule.partial(theta)], axis=2))

    def __getitem__(self, block: slice) -> "Reading":
        return Reading(self.reach[block], self.weights[block])


@dataclass(frozen=True)
class Steps:
    """A block of intervals as maps of the rows before each: everything but the rows themselves, computed at once.

    With u the `depth` rows before interval k, one after the other, its delayed stage values are V_k u + v_k, its
    slopes S x + D (V_k u + v_k) + f_k, and its own row M_k u + m_k.

    Attributes
    ----------
    depth : int
        Rows that a step sees.
    delayed, row : tuple of (ndarray, ndarray)
        (V, v) and (M, m), shapes (k, s r, depth w), (k, s r), (k, w, depth w), (k, w).
    from_state, from_delayed : ndarray
        S and D for every distinct step, shapes (q, s n, n) and (q, s n, s r).
    which : ndarray of int, shape (k,)
        Distinct step of every interval.
    forced : ndarray, shape (k, s n)
        f, solved for the slopes.
    """

    depth: int
    delayed: tuple[np.ndarray, np.ndarray]
    row: tuple[np.ndarray, np.ndarray]
    from_state: np.ndarray
    from_delayed: np.ndarray
    which: np.ndarray
    forced: np.ndarray

    @classmethod
    def of(
        cls,
        A: np.ndarray,
        Bd: np.ndarray,
        Cd: np.ndarray,
        rule: Collocation,
        h: np.ndarray,
        f: np.ndarray,
        reading: Reading,
    ) -> "Steps":
        """Prepare intervals of lengths h under the forcing f, shape (k, s, n)."""
        (n, r), s, count = Bd.shape, len(rule.nodes), len(h)
        width, depth = n + (s + 1) * r, max(1, int(reading.reach.max()))
        distinct, which = np.unique(h, return_inverse=True)
        # slopes Z = G (1 x A x + f + Bd v) with G = (I - h a x A)^-1
        solved = np.linalg.inv(np.eye(s * n) - distinct[:, None, None] * np.kron(rule.integrals, A))
        from_state, from_delayed = solved @ np.kron(np.ones((s, 1)), A), solved @ np.kron(np.eye(s), Bd)
        forced = np.empty((count, s * n))
        read, mean = np.kron(np.eye(s), Cd), np.kron(rule.weights, np.eye(n))
        # what the row of an interval takes from its slopes
        take = np.vstack([mean, np.zeros((r, s * n)), read])
        known = np.zeros((count, s, r, depth, width))  # of the delayed stage values, by the rows before
        inside = reading.reach == 0
        k, i = np.nonzero(~inside)
        for channel in range(r):
            places = n + channel + r * np.arange(s + 1)
            known[k[:, None], i[:, None], channel, depth - reading.reach[k, i][:, None], places] = reading.weights[k, i]
        # stages that read their own interval see its slopes: (I - E) v = what is known
        couple = np.where(inside[:, :, None], reading.weights[:, :, 1:], 0.0) * h[:, None, None]
        E, free = np.empty((count, s * r, s * r)), np.empty((count, s * r))
        for number, G in enumerate(solved):
            at = which == number
            forced[at] = f[at].reshape(-1, s * n) @ G.T
            own = couple[at]
            state = (read @ from_state[number]).reshape(s, r * n)
            known[at, :, :, -1, :n] += inside[at][:, :, None, None] * Cd + (own @ state).reshape(-1, s, r, n)
            E[at] = (own @ (read @ from_delayed[number]).reshape(s, r * s * r)).reshape(-1, s * r, s * r)
            free[at] = (own @ (forced[at] @ read.T).reshape(-1, s, r)).reshape(-1, s * r)
        right = np.concatenate([known.reshape(count, s * r, depth * width), free[:, :, None]], axis=2)
        right = np.linalg.solve(np.eye(s * r) - E, right)
        V, v = right[:, :, :-1], right[:, :, -1]
        M, m = np.empty((count, width, depth * width)), h[:, None] * (forced @ take.T)
        last = (depth - 1) * width
        for number, value in enumerate(distinct):
            at = which == number
            D, S = value * take @ from_delayed[number], value * take @ from_state[number]
            S[:n] += np.eye(n)
            S[n : n + r] += Cd
            M[at] = D @ V[at]
            M[at, :, last : last + n] += S
            m[at] += v[at] @ D.T
        return cls(depth, (V, v), (M, m), from_state, from_delayed, which, forced)

    def run(self, rows: np.ndarray) -> None:
        """Fill all rows but the first `depth`."""
        flat, width, seen = rows.reshape(-1), rows.shape[1], self.depth * rows.shape[1]
        for start, M, m in zip(range(0, len(flat), width), *self.row, strict=False):
            flat[start + seen : start + seen + width] = M @ flat[start : start + seen] + m

    def slopes(self, rows: np.ndarray) -> np.ndarray:
        """Slopes of every interval from the rows before the last, shape (k, s, n)."""
        width, n = rows.shape[1], self.from_state.shape[2]
        seen = np.lib.stride_tricks.sliding_window_view(rows.reshape(-1), self.depth * width)[::width]
        V, v = self.delayed
        values = (V @ seen[:, :, None])[:, :, 0] + v
        x = seen[:, (self.depth - 1) * width :][:, :n]
        slopes = self.forced.copy()
        for number, (S, D) in enumerate(zip(self.from_state, self.from_delayed, strict=True)):
            at = self.which == number
            slopes[at] += x[at] @ S.T + values[at] @ D.T
        return slopes.reshape(len(slopes), -1, n)

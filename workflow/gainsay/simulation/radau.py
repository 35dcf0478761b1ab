"""Radau IIA collocation of x' = M x + N g(t, x): the linear part solved at once, the rest by iteration.

The solution is a polynomial on every step, its derivative matching at the Radau points. A stiff linear part (a fast
observer beside a slow loop) limits no step, since the method is L-stable; the rest must vary little over a step.

References
----------
E. Hairer, G. Wanner, "Solving Ordinary Differential Equations II", 2nd ed., Springer, 1996, sections IV.5 and IV.8.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre


@dataclass(frozen=True)
class Radau:
    """The rule with s points on [0, 1], the last of which is 1.

    Attributes
    ----------
    stages : int
    """

    stages: int

    @cached_property
    def nodes(self) -> np.ndarray:
        """The points, roots of P_s - P_{s-1} carried to [0, 1]; shape (s,)."""
        roots = legendre.legroots([*np.zeros(self.stages - 1), -1.0, 1.0])
        return np.append((1 + roots[:-1]) / 2, 1.0)

    @cached_property
    def highest(self) -> np.ndarray:
        """Rows that take from slopes what their two highest Legendre polynomials add to the state; shape (2, s)."""
        return (self._values * self._weights[:, None]).T[-2:]

    def integrals(self, theta: np.ndarray) -> np.ndarray:
        """Integrals of the Lagrange polynomials from 0 to theta, shape (k, s); k points theta."""
        p = legendre.legvander(2 * np.asarray(theta) - 1, self.stages)
        # of (2 k + 1) P_k: (P_{k+1} - P_{k-1}) / 2
        parts = np.column_stack([(1 + p[:, 1]) / 2, (p[:, 2:] - p[:, :-2]) / 2])
        return parts @ (self._values * self._weights[:, None]).T

    @cached_property
    def amplification(self) -> float:
        """What slopes of modulus 1 at the points change the state by at most, anywhere in a step of length 1."""
        fine = np.linspace(0.0, 1.0, 100 * self.stages)
        return 1.01 * float(np.abs(self.integrals(fine)).sum(axis=1).max())  # between the fine points it grows little

    @cached_property
    def _weights(self) -> np.ndarray:
        return np.linalg.solve(self._values.T, np.eye(self.stages)[0])  # the mean of P_k is zero but for P_0

    @cached_property
    def _values(self) -> np.ndarray:
        """Legendre polynomials below degree s at the points, shape (s, s)."""
        return legendre.legvander(2 * self.nodes - 1, self.stages - 1)


@dataclass(frozen=True)
class Step:
    """A step of one length as maps of the state before it, shape (n, m) of m flights, and of the rest g, (s q, m).

    Attributes
    ----------
    slopes, states : tuple of (ndarray, ndarray)
        Slopes and states at all points, one below the other: shapes (s n, n) and (s n, s q).
    """

    slopes: tuple[np.ndarray, np.ndarray]
    states: tuple[np.ndarray, np.ndarray]

    @classmethod
    def of(cls, rule: Radau, h: float, linear: np.ndarray, entry: np.ndarray) -> "Step":
        """Maps of a step of length h for x' = linear x + entry g, shapes (n, n) and (n, q)."""
        s, n = rule.stages, len(linear)
        integral = h * np.kron(rule.integrals(rule.nodes), np.eye(n))
        ones = np.kron(np.ones((s, 1)), np.eye(n))
        known = np.hstack([ones @ linear, np.kron(np.eye(s), entry)])
        slopes = np.linalg.solve(np.eye(s * n) - integral @ np.kron(np.eye(s), linear), known)
        states = integral @ slopes
        return cls((slopes[:, :n], slopes[:, n:]), (ones + states[:, :n], states[:, n:]))

"""The standard plant of H-infinity and H2 synthesis, its two kinds of loops, and what a synthesis hands back."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from gainsay.errors import InputError
from gainsay.systems.norm_bounds import NormBounds
from gainsay.systems.statespace import StateSpace, finite, square


@dataclass(frozen=True, eq=False, init=False)
class StandardPlant:
    """x' = A x + B1 w + B2 u, z = C1 x + D11 w + D12 u, y = C2 x + D21 w; in discrete time x' is the next state.

    Attributes
    ----------
    A, B1, B2, C1, C2 : ndarray
        Shapes (n, n), (n, w), (n, u), (z, n), (y, n).
    D11, D12, D21 : ndarray
        Shapes (z, w), (z, u), (y, w); zero where None.

    Raises
    ------
    InputError
        If shapes do not fit together or an entry is not finite.
    """

    A: np.ndarray
    B1: np.ndarray
    B2: np.ndarray
    C1: np.ndarray
    C2: np.ndarray
    D11: np.ndarray
    D12: np.ndarray
    D21: np.ndarray

    def __init__(
        self,
        A: ArrayLike,
        B1: ArrayLike,
        B2: ArrayLike,
        C1: ArrayLike,
        C2: ArrayLike,
        D11: ArrayLike | None = None,
        D12: ArrayLike | None = None,
        D21: ArrayLike | None = None,
    ) -> None:
        object.__setattr__(self, "A", square(A, "A"))
        B1, B2, C1, C2 = finite(B1, "B1"), finite(B2, "B2"), finite(C1, "C1"), finite(C2, "C2")
        n, w, u, z, y = len(self.A), B1.shape[1], B2.shape[1], C1.shape[0], C2.shape[0]
        for name, given, shape in (
            ("B1", B1, (n, w)),
            ("B2", B2, (n, u)),
            ("C1", C1, (z, n)),
            ("C2", C2, (y, n)),
            ("D11", D11, (z, w)),
            ("D12", D12, (z, u)),
            ("D21", D21, (y, w)),
        ):
            value = np.zeros(shape) if given is None else finite(given, name)
            if value.shape != shape or 0 in shape:
                raise InputError("plant", field=name, value=value.shape, expected=f"shape {shape}, none of it zero")
            object.__setattr__(self, name, value)

    def with_gain(self, K: np.ndarray) -> StateSpace:
        """Loop from w to z under u = K x."""
        return StateSpace(self.A + self.B2 @ K, self.B1, self.C1 + self.D12 @ K, self.D11)

    def with_controller(self, K: StateSpace) -> StateSpace:
        """Loop from w to z under the controller K from y to u."""
        through = self.B2 @ K.D
        A = np.block([[self.A + through @ self.C2, self.B2 @ K.C], [K.B @ self.C2, K.A]])
        B = np.vstack([self.B1 + through @ self.D21, K.B @ self.D21])
        C = np.hstack([self.C1 + self.D12 @ K.D @ self.C2, self.D12 @ K.C])
        return StateSpace(A, B, C, self.D11 + self.D12 @ K.D @ self.D21)


@dataclass(frozen=True, eq=False)
class Synthesis:
    """A controller and what is known of the loop that it closes.

    Attributes
    ----------
    controller : ndarray or StateSpace
        State feedback gain K, shape (u, n), of u = K x, or the system from y to u.
    norm : NormBounds
        Of the loop from w to z, proved for the gains as they stand.
    least : float
        No controller of the kind reaches less, to rounding: from checked multipliers (H-infinity), or the optimum of
        the Riccati equations, which the loop reaches to 1e-7 (H2; `h2_least` proves one in continuous time).
    """

    controller: np.ndarray | StateSpace
    norm: NormBounds
    least: float

"""Disk of (10) with given gains, proved over boxes of inertia and gain variation.

Inputs are the delta_i of (6), of which J, D and G depend, and the variation of A_f, B_f and C_f, each common to all
entries of its matrix: 1 + delta times the gain. The loop is expanded about the middle of a box to first order in the
inputs, exactly but for a remainder that is bounded entry by entry; in the coordinates of a Lyapunov matrix of the
middle the first-order part is convex in the inputs, so that the corners of the box bound its norm.
"""

from itertools import product

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from gainsay.lmi.rounding import gamma, norm, proved_positive
from gainsay.systems.enclosed_spectra import OUTSIDE, resolved
from gainsay.tables import Case
from papers.li2021 import plant

#: relative size of what rounding leaves out of an entry of the loop: sums of a few products of doubles nearest to exact
_ROUNDING = gamma(40)
#: search of coordinates: rounds, weight of the steps against the loop, part kept of the coordinates before
_ROUNDS, _WEIGHT, _FLOOR = 30, 8.0, 1e-3
#: where between the poles and the border of the disk the disks of the other coordinates lie
_PARTS = (0.4, 0.7)


class GainBox:
    """Test of boxes for `gainsay.campaigns.box.branch`.

    Parameters
    ----------
    case : Case
    controller : str
        As for `papers.li2021.plant.controller`.
    """

    INPUTS = ("inertia_1", "inertia_2", "inertia_3", "variation_a", "variation_b", "variation_c")

    def __init__(self, case: Case, controller: str) -> None:
        self.centre, self.radius = case.number("disk_centre"), case.number("disk_radius")
        self.k = plant.constants(case)
        self.gains = plant.controller(case, controller)
        self.corners = np.array(list(product((-1.0, 1.0), repeat=len(self.INPUTS))))
        n, F = self.k.orbital_rate, self.k.coupling
        self.FtF = F.T @ F
        self.envelope = np.array(self.k.envelope)
        eye = np.eye(3)
        # G and D are linear in J
        self.by_inertia = [
            np.hstack([plant.gravity_gradient(n, tuple(e)), plant.gyroscopic(n, tuple(e)), np.zeros((3, 6))])
            for e in eye * self.envelope[:, None]
        ]
        self.fixed = np.hstack([np.zeros((3, 3)), -self.FtF @ plant.rate_of_frame(n), np.zeros((3, 6))])

    def __call__(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Outcome of each box: 1 proved inside the disk, -1 a point of it proved outside, 0 neither; where to halve.

        A box is halved across the input that moves the loop most.
        """
        judgements = [self.judged(a, b) for a, b in zip(low, high, strict=True)]
        return np.array([outcome for outcome, _ in judgements]), np.array([axis for _, axis in judgements])

    def judged(self, low: np.ndarray, high: np.ndarray) -> tuple[int, int]:
        """Outcome of one box, and the input that moves the loop most."""
        middle = (low + high) / 2
        half = np.maximum(high - middle, middle - low) * (1 + 1e-15)
        loop, slopes, remainder, rounding = self.expanded(middle, half)
        steps = slopes * half[:, None, None]
        (T, Z), *others = self.coordinates(loop, steps)
        axis = int(np.argmax(np.linalg.norm(T @ steps @ Z, axis=(-2, -1))))
        here = resolved(loop, lambda s: np.abs(s + self.centre) - self.radius, rounding)
        if here == OUTSIDE:
            return -1, axis
        return int(any(self.holds(loop, steps, remainder, *pair) for pair in ((T, Z), *others))), axis

    def coordinates(self, loop: np.ndarray, steps: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Coordinates T x in which the loop of the middle and its steps may be small together, with near inverses.

        In the first T'T is near the fixed point of A'PA + w sum S'PS, which a loop whose inputs were noise would have;
        in the others it is a solution of Stein's equation of the loop alone, for boxes so small that the steps say
        little. Any T would do: what is proved in it is proved.
        """
        moved = (loop + self.centre * np.eye(12)) / self.radius
        size = np.sqrt(np.abs(np.diagonal(solve_discrete_lyapunov(moved, np.eye(12)))) + 1e-12)
        P = start = np.diag(1 / size**2)
        for _ in range(_ROUNDS):
            following = moved.T @ P @ moved + _WEIGHT * np.einsum("kji,jl,klm->im", steps, P, steps, optimize=True)
            P = (following + following.T) / (2 * np.trace(following)) + _FLOOR * P
        reach = min(float(np.abs(np.linalg.eigvals(moved)).max()), 0.999)
        # Stein's equation for a disk between the poles and the border: what is left of it is for the steps
        alone = [solve_discrete_lyapunov(moved.T / (reach + part * (1 - reach)), start) for part in _PARTS]
        coordinates = []
        for candidate in (P, *((one + one.T) / 2 for one in alone)):
            try:
                T = np.linalg.cholesky(candidate + 1e-9 * np.diag(np.abs(np.diagonal(candidate)))).T
            except np.linalg.LinAlgError:
                T = np.diag(1 / size)
            coordinates.append((T, np.linalg.inv(T)))
        return coordinates

    def rows(self, middle: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
        """Inverse mass matrix, the rows N of M (10) N in the rates, and their slopes by input."""
        J = np.array(self.k.inertia) + self.envelope * middle[:3]
        n = self.k.orbital_rate
        inverse = np.linalg.inv(np.diag(J) - self.FtF)
        torque = np.hstack([np.zeros((3, 6)), self.gains.C])
        nominal = np.hstack([plant.gravity_gradient(n, tuple(J)), plant.gyroscopic(n, tuple(J)), np.zeros((3, 6))])
        N = -(nominal + self.fixed) + (1 + middle[5]) * torque
        return inverse, N, [*(-part for part in self.by_inertia), 0 * torque, 0 * torque, torque]

    def expanded(self, middle: np.ndarray, half: np.ndarray) -> tuple[np.ndarray, ...]:
        """Loop at the middle, its slopes by input, a bound on what they leave out over the box, and on rounding."""
        inverse, N, parts = self.rows(middle)
        m = len(self.INPUTS)
        loop, slopes, rest = np.zeros((12, 12)), np.zeros((m, 12, 12)), np.zeros((12, 12))
        loop[:3, 3:6] = np.eye(3)
        loop[3:6] = inverse @ N
        loop[6:, :3] = (1 + middle[4]) * self.gains.B
        loop[6:, 6:] = (1 + middle[3]) * self.gains.A
        slopes[4, 6:, :3], slopes[3, 6:, 6:] = self.gains.B, self.gains.A
        for i in range(m):
            slopes[i, 3:6] += inverse @ parts[i]
            if i < 3:
                turned = np.zeros((3, 3))
                turned[i, i] = self.envelope[i]
                slopes[i, 3:6] -= inverse @ turned @ inverse @ N
        rounding = self._rounding(middle, inverse, loop, N)
        # M^-1 over the box: |M^-1| <= (I - |Mc^-1| D)^-1 |Mc^-1|, as a geometric series that must fall
        size, D = np.abs(inverse), np.diag(np.abs(self.envelope) * half[:3])
        first = size @ D
        part = np.abs(first).sum(axis=1).max()
        if part >= 0.5:
            return loop, slopes, np.full((12, 12), np.inf), rounding
        most = size + first @ size + (part**2 / (1 - part)) * size.max(axis=0, keepdims=True)
        moved = sum(np.abs(p) * h for p, h in zip(parts, half, strict=True))
        rest[3:6] = first @ first @ most @ (np.abs(N) + moved) + first @ size @ moved
        return loop, slopes, rest * (1 + 1e-12) + 4 * rounding, rounding

    def _rounding(self, middle: np.ndarray, inverse: np.ndarray, loop: np.ndarray, N: np.ndarray) -> np.ndarray:
        """Bound on what rounding leaves out of the loop at the middle, entry by entry.

        The slopes times the half widths are at most the sizes that enter here, so that four times this covers them.
        """
        J = np.array(self.k.inertia) + np.abs(self.envelope)
        M = np.diag(np.array(self.k.inertia) + self.envelope * middle[:3]) - self.FtF
        sizes = np.diag(J) + np.abs(self.k.coupling).T @ np.abs(self.k.coupling)
        defect = np.abs(np.eye(3) - M @ inverse) + gamma(20) * (sizes @ np.abs(inverse) + np.eye(3))
        n = self.k.orbital_rate
        # terms of the sums in N, which may cancel
        terms = np.abs(N) + np.hstack(
            [np.full((3, 3), 8 * n * n * J.sum()), np.full((3, 3), 8 * n * sizes.sum()), np.abs(self.gains.C)]
        )
        left_out = _ROUNDING * np.abs(loop)
        left_out[3:6] += (2 * np.abs(inverse) @ defect + _ROUNDING * np.abs(inverse)) @ terms
        left_out[6:, :3] += _ROUNDING * np.abs(self.gains.B)
        left_out[6:, 6:] += _ROUNDING * np.abs(self.gains.A)
        return left_out * (1 + 1e-12) + 1e-18

    def holds(self, loop: np.ndarray, steps: np.ndarray, remainder: np.ndarray, T: np.ndarray, Z: np.ndarray) -> bool:
        """Prove the disk for the loop plus steps times numbers of at most one plus anything within the remainder."""
        if not np.isfinite(remainder).all():
            return False
        # the norm of X in coordinates Z^-1 x is that of Z^-1 X Z, and T is Z^-1 but for the defect
        defect = norm(np.eye(12) - T @ Z) + gamma(30) * norm(T) * norm(Z)
        room = (norm(np.abs(T) @ remainder @ np.abs(Z)) + 1e-300) * (1 + gamma(30))
        bound = self.radius * (1 - defect) - room
        if not bound > 0:
            return False
        shifted = loop + self.centre * np.eye(12)
        corners = T @ (shifted + np.tensordot(self.corners, steps, 1)) @ Z
        if not np.linalg.norm(corners, 2, axis=(-2, -1)).max() < bound:
            return False
        sizes = np.abs(T) @ (np.abs(shifted) + np.abs(steps).sum(axis=0)) @ np.abs(Z)
        error = 2 * gamma(60) * (sizes.T @ sizes) + 1e-18
        return all(proved_positive(bound**2 * (1 - 1e-15) * np.eye(12) - X.T @ X, error) for X in corners)

"""Synthesis by smooth minimisation: gains and scalings together, on the worst case that the certificates speak of.

The conditions of `conditions_arcs` and `conditions_robust`, read as functions of the gains, have gradients. Their
largest scaled norms over the circle (a scaling a point) and over the imaginary axis (one scaling, performance channel
included) are minimised by a quasi-Newton method; poles, static gain, torque and the flexible loop enter as
one-sided penalties. What comes out is only a candidate: the certificates are made and checked afterwards.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm
from scipy.optimize import minimize

from gainsay.errors import ComputationError
from papers.li2021 import plant
from papers.li2021.conditions_arcs import best_scaling
from papers.li2021.conditions_robust import MULTIPLIERS, OF_CHANNEL, SPREAD, Loop, loop

GAINS = 72
FREQUENCIES = (0.03, 0.06, 0.08, 0.1, 0.12, 0.15, 0.2, 0.3, 0.5)


@dataclass(frozen=True)
class Wishes:
    """What a design is to reach; None leaves a wish out.

    Parameters
    ----------
    delta_m : float
        Gain variation at which the scaled norms are minimised.
    gamma : float, optional
        Bound on the norm for the shared scaling on the imaginary axis.
    disk_radius, abscissa_flexible : float, optional
        Nominal bounds on |s + a| over the poles of (10), and on the real parts of the flexible loop.
    static_gain, torque : float, optional
        Bounds on the norm of the static gain (rad/(N m)) and on the nominal torque from Table 1's start (N m).
    norm : float, optional
        Bound on the nominal gain from d~ to y at frequencies up to 0.5 rad/s, rad/(N m).
    steady : float, optional
        Bound on the modulus of every steady angle under the torque d(0), rad.
    drawn_abscissa : float, optional
        Bound on the abscissa of (10) at 32 fixed draws of twelve gain factors 1 + U(0, 1), as in Figures 8 and 9.
    """

    delta_m: float
    gamma: float | None = None
    disk_radius: float | None = None
    abscissa_flexible: float | None = None
    static_gain: float | None = None
    torque: float | None = None
    norm: float | None = None
    steady: float | None = None
    drawn_abscissa: float | None = None


@dataclass(eq=False)
class Pull:
    """Derivatives of the objective by the matrices of the linear fractional form, summed up in place."""

    A: np.ndarray
    H: np.ndarray
    Cz: np.ndarray
    Dw: np.ndarray


@dataclass(eq=False)
class Direct:
    """Derivatives of the objective by the gains themselves, summed up in place."""

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray


def pack(gains: plant.Gains | Direct) -> np.ndarray:
    """The 72 entries of A_f, B_f, C_f."""
    return np.concatenate([np.ravel(gains.A), np.ravel(gains.B), np.ravel(gains.C)])


def unpack(x: np.ndarray) -> plant.Gains:
    """Gains from their 72 entries."""
    return plant.Gains(A=x[:36].reshape(6, 6), B=x[36:54].reshape(6, 3), C=x[54:72].reshape(3, 6))


class Objective:
    """Value and gradient of the design objective in gains and logarithms of scalings.

    Parameters
    ----------
    k : plant.Constants
    wishes : Wishes
    disk : tuple of float
        (a, b).
    start : ndarray, shape (6,)
        x(0), for the torque.
    constant : array_like, shape (3,), optional
        Torque behind the steady angles, N m.
    nodes : int, optional
        Points on the upper half circle, denser towards the origin.
    power : float, optional
        Exponent of the two smooth maxima (over singular values, and over points).
    """

    def __init__(
        self,
        k: plant.Constants[float],
        wishes: Wishes,
        disk: tuple[float, float],
        start: np.ndarray,
        constant: Sequence[float] | np.ndarray = (0, 0, 0),
        nodes: int = 26,
        power: float = 14,
    ) -> None:
        self.k, self.wishes, self.power = k, wishes, power
        self.a, self.b = disk
        self.start = np.concatenate([start, np.zeros(6)])
        self.constant = np.asarray(constant, dtype=float)
        self.draws = 1 + np.random.default_rng(0).random((32, 12))
        self.rigid, self.flexible = plant.rigid(k), plant.flexible(k)
        circle = -self.a + self.b * np.exp(1j * np.pi * np.linspace(0, 1, nodes) ** 1.5)
        axis = 1j * np.array([0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.8, 1, 1.5, 2.5, 5])
        self.sets = [(circle, True, False)] + ([(axis, False, True)] if wishes.gamma else [])
        self.lift = np.hstack([np.zeros((3, 3)), np.diag(np.abs(k.envelope).astype(float)), np.zeros((3, 6))])

    def scalings(self, gains: plant.Gains) -> np.ndarray:
        """Starting values for the logarithms of the scalings."""
        form, parts, x = loop(self.k, gains, self.wishes.delta_m), [], None
        for z in self.sets[0][0]:
            _, x = best_scaling(form.response(z), x)
            parts.append(x)
        if len(self.sets) > 1:
            parts.append(np.mean(parts, axis=0))
        return np.concatenate(parts)

    def __call__(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        """Objective and gradient at (gains, logarithms of scalings)."""
        gains, logs = unpack(x[:GAINS]), x[GAINS:].reshape(-1, MULTIPLIERS)
        form = loop(self.k, gains, self.wishes.delta_m)
        radius = np.abs(np.linalg.eigvals(form.A) + self.a).max()
        if radius >= self.b:
            return 1e3 * (1 + radius), np.zeros_like(x)
        pull = Pull(A=np.zeros((12, 12)), H=np.zeros((12, 27)), Cz=np.zeros((27, 12)), Dw=np.zeros((27, 27)))
        direct = Direct(A=np.zeros((6, 6)), B=np.zeros((6, 3)), C=np.zeros((3, 6)))
        slopes = np.zeros_like(logs)
        values, first = [], 0
        for points, own, performance in self.sets:
            rows = slice(first, first + (len(points) if own else 1))
            first = rows.stop
            values.append(self._set(form, points, logs[rows], performance, pull, slopes[rows]))
        total = sum(values)
        # the inertia rows are z = |Xi_J| x'', so they move with A and H
        pull.A += self.lift.T @ pull.Cz[12:15]
        pull.H += self.lift.T @ pull.Dw[12:15]
        total += self._nominal(form, pull) + self._torque(form, gains, pull, direct) + self._flexible(gains, direct)
        total += self._drawn(gains, direct)
        direct.A += pull.A[6:, 6:] + pull.H[6:, :6]
        direct.B += pull.A[6:, :3] + pull.H[6:, 6:9]
        direct.C += self.rigid.B.T @ pull.A[:6, 6:] + self.wishes.delta_m * pull.Cz[9:12, 6:]
        return total, np.concatenate([pack(direct), slopes.ravel()])

    def _set(
        self, form: Loop, points: np.ndarray, logs: np.ndarray, performance: bool, pull: Pull, slopes: np.ndarray
    ) -> float:
        H, Cz, D = form.H, form.Cz, form.Dw
        e = np.exp(logs[:, OF_CHANNEL])
        if performance:
            H = np.hstack([H, form.B])
            Cz = np.vstack([Cz, form.C / self.wishes.gamma])
            D = np.block([[form.Dw, form.Dd], [np.zeros((3, 30))]])
            e = np.hstack([e, np.ones((len(e), 3))])
        R = np.linalg.inv(points[:, None, None] * np.eye(12) - form.A)
        RH, CR = R @ H, Cz @ R
        scaled = e[:, :, None] * (Cz @ RH + D) / e[:, None, :]
        U, s, Vh = np.linalg.svd(scaled)
        weight = (s / s[:, :1]) ** self.power
        value = s[:, 0] * weight.sum(1) ** (1 / self.power)
        share = (value / value.max()) ** self.power
        total = value.max() * share.mean() ** (1 / self.power)
        outer = total * share / share.sum() / value
        slope = (U * (outer * value / weight.sum(1))[:, None, None] * (weight / s)[:, None, :]) @ Vh
        part = np.real(np.conj(slope) * scaled)
        moved = (part.sum(2) - part.sum(1))[:, :27] @ SPREAD
        slopes += moved if len(slopes) == len(points) else moved.sum(0, keepdims=True)
        slope = e[:, :, None] * slope / e[:, None, :]
        left, right = CR.conj().swapaxes(1, 2), RH.conj().swapaxes(1, 2)
        pull.A += np.real(left @ slope @ right).sum(0)
        pull.H += np.real(left @ slope).sum(0)[:, :27]
        pull.Cz += np.real(slope @ right).sum(0)[:27]
        pull.Dw += np.real(slope).sum(0)[:27, :27]
        return float(total)

    def _nominal(self, form: Loop, pull: Pull) -> float:
        total = 0.0
        if self.wishes.static_gain is not None:
            X, Y = np.linalg.solve(form.A, form.B), np.linalg.solve(form.A.T, form.C.T)
            U, s, Vh = np.linalg.svd(-form.C @ X)
            excess = max(s[0] - self.wishes.static_gain, 0.0)
            total += 300 * excess**2
            pull.A += 600 * excess * np.outer(Y @ U[:, 0], X @ Vh[0])
        if self.wishes.norm is not None:
            for w in FREQUENCIES:
                R = np.linalg.inv(1j * w * np.eye(12) - form.A)
                U, s, Vh = np.linalg.svd(form.C @ R @ form.B)
                excess = s[0] - self.wishes.norm
                if excess > 0:
                    total += 100 * excess**2
                    left, right = R.conj().T @ form.C.T @ U[:, 0], R @ form.B @ Vh[0].conj()
                    pull.A += 200 * excess * np.real(np.outer(left, right.conj()))
        if self.wishes.steady is not None:
            state = np.linalg.solve(form.A, form.B @ self.constant)
            angles = -form.C @ state
            excess = np.maximum(np.abs(angles) - self.wishes.steady, 0) / self.wishes.steady
            total += 3 * np.sum(excess**2)
            push = 6 * excess * np.sign(angles) / self.wishes.steady
            pull.A += np.outer(np.linalg.solve(form.A.T, form.C.T @ push), state)
        if self.wishes.disk_radius is not None:
            for value, left, right in _eigen(form.A):
                distance = abs(value + self.a)
                excess = distance - self.wishes.disk_radius
                if excess > 0:
                    total += 100 * excess**2
                    pull.A += 200 * excess / distance * np.real(np.conj(value + self.a) * np.outer(left.conj(), right))
        return total

    def _flexible(self, gains: plant.Gains, direct: Direct) -> float:
        total = 0.0
        if self.wishes.abscissa_flexible is not None:
            m = len(self.flexible.A)
            slope = np.zeros((m + 6, m + 6))
            for value, left, right in _eigen(plant.closed_loop(self.flexible, gains)):
                excess = value.real - self.wishes.abscissa_flexible
                if excess > 0:
                    total += 1e7 * excess**2
                    slope += 2e7 * excess * np.real(np.outer(left.conj(), right))
            direct.A += slope[m:, m:]
            direct.B += slope[m:, :3]
            direct.C += self.flexible.B.T @ slope[:m, m:]
        return total

    def _drawn(self, gains: plant.Gains, direct: Direct) -> float:
        if self.wishes.drawn_abscissa is None:
            return 0.0
        total, count = 0.0, len(self.draws)
        for factors in self.draws:
            fa, fb, fc = factors[:6], factors[6:9], factors[9:]
            for value, left, right in _eigen(plant.closed_loop(self.rigid, gains, fa, fb, fc)):
                excess = value.real - self.wishes.drawn_abscissa
                if excess > 0:
                    total += 300 / count * excess**2
                    slope = 600 / count * excess * np.real(np.outer(left.conj(), right))
                    direct.A += slope[6:, 6:] * fa
                    direct.B += slope[6:, :3] * fb
                    direct.C += fc[:, None] * (self.rigid.B.T @ slope[:6, 6:])
        return total

    def _torque(
        self, form: Loop, gains: plant.Gains, pull: Pull, direct: Direct, step: float = 0.05, count: int = 400
    ) -> float:
        if self.wishes.torque is None:
            return 0.0
        phi = expm(form.A * step)
        states = np.empty((count, 12))
        states[0] = self.start
        for i in range(1, count):
            states[i] = phi @ states[i - 1]
        torque = states[:, 6:] @ gains.C.T
        size = np.linalg.norm(torque, axis=1)
        excess = np.maximum(size - self.wishes.torque, 0)
        push = (6000 * step * excess / np.maximum(size, 1e-12))[:, None] * torque
        direct.C += push.T @ states[:, 6:]
        costate, slope = np.zeros(12), np.zeros((12, 12))
        for i in range(count - 1, 0, -1):
            costate = costate @ phi
            costate[6:] += push[i] @ gains.C
            slope += np.outer(costate, states[i - 1])
        # adjoint of the derivative of expm, from the exponential of a block matrix
        block = np.block([[form.A.T, slope / step], [np.zeros((12, 12)), form.A.T]]) * step
        pull.A += expm(block)[:12, 12:] * step
        return float(3000 * step * np.sum(excess**2))


def _eigen(A: np.ndarray) -> list[tuple[complex, np.ndarray, np.ndarray]]:
    values, right = np.linalg.eig(A)
    left = np.linalg.inv(right).conj().T
    return [(values[j], left[:, j], right[:, j]) for j in range(len(values))]


@dataclass(frozen=True)
class Improved:
    """Gains that a search reached.

    Attributes
    ----------
    gains : Gains
    converged : bool
        Whether the last minimisation met its own stopping criterion, and not a limit on its effort.
    iterations, evaluations : int
        Of all minimisations.
    """

    gains: plant.Gains
    converged: bool
    iterations: int
    evaluations: int


def improve(
    k: plant.Constants[float],
    gains: plant.Gains,
    wishes: Wishes,
    disk: tuple[float, float],
    start: np.ndarray,
    constant: np.ndarray,
    rounds: int = 2,
    iterations: int = 3000,
) -> Improved:
    """Gains that meet the wishes better, from given ones inside the disk.

    Raises
    ------
    ComputationError
        If the objective is not a number at the start.
    """
    objective = Objective(k, wishes, disk, start, constant)
    used, evaluated, converged = 0, 0, False
    for _ in range(rounds):
        x = np.concatenate([pack(gains), objective.scalings(gains)])
        unit = np.concatenate([np.maximum(np.abs(pack(gains)), 0.05), np.ones(x.size - GAINS)])
        if not np.isfinite(objective(x)[0]):
            raise ComputationError("design", "the objective is not a number at the given gains")

        def scaled(y: np.ndarray, unit: np.ndarray = unit) -> tuple[float, np.ndarray]:
            value, slope = objective(y * unit)
            return value, slope * unit

        options = {"maxiter": iterations, "maxfun": 2 * iterations, "maxcor": 40, "ftol": 1e-8, "gtol": 1e-6}
        minimum = minimize(scaled, x / unit, jac=True, method="L-BFGS-B", options=options)
        gains = unpack((minimum.x * unit)[:GAINS])
        used, evaluated, converged = used + minimum.nit, evaluated + minimum.nfev, bool(minimum.success)
    return Improved(gains, converged, used, evaluated)

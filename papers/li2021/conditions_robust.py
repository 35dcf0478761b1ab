"""Robustness of (10) to gain variation and inertia at once: linear fractional form, and conditions that certify it.

With xi = (x, x_f) the loop (10) is xi' = A xi + H w + B d~, z = Cz xi + Dw w + Dd d~, w = Delta z, Delta diagonal and
bounded by one: six channels for F_1, three for F_2, three for F_3, three for Delta J (one multiplier for the three,
so that the paper's bound ||e|| <= ||W0 x'|| is covered as well), twelve for Delta H. Each requirement of the paper gets
a Lyapunov matrix and multipliers of its own, which the paper's conditions do not allow.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_continuous_are, solve_continuous_lyapunov
from scipy.optimize import minimize

from gainsay.errors import ComputationError
from papers.li2021 import plant

CHANNELS = 27
MULTIPLIERS = 25
#: multiplier that each channel uses
OF_CHANNEL = np.array([*range(12), 12, 12, 12, *range(13, 25)])
SPREAD = np.eye(MULTIPLIERS)[OF_CHANNEL]
#: relative change of a norm at which a descent over scalings stops: at its end, and where any scaling with room will do
SETTLED, ENOUGH = 2.2e-9, 1e-6


@dataclass(frozen=True)
class Loop:
    """Linear fractional form of the closed loop; arrays as in the module's docstring, C the measured angles."""

    A: np.ndarray
    H: np.ndarray
    B: np.ndarray
    Cz: np.ndarray
    Dw: np.ndarray
    Dd: np.ndarray
    C: np.ndarray
    T: np.ndarray
    channel: np.ndarray

    def balanced(self) -> "Loop":
        """The same loop with states in units of a Lyapunov factor and every channel's two sides alike.

        xi = T xi_b; channel i scaled by c_i on both sides, so multipliers change by c_i^2.
        """
        drive = self.H / np.maximum(np.linalg.norm(self.H, axis=0), 1e-300)
        W = solve_continuous_lyapunov(self.A, -(drive @ drive.T + self.B @ self.B.T + 1e-6 * np.eye(len(self.A))))
        T = np.linalg.cholesky(W)
        inv = np.linalg.inv(T)
        Cz, H = self.Cz @ T, inv @ self.H
        c = np.sqrt(np.maximum(np.linalg.norm(Cz, axis=1), 1e-12) / np.linalg.norm(H, axis=0))
        c[12:15] = np.exp(np.mean(np.log(c[12:15])))
        return Loop(
            A=inv @ self.A @ T,
            H=H * c,
            B=inv @ self.B,
            Cz=Cz / c[:, None],
            Dw=self.Dw * c / c[:, None],
            Dd=self.Dd / c[:, None],
            C=self.C @ T,
            T=T,
            channel=c,
        )

    def response(self, z: complex) -> np.ndarray:
        """Matrix Cz (z I - A)^-1 H + Dw, shape (27, 27)."""
        return self.Cz @ np.linalg.solve(z * np.eye(len(self.A)) - self.A, self.H) + self.Dw


def loop(k: plant.Constants[float], gains: plant.Gains, delta_m: float) -> Loop:
    """Linear fractional form of (10) for gains and a bound on the gain variation.

    Parameters
    ----------
    k : Constants
    gains : Gains
    delta_m : float
        Bound on the twelve gain variations of (9).
    """
    nominal, factors = plant.rigid(k), plant.uncertain(k)
    A = plant.closed_loop(nominal, gains)
    zero = np.zeros
    H = np.hstack(
        [
            np.vstack([zero((6, 6)), gains.A]),
            np.vstack([zero((6, 3)), gains.B]),
            np.vstack([nominal.B, zero((6, 3))]),
            np.vstack([-factors.E[:, 3:], zero((6, 3))]),
            np.vstack([factors.L, zero((6, 12))]),
        ]
    )
    B = np.vstack([nominal.B, zero((6, 3))])
    C = np.hstack([nominal.C, zero((3, 6))])
    accelerate = np.hstack([np.abs(factors.W0[3:]), zero((3, 6))])
    Cz = np.vstack(
        [
            delta_m * np.hstack([zero((6, 6)), np.eye(6)]),
            delta_m * C,
            delta_m * np.hstack([zero((3, 6)), gains.C]),
            accelerate @ A,
            np.hstack([factors.K, zero((12, 6))]),
        ]
    )
    Dw, Dd = zero((CHANNELS, CHANNELS)), zero((CHANNELS, 3))
    Dw[12:15], Dd[12:15] = accelerate @ H, accelerate @ B
    return Loop(A=A, H=H, B=B, Cz=Cz, Dw=Dw, Dd=Dd, C=C, T=np.eye(12), channel=np.ones(CHANNELS))


def schatten(matrices: np.ndarray, power: int) -> tuple[float, np.ndarray]:
    """Schatten norm of many matrices M as one block diagonal, and its derivative by their entries.

    By powers of the Gram matrices, without singular values: the derivative is along M (M* M)^(power / 2 - 1).

    Parameters
    ----------
    matrices : ndarray of complex, shape (m, n, n)
    power : int
        Even.
    """
    size = float(np.linalg.norm(matrices, axis=(1, 2)).max()) ** 2
    total, along = 0.0, []
    for block in np.array_split(matrices, -(-len(matrices) // 16)):  # few enough for a processor's cache
        gram = np.conj(np.swapaxes(block, 1, 2)) @ block / size
        raised = np.linalg.matrix_power(gram, power // 2 - 1)
        total += float(np.einsum("kij,kji->", raised, gram).real)
        along.append(block @ raised)
    value = float(np.sqrt(size) * total ** (1 / power))
    return value, value / (total * size) * np.concatenate(along)


def shared_scaling(responses: np.ndarray, fixed: int = 0, stop: float = SETTLED) -> tuple[float, np.ndarray]:
    """One scaling for many responses: the least maximum of their scaled norms, nearly, and its 25 logarithms.

    Parameters
    ----------
    responses : ndarray of complex, shape (m, 27 + fixed, 27 + fixed)
    fixed : int, optional
        Further channels at the end that are not scaled.
    stop : float, optional
        Relative change of the norm at which the descent stops.
    """
    spread = np.vstack([SPREAD, np.zeros((fixed, MULTIPLIERS))])

    def smooth(x: np.ndarray, power: int) -> tuple[float, np.ndarray]:
        e = np.exp(spread @ x)
        scaled = e[:, None] * responses / e
        value, slope = schatten(scaled, power)
        part = np.real(np.conj(slope) * scaled)
        return value, ((part.sum(2) - part.sum(1)) @ spread).sum(0)

    x = np.zeros(MULTIPLIERS)
    for power in (4, 10, 30, 100):
        options = {"maxiter": 400, "ftol": stop}
        x = minimize(smooth, x, args=(power,), jac=True, method="L-BFGS-B", options=options).x
    e = np.exp(spread @ x)
    return float(np.linalg.norm(e[:, None] * responses / e, 2, axis=(1, 2)).max()), x


AXIS = np.array([0, 0.01, 0.02, 0.05, 0.08, *np.arange(0.1, 0.6, 0.025), 0.7, 0.8, 1, 1.3, 1.7, 2.5, 5, 20])


def norm_scaling(form: Loop, gamma: float, stop: float = SETTLED) -> tuple[float, np.ndarray]:
    """One scaling for the norm condition at gamma: the scaled norm on the imaginary axis, and its logarithms."""
    right, out = np.hstack([form.H, form.B]), np.vstack([form.Cz, form.C / gamma])
    through = np.block([[form.Dw, form.Dd], [np.zeros((3, 30))]])
    inner = np.linalg.solve(
        1j * AXIS[:, None, None] * np.eye(12) - form.A, np.broadcast_to(right, (len(AXIS), *right.shape))
    )
    return shared_scaling(out @ inner + through, fixed=3, stop=stop)


def norm_riccati(form: Loop, log_scale: np.ndarray, gamma: float) -> tuple[np.ndarray, np.ndarray]:
    """P and multipliers of the norm condition at gamma for given scalings, from the Riccati equation of the lemma.

    Raises
    ------
    ComputationError
        If the equation has no stabilising solution: gamma is too small for the scalings.
    """
    d = gamma**2 * np.exp(2 * log_scale)
    D = np.diag(d[OF_CHANNEL])
    right = np.hstack([form.H, form.B])
    Z, through = form.Cz, np.hstack([form.Dw, form.Dd])
    weight = Z.T @ D @ Z + form.C.T @ form.C
    R = through.T @ D @ through - np.diag(np.concatenate([d[OF_CHANNEL], np.full(3, gamma**2)]))
    best, solution = 0.0, None
    for lift in 10.0 ** np.arange(-1, -7.5, -0.5):
        try:
            raised = weight + lift * np.trace(weight) / 12 * np.eye(12)
            # SciPy before 1.17 takes s only together with e
            P = solve_continuous_are(form.A, right, raised, R, e=np.eye(12), s=Z.T @ D @ through)
        except (np.linalg.LinAlgError, ValueError):
            continue
        P = (P + P.T) / 2
        cross = P @ right + Z.T @ D @ through
        matrix = -np.block([[form.A.T @ P + P @ form.A + weight, cross], [cross.T, R]])
        scale = 1 / np.sqrt(np.abs(np.diag(matrix)))
        margin = float(np.linalg.eigvalsh(scale[:, None] * matrix * scale)[0])
        if np.linalg.eigvalsh(P)[0] > 0 and margin > best:
            best, solution = margin, P
    if solution is not None:
        return solution, d
    raise ComputationError("norm", f"no solution of the Riccati equation at gamma {gamma}")


def original(form: Loop, values: dict) -> tuple[np.ndarray, np.ndarray]:
    """P and the 25 multipliers of a solution in balanced coordinates, back in those of the paper."""
    inv = np.linalg.inv(form.T)
    P = inv.T @ values["P"] @ inv
    d = np.array([values[f"d{i}"] for i in range(MULTIPLIERS)])
    c = np.zeros(MULTIPLIERS)
    c[OF_CHANNEL] = form.channel
    return (P + P.T) / 2, d / c**2

"""Constant gain variations and the disk: another scaling on every arc of the circle |s + a| = b.

For constant Delta the poles of (10) stay in the disk if they are in it for Delta = 0 and no pole meets the circle:
it is enough that on every arc, for some diagonal D > 0, M(s)* D M(s) < D with M(s) = Cz (s I - A)^-1 H + Dw. Only the
upper half of the circle is needed, the data being real. The scalings are found here, from points of the arcs; that
they hold on whole arcs is left to the checker (`gainsay.proof.kinds.contour`).
"""

from collections.abc import Callable

import numpy as np
from scipy.linalg import solve_discrete_are
from scipy.optimize import brentq, minimize, minimize_scalar

from gainsay.errors import ComputationError
from papers.li2021.conditions_robust import ENOUGH, MULTIPLIERS, OF_CHANNEL, SETTLED, SPREAD, Loop, schatten


def scaled_norm(log_scale: np.ndarray, M: np.ndarray, power: int) -> tuple[float, np.ndarray]:
    """Schatten norm of E M E^-1, E = diag(exp(log_scale)), and its gradient in the 25 logarithms; D = E^2."""
    e = np.exp(log_scale[OF_CHANNEL])
    scaled = e[:, None] * M / e
    value, slope = schatten(scaled[None], power)
    part = np.real(np.conj(slope[0]) * scaled)
    return value, SPREAD.T @ (part.sum(1) - part.sum(0))


def best_scaling(M: np.ndarray, start: np.ndarray | None = None, stop: float = SETTLED) -> tuple[float, np.ndarray]:
    """Least largest singular value of E M E^-1 over the scalings, nearly, and the logarithms that give it."""
    x = np.zeros(MULTIPLIERS) if start is None else start
    for power in (4, 12, 40, 120):
        options = {"maxiter": 300, "ftol": stop}
        x = minimize(scaled_norm, x, args=(M, power), jac=True, method="L-BFGS-B", options=options).x
    e = np.exp(x[OF_CHANNEL])
    return float(np.linalg.norm(e[:, None] * M / e, 2)), x


def profile(form: Loop, a: float, b: float, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least scaled norm of M on the circle at the given angles, and the scalings (len(angles), 25)."""
    values, scales, x = [], [], None
    for angle in angles:
        value, x = best_scaling(form.response(-a + b * np.exp(1j * angle)), x)
        values.append(value)
        scales.append(x)
    return np.array(values), np.array(scales)


def peak(form: Loop, a: float, b: float, nodes: int = 61) -> tuple[float, float]:
    """Largest value over the circle of the least scaled norm, and the angle where it is found."""
    angles = np.linspace(0, np.pi, nodes)
    values, scales = profile(form, a, b, angles)
    best = (float(values.max()), float(angles[values.argmax()]))
    for i in range(nodes):
        left, right = max(i - 1, 0), min(i + 1, nodes - 1)
        if values[i] < max(values[left], values[right]) or values[i] < 0.9 * values.max():
            continue
        minimum = minimize_scalar(
            lambda t, i=i: -best_scaling(form.response(-a + b * np.exp(1j * t)), scales[i])[0],
            bounds=(angles[left], angles[right]),
            method="bounded",
            options={"xatol": 1e-4},
        )
        best = max(best, (float(-minimum.fun), float(minimum.x)))
    return best


def largest_delta(build: Callable[[float], Loop], a: float, b: float, low: float, high: float) -> tuple[float, float]:
    """Largest delta_m at which the peak stays below one, and the angle that limits it.

    Parameters
    ----------
    build : callable
        delta_m -> Loop, balanced.
    a, b : float
        Centre and radius of the disk.
    low, high : float
        Values between which the peak passes one.
    """
    if peak(build(low), a, b)[0] >= 1 or peak(build(high), a, b)[0] <= 1:
        raise ComputationError("disk region", f"the peak does not pass 1 between {low} and {high}")
    delta = brentq(lambda x: peak(build(x), a, b)[0] - 1, low, high, xtol=1e-6)
    return float(delta), peak(build(delta), a, b)[1]


def _reaches(form: Loop, a: float, b: float, log_scale: np.ndarray, low: float, high: float, nodes: int = 9) -> float:
    """Largest scaled norm over points of the arc from low to high, in parts of the half circle."""
    e = np.exp(log_scale[OF_CHANNEL])
    circle = -a + b * np.exp(1j * np.pi * np.linspace(low, high, nodes))
    return float(max(np.linalg.norm(e[:, None] * form.response(z) / e, 2) for z in circle))


def cover(
    form: Loop, a: float, b: float, widest: float = 0.1, narrowest: float = 1e-4, room: float = 0.3
) -> tuple[list[float], np.ndarray]:
    """Arcs of the upper half circle s = -a + b exp(i pi t) and a scaling for each that keeps the norm below one.

    Parameters
    ----------
    form : Loop
        Balanced.
    a, b : float
        Centre and radius of the disk.
    widest, narrowest : float, optional
        Lengths of an arc in t.
    room : float, optional
        Share of the distance to one at the middle of an arc that must be left all over it.

    Returns
    -------
    ends : list of float, length m + 1
        From 0 to 1, of six decimals.
    scales : ndarray, shape (m, 25)
        Logarithms of the scalings, in the coordinates of the loop.

    Raises
    ------
    ComputationError
        Where the least scaled norm is not below one, or no arc is short enough.
    """
    ends, scales, width, last = [0.0], [], widest, None
    while ends[-1] < 1:
        low = ends[-1]
        high = round(min(1.0, low + width), 6)
        middle = -a + b * np.exp(0.5j * np.pi * (low + high))
        value, scale = best_scaling(form.response(middle), last, ENOUGH)
        if _reaches(form, a, b, scale, low, high) < 1 - room * (1 - value):
            ends.append(high)
            scales.append(scale)
            last, width = scale, min(widest, 1.5 * width)
            continue
        width /= 1.6
        if width < narrowest:
            raise ComputationError("disk region", f"no scaling near t = {low:.4f}, scaled norm {value:.4f}")
    return ends, np.array(scales)


def one_matrix(form: Loop, a: float, b: float, log_scale: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """P and multipliers that show the disk on the whole circle at once, from a scaling and a Riccati equation.

    Returns
    -------
    P : ndarray, shape (12, 12)
    multipliers : ndarray, shape (25,)
        Both in the coordinates of the loop.

    Raises
    ------
    ComputationError
        If the equation has no solution inside the inequality.
    """
    d = np.exp(2 * log_scale)
    D = np.diag(d[OF_CHANNEL])
    V, Z = np.hstack([form.A + a * np.eye(12), form.H]) / b, np.hstack([form.Cz, form.Dw])
    rest = Z.T @ D @ Z
    rest[12:, 12:] -= D
    room = 1 - max(_reaches(form, a, b, log_scale, 0.0, 1.0, 181), 0.0) ** 2
    if room > 0:
        # part of the room goes to both diagonal blocks, so that the solution lies inside
        lifted = rest.copy()
        lifted[12:, 12:] += 0.3 * room * D
        lifted[:12, :12] += 0.03 * room * np.diag(np.diag(form.Cz.T @ D @ form.Cz))
        try:
            # SciPy before 1.17 takes s only together with e
            P = solve_discrete_are(
                V[:, :12], V[:, 12:], lifted[:12, :12], lifted[12:, 12:], e=np.eye(12), s=lifted[:12, 12:]
            )
        except (np.linalg.LinAlgError, ValueError) as error:
            raise ComputationError("disk region", f"Riccati equation: {error}") from error
        P = (P + P.T) / 2
        N = -(V.T @ P @ V + rest)
        N[:12, :12] += P
        scale = 1 / np.sqrt(np.abs(np.diag(N)))
        if np.linalg.eigvalsh(scale[:, None] * N * scale)[0] > 1e-9:
            return P, d
    raise ComputationError("disk region", f"no single P for this scaling, room {room:.2e}")

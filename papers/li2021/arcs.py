"""Constant gain variations and the disk: another scaling on every arc of the circle |s + a| = b.

For constant Delta the poles of (10) stay in the disk if they are in it for Delta = 0 and no pole meets the circle:
it is enough that on every arc, for some diagonal D > 0, M(s)* D M(s) < D with M(s) = Cz (s I - A)^-1 H + Dw. On an
arc, a finite piece of the circle, that follows from one matrix inequality with Hermitian P and Q >= 0 (generalised
Kalman-Yakubovich-Popov lemma; T. Iwasaki, S. Hara, IEEE Trans. Automatic Control 50 (2005) 41-59). Only the upper
half of the circle is needed, the data being real.
"""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from scipy.linalg import solve_discrete_are
from scipy.optimize import brentq, minimize, minimize_scalar

from gainsay.errors import ComputationError
from papers.li2021.robust import MULTIPLIERS, OF_CHANNEL, SPREAD, Loop, shared_scaling


def scaled_norm(log_scale: np.ndarray, M: np.ndarray, power: float) -> tuple[float, np.ndarray]:
    """Schatten norm of E M E^-1, E = diag(exp(log_scale)), and its gradient in the 25 logarithms; D = E^2."""
    e = np.exp(log_scale[OF_CHANNEL])
    scaled = e[:, None] * M / e
    U, s, Vh = np.linalg.svd(scaled)
    weight = (s / s[0]) ** power
    value = s[0] * weight.sum() ** (1 / power)
    slope = (U * (value / weight.sum() * weight / np.maximum(s, 1e-300))) @ Vh
    part = np.real(np.conj(slope) * scaled)
    return value, SPREAD.T @ (part.sum(1) - part.sum(0))


def best_scaling(M: np.ndarray, start: np.ndarray | None = None) -> tuple[float, np.ndarray]:
    """Least largest singular value of E M E^-1 over the scalings, nearly, and the logarithms that give it."""
    x = np.zeros(MULTIPLIERS) if start is None else start
    for power in (4, 12, 40, 120):
        found = minimize(scaled_norm, x, args=(M, power), jac=True, method="L-BFGS-B", options={"maxiter": 300})
        x = found.x
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
        found = minimize_scalar(
            lambda t, i=i: -best_scaling(form.response(-a + b * np.exp(1j * t)), scales[i])[0],
            bounds=(angles[left], angles[right]),
            method="bounded",
            options={"xatol": 1e-4},
        )
        best = max(best, (float(-found.fun), float(found.x)))
    return best


def largest_delta(build, a: float, b: float, low: float, high: float) -> tuple[float, float]:
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
    found = brentq(lambda x: peak(build(x), a, b)[0] - 1, low, high, xtol=1e-6)
    return float(found), peak(build(found), a, b)[1]


@dataclass(frozen=True)
class Arc:
    """A certified arc between two nodes, in the coordinates of its loop.

    Attributes
    ----------
    first, last : tuple
        Its ends, as `node` gives them.
    multipliers : ndarray, shape (25,)
    weight : float
        w >= 0 in Q = w Cz' D Cz.
    P : ndarray of complex, shape (12, 12)
        Hermitian.
    margin : float
        Least eigenvalue of the negative of `matrix`, its diagonal scaled to one.
    """

    first: tuple[Fraction, bool]
    last: tuple[Fraction, bool]
    multipliers: np.ndarray
    weight: float
    P: np.ndarray
    margin: float

    def original(self, form: Loop) -> tuple[np.ndarray, np.ndarray]:
        """P and multipliers in the coordinates of the paper."""
        inv = np.linalg.inv(form.T)
        c = np.zeros(MULTIPLIERS)
        c[OF_CHANNEL] = form.channel
        P = inv.T @ self.P @ inv
        return (P + P.conj().T) / 2, self.multipliers / c**2


def node(angle: float) -> tuple[Fraction, bool]:
    """Rational point of the unit circle near an angle in [0, pi]: t = tan(angle / 2), mirrored beyond pi / 2."""
    mirrored = angle > np.pi / 2
    return Fraction(round(1e6 * np.tan((np.pi - angle if mirrored else angle) / 2)), 10**6), mirrored


def point(place: tuple[Fraction, bool]) -> tuple[Fraction, Fraction]:
    """Cosine and sine of a node, exactly."""
    t, mirrored = place
    c = (1 - t * t) / (1 + t * t)
    return (-c if mirrored else c), 2 * t / (1 + t * t)


def _weighted(form: Loop, a: float, b: float, ends, multipliers, weight: float) -> tuple[np.ndarray, np.ndarray]:
    """[F G] of the circle's map and the part of `matrix` without P."""
    (c0, s0), (c1, s1) = (tuple(map(float, point(e))) for e in ends)
    n, level = (c0 + c1) + 1j * (s0 + s1), (c0 + c1) * c1 + (s0 + s1) * s1
    V = np.hstack([form.A + a * np.eye(12), form.H]) / b
    J, Z, D = np.eye(12, 39), np.hstack([form.Cz, form.Dw]), np.diag(multipliers[OF_CHANNEL])
    Q = weight * form.Cz.T @ D @ form.Cz
    rest = Z.T @ D @ Z + n * V.T @ Q @ J + np.conj(n) * J.T @ Q @ V - 2 * level * J.T @ Q @ J
    rest[12:, 12:] -= D
    return V, (rest + rest.conj().T) / 2


def matrix(form: Loop, a: float, b: float, ends, multipliers, weight: float, P) -> np.ndarray:
    """Hermitian matrix (39, 39) whose negative definiteness certifies the arc between two nodes.

    With z = (s + a)/b on the unit circle, v = (x, w) and z x = V v, the terms in P cancel on the circle, and those in
    Q = weight Cz' D Cz, weighted by 2 Re(conj(n) z) - 2 level, are not negative on the arc cut off by the chord
    between the nodes; so |D^(1/2) M w| < |D^(1/2) w| there.
    """
    V, rest = _weighted(form, a, b, ends, multipliers, weight)
    N = V.T @ P @ V + rest
    N[:12, :12] -= P
    return (N + N.conj().T) / 2


def certify(form: Loop, a: float, b: float, ends, log_scale: np.ndarray, weights=(0, 1, 3, 10, 30, 100)) -> Arc | None:
    """Certify one arc with a given scaling, or None where no Riccati solution does it."""
    d = np.exp(2 * log_scale)
    best = None
    for weight in weights:
        V, rest = _weighted(form, a, b, ends, d, weight)
        F, G = V[:, :12], V[:, 12:]
        top = _largest_on_circle(F, G, rest, d)
        if top >= 0:
            continue
        # part of the room goes to both diagonal blocks, so that the solution lies inside
        lifted = rest.copy()
        lifted[12:, 12:] -= 0.3 * top * np.diag(d[OF_CHANNEL])
        lifted[:12, :12] -= 0.03 * top * np.diag(np.diag(form.Cz.T @ (d[OF_CHANNEL][:, None] * form.Cz)))
        try:
            P = solve_discrete_are(F, G, lifted[:12, :12], lifted[12:, 12:], s=lifted[:12, 12:])
        except (np.linalg.LinAlgError, ValueError):
            continue
        P = (P + P.conj().T) / 2
        N = -matrix(form, a, b, ends, d, weight, P)
        scale = 1 / np.sqrt(np.abs(np.diag(N).real))
        margin = float(np.linalg.eigvalsh(scale[:, None] * N * scale)[0])
        if margin > 1e-9 and (best is None or margin > best.margin):
            best = Arc(*ends, d, float(weight), P, margin)
    return best


def _largest_on_circle(F: np.ndarray, G: np.ndarray, rest: np.ndarray, d: np.ndarray, nodes: int = 181) -> float:
    """Largest eigenvalue over the whole circle of the form in w, in units of its multipliers; negative: P exists."""
    z = np.exp(1j * np.linspace(-np.pi, np.pi, nodes))
    X = np.linalg.solve(z[:, None, None] * np.eye(12) - F, np.broadcast_to(G, (nodes, *G.shape)))
    v = np.concatenate([X, np.broadcast_to(np.eye(27), (nodes, 27, 27))], axis=1) / np.sqrt(d[OF_CHANNEL])
    return float(np.linalg.eigvalsh(v.conj().swapaxes(1, 2) @ rest @ v)[:, -1].max())


def cover(form: Loop, a: float, b: float, widest: float = 0.4, narrowest: float = 0.004) -> list[Arc]:
    """Arcs from angle 0 to pi, each certified; raises ComputationError where an arc cannot be.

    Where there is room a scaling nearer to the one that serves the whole circle is taken: what is best at one point
    can be bad far from it, and then P is hard to find.
    """
    circle = np.array([form.response(-a + b * np.exp(1j * t)) for t in np.linspace(0, np.pi, 41)])
    common = shared_scaling(circle)[1]
    arcs, angle, width, local = [], 0.0, widest, None
    while angle < np.pi:
        stop = min(angle + width, np.pi)
        ends = (node(angle), node(stop))
        inside = [form.response(-a + b * np.exp(1j * t)) for t in (angle, (angle + stop) / 2, stop)]
        value, local_here = best_scaling(inside[1], local)
        arc = None
        for share in (1.0, 0.7, 0.4, 0.15, 0.0):
            scale = share * common + (1 - share) * local_here
            e = np.exp(scale[OF_CHANNEL])
            if max(np.linalg.norm(e[:, None] * M / e, 2) for M in inside) < 1:
                arc = certify(form, a, b, ends, scale)
            if arc is not None:
                break
        if arc is None:
            width /= 1.6
            if width < narrowest:
                raise ComputationError("disk region", f"no certificate near angle {angle:.4f}, scaled norm {value:.4f}")
            continue
        arcs.append(arc)
        local, angle, width = local_here, stop, min(widest, 1.4 * width)
    return arcs

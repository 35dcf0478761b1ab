"""Closed forms for the pitch axis of pinheiro2013: the H2 limit, both norms of a gain, the true mixed optimum."""

import numpy as np
from scipy.optimize import minimize_scalar

from gainsay.errors import InputError
from papers.pinheiro2013.conditions import gamma_min
from papers.pinheiro2013.plant import GeneralizedPlant


def h2_limit(plant: GeneralizedPlant, moment: float) -> tuple[np.ndarray, float]:
    """Gain and H2 norm of the H2 limit of one double integrator I q'' = -s q + u, in closed form.

    K1 = sqrt(s^2 + Q1^2) - s, K2 = sqrt(Q2^2 + 2 I K1) with R = 1, and the norm is |r| sqrt(I K2).
    """
    angle, rate = plant.C2[0, 0] / plant.D22[-1, 0], plant.C2[1, 1] / plant.D22[-1, 0]
    stiffness = -plant.A[1, 0] * moment
    # Written so that nothing cancels where the stiffness exceeds the weight.
    first = angle**2 / (np.sqrt(stiffness**2 + angle**2) + stiffness)
    second = np.sqrt(rate**2 + 2 * moment * first)
    return np.array([[first, second]]), float(np.linalg.norm(plant.B1[1]) * np.sqrt(moment * second) * plant.D22[-1, 0])


def norms(plant: GeneralizedPlant, k1: float, k2: float) -> tuple[float, float]:
    """H2 and H-infinity norm of pitch with q'' + k2 q' + k1 q = r w, in closed form.

    The covariance is |r|^2 diag(1/(2 k1 k2), 1/(2 k2)). The squared gain, with v = w^2, is
    |r|^2 (v^2 + 2)/((k1 - v)^2 + k2^2 v).

    Returns
    -------
    h2, hinf : float
    """
    size = np.linalg.norm(plant.B1[1])
    K = (np.array([k1, k2]) + plant.A[1]) / plant.B2[1, 0]
    weights = np.diag(plant.C2.T @ plant.C2) + plant.D22[-1, 0] ** 2 * K**2
    h2 = size * np.sqrt(weights[0] / (2 * k1 * k2) + weights[1] / (2 * k2))
    # Stationary where (v^2 + 2)' d = (v^2 + 2) d' with d = v^2 + b v + k1^2: b v^2 + 2 (k1^2 - 2) v - 2 b = 0.
    b = k2**2 - 2 * k1
    roots = np.roots([b, 2 * (k1**2 - 2), -2 * b]) if b else np.array([])
    inner = [v.real for v in np.atleast_1d(roots) if abs(v.imag) < 1e-12 and v.real > 0]
    squares = [1.0, 2 / k1**2, *((v**2 + 2) / ((k1 - v) ** 2 + k2**2 * v) for v in inner)]
    return float(h2), float(size * np.sqrt(max(squares)))


def true_optimum(plant: GeneralizedPlant, gamma: float) -> tuple[np.ndarray, float]:
    """Least H2 norm over both pitch gains with the H-infinity norm at most gamma, without a shared X.

    For given k1 >= sqrt 2 |r|/gamma the level asks for k2^2 >= 2 k1 - (2/gamma^2) sqrt((gamma^2 - |r|^2)
    (gamma^2 k1^2 - 2 |r|^2)), and the H2 norm is unimodal in k2, so that one search over k1 remains.

    Returns
    -------
    K : ndarray, shape (1, 2)
    h2 : float

    Raises
    ------
    InputError
        If gamma does not exceed gamma_min.
    """
    size, least = np.linalg.norm(plant.B1[1]), gamma_min(plant)
    if not gamma > least:
        raise InputError("level", field="gamma", value=gamma, expected=f"above gamma_min = {least!r}")
    lowest = np.sqrt(2) * size / gamma

    def along(logarithm: float) -> tuple[float, float, float]:
        k1 = lowest * np.exp(logarithm)
        free = max((gamma**2 - size**2) * (gamma**2 * k1**2 - 2 * size**2), 0.0)
        floor = np.sqrt(max(2 * k1 - 2 / gamma**2 * np.sqrt(free), 1e-12))
        minimum = minimize_scalar(
            lambda x: norms(plant, k1, floor * np.exp(x))[0], bounds=(0, 8), method="bounded", options={"xatol": 1e-12}
        )
        inner = floor * np.exp(minimum.x)
        return min((norms(plant, k1, k2)[0], k1, k2) for k2 in (floor, inner))

    grid = np.linspace(0, 8, 161)
    i = int(np.argmin([along(x)[0] for x in grid]))
    bounds = (grid[max(i - 1, 0)], grid[min(i + 1, len(grid) - 1)])
    minimum = minimize_scalar(lambda x: along(x)[0], bounds=bounds, method="bounded", options={"xatol": 1e-12})
    h2, k1, k2 = min(along(minimum.x), along(grid[i]))
    return np.array([[k1 + plant.A[1, 0], k2]]) / plant.B2[1, 0], h2

"""Model (1) of wan2014 with the factors of (42), put together in numpy from the printed tables."""

import math
from dataclasses import dataclass

import numpy as np

from gainsay.tables import Case
from papers.wan2014 import plant


@dataclass(frozen=True)
class Model:
    """dx/dt = (A + E1 Lambda(t) E2) x + B u; shapes (6, 6), (6, 3), (6, 6), (6, 6)."""

    A: np.ndarray
    B: np.ndarray
    E1: np.ndarray
    E2: np.ndarray


def model_of(case: Case) -> Model:
    own, n, coefficient = plant.design_model(case), case.number("mean_motion"), case.matrix("E2_coefficient")
    E2 = np.where(coefficient == 0, 0.0, coefficient * n ** case.matrix("E2_power"))
    return Model(own.A, own.B, case.number("eccentricity") * case.matrix("E1_over_e"), E2)


def uncertainty(mean_anomaly: float) -> np.ndarray:
    """Lambda of (42), 6x6, at a mean anomaly in rad."""
    sine, cosine = math.sin(mean_anomaly), math.cos(mean_anomaly)
    return np.diag([sine, -sine, cosine, cosine, -0.5 * cosine, cosine])

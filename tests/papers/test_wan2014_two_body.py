"""The inclusion in which the flights of the two-body problem are proved to end at the target."""

from pathlib import Path

import numpy as np
import pytest

from gainsay.dynamics.relative_orbit import relative_acceleration
from gainsay.errors import CertificateError
from gainsay.proof import check
from gainsay.statements.floats import Floats
from gainsay.tables import read_case
from papers.wan2014 import plant
from papers.wan2014.proofs_two_body import RANGE, certificate, decaying, flights

CASE = read_case(Path(__file__).parents[2], "wan2014")
ORBIT = plant.target_orbit(CASE)


@pytest.fixture(scope="module")
def found():
    return decaying(CASE).solve().need("decay").values


def acceleration(anomaly: float, position: np.ndarray) -> np.ndarray:
    """Rows 4 to 6 of A(t): the mean gravity gradient from the target to the chaser by Gauss's rule, and the frame."""
    radius, rate, spin = ORBIT.frame_motion(anomaly)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    found = np.zeros((3, 6))
    for share, weight in zip((nodes + 1) / 2, weights / 2, strict=True):
        p = np.array([radius, 0, 0]) + share * position
        d = np.linalg.norm(p)
        found[:, :3] += weight * ORBIT.gravitational_parameter / d**3 * (3 * np.outer(p, p) / d**2 - np.eye(3))
    found[0, 0] += rate**2
    found[1, 1] += rate**2
    found[0, 1] += spin
    found[1, 0] -= spin
    found[0, 4], found[1, 3] = 2 * rate, -2 * rate
    return found


def test_the_two_body_problem_lies_in_the_inclusion_within_the_range():
    floats = Floats(CASE, flights(CASE), {})
    A, H, Cz = (floats.constant(name) for name in ("Am", "H", "Cz"))
    middle, width = A[3:], np.zeros((3, 6))
    for channel in range(H.shape[1]):
        assert (H[3:6, channel] == H[9:12, channel]).all()  # in the error as in the state
        width += np.outer(H[3:6, channel], Cz[channel, :6])
    draw = np.random.default_rng(2014)
    most = np.zeros((3, 6))
    for _ in range(2000):
        direction = draw.normal(size=3)
        position = float(RANGE) * draw.choice([1.0, draw.random()]) * direction / np.linalg.norm(direction)
        velocity, anomaly = draw.normal(size=3), draw.choice([0.0, np.pi, 2 * np.pi * draw.random()])
        exact = acceleration(anomaly, position)
        # the same motion as another function of the library computes it, to the rounding of mu/r^2
        assert exact @ [*position, *velocity] == pytest.approx(
            np.array(relative_acceleration(ORBIT, anomaly, position, velocity)), rel=1e-9, abs=1e-12
        )
        off = np.abs(exact - middle)
        assert (off <= width * (1 + 1e-12)).all()
        most = np.maximum(most, np.divide(off, width, out=np.zeros((3, 6)), where=width > 0))
    # each channel is used: the mean of p_y p_z on the way is at most a sixth where its bound is one half, by hand
    assert (most[width > 0] > 0.15).all()


def test_the_corners_are_starts_of_the_flights():
    floats = Floats(CASE, flights(CASE), {})
    x0 = CASE.matrix("x0").ravel()
    starts = {tuple(x0 - column[6:]) for column in floats.constant("corners").T}  # the estimates
    choices = {tuple(plant.observer_start(CASE, name)) for name in ("measured_position", "exact", "zero")}
    assert choices < starts and len(starts) == 4
    assert all((column[:6] == x0).all() for column in floats.constant("corners").T)


def test_every_flight_is_proved_to_end_at_the_target(found):
    proved = certificate(CASE, found["P"], np.diagonal(found["S"]))
    assert {c.quantity for c in proved.conclusions} == {"audit.final_range", "audit.final_speed"}
    assert check(proved, CASE).conclusions
    # a fifth corner outside the others is not covered by what bounds the four
    wider = [(n, t if n != "corners" else f"row({t}, 100*x0[0:6,0])") for n, t in proved.definitions]
    with pytest.raises(CertificateError):
        check(proved.changed(definitions=wider), CASE)

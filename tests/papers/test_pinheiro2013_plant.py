import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.dynamics import attitude
from gainsay.errors import InputError
from gainsay.systems.lft import Lft
from papers.pinheiro2013.plant import (
    GROUPS,
    Satellite,
    generalized_plant,
    inverse_moment,
    linear_model,
)

moments = st.tuples(st.floats(5, 9), st.floats(5, 9), st.floats(5, 9))
deltas = st.tuples(*[st.floats(-1, 1)] * 3)
SATELLITE = Satellite((7.0, 6.0, 5.0), 1.1e-3)


@given(moments, deltas, st.sampled_from(list(GROUPS)), st.floats(1e-4, 0.5))
@settings(max_examples=60, deadline=None)
def test_closed_uncertainty_loop_is_the_direct_uncertain_model(inertia, delta, group, n):
    # Identity: (8) with I_i = nominal + p_i delta_i, written by hand. A large n keeps its terms above rounding.
    satellite = Satellite(inertia, n, change=0.1)
    closed_a, closed_b = generalized_plant(satellite, group).uncertain(delta)
    direct_a, direct_b = linear_model(satellite.changed(0.1 * np.array(delta)), group)
    assert closed_a == pytest.approx(direct_a, rel=1e-11, abs=1e-14)
    assert closed_b == pytest.approx(direct_b, rel=1e-11)


@pytest.mark.parametrize("delta", [-1.0, 1.0])
def test_printed_sign_of_the_inverse_moment_is_wrong(delta):
    # 1/(I + p delta) itself is the expected value.
    inertia, change = 20.0, 2.0
    assert inverse_moment(inertia, change).close([[delta]]).item() == pytest.approx(1 / (inertia + change * delta))
    printed = (
        Lft(-change / inertia, 1 / inertia, change / inertia, 1 / inertia).close([[delta]]).item()
    )  # the signs of (14)
    assert (printed - 1 / inertia) * (1 / (inertia + change * delta) - 1 / inertia) < 0


def test_linear_model_is_the_derivative_of_the_nonlinear_motion():
    inertia, n = SATELLITE.inertia, SATELLITE.n
    A, B = linear_model(SATELLITE, "all")
    omega_0 = attitude.rate_body(np.zeros(3), np.zeros(3), n)
    step = 1e-5

    def accelerations(x, torque):
        # Angles and their rates, carried over to body rates and back by a difference along the motion.
        state = np.concatenate([x[:3], attitude.rate_body(x[:3], x[3:], n)])
        slope = attitude.derivative(state, inertia, n, torque)
        forward = attitude.euler_rates(state[:3] + step * slope[:3], state[3:] + step * slope[3:], n)
        backward = attitude.euler_rates(state[:3] - step * slope[:3], state[3:] - step * slope[3:], n)
        return (forward - backward) / (2 * step)

    assert attitude.derivative(np.concatenate([np.zeros(3), omega_0]), inertia, n, np.zeros(3)) == pytest.approx(
        np.zeros(6), abs=1e-18
    )
    for j in range(6):
        x = 1e-4 * np.eye(6)[j]
        slope = (accelerations(x, np.zeros(3)) - accelerations(-x, np.zeros(3))) / 2e-4
        assert slope == pytest.approx(A[3:, j], abs=2e-8)
    for j in range(3):
        slope = (accelerations(np.zeros(6), np.eye(3)[j]) - accelerations(np.zeros(6), -np.eye(3)[j])) / 2
        assert slope == pytest.approx(B[3:, j], rel=1e-6, abs=1e-9)


def test_pitch_plant_has_the_structure_of_equation_18():
    plant = generalized_plant(SATELLITE, "pitch")
    Ix, Iy, Iz = SATELLITE.inertia
    g, (px, py, pz) = 3 * SATELLITE.n**2, 0.1 * np.array(SATELLITE.inertia)
    # Equation (18) written out, d and u with the sign of (12).
    row = [-g * (Ix - Iz) / Iy, 0, -py / Iy, -g * px / Iy, -g * pz / Iy, 1 / Iy, 1 / Iy]
    assert np.hstack([plant.A, plant.B1, plant.B2]) == pytest.approx(np.array([[0, 1, 0, 0, 0, 0, 0], row]))
    assert np.hstack([plant.C1, plant.D11, plant.D12]) == pytest.approx(
        np.array([row, [1, 0, 0, 0, 0, 0, 0], [-1, 0, 0, 0, 0, 0, 0]])
    )
    assert np.hstack([plant.C2, plant.D22]) == pytest.approx(np.diag([0.1, 0.1, 1]))


def test_roll_and_yaw_share_twelve_uncertainty_channels():
    plant = generalized_plant(SATELLITE, "roll_yaw")
    assert len(plant.channels) == 12
    assert plant.B1.shape == (4, 14)


def test_six_states_hold_pitch_and_roll_yaw_side_by_side():
    both = generalized_plant(SATELLITE, "all")
    pitch, roll_yaw = generalized_plant(SATELLITE, "pitch"), generalized_plant(SATELLITE, "roll_yaw")
    assert both.A[np.ix_([1, 4], [1, 4])] == pytest.approx(pitch.A)
    assert both.A[np.ix_([0, 2, 3, 5], [0, 2, 3, 5])] == pytest.approx(roll_yaw.A)


def test_bad_satellites_and_gains_are_refused():
    with pytest.raises(InputError, match="none above the sum of the others"):
        Satellite((1.0, 1.0, 3.0), 1e-3)
    with pytest.raises(InputError, match=r"gain of the wrong shape K \(2, 1\): expected \(1, 2\)"):
        generalized_plant(SATELLITE, "pitch").closed(np.ones((2, 1)))
    with pytest.raises(InputError, match="group of axes"):
        generalized_plant(SATELLITE, "roll")

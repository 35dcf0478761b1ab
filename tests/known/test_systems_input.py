"""Physics that cannot be is refused before anything is computed; integrations that break say when."""

import math

import numpy as np
import pytest

from gainsay.dynamics.attitude import inertia_matrix
from gainsay.dynamics.flexible import FlexibleBody
from gainsay.dynamics.relative_orbit import KeplerOrbit, clohessy_wiltshire, mean_motion, thrust_input
from gainsay.errors import ComputationError, InputError
from gainsay.simulation.ode import integrate, largest, last_crossing
from gainsay.simulation.periodic import PeriodicSolution
from gainsay.systems.delay import DelaySystem
from gainsay.systems.margins import structured_bounds
from gainsay.systems.norms import hinf_norm
from gainsay.systems.regions import Disk, HalfPlane

BODY = {
    "inertia": np.diag([20.0, 30.0, 25.0]), "coupling": np.array([[0.5, -0.3, 0.8]]), "frequency": np.array([0.7]),
    "damping": np.array([0.01]),
}  # fmt: skip


@pytest.mark.parametrize(
    "changes",
    [
        {"inertia": np.diag([1.0, 1.0, 3.0])},  # no rigid body: the triangle inequality
        {"inertia": np.diag([-20.0, 30.0, 25.0])},
        {"inertia": np.array([[20.0, 1, 0], [0, 30, 0], [0, 0, 25]])},
        {"inertia": np.diag([math.nan, 30.0, 25.0])},
        {"frequency": np.array([0.0])}, {"frequency": np.array([-0.7])}, {"frequency": np.array([math.inf])},
        {"frequency": np.float64(0.7)}, {"damping": np.array([-0.01])}, {"damping": np.array([math.nan])},
        {"coupling": np.array([[math.nan, 0, 0]])}, {"coupling": np.array([[10.0, 0, 0]])},
        {"stiffness": np.full((3, 3), math.inf)}, {"damping": np.array([0.01j])}, {"frequency": ["0.7"]},
        {"inertia": None}, {"gyroscopic": 1.0},
    ],
)  # fmt: skip
def test_a_body_that_cannot_be_is_refused(changes):
    with pytest.raises(InputError):
        FlexibleBody(**(BODY | changes))


def test_a_body_of_lists_is_that_of_arrays():
    listed = FlexibleBody(**{name: np.asarray(value).tolist() for name, value in BODY.items()})
    np.testing.assert_array_equal(listed.state_space()[0], FlexibleBody(**BODY).state_space()[0])


@pytest.mark.parametrize(
    "moments",
    [
        [1, 1, 3], [0, 1, 1], [1, 1, -1], [1, math.nan, 1], [1, math.inf, 1], [1, 2], "abc", [[1], [1, 2]],
        np.eye(3) * (1 + 0j), None,
    ],
)  # fmt: skip
def test_an_inertia_that_cannot_be_is_refused(moments):
    with pytest.raises(InputError, match="inertia"):
        inertia_matrix(moments)


@pytest.mark.parametrize(
    "elements",
    [
        (-4e14, 7e6, 0.1),
        (4e14, -7e6, 1.5),
        (4e14, 7e6, 1.0),
        (4e14, 7e6, -0.1),
        (4e14, 7e6, math.nan),
        (4e14, math.inf, 0),
        ("4e14", 7e6, 0.1),
        (4e14, 7e6, None),
        (4e14, np.array([7e6, 8e6]), 0.1),
        (4e14, 7e6, 0.1j),
    ],
)
def test_an_orbit_that_is_no_ellipse_is_refused(elements):
    with pytest.raises(InputError):
        KeplerOrbit(*elements)


@pytest.mark.parametrize(
    "call",
    [
        lambda: thrust_input(-200.0), lambda: thrust_input(0.0), lambda: thrust_input(math.nan),
        lambda: mean_motion(4e14, 0.0), lambda: clohessy_wiltshire(math.nan),
    ],
)  # fmt: skip
def test_numbers_that_no_spacecraft_has_are_refused(call):
    with pytest.raises(InputError):
        call()


@pytest.mark.parametrize("method", ["DOP853", "RK45", "LSODA", "Radau"])
def test_an_integration_that_meets_nan_ends_with_the_time(method):
    # x' = sqrt(1 - t): not a number after t = 1
    with pytest.raises(ComputationError, match=r"t = 1\.|t = 0\.9"), np.errstate(invalid="ignore"):
        integrate(lambda t, x: np.sqrt(np.array([1.0 - t])), np.zeros(1), 2.0, method=method)


@pytest.mark.parametrize("method", ["RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA"])
def test_a_solution_that_leaves_every_bound_ends_with_an_error(method):
    # closed form: x' = x^2, x(0) = 1 is 1/(1 - t)
    with pytest.raises(ComputationError), np.errstate(all="ignore"):
        integrate(lambda t, x: x**2, np.ones(1), 2.0, rtol=1e-6, method=method)


@pytest.mark.parametrize("method", ["RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA"])
def test_an_infinite_derivative_ends_with_an_error(method):
    with pytest.raises(ComputationError), np.errstate(all="ignore"):
        integrate(lambda t, x: -x if t < 0.5 else x * np.inf, np.ones(1), 1.0, rtol=1e-6, method=method)


def test_a_kink_or_an_output_that_is_not_a_number_says_when():
    found = integrate(lambda t, x: -x, np.ones(1), 1.0)
    with pytest.raises(ComputationError, match="kink is not a number at t = 0"):
        integrate(lambda t, x: -x, np.ones(1), 1.0, kinks=[lambda t, x: math.nan])
    for locate in (largest, last_crossing):
        with pytest.raises(ComputationError, match="not a number at t = 0"):
            locate(found, lambda t, x: x[:, 0] * math.nan)
    for time in (-0.1, 1.1, math.nan, np.array([0.5, 1.1])):
        with pytest.raises(InputError, match=r"0\.\.1 s"):
            found(time)


@pytest.mark.parametrize(
    "wrong",
    [{"rtol": math.nan}, {"rtol": -1.0}, {"atol": math.nan}, {"atol": -1.0}, {"atol": np.ones(2)}, {"method": "Euler"}],
)
def test_tolerances_and_methods_that_are_none_are_refused(wrong):
    with pytest.raises(InputError):
        integrate(lambda t, x: -x, np.ones(1), 1.0, **wrong)


@pytest.mark.parametrize(
    ("start", "end", "slope"),
    [([math.nan], 1.0, 0.0), ([1.0], math.nan, 0.0), ([1.0], -1.0, 0.0), ([1.0], 1.0, math.nan), ([[1.0]], 1.0, 0.0)],
)
def test_a_start_that_is_no_start_is_refused(start, end, slope):
    with pytest.raises(InputError):
        integrate(lambda t, x: x * 0 + slope, np.array(start), end)


def test_the_error_estimate_of_a_periodic_solution_is_near_the_error():
    # closed form: x' = cos(2 pi t) M x with M^2 = -I, so x = exp(sin(2 pi t)/(2 pi) M) x0; M commutes with itself, so
    # the quadrature of the cosine is the whole error
    M = np.array([[0.0, 1.0], [-1.0, 0.0]])
    found = PeriodicSolution(lambda t: (1 + np.cos(2 * np.pi * t)) * M, 1.0, np.array([1.0, 0.0]), 3, steps=12)
    angle = found.times + np.sin(2 * np.pi * found.times) / (2 * np.pi)
    exact = np.column_stack([np.cos(angle), -np.sin(angle)])
    error, estimate = np.abs(found.states - exact), found.error()
    assert 1e-7 < error.max() < 1e-3
    np.testing.assert_allclose(estimate, error, atol=0.1 * error.max())


def test_a_periodic_solution_that_overflows_says_when():
    with pytest.raises(ComputationError, match="double precision before"), np.errstate(all="ignore"):
        PeriodicSolution(lambda t: np.array([[300.0]]), 1.0, np.ones(1), 5)


@pytest.mark.parametrize("arguments", [(math.nan, 1), (math.inf, 1), (0.0, 1), (1.0, 0), (1.0, 2.5), ("1", 1)])
def test_a_period_that_is_none_is_refused(arguments):
    with pytest.raises(InputError):
        PeriodicSolution(lambda t: np.eye(1), arguments[0], np.ones(1), arguments[1])


def test_a_periodic_matrix_that_does_not_fit_is_refused():
    for wrong in (np.eye(2), np.ones((1, 2)), [[math.nan]], [["a"]]):
        with pytest.raises(InputError, match=r"A\([0t]"):
            PeriodicSolution(lambda t, wrong=wrong: wrong, 1.0, np.ones(1), 2)
    found = PeriodicSolution(lambda t: -np.eye(1), 1.0, np.ones(1), 2)
    with pytest.raises(InputError, match="after"):
        found.largest(lambda t, x: x[..., 0], after=3.0)
    with pytest.raises(ComputationError, match="not a number at 0 s"):
        found.largest(lambda t, x: x[..., 0] * math.nan)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Disk("1", 1.0), lambda: Disk(1.0, math.nan), lambda: Disk(1.0, 0.0), lambda: HalfPlane(math.nan),
        lambda: HalfPlane("0"), lambda: Disk(1.0, 1.0).reach([[1j]]),
        lambda: DelaySystem(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0))),
        lambda: structured_bounds("abc", [1]), lambda: hinf_norm(np.array([[-1 + 0j]]), [[1]], [[1]]),
    ],
)  # fmt: skip
def test_what_is_no_region_or_system_is_refused(make):
    with pytest.raises(InputError):
        make()


def test_a_structured_value_beyond_doubles_is_refused():
    # its value is 1, the geometric mean of the two entries; no scaling of doubles reaches it
    with pytest.raises(ComputationError), np.errstate(all="ignore"):
        structured_bounds([[0, 1e200], [1e-200, 0]], [1, 1])

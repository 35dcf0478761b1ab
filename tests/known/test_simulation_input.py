"""Simulation and dynamics given what is no input, and what closed forms settle: right, or refused in one line."""

import math

import numpy as np
import pytest

from gainsay.dynamics import attitude
from gainsay.dynamics.relative_orbit import KeplerOrbit
from gainsay.errors import ComputationError, InputError
from gainsay.simulation.delay import DelayLaw, simulate_delay
from gainsay.simulation.linear import Response
from gainsay.simulation.ode import integrate
from gainsay.simulation.periodic import PeriodicSolution, piecewise

NAN, INF, ONE = float("nan"), float("inf"), np.eye(1)


def decay(t, x):
    return -x


def constant(delay):
    return DelayLaw(lambda t: np.full_like(t, delay), delay, 0.0)


def delayed(**changes):
    given = {"A": 0 * ONE, "Bd": -ONE, "Cd": ONE, "law": constant(1.0), "initial": np.ones(1), "end": 2.0, **changes}
    return simulate_delay(**given)


REFUSED = {
    **{f"integrate to {end!r}": lambda end=end: integrate(decay, np.ones(1), end)
       for end in (NAN, INF, 0.0, -1.0, "1", None, 1j, [1.0])},
    "a tolerance that is a text": lambda: integrate(decay, np.ones(1), 1.0, rtol="a"),
    "a tolerance that is none": lambda: integrate(decay, np.ones(1), 1.0, atol=NAN),
    "times in a square": lambda: integrate(decay, np.ones(1), 1.0)(np.ones((1, 2))),
    **{f"response to {end!r}": lambda end=end: Response(-ONE, np.ones(1), end, 10) for end in (NAN, INF, 0, -1)},
    **{f"response in {n!r} steps": lambda n=n: Response(-ONE, np.ones(1), 1.0, n) for n in (0, 1.5, NAN)},
    "response of no matrix": lambda: Response(NAN * ONE, np.ones(1), 1.0, 10),
    "response from nowhere": lambda: Response(-ONE, np.array([NAN]), 1.0, 10),
    **{f"response at {t!r}": lambda t=t: Response(-ONE, np.ones(1), 1.0, 10).at(t) for t in (-1.0, 2.0, NAN)},
    **{f"held for {t!r}": lambda t=t: piecewise(-ONE[None], t, np.ones(1)) for t in (0.0, -1.0, NAN, INF)},
    "held without loops": lambda: piecewise(np.zeros((0, 1, 1)), 1.0, np.ones(1)),
    "held loops that are none": lambda: piecewise(NAN * ONE[None], 1.0, np.ones(1)),
    "delay from a text": lambda: delayed(initial=np.array(["a"])),
    "delay without a matrix": lambda: delayed(A=NAN * ONE),
    "delay with half a stage": lambda: delayed(stages=1.5),
    "forcing of another shape": lambda: delayed(forcing=lambda t: np.zeros((len(t), 2))),
    "a jump after the end": lambda: delayed(jumps=[3.0]),
    "a jump that is none": lambda: delayed(jumps=[NAN]),
    **{f"delayed state at {t!r}": lambda t=t: delayed()(t) for t in (NAN, 2.5, [0.0, NAN])},
    # Wie 1998, section 6.1: moments are positive and none exceeds the sum of the others
    **{f"motion of {J!r}": lambda J=J: attitude.derivative(np.zeros(6), J, 1e-3, np.zeros(3))
       for J in ([1, 1, 3], [0, 1, 1], [-1, 1, 1], [NAN, 1, 1], [1, 1], [[1, 2], [2, 1]], "a", [1j, 1, 1],
                 [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]])},
    "gradient of no body": lambda: attitude.gravity_gradient([1, 1, 3], np.zeros(3), 1e-3),
    "a state of five": lambda: attitude.derivative(np.zeros(5), [1, 1, 1], 1e-3, np.zeros(3)),
    "a torque of two": lambda: attitude.derivative(np.zeros(6), [1, 1, 1], 1e-3, np.zeros(2)),
    **{f"{len(a)} angles to {f.__name__}": lambda a=a, f=f: f(a)
       for a in ([0, 0], [0, 0, 0, 0]) for f in (attitude.direction_cosines, attitude.rate_matrix)},
    "four angles": lambda: attitude.euler_rates([0, 0, 0, 0], np.zeros(3), 1e-3),
    **{f"an orbit at {angle!r}": lambda angle=angle, of=of: getattr(KeplerOrbit(3.986e14, 7e6, 0.3), of)(angle)
       for angle in (NAN, INF) for of in ("radius", "frame_motion", "inertial_state")},
    **{f"an orbit of {numbers}, beyond doubles": lambda numbers=numbers: KeplerOrbit(*numbers, 0.1)
       for numbers in ((3.986e14, 1e308), (3.986e14, 1e-300), (1e-308, 7e6), (1e308, 1e10), (1e300, 1e200))},
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_input_is_refused(name):
    with pytest.raises(InputError) as caught:
        REFUSED[name]()
    assert "\n" not in str(caught.value)


def test_a_response_beyond_doubles_is_refused():
    with pytest.raises(ComputationError, match="double precision"):
        Response(np.array([[800.0]]), np.ones(1), 1.0, 10)


def test_a_plate_is_a_body():
    # the limit of the triangle inequality: a thin plate has Iz = Ix + Iy
    assert np.isfinite(attitude.derivative(np.zeros(6), [1.0, 2.0, 3.0], 1e-3, np.zeros(3))).all()


def by_steps(t, delay):
    """x' = -x(t - d) from 1: the method of steps, sum of (-1)^k (t - (k - 1) d)^k / k!."""
    return sum((-1) ** k * (t - (k - 1) * delay) ** k / math.factorial(k) for k in range(math.floor(t / delay) + 2))


@pytest.mark.parametrize("delay", [1.0, 0.3333, 0.1, 0.02])
@pytest.mark.parametrize("step", [0.5, 0.01])
def test_delays_shorter_and_longer_than_a_step(delay, step):
    found = simulate_delay(0 * ONE, -ONE, ONE, constant(delay), np.ones(1), 3 * delay, step=step)
    assert found(3 * delay)[0, 0] == pytest.approx(by_steps(3 * delay, delay), abs=1e-8)


@pytest.mark.parametrize("delay", [1e-3, 1e-6, 1e-12, 0.0])
def test_a_delay_that_vanishes(delay):
    # x' = -x(t - d) tends to exp(-t), within d of it
    found = simulate_delay(0 * ONE, -ONE, ONE, constant(delay), np.ones(1), 1.0, step=0.05)
    assert found(1.0)[0, 0] == pytest.approx(math.exp(-1), abs=2 * delay + 1e-9)


@pytest.mark.parametrize("width", [1e-1, 1e-4, 1e-8])
def test_a_pulse_between_its_jumps(width):
    # x' = -x(t - 1) + f, f of integral one about 0.5: x = 1 - (t - 0.5) one delay and a half after it, to the width
    ends = [0.5, 0.5 + width]

    def pulse(t):
        return ((t > ends[0]) & (t < ends[1]))[:, None] / (ends[1] - ends[0])

    found = simulate_delay(0 * ONE, -ONE, ONE, constant(1.0), np.zeros(1), 2.0, forcing=pulse, jumps=ends)
    assert found(1.4)[0, 0] == pytest.approx(1.0, abs=1e-9)
    assert found(2.0)[0, 0] == pytest.approx(1 - (0.5 - width / 2), abs=1e-7)


@pytest.mark.parametrize("method", ["DOP853", "Radau", "LSODA", "BDF"])
def test_a_slope_beyond_doubles_ends_the_integration(method):
    # x' = exp(min(1000 x, 700)): finite, and its slope in x is not
    with pytest.raises(ComputationError, match="integration"):
        integrate(lambda t, x: np.exp(np.minimum(1e3 * x, 700)), [0.5], 1.0, method=method)


def test_an_error_of_the_right_hand_side_itself_is_not_hidden():
    def broken(t, x):
        if t > 0:
            raise ValueError("of its own")
        return -x

    with pytest.raises(ValueError, match="of its own"):
        integrate(broken, [0.5], 1.0, method="Radau")


@pytest.mark.filterwarnings("error")
def test_a_periodic_solution_beyond_doubles_is_refused_without_a_warning():
    # x' = 1e4 x for 200 s: e^(2e6)
    with pytest.raises(ComputationError, match="leaves double precision"):
        PeriodicSolution(lambda t: np.array([[1e4]]), 1.0, np.array([1.0]), 200)


@pytest.mark.filterwarnings("error")
def test_a_slope_beyond_doubles_ends_an_integration_without_a_warning():
    with pytest.raises(ComputationError, match="integration: DOP853 gave up"):
        integrate(lambda t, x: 1e200 * x, [1.0], 2.0)


@pytest.mark.filterwarnings("error")
def test_a_body_at_the_end_of_doubles_is_one():
    assert (attitude.inertia_matrix([1e308, 1e308, 1e308]) == np.diag([1e308] * 3)).all()

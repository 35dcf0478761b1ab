"""Simulation and dynamics given functions and entries that are no numbers, and laws that hold for every number."""

import math

import numpy as np
import pytest

from gainsay.dynamics import attitude
from gainsay.dynamics.relative_orbit import KeplerOrbit, differential_gravity, relative_acceleration
from gainsay.errors import ComputationError, InputError
from gainsay.simulation.batch import segments
from gainsay.simulation.delay import DelayLaw, simulate_delay
from gainsay.simulation.linear import Response, with_harmonics
from gainsay.simulation.ode import integrate, largest, last_crossing
from gainsay.simulation.periodic import PeriodicSolution, piecewise, with_oscillators

NAN, INF, ONE = math.nan, math.inf, np.eye(1)
NO_NUMBERS = ("1", None, 1j, [1.0, "a"], {}, b"1")


def decay(t, x):
    return -x


def later(value):
    """A right-hand side that gives something else after half a second."""
    return lambda t, x: value if t > 0.5 else -x


def turning(t):
    return np.array([[0.0, 1.0], [-1.0 - 0.3 * math.cos(t), -0.1]])


def delayed(**changes):
    law = DelayLaw(lambda t: np.full_like(t, 1.0), 1.0, 0.0)
    return simulate_delay(**{"A": 0 * ONE, "Bd": -ONE, "Cd": ONE, "law": law, "initial": [1.0], "end": 2.0, **changes})


def flights(**changes):
    maps = {"linear": -np.eye(2), "entry": np.eye(2), "rest": lambda t, x: 0 * x}
    given = {"starts": np.ones((3, 2)), "end": 1.0, "rtol": 1e-9, "atol": [1e-9, 1e-9], "length": 0.5}
    return list(segments(**{**maps, **given, **changes}))


FALL, SWING = integrate(decay, [1.0], 1.0), Response(np.array([[0, 1], [-1, -0.2]]), [1.0, 0.0], 10.0, 100)
MATHIEU, ORBIT = PeriodicSolution(turning, 2 * math.pi, [1.0, 0.0], 2), KeplerOrbit(3.986e14, 7e6, 0.3)
OUTPUTS = {"a text": "a", "nothing": None, "one number": 1.0, "the states": np.ones((6, 2)), "no real": 1j}

REFUSED = {
    **{f"slope {v!r} later by {m}": lambda v=v, m=m: integrate(later(v), [1.0], 1.0, method=m)
       for v in (*NO_NUMBERS[:5], np.ones(2)) for m in ("DOP853", "Radau", "BDF", "LSODA")},
    **{f"slope {v!r}": lambda v=v: integrate(lambda t, x: v, [1.0], 1.0)
       for v in (*NO_NUMBERS, 1.0, [[1.0]], [NAN], [INF])},
    **{f"kink {v!r}": lambda v=v: integrate(decay, [1.0], 1.0, kinks=[lambda t, x: v]) for v in NO_NUMBERS},
    **{f"trajectory at {v!r}": lambda v=v: FALL(v) for v in (*NO_NUMBERS, NAN, 2.0, -1.0)},
    **{f"{of.__name__} of {name}": lambda of=of, v=v: of(FALL, lambda t, x: v)
       for of in (largest, last_crossing) for name, v in OUTPUTS.items()},
    **{f"periodic matrix {v!r} later": lambda v=v: PeriodicSolution(lambda t: v if t > 3 else turning(t), 6, [1, 0], 2)
       for v in (*NO_NUMBERS, np.eye(3), NAN * np.eye(2), 1j * np.eye(2))},
    **{f"periodic state at {v!r}": lambda v=v: MATHIEU.state(v) for v in (*NO_NUMBERS, NAN, -1.0, 1e9)},
    **{f"periodic peak after {v!r}": lambda v=v: MATHIEU.largest(lambda t, x: x[..., 0], v)
       for v in (*NO_NUMBERS, NAN, 1e9)},
    **{f"last exit of level {v!r}": lambda v=v: MATHIEU.last_exit(lambda t, x: x[..., 0], v)
       for v in (*NO_NUMBERS, NAN)},
    **{f"held loops {v!r}": lambda v=v: piecewise(v, 1.0, [1.0]) for v in (*NO_NUMBERS, 1.0)},
    **{f"oscillator rate {v!r}": lambda v=v: with_oscillators(np.eye(2), np.ones((2, 3)), v)
       for v in (*NO_NUMBERS, NAN, INF)},
    **{f"harmonic {name} {v!r}": lambda name=name, v=v: with_harmonics(
        **{**{"A": -ONE, "shape": [1.0], "rates": [1.0], "amplitude": 1.0, "constant": 0.0}, name: v})
       for name in ("A", "shape", "rates", "amplitude", "constant") for v in (*NO_NUMBERS, NAN, [[NAN]])},
    **{f"peak of output {v!r}": lambda v=v: SWING.peak(v) for v in (*NO_NUMBERS, [NAN, 0], [1.0], [[1.0, 0.0]])},
    **{f"last time of output {v!r}": lambda v=v: SWING.last_above(v, 0.1) for v in (*NO_NUMBERS, [NAN, 0], [1.0])},
    **{f"response above {v!r}": lambda v=v: SWING.last_above([1.0, 0.0], v) for v in (*NO_NUMBERS, NAN)},
    **{f"response at {v!r}": lambda v=v: SWING.at(v) for v in (*NO_NUMBERS, NAN)},
    **{f"delay {name} {v!r}": lambda name=name, v=v: delayed(**{name: v})
       for name in ("end", "step", "start", "stages") for v in (*NO_NUMBERS, NAN, INF)},
    **{f"delay bound {k} {v!r}": lambda v=v, k=k: DelayLaw(np.zeros_like, *((v, 0.0) if k else (1.0, v)))
       for k in (0, 1) for v in (*NO_NUMBERS, NAN, INF)},
    **{f"delay law {v!r}": lambda v=v: delayed(law=DelayLaw(lambda t: v, 1.0, 0.5))
       for v in (*NO_NUMBERS, 0.5, np.ones((2, 2)))},
    **{f"forcing {v!r}": lambda v=v: delayed(forcing=lambda t: v) for v in (*NO_NUMBERS, 1.0)},
    **{f"forcing of {v!r}": lambda v=v: delayed(forcing=lambda t: np.full((len(t), 1), v)) for v in (NAN, INF, 1j)},
    "forcing of two by its transpose": lambda: delayed(
        A=np.zeros((2, 2)), Bd=np.zeros((2, 1)), Cd=np.zeros((1, 2)), initial=[0, 0],
        forcing=lambda t: np.vstack([t, 0 * t])),
    **{f"jumps {v!r}": lambda v=v: delayed(jumps=v) for v in (*NO_NUMBERS, 1.0, [[1.0]])},
    **{f"delay solution at {v!r}": lambda v=v: delayed()(v) for v in (*NO_NUMBERS, [[0.5, 0.6]])},
    **{f"flights {name} {v!r}": lambda name=name, v=v: flights(**{name: v})
       for name in ("linear", "entry", "starts", "end", "rtol", "atol", "length") for v in (*NO_NUMBERS, NAN, -1.0)},
    **{f"flights of rest {v!r}": lambda v=v: flights(rest=lambda t, x: v) for v in (*NO_NUMBERS, np.ones((1, 2)))},
    **{f"{of.__name__} of angles {v!r}": lambda of=of, v=v: of(v)
       for of in (attitude.direction_cosines, attitude.rate_matrix)
       for v in (*NO_NUMBERS, "abc", ["0", "0", "0"], [None, 0, 0], [[0], [0], [0]], {1: 2, 2: 3, 3: 4})},
    **{f"{of.__name__} of rates {v!r}": lambda of=of, v=v: of([0, 0, 0], v, 1e-3)
       for of in (attitude.rate_body, attitude.euler_rates) for v in (*NO_NUMBERS, 1.0, ["0"] * 3, [[0], [0], [0]])},
    **{f"{of.__name__} at orbital rate {v!r}": lambda of=of, v=v: of([0, 0, 0], [0, 0, 0], v)
       for of in (attitude.rate_body, attitude.euler_rates) for v in (*NO_NUMBERS, NAN)},
    **{f"gradient at orbital rate {v!r}": lambda v=v: attitude.gravity_gradient([1, 1, 1], [0, 0, 0], v)
       for v in (*NO_NUMBERS, NAN)},
    **{f"attitude state {v!r}": lambda v=v: attitude.derivative(v, [1, 1, 1], 1e-3, np.zeros(3))
       for v in (*NO_NUMBERS, "abcdef", ["a"] * 6, np.zeros((6, 1)))},
    **{f"torque {v!r}": lambda v=v: attitude.derivative(np.zeros(6), [1, 1, 1], 1e-3, v) for v in (*NO_NUMBERS, 1.0)},
    **{f"{name} of anomaly {v!r}": lambda name=name, v=v: getattr(ORBIT, name)(v)
       for name in ("radius", "frame_motion", "inertial_state") for v in NO_NUMBERS},
    **{f"gravity at {v!r}": lambda v=v: differential_gravity(1.0, 1.0, v, 0.0, 0.0) for v in NO_NUMBERS},
    **{f"gravity of {v!r} in place {k}": lambda v=v, k=k: differential_gravity(*((v, 1) if k else (1, v)), 0.1, 0, 0)
       for k in (0, 1) for v in (*NO_NUMBERS, 0.0, -1.0, NAN, INF)},
    "gravity in the Earth's centre": lambda: differential_gravity(1.0, 1.0, -1.0, 0.0, 0.0),
    **{f"relative motion from {v!r} in place {k}": lambda v=v, k=k: relative_acceleration(
        ORBIT, 0.0, *((v, [0, 0, 0]) if k else ([1, 0, 0], v))) for k in (0, 1) for v in NO_NUMBERS},
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_number_is_refused(name):
    with pytest.raises(InputError) as caught:
        REFUSED[name]()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("rest", [lambda t, x: 5 * x**2, lambda t, x: x * (NAN if t[-1] > 0.3 else 1)])
def test_flights_that_end_are_ended(rest):
    # x' = -x + 5 x^2 from 1 has its pole at log(5/4)
    with pytest.raises(ComputationError):
        flights(rest=rest)


def test_a_function_that_is_none_has_no_last_exit():
    with pytest.raises(ComputationError, match="not a number"):
        MATHIEU.last_exit(lambda t, x: NAN * x[..., 0], 1.0)


def test_gains_held_beyond_doubles_are_refused():
    with pytest.raises(ComputationError, match="double precision"), np.errstate(all="ignore"):
        piecewise(np.full((3, 1, 1), 800.0), 1.0, [1.0])


def test_sliding_along_a_kink_is_said():
    # Filippov: x' = -sign(x - 1/2) reaches 1/2 after half a second and stays
    with pytest.raises(ComputationError, match=r"slides along a kink from t = 0\.5"):
        integrate(lambda t, x: -np.sign(x - 0.5), [1.0], 1.0, kinks=[lambda t, x: x[0] - 0.5])


def test_an_output_may_be_infinite():
    time, value = largest(FALL, lambda t, x: np.where(t > 0.5, INF, 0.0))
    assert time > 0.5 and value == INF


@pytest.mark.parametrize("start", [-3.0, 0.0, 7.0])
def test_the_clock_of_a_delay_run_may_start_anywhere(start):
    # x' = -x(t - 1), x = 1 before: by the method of steps 1 - t + (t - 1)^2 / 2 at t = 2
    assert delayed(start=start, end=start + 2)(start + 2)[0, 0] == pytest.approx(-0.5, abs=1e-10)


@pytest.mark.parametrize("growth", [0.0, -0.2, 0.1])
def test_floquet_multipliers_of_one_state(growth):
    # x' = (g + cos(t)/2) x: the multiplier is exp(2 pi g)
    solution = PeriodicSolution(lambda t: np.array([[growth + 0.5 * math.cos(t)]]), 2 * math.pi, [1.0], 3)
    assert solution.monodromy[0, 0] == pytest.approx(math.exp(2 * math.pi * growth), rel=1e-8)


def test_a_double_multiplier_of_one():
    # x1' = (1 + cos t) x2, x2' = 0: a Jordan block [[1, 2 pi], [0, 1]]
    def A(t):
        return np.array([[0.0, 1.0 + math.cos(t)], [0.0, 0.0]])

    found = PeriodicSolution(A, 2 * math.pi, [0.0, 1.0], 3).monodromy
    np.testing.assert_allclose(found, [[1, 2 * math.pi], [0, 1]], atol=1e-9)


@pytest.mark.parametrize("eccentricity", [0.0, 0.1, 0.9, 0.99])
@pytest.mark.parametrize("anomaly", [0.0, 2.5, -1.0, 9.0])
def test_energy_and_momentum_of_an_orbit(eccentricity, anomaly):
    # vis-viva: v^2/2 - mu/r = -mu/(2 a); the angular momentum is sqrt(mu a (1 - e^2))
    position, velocity = KeplerOrbit(1.0, 1.0, eccentricity).inertial_state(anomaly)
    assert velocity @ velocity / 2 - 1 / np.linalg.norm(position) == pytest.approx(-0.5, abs=1e-11)
    momentum = position[0] * velocity[1] - position[1] * velocity[0]
    assert momentum == pytest.approx(math.sqrt(1 - eccentricity**2), abs=1e-13)

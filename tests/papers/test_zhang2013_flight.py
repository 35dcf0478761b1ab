"""Plant and runs of zhang2013 against physics, closed forms and an independent integrator."""

import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from gainsay.errors import CertificateError, InputError
from gainsay.logs import LogWriter, read_log
from gainsay.logs.check import layout_problems
from gainsay.proof.build import finish
from gainsay.scans.criterion import criteria
from gainsay.simulation.delay import DelayLaw
from gainsay.systems.delay_spectrum import spectral_abscissa, unstable_root_count
from gainsay.tables import Case, read_case
from papers.zhang2013 import proofs, runs, scans
from papers.zhang2013 import response as flight
from papers.zhang2013.figures import FIGURES
from papers.zhang2013.plant import MODES, Spacecraft

CASE: Case = read_case(Path(__file__).resolve().parents[2], "zhang2013")
CRAFT = Spacecraft.of(CASE)
K, L = CASE.printed("K").exact, CASE.printed("L").exact
NONE = DelayLaw(lambda t: 0.0 * t, 0.0, 0.0)


def test_flexible_plant_solves_the_equations_of_motion():
    # the mass matrix [[J, F], [F', I]] solved in floats, apart from the elimination in the plant
    A, B = (m.astype(float) for m in CRAFT.flexible())
    F = np.array([[float(f) for f in CRAFT.coupling]])
    mass = np.block([[np.array([[35.72]]), F], [F.T, np.eye(2)]])
    state = np.array([0.3, -0.2, 0.5, 0.7, -0.4, 0.9])
    w, z = np.array([3.17, 7.38]), np.array([0.0001, 0.0015])
    force = np.concatenate([[2.0], -2 * z * w * state[4:] - w**2 * state[2:4]])
    acceleration = np.linalg.solve(mass, force)
    np.testing.assert_allclose((A @ state + B[:, 0] * 2.0)[[1, 4, 5]], acceleration, rtol=1e-12)


def test_energy_is_kept_without_damping():
    craft = replace(CRAFT, damping=(Fraction(0), Fraction(0)))
    A = craft.flexible()[0].astype(float)
    F, w = np.array([float(f) for f in craft.coupling]), np.array([3.17, 7.38])

    def energy(x):
        return 0.5 * (35.72 * x[1] ** 2 + 2 * x[1] * F @ x[4:] + x[4:] @ x[4:] + (w * x[2:4]) @ (w * x[2:4]))

    x = np.array([0.1, 0.2, 0.3, -0.1, 0.5, 0.4])
    assert energy(expm(7.0 * A) @ x) == pytest.approx(energy(x), rel=1e-10)


def test_observer_state_of_the_paper_and_its_estimate_give_the_same_loop():
    # (4) with p instead of w2hat = p + L x: a change of coordinates, so the same eigenvalues
    A, B = (m.astype(float) for m in CRAFT.flexible())
    Kf, Lf = CASE.matrix("K"), CASE.matrix("L")
    A2, B2 = CRAFT.A.astype(float), CRAFT.B.astype(float)
    u = np.hstack([Kf - Lf, np.zeros((1, 4)), [[-1.0]]])  # -w2hat + K x = -p - L x + K x
    LB = Lf @ B2
    p_rate = -LB @ np.hstack([Lf, np.zeros((1, 4)), [[1.0]]]) - np.hstack([Lf @ A2, np.zeros((1, 5))]) - LB @ u
    loop = np.vstack([np.hstack([A, np.zeros((6, 1))]) + B @ u, p_rate])
    system = CRAFT.flexible_loop(K, L, "paper")
    expected, found = (np.sort_complex(np.linalg.eigvals(m)) for m in (loop, system.A + system.A1))
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_delay_margin_of_the_design_model_is_its_closed_form():
    # s^2 = b (K1 + K2 s) e^{-sd}: w^4 = b^2 (K1^2 + K2^2 w^2), and w d is the angle of -(K1 + j K2 w)
    b = 1 / (35.72 - 1.27814**2 - 0.91756**2)
    k1, k2 = 5.7323 * b, 5.4831 * b
    w = math.sqrt((k2**2 + math.sqrt(k2**4 + 4 * k1**2)) / 2)
    margin = CRAFT.design_loop(K, L).quasi_polynomial.margin()
    assert margin.delay == pytest.approx(math.atan2(k2 * w, k1) / w, rel=1e-12)


@pytest.mark.parametrize("mode", MODES)
def test_flexible_margins_are_where_roots_cross(mode):
    loop = CRAFT.flexible_loop(K, L, mode)
    margin = loop.quasi_polynomial.margin().delay
    assert spectral_abscissa(loop, margin * (1 - 1e-6)) < 0 < spectral_abscissa(loop, margin * (1 + 1e-6))
    assert unstable_root_count(loop, 0.99 * margin) == 0
    assert unstable_root_count(loop, 1.01 * margin) == 2


@pytest.mark.parametrize(("mode", "start"), [("paper", "zero"), ("all", "matched"), ("no_observer", "zero")])
def test_a_run_without_delay_is_a_matrix_exponential(mode, start):
    found = flight.fly(CASE, K, L, mode, start, law=NONE, horizon=10.0)
    loop = CRAFT.flexible_loop(K, L, mode)
    n = loop.order
    size = 4.5e-5
    # oscillator (cos t, sin t) appended: w1 = size (3 cos t + 1.5 sin t)
    whole = np.zeros((n + 2, n + 2))
    whole[:n, :n] = loop.A + loop.A1
    whole[:n, n:] = loop.B @ [[3 * size, 1.5 * size]]
    whole[n:, n:] = [[0, -1], [1, 0]]
    x0 = np.zeros(n + 2)
    x0[:2], x0[n] = (0.08, 0.001), 1.0
    if start == "zero" and mode != "no_observer":
        x0[6] = 105.4207 * 0.001
    np.testing.assert_allclose(found.solution(np.array([10.0]))[0], (expm(10 * whole) @ x0)[:n], atol=1e-10)


def test_located_minimum_is_stationary_and_below_every_sample():
    found = flight.fly(CASE, K, L, "paper", "zero", horizon=20.0)
    time, value = flight.lowest_angle(found)
    assert abs(found.solution(np.array([time]))[0, 1]) < 1e-12
    assert value <= found.solution(np.linspace(0, 20, 20001))[:, 0].min() + 1e-15


def test_numbers_do_not_depend_on_the_mesh():
    one, two = (
        flight.numbers(flight.fly(CASE, K, L, "all", "zero", horizon=60.0, **scheme))
        for scheme in ({}, {"step": 0.017, "stages": 6})
    )
    for name, (_, value, _) in one.items():
        assert two[name][1] == pytest.approx(value, rel=1e-8, abs=1e-12), name


def test_bad_choices_are_refused():
    with pytest.raises(InputError, match="zero, matched"):
        flight.fly(CASE, K, L, "paper", "elsewhere")
    with pytest.raises(InputError, match="delay mode"):
        CRAFT.flexible_loop(K, L, "some")
    with pytest.raises(InputError, match="J - F F'"):
        replace(CRAFT, inertia=Fraction(1))


def test_a_law_outside_the_paper_is_refused_with_the_time():
    law = DelayLaw(lambda t: 0.02 * (1 + np.sin(3 * t)), CASE.number("d_M"), CASE.number("mu"))
    with pytest.raises(InputError, match=r"delay at t = 0\.1745\d* s"):  # asin(0.5) / 3 = 0.17453 s
        flight.fly(CASE, K, L, "paper", "zero", law=law, horizon=5.0)


@pytest.mark.parametrize(
    ("mean", "amplitude", "frequency", "expected"),
    [(0.015, 0.015, 6.0, True), (0.02, 0.015, 6.0, False), (0.015, 0.016, 1.0, False), (0.015, 0.015, 6.7, False)],
)
def test_admissible_laws_keep_the_bounds_of_the_paper(mean, amplitude, frequency, expected):
    point = {"delay_mean": mean, "delay_amplitude": amplitude, "delay_frequency": frequency}
    assert flight.admissible(CASE, point) == expected


def test_quantities_of_a_run_come_from_its_log(tmp_path, monkeypatch):
    short = {"horizon": 3.0, "log_step": 0.05}
    monkeypatch.setattr(Case, "number", lambda self, name: short.get(name, float(self.exact(name))))
    run = runs.RUNS[0]
    path = tmp_path / "nominal.mcap"
    with LogWriter(path, provenance={"paper": "zhang2013"}) as log:
        run.simulate(CASE, {}, log)
    log = read_log(path)
    measured = run.measure(CASE, log)
    assert set(measured) == {q for q in CASE.quantities if q.startswith("run.") and q.count(".") == 1}
    assert all(m.lower <= m.value <= m.upper for m in measured.values())
    assert layout_problems(runs.LAYOUT, log) == []
    angle = log["/spacecraft/attitude"].column("angle")
    assert angle[0] == 0.08
    assert measured["run.theta_min"].value <= angle.min()


def test_a_scanned_reading_at_our_filling_is_the_nominal_run():
    point = {name: CASE.number(name) for name in scans.SCANNED[:5]} | {"delay_mode": "paper", "observer_start": "zero"}
    found = flight.scan_numbers(CASE, point | {"horizon": 120.0})
    nominal, bare = (flight.numbers(flight.fly(CASE, K, L, m, "zero", horizon=120.0)) for m in ("paper", "no_observer"))
    for name in ("theta_end", "rate_end", "estimation_error_rms_end"):
        assert found[f"run.{name}"] == pytest.approx(nominal[name][1], rel=1e-7), name
    vibration = nominal["vibration_rms_50s"][1]
    assert found["audit.rejection"] == pytest.approx(nominal["estimation_error_rms_50s"][1] / vibration, rel=1e-7)
    assert found["audit.vibration_ratio"] == pytest.approx(vibration / bare["vibration_rms_50s"][1], rel=1e-7)


def test_every_scanned_quantity_has_a_claim_with_a_criterion():
    for quantity in scans.SCANNED_QUANTITIES:
        (of,) = (claim for claim in CASE.claims.values() if claim.quantity == quantity)
        assert all(reading.phrase for reading in criteria(of))


SIZE = "number('w1_amplitude') ** 2 * (number('w1_cosine') ** 2 + number('w1_sine') ** 2)"


def ends(made, quantity: str) -> tuple[float, float]:
    (inside,) = (c.value for c in made.conclusions if c.relation == "inside" and c.quantity == quantity)
    return tuple(float(Fraction(end)) for end in inside.split(".."))


def test_root_mean_square_of_w1_is_its_amplitude_over_the_root_of_two():
    low, high = ends(proofs.w1_rms(CASE, SIZE, "audit.w1_rms"), "audit.w1_rms")
    t = np.arange(1000) * (2 * np.pi / 1000)  # one period, evenly sampled: exact for a sinusoid
    assert low == pytest.approx(np.sqrt(np.mean(flight.external_torque(CASE)(t) ** 2)), rel=1e-12)
    assert high == pytest.approx(low, rel=1e-12)


def test_the_estimation_error_keeps_the_amplitude_that_is_certified():
    made = proofs.residual_error(CASE, "w1_frequency", SIZE, "audit.residual_error")
    low, high = ends(made, "audit.residual_error")
    run = flight.fly(CASE, K, L, "paper", "zero", law=NONE, horizon=420.0)
    x = run.solution(420.0 - np.arange(1000) * (2 * np.pi / 1000))  # the last period; free motion: exp(-0.04 * 413)
    error = run.w2(x) - run.estimate(x)
    assert np.sqrt(2 * np.mean(error**2)) == pytest.approx(low, rel=1e-4)
    assert high == pytest.approx(low, rel=1e-12)
    # the error of a body that does not vibrate: e' = -L B (e + w1)
    bandwidth = 105.4207 / (35.72 - 1.27814**2 - 0.91756**2)
    assert low == pytest.approx(4.5e-5 * math.sqrt(11.25) * bandwidth / math.hypot(bandwidth, 1.0), rel=0.02)


def test_the_norm_of_w_may_exceed_the_larger_bound():
    made = proofs.larger_than_max(CASE)
    with pytest.raises(CertificateError):  # with delta_2 = 0 it cannot
        finish(
            made.changed(definitions=(("delta_1", "4"), ("delta_2", "0")), fields=made.fields | {"low": "1e-9"}), CASE
        )


def test_every_run_and_figure_is_declared():
    assert {run.name for run in runs.RUNS} == set(CASE.paper.runs)
    assert {figure.name for figure in FIGURES} == set(CASE.paper.figures)


@pytest.mark.slow
def test_the_nominal_run_agrees_with_an_independent_integrator():
    jitcdde = pytest.importorskip("jitcdde")
    pytest.importorskip("sympy")  # jitcdde writes its C code with it
    import symengine

    loop = CRAFT.flexible_loop(K, L, "paper")
    t, y = jitcdde.t, jitcdde.y
    late = t - 0.015 * (1 + symengine.sin(6 * t))
    w1 = 4.5e-5 * (3 * symengine.cos(t) + 1.5 * symengine.sin(t))
    delayed = sum(float(loop.Cd[0, j]) * y(j, late) for j in range(2))
    right = [
        sum(float(loop.A[i, j]) * y(j) for j in range(7)) + float(loop.Bd[i, 0]) * delayed + float(loop.B[i, 0]) * w1
        for i in range(7)
    ]
    initial = [0.08, 0.001, 0, 0, 0, 0, 105.4207 * 0.001]
    other = jitcdde.jitcdde(right, max_delay=0.03)
    other.constant_past(initial)
    other.set_integration_parameters(atol=1e-12, rtol=1e-11, first_step=1e-4, max_step=5e-3)
    other.adjust_diff()
    reached = np.array([other.integrate(time) for time in (2.0, 5.0, 10.0)])
    found = flight.fly(CASE, K, L, "paper", "zero", horizon=10.0).solution(np.array([2.0, 5.0, 10.0]))
    np.testing.assert_allclose(found, reached, atol=1e-8)

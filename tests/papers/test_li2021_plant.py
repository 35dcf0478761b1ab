"""Plant of li2021: exact identities, the full model against the reduced one, the linear fractional form."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.tables import read_case
from papers.li2021 import conditions_robust as robust
from papers.li2021 import plant

ROOT = Path(__file__).resolve().parents[2]
DELTA = st.tuples(*[st.fractions(-1, 1, max_denominator=50)] * 3)


@pytest.fixture(scope="module")
def case():
    return read_case(ROOT, "li2021")


def exact_diagonal(values):
    return np.array(
        [[v if i == j else Fraction(0) for j in range(len(values))] for i, v in enumerate(values)], dtype=object
    )


@settings(max_examples=25, deadline=None)
@given(DELTA)
def test_factorisations_hold_exactly(delta):
    # identity in rationals, from the definitions of D and G
    k = plant.exact_constants(read_case(ROOT, "li2021"))
    f = plant.uncertainty_factors(k)
    J = tuple(j + e * d for j, e, d in zip(k.inertia, k.envelope, delta, strict=True))
    change_D = plant.gyroscopic(k.orbital_rate, J) - plant.gyroscopic(k.orbital_rate, k.inertia)
    change_G = plant.gravity_gradient(k.orbital_rate, J) - plant.gravity_gradient(k.orbital_rate, k.inertia)
    assert (f.XD @ exact_diagonal([delta[i] for i in f.order_D]) @ f.GD == change_D).all()
    assert (f.XG @ exact_diagonal([delta[i] for i in f.order_G]) @ f.GG == change_G).all()


def test_factors_are_those_of_the_tables(case):
    f = plant.uncertainty_factors(plant.constants(case))
    assert (f.GD == case.matrix("GammaD")).all() and (f.GG == case.matrix("GammaG")).all()


def test_exact_and_float_plants_agree(case):
    exact = plant.rigid(plant.exact_constants(case), (Fraction(1, 3), Fraction(-1), Fraction(1, 7)))
    floats = plant.rigid(plant.constants(case), (1 / 3, -1, 1 / 7))
    assert np.allclose(exact.A.astype(float), floats.A, rtol=1e-13, atol=1e-22)


def test_reduction_to_seven(case):
    # identity: (6) is (7) with d~ = d + F'(Cm eta' + Lambda eta), also off the nominal inertia
    k, delta = plant.constants(case), (1.0, -0.5, 0.3)
    full, reduced = plant.flexible(k, delta), plant.rigid(k, delta)
    rng = np.random.default_rng(3)
    x, u, d = rng.standard_normal(14), rng.standard_normal(3), rng.standard_normal(3)
    w, zeta = np.array(k.frequency), np.array(k.damping)
    felt = d + k.coupling.T @ (2 * zeta * w * x[10:] + w**2 * x[6:10])
    assert np.allclose((full.A @ x + full.B @ (u + d))[:6], reduced.A @ x[:6] + reduced.B @ (u + felt), atol=1e-14)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 100_000))
def test_linear_fractional_form_closes_to_the_loop(seed):
    # identity: upper loop closed by Delta gives (10) with (9) and inertias off nominal
    case = read_case(ROOT, "li2021")
    k, gains = plant.constants(case), plant.controller(case, "proposed")
    rng = np.random.default_rng(seed)
    bound, delta = 0.07, rng.uniform(-1, 1, 3)
    gain = rng.uniform(-1, 1, 12)
    f = plant.uncertainty_factors(k)
    repeated = np.concatenate([gain, np.sign(k.envelope) * delta, delta[list(f.order_G)], delta[list(f.order_D)]])
    for form in (robust.loop(k, gains, bound), robust.loop(k, gains, bound).balanced()):
        closed = form.A + form.H @ np.diag(repeated) @ np.linalg.solve(
            np.eye(27) - form.Dw @ np.diag(repeated), form.Cz
        )
        factors = 1 + bound * gain
        wanted = plant.closed_loop(plant.rigid(k, delta), gains, factors[:6], factors[6:9], factors[9:])
        assert np.allclose(form.T @ closed @ np.linalg.inv(form.T), wanted, rtol=1e-9, atol=1e-10)


def test_gain_factors_act_as_in_nine(case):
    # (9): columns of A_f and B_f, rows of C_f
    k, gains = plant.constants(case), plant.controller(case, "proposed")
    nominal = plant.rigid(k)
    fa, fb, fc = np.arange(1.0, 7), np.arange(1.0, 4), np.array([2.0, 3.0, 5.0])
    loop = plant.closed_loop(nominal, gains, fa, fb, fc)
    assert np.allclose(loop[6:, 6:], gains.A @ np.diag(fa))
    assert np.allclose(loop[6:, :6], gains.B @ np.diag(fb) @ nominal.C)
    assert np.allclose(loop[:6, 6:], nominal.B @ np.diag(fc) @ gains.C)
    stack = plant.closed_loop(nominal, gains, np.stack([fa, fa]), np.stack([fb, fb]), np.stack([fc, fc]))
    assert np.allclose(stack[1], loop)


def test_disturbance_of_table_one(case):
    # Table 1 at t = 0: d = 1.5e-5 (4 J1, 3 J2, J3)
    k = plant.constants(case)
    found = plant.disturbance(case, k) @ [1, 0, 1]
    assert np.allclose(found, 1.5e-5 * np.array([4 * 25.3868, 3 * 24.3483, 20.3781]), rtol=1e-12)

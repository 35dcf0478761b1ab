import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import ComputationError, InputError
from gainsay.lmi import Infimum, infimum, matrix, symmetric
from gainsay.proof.scope import MappingTables
from gainsay.statements.floats import Floats
from gainsay.systems.norms import h2_norm, hinf_norm
from papers.pinheiro2013 import conditions as mixed
from papers.pinheiro2013 import conditions_gains as gains
from papers.pinheiro2013 import conditions_pitch as pitch
from papers.pinheiro2013 import statements
from papers.pinheiro2013.plant import Satellite, generalized_plant

SATELLITE = Satellite((12.0, 11.0, 9.0), 1.0e-3)
PITCH, ROLL_YAW = (generalized_plant(SATELLITE, group) for group in ("pitch", "roll_yaw"))
moments = st.tuples(*[st.floats(4, 8)] * 3)


def test_least_level_of_pitch_has_its_closed_form():
    # Closed form: D11 has one row, -(p, 3 n^2 p Ix/Iy, 3 n^2 p Iz/Iy, -1/Iy) with p the relative change.
    Ix, Iy, Iz = SATELLITE.inertia
    g = 3 * SATELLITE.n**2 / Iy
    expected = np.sqrt(0.01 * (1 + g**2 * (Ix**2 + Iz**2)) + 1 / Iy**2)
    assert mixed.gamma_min(PITCH) == pytest.approx(expected, rel=1e-14)


@given(moments, st.sampled_from(["pitch", "roll_yaw", "all"]), st.floats(1e-4, 2e-3))
@settings(max_examples=30, deadline=None)
def test_closed_form_gain_reaches_the_least_level(inertia, group, n):
    # Law: the norm of a loop is at least that of its feedthrough; the closed-form gain meets the bound.
    plant = generalized_plant(Satellite(inertia, n), group)
    norm, _ = hinf_norm(*plant.closed(mixed.limit_gain(plant))[:4])
    assert norm == pytest.approx(mixed.gamma_min(plant), rel=1e-9)


@pytest.mark.parametrize("gamma", [0.15, 0.5, 2.0, 20.0])
def test_lmi_agrees_with_descent_over_the_gains(gamma):
    # Second method: the Riccati equation of a fixed gain, minimised over the two gains, no LMI.
    found = infimum(mixed.mixed_program(PITCH, gamma))
    assert isinstance(found, Infimum)
    K = np.linalg.solve(found.values["X"], found.values["Y"].T).T
    _, sqrt_trace = mixed.mixed_by_descent(PITCH, gamma, K)
    assert np.sqrt(found.value) == pytest.approx(sqrt_trace, rel=1e-6)
    assert found.lower <= sqrt_trace**2 * (1 + 1e-9)


@pytest.mark.parametrize("plant", [PITCH, ROLL_YAW], ids=["pitch", "roll_yaw"])
@pytest.mark.parametrize("gamma", [0.2, 2.0, 100.0])
def test_design_keeps_both_bounds_and_its_trace_is_that_of_its_gain(plant, gamma):
    design = mixed.mixed_design(plant, gamma)
    assert design.hinf <= gamma
    assert design.h2 <= design.sqrt_trace
    # Identity: the least X for this gain solves a Riccati equation.
    assert mixed.trace_of_gain(plant, design.K, gamma) == pytest.approx(design.sqrt_trace**2, rel=2e-6)


def test_gains_forget_the_weights_at_the_least_level():
    # Closed form of the limit: sqrt 2 and 2^(3/4) for pitch; sqrt 2 and 1 + sqrt 2 for roll and yaw; the distance to it
    # is of the order of the distance to the level.
    for weights in ((0.1, 0.1, 1.0), (1.0, 0.3, 1.0)):
        satellite = Satellite(SATELLITE.inertia, SATELLITE.n, weights=weights)
        plant = generalized_plant(satellite, "pitch")
        K = mixed.mixed_design(plant, 1.0005 * mixed.gamma_min(plant)).K / satellite.moment("y")
        assert K[0] == pytest.approx([np.sqrt(2), 2**0.75], rel=1e-3)
        plant = generalized_plant(satellite, "roll_yaw")
        K = mixed.mixed_design(plant, 1.0005 * mixed.gamma_min(plant)).K / satellite.moment("z")
        assert K[1, [1, 3]] == pytest.approx([np.sqrt(2), 1 + np.sqrt(2)], rel=1e-3)


def test_h2_limit_of_pitch_has_its_closed_form():
    # Closed form of the double integrator's Riccati equation, derived by hand.
    found = mixed.h2_design(PITCH)
    K, norm = pitch.h2_limit(PITCH, SATELLITE.moment("y"))
    assert pytest.approx(K, rel=1e-9) == found.K
    assert (found.h2, found.sqrt_trace) == pytest.approx((norm, norm), rel=1e-9)


def test_large_levels_approach_the_h2_limit_from_above():
    limit = mixed.h2_design(ROLL_YAW)
    bounds = [mixed.mixed_design(ROLL_YAW, gamma).sqrt_trace for gamma in (30.0, 100.0, 1000.0)]
    assert bounds == sorted(bounds, reverse=True)
    assert limit.h2 < bounds[-1] < limit.h2 * (1 + 1e-3)


@given(st.floats(0.05, 5), st.floats(0.05, 5))
@settings(max_examples=50, deadline=None)
def test_closed_forms_of_both_pitch_norms(k1, k2):
    K = (np.array([[k1, k2]]) + PITCH.A[1]) / PITCH.B2[1, 0]
    A, B, C, D, C2 = PITCH.closed(K)
    # Other methods: Hamiltonian test and Gramians.
    assert pitch.norms(PITCH, k1, k2) == pytest.approx((h2_norm(A, B, C2), hinf_norm(A, B, C, D)[0]), rel=1e-7)


@pytest.mark.parametrize("gamma", [0.15, 1.0, 10.0])
def test_no_pitch_gain_beats_the_true_optimum(gamma):
    K, least = pitch.true_optimum(PITCH, gamma)
    A, B, C, D, C2 = PITCH.closed(K)
    assert h2_norm(A, B, C2) == pytest.approx(least, rel=1e-8)
    assert hinf_norm(A, B, C, D)[0] <= gamma * (1 + 1e-8)
    assert least < mixed.mixed_design(PITCH, gamma).h2
    generator, k = np.random.default_rng(1), PITCH.B2[1, 0] * K[0] - PITCH.A[1]
    for factor in np.exp(generator.normal(0, 0.3, (3000, 2))):
        h2, hinf = pitch.norms(PITCH, *(k * factor))
        assert hinf > gamma or h2 >= least * (1 - 1e-9)


@given(st.integers(0, 1000))
@settings(max_examples=30, deadline=None)
def test_printed_lmi_fails_everywhere(seed):
    # Closed form: block (3, 3) is gamma^2 I, hence the largest eigenvalue is at least gamma^2.
    generator = np.random.default_rng(seed)
    X = generator.standard_normal((2, 2))
    values = {"X": X @ X.T, "Y": generator.standard_normal((1, 2))}
    assert np.linalg.eigvalsh(first_of_21(values, statements.equation_21))[-1] >= 4.0


def first_of_21(values: dict, edition) -> np.ndarray:
    """First LMI of (21) for pitch at gamma = 2 and a point, by the solver's evaluator."""
    return floats().value(edition(statements.sizes(PITCH), {}, "4").formula).value(values)


def floats() -> Floats:
    """Formulas over the plant of pitch in doubles and the unknowns of (21)."""
    texts = {name: [[repr(float(x)) for x in row] for row in getattr(PITCH, name)] for name in statements.GIVEN}
    unknowns = {"X": symmetric("X", 2), "Y": matrix("Y", 1, 2), "Q": symmetric("Q", 3)}
    return Floats(MappingTables(printed=texts), {**statements.GIVEN, "gamma2": "4"}, unknowns)


def test_21_is_what_a_second_reading_spells():
    """Typed afresh from the paper's (21): blocks row by row, both triangles; the sign of (3,3) as printed."""
    rng = np.random.default_rng(5)
    X, Y, Q = rng.normal(size=(2, 2)), rng.normal(size=(1, 2)), rng.normal(size=(3, 3))
    X, Q, p = X + X.T, Q + Q.T, PITCH
    AX_B2Y = p.A @ X - p.B2 @ Y
    CX_DY = p.C1 @ X - p.D12 @ Y
    one = np.block([
        [AX_B2Y + AX_B2Y.T, p.B1, CX_DY.T],
        [p.B1.T, -np.eye(4), p.D11.T],
        [CX_DY, p.D11, 4 * np.eye(3)],
    ])  # fmt: skip
    two = np.block([[Q, p.C2 @ X - p.D22 @ Y], [(p.C2 @ X - p.D22 @ Y).T, X]])
    values = {"X": X, "Y": Y, "Q": Q}
    np.testing.assert_allclose(first_of_21(values, statements.equation_21), one, atol=1e-13)
    second = statements.second_21(statements.sizes(PITCH), {}).formula
    np.testing.assert_allclose(floats().value(second).value(values), two, atol=1e-13)
    one[-3:, -3:] *= -1  # the bounded real lemma has -gamma^2 I there
    np.testing.assert_allclose(first_of_21(values, statements.corrected_21), one, atol=1e-13)


def test_level_below_the_least_is_refused_with_the_least_named():
    least = mixed.gamma_min(PITCH)
    for call in (mixed.mixed_design, mixed.mixed_program, pitch.true_optimum):
        with pytest.raises(InputError, match=rf"gamma 0\.09.*{least!r}|{least!r}.*gamma 0\.09|gamma_min = {least!r}"):
            call(PITCH, 0.09)


@pytest.mark.parametrize("plant", [PITCH, ROLL_YAW], ids=["pitch", "roll_yaw"])
@pytest.mark.parametrize("gamma", [0.2, 2.0, 100.0])
def test_gradient_of_the_trace_is_its_difference_quotient(plant, gamma):
    K = mixed.starting_gain(plant, gamma)[0] * 1.02
    gradient, generator = mixed.trace_gradient(plant, K, gamma), np.random.default_rng(5)
    for _ in range(5):
        step = 1e-5 * generator.standard_normal(K.shape) * np.abs(K).max()
        slope = mixed.trace_of_gain(plant, K + step, gamma) - mixed.trace_of_gain(plant, K - step, gamma)
        assert slope == pytest.approx(2 * np.sum(gradient * step), rel=1e-4)


@pytest.mark.parametrize("gamma", [0.2, 2.0, 100.0])
def test_descent_ends_where_the_lmi_does_from_elsewhere(gamma):
    design = mixed.mixed_design(ROLL_YAW, gamma)
    K, sqrt_trace = mixed.mixed_by_descent(ROLL_YAW, gamma, mixed.starting_gain(ROLL_YAW, gamma)[0])
    assert sqrt_trace == pytest.approx(design.sqrt_trace, rel=1e-6)
    assert sqrt_trace <= design.sqrt_trace
    assert pytest.approx(design.K, rel=1e-3, abs=1e-5 * np.abs(design.K).max()) == K


def test_gain_that_misses_the_level_has_no_covariance():
    with pytest.raises(ComputationError, match=r"gamma = 2\.0"):
        mixed.least_covariance(PITCH, mixed.h2_design(PITCH).K, 2.0)
    assert mixed.trace_of_gain(PITCH, -np.ones((1, 2)), 2.0) == np.inf


LEVELS = (0.2, 2.0, 100.0)


@pytest.fixture(scope="module", params=[PITCH, ROLL_YAW], ids=["pitch", "roll_yaw"])
def together(request):
    """A plant with the gains of three levels, found together."""
    stacked = gains.stack([request.param] * 3, LEVELS, [mixed.limit_gain(request.param)] * 3)
    return request.param, stacked, *gains.least_trace_gains(stacked)


def test_gains_found_together_are_those_of_the_lmi_and_of_the_descent(together):
    plant, _, found, errors = together
    assert errors.max() < 1e-11
    for gamma, K in zip(LEVELS, found, strict=True):
        # Two other ways to the same gain: the LMI, to the root of its gap, and the descent by another Riccati solver.
        design = mixed.mixed_design(plant, gamma)
        assert pytest.approx(design.K, rel=2e-3, abs=1e-4 * np.abs(design.K).max()) == K
        assert mixed.trace_of_gain(plant, K, gamma) <= design.sqrt_trace**2 * (1 + 1e-12)
        other, _ = mixed.mixed_by_descent(plant, gamma, design.K)
        assert pytest.approx(other, rel=1e-7, abs=1e-9 * np.abs(other).max()) == K


def test_a_gain_does_not_hang_on_its_neighbours_nor_on_the_start(together):
    plant, _, found, _ = together
    for i, gamma in enumerate(LEVELS):
        # Law: there is one stationary gain, whatever other gain that reaches the level is given beside the H2 gain.
        start = 1.05 * found[i] if np.isfinite(mixed.trace_of_gain(plant, 1.05 * found[i], gamma)) else found[i]
        alone, _ = gains.least_trace_gains(gains.stack([plant], [gamma], [start]))
        assert pytest.approx(found[i], rel=1e-9, abs=1e-11 * np.abs(found[i]).max()) == alone[0]


def test_derivatives_of_the_trace_are_difference_quotients(together):
    _, stacked, found, _ = together
    K = found * 1.02
    X, trace = gains.covariances(stacked, K)
    assert np.isfinite(trace).all()
    first, second = gains._derivatives(stacked, K, X)
    step = 1e-5 * np.random.default_rng(3).standard_normal(K.shape) * np.abs(K).max(axis=(1, 2), keepdims=True)
    ends = [(K + sign * step, *gains.covariances(stacked, K + sign * step)) for sign in (1, -1)]
    slopes = [gains._derivatives(stacked, end, X)[0] for end, X, _ in ends]
    assert ends[0][2] - ends[1][2] == pytest.approx(2 * (first * step).sum(axis=(1, 2)), rel=1e-4)
    predicted = (second @ step.reshape(len(K), -1, 1)).reshape(K.shape)
    scale = np.abs(predicted).max(axis=(1, 2), keepdims=True)
    assert ((slopes[0] - slopes[1]) / 2 / scale) == pytest.approx(predicted / scale, abs=1e-5)


def test_gains_that_miss_the_level_have_no_covariance_in_a_stack():
    stacked = gains.stack([PITCH] * 2, [2.0, 2.0], [mixed.limit_gain(PITCH)] * 2)
    # The H2 gain misses the level, an unstable gain has no norm; the closed-form gain reaches it.
    for K, reaches in ((mixed.h2_design(PITCH).K, False), (-np.ones((1, 2)), False), (mixed.limit_gain(PITCH), True)):
        _, trace = gains.covariances(stacked, np.array([K, mixed.limit_gain(PITCH)]))
        assert np.isfinite(trace).tolist() == [reaches, True]
        assert trace[1] == pytest.approx(mixed.trace_of_gain(PITCH, mixed.limit_gain(PITCH), 2.0), rel=1e-10)
    with pytest.raises(InputError, match="above the norm of D11"):
        gains.stack([PITCH], [0.9 * mixed.gamma_min(PITCH)], [mixed.limit_gain(PITCH)])
    with pytest.raises(ComputationError, match="no gain at hand"):
        gains.least_trace_gains(gains.stack([PITCH], [2.0], [-np.ones((1, 2))])[[0]])

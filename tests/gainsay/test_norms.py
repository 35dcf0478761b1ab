import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import InputError
from gainsay.systems.norms import (
    bounded_real_certificate_matrix,
    bounded_real_matrix,
    h2_norm,
    hinf_norm,
    is_definite,
)
from gainsay.systems.spectrum import spectral_abscissa
from gainsay.systems.statespace import StateSpace


def random_system(seed, states=4, inputs=2, outputs=3, feedthrough=True):
    generator = np.random.default_rng(seed)
    A = generator.standard_normal((states, states))
    A -= (spectral_abscissa(A) + 0.05 + generator.random()) * np.eye(states)
    B, C = generator.standard_normal((states, inputs)), generator.standard_normal((outputs, states))
    D = generator.standard_normal((outputs, inputs)) if feedthrough else np.zeros((outputs, inputs))
    return A, B, C, D


@pytest.mark.parametrize("damping", [0.3, 0.05, 1e-4])
def test_second_order_resonance_has_its_closed_form(damping):
    # Closed form: the peak of 1/(s^2 + 2 d w s + w^2) is 1/(2 d w^2 sqrt(1 - d^2)) at w sqrt(1 - 2 d^2).
    w = 0.7
    A = [[0, 1], [-(w**2), -2 * damping * w]]
    norm, frequency = hinf_norm(A, [[0], [1]], [[1, 0]])
    assert norm == pytest.approx(1 / (2 * damping * w**2 * np.sqrt(1 - damping**2)), rel=1e-9)
    assert frequency == pytest.approx(w * np.sqrt(1 - 2 * damping**2), rel=1e-4)
    # Closed form of the same system: the H2 norm squared is 1/(4 d w^3).
    assert h2_norm(A, [[0], [1]], [[1, 0]]) == pytest.approx(1 / np.sqrt(4 * damping * w**3), rel=1e-10)


def test_norm_of_an_all_pass_and_of_a_feedthrough():
    # (s - 1)/(s + 1) has unit gain at every frequency.
    assert hinf_norm([[-1]], [[1]], [[-2]], [[1]])[0] == pytest.approx(1, rel=1e-9)
    # s/(s + 1) rises to its feedthrough: the norm is |D|, attained only at infinity.
    norm, frequency = hinf_norm([[-1]], [[1]], [[-1]], [[1]])
    assert (norm, frequency) == (1.0, np.inf)
    assert hinf_norm([[-1]], [[0]], [[1]])[0] == 0.0


@pytest.mark.parametrize("seed", range(12))
def test_hinf_norm_agrees_with_python_control(seed):
    # Independent implementation: control.norm(p=inf), its own bisection on the Hamiltonian, to its tolerance.
    A, B, C, D = random_system(seed, states=2 + seed % 5, inputs=2, outputs=2)  # it takes square systems only
    other = control.norm(control.ss(A, B, C, D), "inf", tol=1e-10, method="scipy")
    assert hinf_norm(A, B, C, D)[0] == pytest.approx(other, rel=1e-7)


@pytest.mark.parametrize("seed", range(8))
def test_h2_norm_agrees_with_python_control(seed):
    # Independent implementation: control.norm(p=2).
    A, B, C, _ = random_system(seed, feedthrough=False)
    assert h2_norm(A, B, C) == pytest.approx(control.norm(control.ss(A, B, C, 0 * C @ B), 2), rel=1e-8)


@given(st.integers(0, 10_000))
@settings(max_examples=40)
def test_no_frequency_beats_the_norm_and_its_own_attains_it(seed):
    A, B, C, D = random_system(seed)
    norm, frequency = hinf_norm(A, B, C, D)
    system = StateSpace(A, B, C, D)
    assert system.gain(frequency) == pytest.approx(norm, rel=1e-9)
    assert max(system.gain(w) for w in np.geomspace(1e-3, 1e3, 400)) <= norm * (1 + 1e-9)


@given(st.integers(0, 10_000))
@settings(max_examples=25)
def test_certificate_matrix_proves_the_norm_to_a_millionth(seed):
    A, B, C, D = random_system(seed)
    norm, _ = hinf_norm(A, B, C, D)
    P = bounded_real_certificate_matrix(A, B, C, D, norm * (1 + 1e-6))
    assert is_definite(P)
    assert is_definite(bounded_real_matrix(A, B, C, D, P, norm * (1 + 1e-6)), -1)
    # Law: the lemma is an equivalence, so below the norm no matrix may pass.
    assert not is_definite(bounded_real_matrix(A, B, C, D, P, norm * (1 - 1e-6)), -1)


def test_bound_below_the_norm_is_refused_with_the_norm():
    with pytest.raises(InputError, match=r"H-infinity norm 1\.0 attained at 0\.0 rad/s.*gamma 0\.99"):
        bounded_real_certificate_matrix([[-1]], [[1]], [[1]], [[0]], 0.99)


@pytest.mark.parametrize("call", [hinf_norm, h2_norm])
def test_unstable_system_has_no_norm(call):
    with pytest.raises(InputError, match=r"unstable system: spectral abscissa 0\.1: expected below 0"):
        call([[0.1]], [[1]], [[1]])


def test_bad_shapes_are_named():
    with pytest.raises(InputError, match=r"B \(1, 1\): expected \(2, 1\)"):
        StateSpace(-np.eye(2), [[1]], [[1, 1]])
    with pytest.raises(InputError, match=r"A.*expected \(n, n\)"):
        spectral_abscissa([[1, 2]])
    with pytest.raises(InputError, match="finite"):
        spectral_abscissa([[np.nan]])
    with pytest.raises(InputError, match="infinite"):
        h2_norm([[-1]], [[1]], [[1]], [[1]])


@given(st.integers(0, 10_000), st.floats(1e-9, 1e-1))
@settings(max_examples=60)
def test_norm_barely_above_the_feedthrough(seed, size):
    # Nearly all of the gain comes from D: the region where level^2 I - D'D is close to singular.
    A, B, C, D = random_system(seed)
    norm, _ = hinf_norm(A, size * B, C, D)
    system = StateSpace(A, size * B, C, D)
    assert norm * (1 + 1e-12) >= np.linalg.norm(D, 2)  # two singular value decompositions, each to rounding
    assert max(system.gain(w) for w in np.geomspace(1e-3, 1e4, 300)) <= norm * (1 + 1e-9)

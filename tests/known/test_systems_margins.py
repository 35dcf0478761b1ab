"""Disk margins and structured singular values against publications, closed forms and python-control."""

import itertools
import math

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import block_diag

from gainsay.errors import ComputationError, InputError
from gainsay.systems.margins import disk_margin, structured_bounds
from gainsay.systems.norms import hinf_enclosure
from gainsay.systems.structured import structured_peak


def test_the_example_of_the_introduction_to_disk_margins():
    # Seiler, Packard, Gahinet (2020), L = 25/(s^3 + 10 s^2 + 10 s + 10): alpha 0.46, gains 0.63 to 1.59, 25.8 deg
    L = control.ss(control.tf([25], [1, 10, 10, 10]))
    found = disk_margin(L.A, L.B, L.C, L.D)
    assert found.lower == pytest.approx(0.46, abs=0.005)
    assert found.gain == (pytest.approx(0.63, abs=0.005), pytest.approx(1.59, abs=0.005))
    assert math.degrees(found.phase) == pytest.approx(25.8, abs=0.05)


@pytest.mark.parametrize("skew", [0.0, 1.0, -1.0, 0.5])
@pytest.mark.parametrize("loop", [([25], [1, 10, 10, 10]), ([1, 2], [1, 3, 0.5, 0.1]), ([3], [1, 2, 1])])
def test_margins_agree_with_python_control(loop, skew):
    # independent implementation, on a grid with our frequency in it
    L = control.ss(control.tf(*loop))
    found = disk_margin(L.A, L.B, L.C, L.D, skew=skew)
    grid = np.unique(np.append(np.logspace(-3, 3, 5000), found.frequency))
    alpha, _, degrees = control.disk_margins(L, grid[grid < 1e4], skew=skew)
    assert found.lower <= alpha * (1 + 1e-12) and found.lower == pytest.approx(alpha, rel=1e-5)
    if math.isfinite(found.phase) and found.gain[1] < math.inf:
        assert math.degrees(found.phase) == pytest.approx(degrees, rel=1e-4)


@pytest.mark.parametrize("rate", [1e-6, 1.0, 1e6])
def test_an_integrator_has_the_margin_two(rate):
    # closed form: (S - T)/2 = (s - w)/(2 (s + w)) has the gain 1/2 everywhere: 90 deg, any gain
    found = disk_margin([[0.0]], [[rate]], [[1.0]])
    assert found.lower <= 2 <= found.upper and found.upper - found.lower < 1e-8
    assert found.gain[0] < 1e-8 and found.gain[1] > 1e8
    assert found.phase == pytest.approx(math.pi / 2, abs=1e-8)


def test_loops_without_a_margin_are_refused():
    with pytest.raises(InputError, match="unstable"):
        disk_margin([[1.0]], [[1.0]], [[0.5]])
    with pytest.raises(InputError, match="well posed"):
        disk_margin([[-1.0]], [[1.0]], [[1.0]], [[-1.0]])
    with pytest.raises(InputError, match="one channel"):
        disk_margin(-np.eye(2), np.eye(2), np.eye(2))
    with pytest.raises(InputError, match="skew"):
        disk_margin([[-1.0]], [[1.0]], [[1.0]], skew=math.nan)


def complex_matrix(seed: int, n: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n))


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("seed", range(3))
def test_a_dyad_has_its_closed_form(seed, n):
    # Packard, Doyle (1993): mu of u v* with scalar blocks is sum |u_i v_i|
    rng = np.random.default_rng(seed)
    u, v = rng.normal(size=(2, n)) + 1j * rng.normal(size=(2, n))
    found = structured_bounds(np.outer(u, v.conj()), [1] * n)
    value = np.abs(u * v).sum()
    assert value <= found.upper * (1 + 1e-12)
    assert (found.lower, found.upper) == (pytest.approx(value, rel=1e-6), pytest.approx(value, rel=1e-6))


@pytest.mark.parametrize(
    ("M", "blocks", "value"),
    [
        ([[0, 4], [1, 0]], [1, 1], 2.0),  # sqrt(m12 m21)
        ([[0, 4], [1, 0]], [2], 4.0),  # one full block: the norm
        ([[3, 0], [0, -5]], [1, 1], 5.0),  # diagonal: the largest modulus
        ([[1, 1e6], [0, 2]], [1, 1], 2.0),  # triangular: the largest of the diagonal
        ([[0, 0], [0, 0]], [1, 1], 0.0),
    ],
)  # fmt: skip
def test_small_structures(M, blocks, value):
    # closed forms; a triangular structure has no best scaling, only ever better ones
    found = structured_bounds(M, blocks)
    assert found.lower == pytest.approx(value, rel=1e-6, abs=1e-300)
    assert value <= found.upper * (1 + 1e-15) and found.upper <= value * 1.01


@given(st.integers(0, 10_000), st.sampled_from([[1, 1], [1, 2], [1, 1, 1], [2, 2, 1]]))
@settings(max_examples=12)
def test_bounds_meet_for_three_blocks(seed, blocks):
    # Doyle (1982): with at most three full blocks the upper bound is the value
    M = complex_matrix(seed, sum(blocks))
    found = structured_bounds(M, blocks)
    assert found.lower <= found.upper * (1 + 1e-12)
    assert found.upper <= found.lower * 1.02
    # law: between spectral radius and norm; the perturbation makes I - M Delta singular
    assert np.abs(np.linalg.eigvals(M)).max() <= found.upper * (1 + 1e-12)
    assert found.upper <= np.linalg.norm(M, 2) * (1 + 1e-9)
    loop = np.eye(len(M)) - M @ found.perturbation
    assert np.linalg.svd(loop, compute_uv=False)[-1] < 1e-9
    assert np.linalg.norm(found.perturbation, 2) <= (1 + 1e-9) / found.lower


@pytest.mark.parametrize(
    ("M", "blocks"), [([[1, 2]], [1]), ([[1]], [2]), ([[math.nan]], [1]), (np.eye(2), [0, 2]), ([], [])]
)
def test_bad_structures_are_refused(M, blocks):
    with pytest.raises(InputError):
        structured_bounds(M, blocks)


def test_the_peak_with_one_block_is_the_norm():
    # law: with a single full block the structured singular value is the largest singular value
    A, B, C = [[0, 1], [-1, -0.1]], [[0], [1]], [[1, 0]]
    found, norm = structured_peak(A, B, C, blocks=[1]), hinf_enclosure(A, B, C)
    assert found.lower <= norm.upper and norm.lower <= found.upper <= norm.upper * 1.0011
    assert found.frequency == pytest.approx(norm.frequency, rel=1e-2)


def test_the_peak_of_two_systems_in_a_ring():
    # closed form: of [[0, g1], [g2, 0]] it is sqrt|g1 g2|, g1 = 1/(s^2 + s/10 + 1), g2 = 3/(s + 2); a fine grid
    A = [[0, 1, 0], [-1, -0.1, 0], [0, 0, -2]]
    found = structured_peak(A, [[0, 0], [0, 1], [1, 0]], [[1, 0, 0], [0, 0, 3]], blocks=[1, 1])
    w = np.linspace(0.9, 1.1, 400_001)
    peak = np.sqrt(np.abs(3 / ((1 - w**2 + 0.1j * w) * (2 + 1j * w))).max())
    assert found.lower <= peak * (1 + 1e-9) and peak <= found.upper * (1 + 1e-12)
    assert found.upper <= found.lower * 1.01
    assert found.intervals[0][0] == 0 and found.intervals[-1][1] == np.inf
    assert all(a[1] >= b[0] for a, b in itertools.pairwise(found.intervals))  # nothing between them


def test_the_peak_of_what_no_loop_closes_is_small():
    # closed form: [[0, 2/(s + 1)], [0, 0]] has the spectral radius zero under every block-diagonal perturbation
    assert structured_peak([[-1.0]], [[0.0, 2.0]], [[1.0], [0.0]], blocks=[1, 1]).upper < 0.01


@pytest.mark.parametrize("seed", [0])
def test_no_smaller_perturbation_makes_the_loop_unstable(seed):
    # law: small gain; A + B E (I - D E)^-1 C stays Hurwitz for every structured E below 1/upper
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(3, 3))
    A -= (np.linalg.eigvals(A).real.max() + 0.2) * np.eye(3)
    B, C, D = rng.normal(size=(3, 3)), rng.normal(size=(3, 3)), 0.2 * rng.normal(size=(3, 3))
    found = structured_peak(A, B, C, D, blocks=[2, 1])
    assert found.lower <= found.upper and found.upper <= hinf_enclosure(A, B, C, D).upper * 1.0011
    for _ in range(200):
        parts = [rng.normal(size=(k, k)) + 1j * rng.normal(size=(k, k)) for k in (2, 1)]
        E = block_diag(*(0.999 / found.upper * M / np.linalg.norm(M, 2) for M in parts))
        closed = A + B @ E @ np.linalg.solve(np.eye(3) - D @ E, C)
        assert np.linalg.eigvals(closed).real.max() < 0


@pytest.mark.parametrize(
    "changes", [{"A": [[1.0]]}, {"A": [[0.0]]}, {"blocks": [2]}, {"blocks": []}, {"tolerance": 0}, {"B": [[1.0, 1.0]]}]
)
def test_a_peak_of_what_has_none_is_refused(changes):
    given = {"A": [[-1.0]], "B": [[1.0]], "C": [[1.0]], "blocks": [1], **changes}
    with pytest.raises((InputError, ComputationError)):
        structured_peak(**given)

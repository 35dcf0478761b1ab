import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gainsay.errors import InputError
from gainsay.systems.pole_sets import match_poles, pole_clusters


def test_poles_of_a_diagonal_matrix_move_by_as_much_as_its_entries():
    # Gershgorin of diag(a) with a spread s in every entry: radius 2 s for n = 2
    far, near = pole_clusters(np.diag([-1.0, -3.0]), 0.25)
    assert (far.centre, near.centre) == (-3, -1)
    assert far.radius == pytest.approx(0.5, rel=1e-12) and far.count == near.count == 1


def test_a_jordan_block_is_one_cluster_with_its_multiplicity():
    J = -2.0 * np.eye(4) + np.diag(np.ones(3), 1)  # fourfold pole at -2
    (cluster,) = pole_clusters(J + 1e-14 * np.arange(16.0).reshape(4, 4), 1e-12)
    assert cluster.count == 4
    assert cluster.centre == pytest.approx(-2.0, abs=1e-12)  # the mean is the trace over n
    assert match_poles([-2.0] * 4, [cluster]) == [cluster] * 4


@given(st.integers(0, 2**32 - 1), st.floats(1e-9, 1e-2))
def test_every_matrix_within_the_spread_has_its_poles_in_the_discs(seed, spread):
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((4, 4))
    clusters = pole_clusters(A, spread)
    moved = np.linalg.eigvals(A + spread * rng.choice([-1.0, 1.0], (4, 4)))
    assert sum(cluster.count for cluster in clusters) == 4
    for pole in moved:
        assert min(abs(pole - c.centre) - c.radius for c in clusters) <= 1e-12


def test_matching_is_over_the_whole_set_and_keeps_conjugates_apart():
    A = np.array([[-0.5, 0.12], [-0.12, -0.5]])  # poles -0.5 +- 0.12i
    clusters = pole_clusters(A)
    plus, minus = match_poles([-0.5 + 0.12j, -0.5 - 0.12j], clusters)
    assert plus.centre.imag == pytest.approx(0.12) and minus.centre.imag == pytest.approx(-0.12)
    # nearest to each alone would give -1 to both; together 0 and -1 go their own ways
    first, second = match_poles([-0.9, -0.6], pole_clusters(np.diag([-1.0, 0.0])))
    assert (first.centre, second.centre) == (-1, 0)


def test_bad_input_is_refused():
    with pytest.raises(InputError, match="published poles 3"):
        match_poles([-1, -2, -3], pole_clusters(np.diag([-1.0, -2.0])))
    with pytest.raises(InputError, match="at least 0"):
        pole_clusters(np.eye(2), -1.0)

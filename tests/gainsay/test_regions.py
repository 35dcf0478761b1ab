"""Regions for poles: closed forms, certificates of membership, refusals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gainsay.errors import InputError
from gainsay.systems.regions import Disk, HalfPlane


def test_closed_forms():
    A = np.array([[-1.0, 2.0], [-2.0, -1.0]])  # eigenvalues -1 +- 2j
    assert Disk(1.0, 3.0).reach(A) == pytest.approx(2.0)
    assert HalfPlane().reach(A) == pytest.approx(-1.0)
    assert Disk(1.0, 2.1).holds(A) and not Disk(1.0, 1.9).holds(A)
    assert HalfPlane(-0.9).holds(A) and not HalfPlane(-1.1).holds(A)


def test_stacks():
    stack = np.stack([np.diag([-1.0, -2.0]), np.diag([-3.0, 0.5])])
    assert np.allclose(Disk(1.0, 1.0).reach(stack), [1.0, 2.0])
    assert np.allclose(HalfPlane().reach(stack), [-1.0, 0.5])


@given(st.integers(0, 10_000))
def test_lyapunov_matrices_prove(seed):
    # law: the inequality of Stein (of Lyapunov) with P > 0 holds exactly where the eigenvalues are inside
    A = np.random.default_rng(seed).standard_normal((4, 4))
    disk = Disk(0.5, Disk(0.5, 1.0).reach(A) * 1.2 + 0.1)
    P = disk.lyapunov_matrix(A)
    moved = A + 0.5 * np.eye(4)
    assert np.linalg.eigvalsh(P)[0] > 0
    assert np.linalg.eigvalsh(moved.T @ P @ moved - disk.radius**2 * P)[-1] < 0
    plane = HalfPlane(HalfPlane().reach(A) + 0.3)
    P = plane.lyapunov_matrix(A)
    shifted = A - plane.abscissa * np.eye(4)
    assert np.linalg.eigvalsh(P)[0] > 0 and np.linalg.eigvalsh(shifted.T @ P + P @ shifted)[-1] < 0


@given(st.integers(0, 10_000), st.integers(1, 8), st.sampled_from([-0.5, 0.0, 2.0]), st.integers(-9, 9))
def test_each_of_a_stack_is_judged_as_by_its_eigenvalues(seed, n, abscissa, decades):
    generator = np.random.default_rng(seed)
    stack = 10.0**decades * generator.standard_normal((3, 5, n, n))
    stack -= stack.shape[-1] ** 0.5 * 10.0**decades * generator.random((3, 5, 1, 1)) * np.eye(n)
    reach = HalfPlane(abscissa).reach(stack)
    clear = np.abs(reach - abscissa) > 1e-9 * (1 + 10.0**decades)  # nearer than that either answer is rounding
    np.testing.assert_array_equal(HalfPlane(abscissa).each(stack)[clear], (reach < abscissa)[clear])


@given(st.integers(0, 10_000), st.integers(1, 8), st.floats(-3.0, 3.0), st.floats(0.1, 6.0))
def test_each_of_a_stack_is_held_against_a_disk_as_by_its_eigenvalues(seed, n, centre, radius):
    stack = np.random.default_rng(seed).standard_normal((3, 5, n, n))
    reach = Disk(centre, radius).reach(stack)
    clear = np.abs(reach - radius) > 1e-9  # nearer than that either answer is rounding
    np.testing.assert_array_equal(Disk(centre, radius).each(stack)[clear], (reach < radius)[clear])


@given(st.integers(0, 10_000), st.integers(1, 300), st.integers(1, 6), st.integers(-9, 9))
def test_farthest_is_the_largest_of_all_eigenvalues(seed, count, n, decades):
    # oracle: the eigenvalues of every matrix
    stack = 10.0**decades * np.random.default_rng(seed).standard_normal((count, n, n))
    for region in (Disk(10.0**decades, 1.0), HalfPlane()):
        reaches = region.reach(stack)
        assert region.farthest(stack) == (reaches.max(), reaches.argmax())


def test_farthest_of_matrices_that_are_alike():
    assert Disk(1.0, 1.0).farthest(np.tile(-np.eye(3), (200, 1, 1))) == (0.0, 0)
    assert HalfPlane().farthest(np.zeros((200, 2, 2))) == (0.0, 0)
    spiked = np.tile(np.diag([-1.0, -2.0]), (1100, 1, 1))
    spiked[777] = [[-1.0, 1e6], [0.0, -0.5]]
    assert HalfPlane().farthest(spiked) == (-0.5, 777) and Disk(1.0, 1.0).farthest(spiked) == (1.0, 0)


def test_each_near_the_axis_and_without_an_inverse():
    # 1 is an eigenvalue of the second and the size by which its Cayley transform would be taken
    turning = np.array([[-1e-12, 1.0], [-1.0, -1e-12]])
    stack = np.stack([turning, np.diag([1.0, -1.0]), -turning, np.zeros((2, 2)), np.array([[-1.0, 1e12], [0.0, -1.0]])])
    assert HalfPlane().each(stack).tolist() == [True, False, False, False, True]
    assert HalfPlane().each(np.zeros((0, 3, 3))).shape == (0,)
    assert HalfPlane().each(np.tile(-np.eye(3), (1100, 1, 1))).all()  # more than are taken at once


def test_refusals():
    with pytest.raises(InputError, match="outside the disk"):
        Disk(1.0, 0.5).lyapunov_matrix(np.eye(2))
    with pytest.raises(InputError, match="outside the half plane"):
        HalfPlane().lyapunov_matrix(np.eye(2))
    with pytest.raises(InputError):
        Disk(1.0, 0.0)
    with pytest.raises(InputError):
        Disk(1.0, 1.0).reach(np.ones((2, 3)))
    with pytest.raises(InputError):
        HalfPlane().reach(np.array([[np.nan]]))

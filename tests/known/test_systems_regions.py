"""Regions of poles that rounding cannot see: defective matrices and poles beside an edge, by closed forms."""

import numpy as np
import pytest

from gainsay.systems.delay import DelaySystem
from gainsay.systems.delay_spectrum import spectral_abscissa as delayed_abscissa
from gainsay.systems.delay_spectrum import unstable_root_count
from gainsay.systems.regions import Disk, HalfPlane
from gainsay.systems.spectrum import is_hurwitz, is_schur, rational, spectral_abscissa


def defective(size: int, seed: int) -> np.ndarray:
    """One Jordan block at -1 in other coordinates: integers of determinant one, so the matrix is exact."""
    draw = np.random.default_rng(seed)
    low, high = (np.tril(np.rint(draw.normal(size=(size, size))), -1) + np.eye(size) for _ in range(2))
    there, back = low @ high.T, np.rint(np.linalg.inv(high)).T @ np.rint(np.linalg.inv(low))
    assert np.array_equal(there @ back, np.eye(size))
    return there @ (np.diag(np.ones(size - 1), 1) - np.eye(size)) @ back


@pytest.mark.parametrize("size", [2, 3, 5, 8])
@pytest.mark.parametrize("room", [1e-2, 1e-4, 1e-12])
def test_a_defective_matrix(size, room):
    # by construction every eigenvalue is -1; LAPACK's scatter by eps^(1/size), 1e-2 for 8
    A = defective(size, size)
    assert HalfPlane(-1 + room).holds(A) and not HalfPlane(-1 - room).holds(A) and not HalfPlane(-1).holds(A)
    assert Disk(1.0, room).holds(A) and not Disk(2.0, 1 - room).holds(A) and not Disk(2.0, 1.0).holds(A)
    assert HalfPlane(-0.5).holds(np.stack([A, A])) and not HalfPlane(-1).holds(np.stack([A - np.eye(size), A]))
    assert spectral_abscissa(A) == pytest.approx(-1, rel=1e-9)


@pytest.mark.parametrize("damping", [1e-17, 0.0, -1e-17, 5e-324])
@pytest.mark.parametrize("rate", [1e-3, 1.0, 1e3])
def test_poles_beside_an_edge(rate, damping):
    # s^2 + 2 z s + w^2: in the open half plane exactly if z > 0
    A = np.array([[0, rate], [-rate, -2 * damping]])
    assert HalfPlane().holds(A) is (damping > 0) and is_hurwitz(rational(A)) is (damping > 0)
    assert spectral_abscissa(A) == pytest.approx(-damping, rel=1e-9, abs=1e-320)


@pytest.mark.parametrize("square", [1.0, 1 - 2.0**-53, 1 + 2.0**-52])
def test_poles_beside_the_unit_circle(square):
    # z^2 = -square: on the circle, or a last digit to a side of it
    A = np.array([[0, 1.0], [-square, 0]])
    assert Disk(0.0, 1.0).holds(A) is (square < 1) and is_schur(rational(A)) is (square < 1)
    assert is_schur(rational(-np.eye(2))) is False


@pytest.mark.parametrize(
    ("coefficients", "stable"),
    [
        ([1, 2, 1], True),
        ([1, 2, 3, 6], False),  # (s + 2)(s^2 + 3): on the axis
        ([1, 1, 2, 24], False),  # Nise, Control Systems Engineering: two to the right
        ([1, 10, 31, 1030], False),  # the same book: two to the right
        ([1, 1, 1, 1, 1], False),  # fifth roots of unity
        ([1, 4, 6, 4, 1], True),  # (s + 1)^4
        ([1, 0, 0], False),
    ],
)
def test_the_table_of_routh(coefficients, stable):
    # each by its factors or the textbook named
    n = len(coefficients) - 1
    companion = np.vstack([-np.array(coefficients[1:], dtype=float), np.eye(n - 1, n)])
    assert is_hurwitz(rational(companion)) is stable


def test_a_delay_system_in_which_nothing_is_delayed():
    system = DelaySystem([[-1.0]], np.zeros((1, 0)), np.zeros((0, 1)))
    assert delayed_abscissa(system, 2.0) == -1 and unstable_root_count(system, 2.0) == 0

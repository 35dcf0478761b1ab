import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import ComputationError, InputError
from gainsay.systems.lft import Lft


def random_lft(generator, q, r, p, m, size=0.3):
    return Lft.split(size * generator.standard_normal((q + p, r + m)), q, r)


def test_division_by_an_uncertain_number_has_its_closed_form():
    # 1/(I + p d) = 1/I - (p/I) d (1 + (p/I) d)^-1 (1/I).
    inertia, change = 3.0, 0.4
    block = Lft(-change / inertia, 1 / inertia, -change / inertia, 1 / inertia)
    for delta in (-1.0, 0.0, 0.37, 1.0):
        assert block.close([[delta]])[0, 0] == pytest.approx(1 / (inertia + change * delta), rel=1e-14)


@given(st.integers(0, 10_000))
@settings(max_examples=50)
def test_close_solves_the_loop_equations(seed):
    generator = np.random.default_rng(seed)
    block = random_lft(generator, 2, 3, 4, 2)
    delta, outer = generator.standard_normal((3, 2)), generator.standard_normal(2)
    # Identity: z = M11 w + M12 v, w = Delta z, y = M21 w + M22 v solved as one linear system.
    z = np.linalg.solve(np.eye(2) - block.M11 @ delta, block.M12 @ outer)
    assert block.close(delta) @ outer == pytest.approx(block.M21 @ delta @ z + block.M22 @ outer, rel=1e-9, abs=1e-12)


@given(st.integers(0, 10_000))
@settings(max_examples=50)
def test_star_product_is_associative_with_closing(seed):
    generator = np.random.default_rng(seed)
    first, second = random_lft(generator, 2, 3, 2, 3), random_lft(generator, 3, 2, 1, 2)
    delta = 0.5 * generator.standard_normal((3, 2))
    top = Lft(np.zeros((0, 0)), np.zeros((0, 3)), np.zeros((2, 0)), first.close(delta))
    assert first.star(second).close(delta) == pytest.approx(top.star(second).M22, rel=1e-9, abs=1e-12)
    # The inner block is the first one flipped, closed by what the second one has above.
    flipped = Lft(first.M22, first.M21, first.M12, first.M11)
    inner, bottom = first.star(second).M11, flipped.close(second.M11)
    assert inner == pytest.approx(bottom, rel=1e-12, abs=1e-12)


def test_bad_loops_are_refused():
    with pytest.raises(InputError, match="M12"):
        Lft(np.eye(2), np.eye(3), np.eye(2), np.eye(3))
    block = Lft([[1.0]], [[1.0]], [[1.0]], [[0.0]])
    with pytest.raises(ComputationError, match="not well posed"):
        block.close([[1.0]])
    with pytest.raises(InputError, match=r"\(2, 2\): expected \(1, 1\)"):
        block.close(np.eye(2))

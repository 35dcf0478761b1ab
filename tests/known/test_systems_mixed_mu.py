"""Real, repeated and full blocks against closed forms and the figures of SLICOT."""

import math

import numpy as np
import pytest
from scipy.optimize import linprog

from gainsay.errors import ComputationError, InputError
from gainsay.systems.margins import structured_bounds
from gainsay.systems.mixed_mu import Block, mixed_bounds

ROOM = 1.0002
STRUCTURES = {
    "rr2": [Block("real"), Block("real"), Block("full", 2)],
    "r12": [Block("real"), Block("full"), Block("full", 2)],
    "rrrr": [Block("real")] * 4,
}


def drawn(seed: int, n: int = 4) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n))


def kept(M: np.ndarray, blocks: list[Block], found) -> None:
    """What bounds promise: the perturbation does it, is of its norm, and D and G satisfy the theorem in doubles."""
    assert found.lower <= found.upper
    start, beside = 0, np.ones(M.shape, dtype=bool)
    for block in blocks:
        place = slice(start, start + block.size)
        start, beside[place, place] = start + block.size, False
        D, G, Delta = (matrix[place, place] for matrix in (found.D, found.G, found.perturbation))
        assert block.kind != "full" or (D[0, 0] * np.eye(block.size) == D).all()
        assert block.kind == "real" or not G.any()
        assert block.kind == "full" or (Delta[0, 0] * np.eye(block.size) == Delta).all() or not found.lower
        assert block.kind != "real" or not Delta.imag.any() or not found.lower
    assert not found.D[beside].any() and not found.G[beside].any()
    if found.lower:
        assert np.linalg.svd(np.eye(len(M)) - M @ found.perturbation)[1][-1] < 1e-8
        assert np.linalg.norm(found.perturbation, 2) == pytest.approx(1 / found.lower, rel=1e-12)
    form = found.upper**2 * found.D - M.conj().T @ found.D @ M - 1j * (found.G @ M - M.conj().T @ found.G)
    for matrix in (found.D, form):
        assert np.linalg.eigvalsh(matrix).min() > -1e-9 * np.abs(found.D).max() * (1 + found.upper) ** 2


@pytest.mark.parametrize("seed", [pytest.param(0, marks=pytest.mark.slow), 1])
def test_one_block_has_a_closed_form(seed):
    M = drawn(seed, 3).real
    values = np.linalg.eigvals(M)
    # a real number times the unit matrix: the largest real eigenvalue; a complex one: the spectral radius; any matrix:
    # the norm
    real = np.abs(values[np.abs(values.imag) < 1e-12]).max()
    for kind, right in (("real", real), ("complex", np.abs(values).max()), ("full", np.linalg.norm(M, 2))):
        found = mixed_bounds(M, [Block(kind, 3)])
        kept(M, [Block(kind, 3)], found)
        assert right * (1 - 1e-9) <= found.upper <= right * ROOM
        assert found.lower == pytest.approx(right, rel=1e-7)


def test_a_real_number_cannot_turn():
    # eigenvalues i and -i: det(I - M d) = 1 + d^2 has no real root
    found = mixed_bounds([[0, 1], [-1, 0]], [Block("real", 2)])
    assert found.lower == 0 and found.upper < 2e-6 and np.isnan(found.perturbation).all()
    assert mixed_bounds([[1j]], [Block("real")]).upper < 2e-6


@pytest.mark.parametrize("seed", range(2))
def test_rank_one_with_real_numbers_is_a_linear_program(seed):
    # 1 = sum of d_i b_i a_i with real d_i: the least largest |d_i|; the upper bound is the value itself (Young 1994)
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(2, 3)) + 1j * rng.normal(size=(2, 3))
    bound = np.hstack([np.vstack([np.eye(3), -np.eye(3)]), -np.ones((6, 1))])
    product = a * b
    least = linprog([0, 0, 0, 1], bound, np.zeros(6), [[*product.real, 0], [*product.imag, 0]], [1, 0],
                    [(None, None)] * 3 + [(0, None)]).fun  # fmt: skip
    found = mixed_bounds(np.outer(a, b), [Block("real")] * 3)
    assert found.lower == pytest.approx(1 / least, rel=1e-6)
    assert 1 / least <= found.upper * (1 + 1e-9) <= ROOM / least


def test_blocks_down_the_diagonal_count_by_themselves():
    # a real number cannot reach 3i, the complex one reaches 2i, the full block has the norm 1
    M = np.diag([3j, 2j, 1, 0])
    blocks = [Block("real"), Block("complex"), Block("full", 2)]
    found = mixed_bounds(M, blocks)
    kept(M, blocks, found)
    assert found.lower == pytest.approx(2, rel=1e-9) and 2 <= found.upper * (1 + 1e-9) <= 2 * ROOM


@pytest.mark.parametrize("far", [1.0, 1e5, 1e100])
def test_real_numbers_of_a_real_matrix(far):
    # det(I - M Delta) = 1 + 4 d1 d2, least where d1 = -d2 = 1/2; D M D^-1 has the same
    M = np.array([[0, 4 * far], [-1 / far, 0]])
    found = mixed_bounds(M, [Block("real"), Block("real")])
    assert found.lower == pytest.approx(2, rel=1e-7) and 2 * (1 - 1e-9) <= found.upper <= 2 * ROOM


# The upper bounds of SLICOT's AB13MD (Slycot 0.7.1) for the matrices of `drawn`
SLICOT = [
    (0, "rr2", 3.1644146205568875),
    (1, "r12", 3.4126111438583306),
    pytest.param(0, "rrrr", 2.4218909952633867, marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("seed", "structure", "slicot"), SLICOT)
def test_the_upper_end_is_that_of_slicot(seed, structure, slicot):
    M = drawn(seed)
    found = mixed_bounds(M, STRUCTURES[structure])
    kept(M, STRUCTURES[structure], found)
    assert slicot * (1 - 1e-7) <= found.upper <= slicot * ROOM


@pytest.mark.slow
def test_full_blocks_agree_with_the_bounds_for_these_alone():
    M = drawn(3)
    mixed, full = mixed_bounds(M, [Block("full"), Block("full"), Block("full", 2)]), structured_bounds(M, [1, 1, 2])
    assert full.lower * (1 - 1e-9) <= mixed.upper and mixed.upper == pytest.approx(full.upper, rel=2e-4)


@pytest.mark.parametrize("factor", [1e-200, 1e200, 3.0])
def test_units_change_nothing(factor):
    # and the blocks by themselves, 1 and 2
    found = mixed_bounds(factor * np.diag([1.0, 2.0]), [Block("real"), Block("complex")])
    assert found.lower == pytest.approx(2 * factor, rel=1e-9) and found.upper <= 2 * factor * ROOM


def test_what_is_no_problem_is_refused():
    assert mixed_bounds(np.zeros((2, 2)), [Block("real", 2)]).upper == 0
    one = [Block("full")]
    for M, blocks in (([[1, 2]], one), ([[math.nan]], one), ("a", one), (np.eye(2), one), (np.eye(2), [2]),
                      (np.eye(2), None), (np.zeros((0, 0)), [])):  # fmt: skip
        with pytest.raises(InputError):
            mixed_bounds(M, blocks)
    for kind, size in (("real", 0), ("real", True), ("real", 1.0), ("imaginary", 1)):
        with pytest.raises(InputError):
            Block(kind, size)
    for M in ([[1e308, 1e308], [1e308, 1e308]], [[5e-324, 0], [0, 0]]):
        with pytest.raises(ComputationError, match="double precision"):
            mixed_bounds(M, [Block("full", 2)])
    for tolerance in (0, 1, math.nan, "a"):
        with pytest.raises(InputError, match="tolerance"):
            mixed_bounds(np.eye(1), [Block("full")], tolerance=tolerance)

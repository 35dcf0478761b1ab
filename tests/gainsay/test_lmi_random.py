"""Random programs of known outcome: none wrong, and hardly one undecided; a change of units changes no outcome."""

from collections import Counter
from fractions import Fraction

import numpy as np
import pytest

from gainsay.bench.random_programs import draws
from gainsay.lmi import (
    Infeasible,
    Infimum,
    Program,
    Solved,
    Unbounded,
    Undecided,
    affine,
    infimum,
    matrix,
    scalar,
    scaling,
    solve,
    solving,
    sym,
    symmetric,
    trace,
    within,
)
from gainsay.lmi.affine import Affine, Definite, Entrywise
from gainsay.lmi.centring import central_path
from gainsay.lmi.kernels import on_kernels
from gainsay.lmi.multipliers import System
from gainsay.lmi.points import holds
from gainsay.lmi.rounding import RightInverse, proved_positive, twofold
from gainsay.lmi.scaling import Scaled


def _count(seed, count, most):
    counts = Counter()
    for drawn in draws(seed, count, most):
        outcome = solve(drawn.program)
        right, wrong = (Solved, Infeasible) if drawn.feasible else (Infeasible, Solved)
        counts["wrong" if isinstance(outcome, wrong) else "right" if isinstance(outcome, right) else "undecided"] += 1
    return counts


def test_small_random_programs():
    # constructed: see the generator
    assert _count(1, 16, 8) == {"right": 16}


@pytest.mark.slow
def test_random_programs_up_to_forty_rows():
    counts = _count(2, 400, 40)
    assert counts["wrong"] == 0
    assert counts["right"] >= 396


def _lyapunov(rng, unstable):
    n = int(rng.integers(2, 9))
    A = rng.standard_normal((n, n))
    shift = 0.1 + rng.random()
    A += ((shift if unstable else -shift) - np.linalg.eigvals(A).real.max()) * np.eye(n)
    X = symmetric("X", n)
    return Program(subject_to=[(sym(A.T @ X) < 0).named("Lyapunov"), (X > 0).named("X")])


def _lyapunov_right(seed, count):
    rng = np.random.default_rng(seed)
    kinds = [(u, solve(_lyapunov(rng, u))) for u in (True, False) for _ in range(count)]
    return sum(isinstance(outcome, Infeasible if u else Solved) for u, outcome in kinds) / len(kinds)


def test_random_lyapunov_inequalities():
    # Lyapunov 1892: feasible exactly if A is stable
    assert _lyapunov_right(3, 6) == 1


@pytest.mark.slow
def test_many_random_lyapunov_inequalities():
    assert _lyapunov_right(4, 300) > 0.99


@pytest.mark.parametrize("power", [-9, -4, 4, 9])
def test_units_change_no_outcome(power):
    # unknown k times 10^(power (-1)^k), row i times 10^(power i / rows): the same program in other units
    for drawn in draws(5, 6, 6):
        (block,) = drawn.program.constraints
        n = block.expression.shape[0]
        d = 10.0 ** (power * np.arange(n) / n)
        terms = {
            v: c * np.outer(d, d)[:, :, None] * 10.0 ** (power * (-1) ** k)
            for k, (v, c) in enumerate(block.expression.terms.items())
        }
        other = Definite("block", Affine(block.expression.constant * np.outer(d, d), terms), True, (("", n),))
        assert type(solve(Program(subject_to=[other]))) is (Solved if drawn.feasible else Infeasible)


def test_well_placed_programs_are_answered_by_the_first_runs():
    for drawn in draws(6, 12, 10):
        outcome = solve(drawn.program)
        assert type(outcome) is (Solved if drawn.feasible else Infeasible)
        assert len(outcome.attempts) == 1
    rng = np.random.default_rng(7)
    t = scalar("t")
    for n in (3, 8, 15):
        M = rng.standard_normal((n, n))
        M = M + M.T
        found = infimum(Program(minimise=t, subject_to=[(t * np.eye(n) - M > 0).named("t I > M")]))
        # the largest eigenvalue, LAPACK's to its rounding
        top = np.linalg.eigvalsh(M)[-1]
        assert isinstance(found, Infimum) and len(found.attempts) == 2
        assert found.lower - 1e-13 * abs(top) <= found.value <= found.upper + 1e-13 * abs(top)
        assert found.lower - 1e-13 * abs(top) <= top <= found.upper + 1e-13 * abs(top)
        assert found.upper - found.lower < 1e-6 * abs(top)


def test_the_first_runs_prove_nothing_false(monkeypatch):
    # weakly infeasible, unbounded, and a closed pair: later runs decide; of a large program the first point is taken
    monkeypatch.setattr(solving, "_LARGE", 0)
    x, P = scalar("x"), symmetric("P", 2)
    weak = x * np.diag([1.0, 0.0]) + np.array([[0.0, 1.0], [1.0, 0.0]])
    assert isinstance(solve(Program(subject_to=[weak >= 0])), Undecided)
    assert isinstance(infimum(Program(minimise=-x, subject_to=[x > 0])), Unbounded)
    pair = [(P >= 0).named("up"), (P <= 0).named("down")]
    assert isinstance(infimum(Program(minimise=trace(P), subject_to=pair)), Infimum)
    assert len(solve(Program(minimise=x, subject_to=[x > 1])).attempts) == 1


def test_kernels_are_left_from_the_last_to_the_first():
    # each x_k raises row k alone; on the kernels of all of them -1 > 0 is left, whatever the congruence T
    T = np.array([[1.0, 2, 0, 1], [0, 1, 1, 0], [0, 0, 1, 3], [0, 0, 0, 1]])
    rows = sum((scalar(f"x{k}") * np.outer(T[k], T[k]) for k in range(3)), affine(-np.outer(T[3], T[3])))
    outcome = solve(Program(subject_to=[rows > 0]))
    assert isinstance(outcome, Infeasible)
    assert sum(a.get("aim") == "level, on kernels" for a in outcome.attempts) == 0


@pytest.mark.parametrize("share", [0.5, 0.99, 1.01, 1.5, 4.0])
def test_a_step_is_bounded_only_where_there_is_one(share):
    # closed form: d = r + c d^2 has the least root (1 - sqrt(1 - 4 c r))/(2 c) where 4 c r <= 1, and none beyond
    inverse, curvature = RightInverse.of(np.eye(1)), 3.0
    assert inverse is not None
    residual = share / (4 * curvature)
    bound = inverse.reach(residual, curvature)
    if share > 1:
        assert bound == np.inf
    else:
        assert (1 - np.sqrt(1 - share)) / (2 * curvature) <= bound < np.inf


def test_a_twofold_product_keeps_twice_the_digits():
    rng = np.random.default_rng(8)
    A, B, C = (rng.standard_normal(shape) * 10.0 ** rng.integers(-8, 8, shape) for shape in ((3, 4), (4, 2), (2, 3)))
    high, low = twofold(A, B, C)
    exact = [[[Fraction(float(v)) for v in row] for row in m] for m in (A, B, C, high, low)]
    for i in range(3):
        for j in range(3):
            terms = [exact[0][i][k] * exact[1][k][m] * exact[2][m][j] for k in range(4) for m in range(2)]
            rest = sum(terms) - exact[3][i][j] - exact[4][i][j]
            assert abs(rest) < Fraction(1, 2**100) * sum(map(abs, terms))


def test_the_central_path_of_a_half_line():
    # least x with x > 1: x = 1 + mu on the path, and the multiplier of the only inequality is one
    x = scalar("x")
    (block,) = Program(subject_to=[x > 1]).constraints
    scaled = Scaled(np.ones(1), (-np.ones((1, 1)),), (np.ones((1, 1, 1)),))
    path = list(central_path(scaled, [block], np.array([5.0]), 1e-6))
    assert path and path[-1][0] < 1e-5
    for mu, point, (multiplier,) in path:
        assert 0.5 * mu < point[0] - 1 < 1.5 * mu
        np.testing.assert_allclose(multiplier, 1.0, rtol=1e-9)


def test_errors_around_a_proof_are_counted():
    # I + E with |E_ij| <= e: definite whenever 2 e < 1, and at e = 2 it holds -I
    assert proved_positive(np.eye(2), 0.4 * np.ones((2, 2)))
    assert not proved_positive(np.eye(2), 2.0 * np.ones((2, 2)))
    assert not proved_positive(np.eye(2), 2.0)


@pytest.mark.parametrize(("reach", "proved"), [(0.0, True), (0.49, True), (1.1, False)])
def test_a_step_out_of_the_cone_proves_nothing(monkeypatch, reach, proved):
    # -1 + 0 x > 0 beside x - x: the multiplier I of size two has eigenvalues one, a step of norm above one may end it
    x = scalar("x")
    program = Program(subject_to=[x * np.diag([1.0, -1.0]) - np.eye(2) > 0])
    scaled = Scaled(np.zeros(1), (-np.eye(2),), (np.diag([1.0, -1.0])[..., None],))
    system = System(scaled, program.constraints, np.zeros(1))
    assert system.solvable()
    monkeypatch.setattr(RightInverse, "reach", lambda *_: reach)
    assert (system.confined([np.eye(2)], 0.0) is not None) == proved


def test_a_cost_that_no_multipliers_reach_has_no_equations():
    x, y = scalar("x"), scalar("y")
    for row, cost in (([1.0, 0.0], [1.0, 1.0]), ([1.0, 1.0], [1.0, 0.0])):
        constraints = Program(subject_to=[row[0] * x + row[1] * y > 0]).constraints
        scaled = Scaled(np.array(cost), (np.zeros((1, 1)),), (np.array([[row]]),))
        assert not System(scaled, constraints, scaled.cost).solvable()
        assert System(scaled, constraints, np.array(row)).solvable()


def test_kernels_are_of_coefficients_proved_semidefinite():
    x = scalar("x")
    for least, kernels in ((0.0, 1), (-1e-12, 0)):
        program = Program(subject_to=[x * np.diag([1.0, least, 0.0]) + np.diag([0.0, 1.0, -1.0]) > 0])
        assert len(on_kernels(program)) == kernels


def test_an_entry_below_zero_by_less_than_rounding_does_not_hold():
    entry = Entrywise("x >= 1", scalar("x") - 1)
    for value, right in ((1.0, True), (1 - 2.0**-53, False)):
        assert holds(np.ones((1, 1)), -np.ones(1), entry, np.array([value])) == right


def test_the_residual_of_factors_is_bounded_by_what_it_is_summed_of():
    # entries z_i = f_i^2 of a list: the exact residual in fractions lies within the bound
    rng = np.random.default_rng(8)
    rows = matrix("v", 6, 1)
    program = Program(subject_to=within(rng.standard_normal((9, 6)) @ rows, -np.ones((9, 1)), np.ones((9, 1)), "list"))
    scaled = scaling.exact(program, scaling.first(program))[1]
    system = System(scaled, program.constraints, np.zeros(6))
    factors = [rng.uniform(0.5, 2, 9) for _ in program.constraints]
    _, total, _, bound = system._linearised(factors)
    exact = [
        sum(
            Fraction(float(f)) ** 2 * Fraction(float(line[k]))
            for part, tensor in zip(factors, scaled.tensors, strict=True)
            for f, line in zip(part, tensor, strict=True)
        )
        for k in range(6)
    ]
    for value, middle, size in zip(exact, total, bound, strict=True):
        assert abs(value) <= Fraction(float(size))
        assert size >= abs(middle) + 2.0**-53 * 18

"""Programs with known answers, at benign and at hostile scales; nothing is believed that a solver says."""

import dataclasses
import subprocess
import sys

import numpy as np
import pytest

from gainsay.errors import ComputationError, InputError
from gainsay.lmi import (
    BlockMatrix,
    Infeasible,
    Program,
    Scale,
    Solved,
    Undecided,
    affine,
    backends,
    equal,
    find_point,
    infimum,
    matrix,
    positive,
    ranges,
    scalar,
    solve,
    solving,
    sweep,
    sym,
    symmetric,
    threshold,
    trace,
    within,
)
from gainsay.lmi import scaling as scalings


def _bounded_real(a, b, c, units=None):
    """Least g such that the H-infinity norm of c (sI - a)^-1 b is below sqrt(g); states in the given units."""
    t = np.eye(len(a)) if units is None else np.diag(units)
    a, b, c = t @ a @ np.linalg.inv(t), t @ b, c @ np.linalg.inv(t)
    p, g = symmetric("P", len(a)), positive("g")
    f = BlockMatrix("BRL", "state", "input")
    f["state", "state"] = sym(a.T @ p) + c.T @ c
    f["state", "input"] = p @ b
    f["input", "input"] = -g * np.eye(b.shape[1])
    return Program(minimise=g, subject_to=[f < 0, (p > 0).named("P > 0")], label="BRL")


# c (sI - a)^-1 b = 1 / (s^2 + 2 z s + 1): resonance 1 / (2 z sqrt(1 - z^2)), a closed form
ZETA = 0.1
A = np.array([[0.0, 1.0], [-1.0, -2 * ZETA]])
B, C = np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]])
PEAK = 1 / (2 * ZETA * np.sqrt(1 - ZETA**2))


@pytest.mark.parametrize("margin", [1e-4, 1e-3])
def test_multipliers_keep_the_margin_that_was_asked_for(margin):
    """[[x, 1], [1, x]] >= 0 asks x >= 1; its multipliers at the optimum have rank one, and their bound is exact."""
    x = scalar("x")
    f = BlockMatrix("F", "one", "two")
    f["one", "one"], f["one", "two"], f["two", "two"] = x, np.eye(1), x
    found = infimum(Program(minimise=x, subject_to=[f > 0]), margins=(margin,))
    assert found.lower <= 1 <= found.upper
    assert np.linalg.eigvalsh(found.multipliers["F"])[0] > margin / 10


@pytest.mark.parametrize("units", [None, [1e4, 1e-3], [1e-6, 1e5]])
def test_infimum_encloses_the_closed_form_in_any_units(units):
    found = infimum(_bounded_real(A, B, C, units))
    assert found.lower <= PEAK**2 * (1 + 1e-9) and found.upper >= PEAK**2
    assert found.width < 1e-6
    assert found.value == pytest.approx(PEAK**2, rel=1e-6)


def test_solved_has_the_margin_asked_for_in_every_block():
    result = solve(_bounded_real(A, B, C, [1e4, 1e-3]))
    assert isinstance(result, Solved)
    assert set(result.margins) == {"BRL", "P > 0", "g > 0"}
    assert min(result.margins.values()) > 1e-8
    # the same blocks, from the values alone
    p, g = result["P"], result["g"]
    assert np.linalg.eigvalsh(p)[0] > 0 and isinstance(g, float)
    np.testing.assert_allclose(result.check.blocks["P > 0"], p)
    assert PEAK**2 < result.objective < PEAK**2 * (1 + 1e-4)
    assert all({"solver", "status", "iterations"} <= set(a) for a in result.attempts)


def test_a_point_is_found_as_solve_finds_it_and_none_says_no_more():
    program = _bounded_real(A, B, C)
    found, solved = find_point(program), solve(program)
    assert found.objective == solved.objective and found.margins == solved.margins
    # A has its eigenvalues on the left: the inequality has a point, and with -A none (Lyapunov)
    p = symmetric("P", 2)
    stable, unstable = (
        Program(subject_to=[(sym(sign * A.T @ p) < 0).named("L"), (p > 0).named("P")], label="L") for sign in (1, -1)
    )
    assert find_point(stable, near={"P": np.eye(2)}) is not None
    assert find_point(unstable) is None
    # what needs no solver
    assert isinstance(find_point(Program(subject_to=[(0 * p + np.eye(2) > 0).named("I")], label="I")), Solved)


def test_the_two_routes_to_the_solver_agree():
    # cvxpy canonicalises on its own: an independent statement of the same cone program
    program = _bounded_real(A, B, C)
    scale = scalings.first(program)
    optima = [
        backends.run(scalings.apply(program, scale), program.constraints, 0.0, setting).primal
        for setting in ("clarabel", "cvxpy")
    ]
    assert optima[0] == pytest.approx(optima[1], rel=1e-6)


def test_unstable_lyapunov_inequality_is_infeasible_with_a_checked_candidate():
    # a has the eigenvalue +0.1: no P > 0 with a'P + P a < 0
    a = np.array([[0.1, 1e4], [0.0, -2.0]])
    p = symmetric("P", 2)
    program = Program(subject_to=[((sym(a.T @ p)) < 0).named("Lyapunov"), (p > 0).named("P > 0")])
    result = solve(program)
    assert isinstance(result, Infeasible)
    z1, z2 = (result.farkas.multipliers[k] for k in ("Lyapunov", "P > 0"))
    # the sum of <-a'P - P a, Z1> + <P, Z2> vanishes for every P: Z2 = a Z1 + Z1 a', written out independently
    np.testing.assert_allclose(a @ z1 + z1 @ a.T, z2, atol=1e-10 * np.abs(z2).max())
    assert np.linalg.eigvalsh(z1)[0] > -1e-12 and np.trace(z1) > 0


def test_contradicting_bounds_are_infeasible():
    x = scalar("x")
    result = solve(Program(minimise=x, subject_to=[(x > 2).named("above"), (x < 1).named("below")]))
    assert isinstance(result, Infeasible)
    assert result.farkas.value < 0


def test_boundary_only_program_is_never_called_solved():
    # p >= 0 and p <= 0 leave p = 0 alone: strict inequalities have no point
    p = symmetric("P", 2)
    assert not isinstance(solve(Program(subject_to=[(p > 0).named("a"), (p < 0).named("b")])), Solved)


def test_a_lying_solver_is_not_believed(monkeypatch):
    """A solver that says Solved at a point outside gives Undecided with every attempt on record."""

    def liar(scaled, constraints, margin, setting="clarabel"):
        zeros = tuple(np.zeros(np.shape(c)) for c in scaled.constants)
        return backends.Raw(np.ones(len(scaled.cost)), zeros, 1.0, 1.0, {"solver": setting, "status": "Solved"})

    monkeypatch.setattr(solving.backends, "run", liar)
    p = symmetric("P", 2)
    result = solve(Program(subject_to=[(sym(A.T @ p) < 0).named("Lyapunov"), (p > 0).named("P > 0")], label="(1)"))
    assert isinstance(result, Undecided)
    assert len(result.attempts) >= len(backends.SETTINGS)
    with pytest.raises(ComputationError) as raised:
        result.need("(1)")
    assert raised.value.where == "(1)" and raised.value.attempts == result.attempts


def test_a_raising_solver_is_recorded(monkeypatch):
    def panic(*_):
        raise BaseException("near-infeasible\nand more")

    monkeypatch.setattr(backends, "_clarabel", panic)
    monkeypatch.setattr(backends, "_cvxpy", panic)
    result = solve(_bounded_real(A, B, C))
    assert isinstance(result, Undecided)
    assert all(a["status"] == "raised" and "near-infeasible" in a["message"] for a in result.attempts)


def test_box_and_equality():
    # least trace of a 2 x 2 matrix between given entries with x12 = 1 and det >= 0: x11 = x22 = 1
    x = symmetric("X", 2)
    low, high = np.full((2, 2), -3.0), np.full((2, 2), 3.0)
    program = Program(
        minimise=trace(x), subject_to=[(x > 0).named("X > 0"), within(x, low, high, "box"), equal(x[0, 1], 1, "x12")]
    )
    found = infimum(program)
    assert found.lower <= 2.0 <= found.upper and found.width < 1e-6


def test_stated_sizes_and_found_sizes_give_one_answer():
    program = _bounded_real(A, B, C, [1e4, 1e-3])
    stated = dataclasses.replace(program, scale=Scale(P=[1e-4, 1e3], g=25.0))
    assert solve(stated).objective == pytest.approx(solve(program).objective, rel=1e-5)
    y = matrix("Y", 2, 2)
    low, high = -np.ones((2, 2)), np.ones((2, 2))
    paired = Program(minimise=trace(y), subject_to=[within(y, low, high, "b")], scale=Scale(Y=([1, 2], [3, 4])))
    # entries from -1 to 1: the least trace is -2
    assert solve(paired).objective == pytest.approx(-2, rel=1e-5)


def _decay(rate):
    p = symmetric("P", 2)
    shifted = A + rate * np.eye(2)
    return Program(subject_to=[(sym(shifted.T @ p) < 0).named("decay"), (p > np.eye(2)).named("P > I")], label="decay")


def test_threshold_brackets_the_spectral_abscissa():
    # eigenvalues of A have real part -ZETA: decay rates below it are feasible, above it infeasible
    found = threshold(_decay, infeasible=1.0, feasible=0.0, relative=1e-3)
    assert found.feasible < ZETA < found.infeasible
    # undecided rates, if any, lie between the two
    assert all(found.feasible < v < found.infeasible for v in found.undecided)
    assert found.infeasible - found.feasible < 0.05


def test_threshold_tries_its_infeasible_end():
    with pytest.raises(InputError, match="a point at the infeasible end"):
        threshold(_decay, infeasible=0.05, feasible=0.0)


def test_sweep_goes_on_past_infeasible_values():
    kinds = [type(outcome) for _, outcome in sweep(_decay, [0.05, 0.5, 0.08])]
    assert kinds == [Solved, Infeasible, Solved]


def test_ranges_of_linear_expressions():
    # trace of a 2 x 2 matrix above the identity with entries up to 3: from 2 to 6
    x = symmetric("X", 2)
    box = within(x, np.full((2, 2), -3.0), np.full((2, 2), 3.0), "box")
    program = Program(subject_to=[(x > np.eye(2)).named("X > I"), box])
    (found,) = ranges(program, [trace(x)], near={"X": 2 * np.eye(2)})
    assert (found.low, found.high) == (pytest.approx(2, rel=1e-5), pytest.approx(6, rel=1e-5))
    assert program.check(found.at_low).holds and program.check(found.at_high).holds


def test_multipliers_prove_the_lower_bound_on_their_own():
    program = _bounded_real(A, B, C)
    found = infimum(program)
    z, zp, zg = (found.multipliers[k] for k in ("BRL", "P > 0", "g > 0"))
    # written out: the weighted sum of -F, P and g is -tr(z11 C'C) + <P, ...> + g (...) and must leave g alone
    inner, cross = z[:2, :2], z[:2, 2:]
    coefficient_of_p = -(A @ inner + inner @ A.T) - (B @ cross.T + cross @ B.T) + zp
    np.testing.assert_allclose(coefficient_of_p, 0, atol=1e-10 * np.abs(z).max())
    assert z[2, 2] + zg[0, 0] == pytest.approx(1, abs=1e-10)
    assert min(np.linalg.eigvalsh(z)[0], np.linalg.eigvalsh(zp)[0], zg[0, 0]) >= 0
    assert found.lower == pytest.approx(float((C @ inner @ C.T)[0, 0]), rel=1e-10)


def test_stating_programs_imports_no_solver():
    code = "import sys, gainsay.lmi; sys.exit(any(m in sys.modules for m in ('cvxpy', 'clarabel', 'scipy')))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("seed", range(6))
def test_rounding_left_in_a_coefficient_asks_for_no_scale(seed):
    """D, G scaling of a complex matrix written in reals: where the products should be zero they leave 1e-17."""
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(2, 3)) + 1j * rng.normal(size=(2, 3))
    whole = np.outer(a, b) / np.linalg.norm(a) / np.linalg.norm(b)
    m = np.block([[whole.real, -whole.imag], [whole.imag, whole.real]])
    j = np.block([[np.zeros((3, 3)), -np.eye(3)], [np.eye(3), np.zeros((3, 3))]])
    places = [np.diag([float(i % 3 == k) for i in range(6)]) for k in range(3)]
    d = sum((scalar(f"d{k}") * place for k, place in enumerate(places)), affine(np.zeros((6, 6))))
    g = sum((scalar(f"g{k}") * place for k, place in enumerate(places)), affine(np.zeros((6, 6))))
    # d = 1, g = 0 is a point: the norm of m is 1
    program = Program(subject_to=[(1.1**2 * d - m.T @ d @ m - sym(j @ g @ m) > 0).named("F")])
    assert isinstance(solve(program), Solved)

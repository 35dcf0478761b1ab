"""wan2014 synthesis: matrices against their formulas, bounds against trajectories, proofs against forgery."""

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm, solve_continuous_lyapunov

from gainsay.errors import CertificateError
from gainsay.exact.ball import precision
from gainsay.lmi import Infeasible, Solved, infimum, matrix, positive, solve, symmetric
from gainsay.proof import Certificate, check
from gainsay.proof.checker import CaseTables
from gainsay.proof.scope import Scope
from gainsay.tables.case import read_case
from papers.wan2014 import digits, formulas, lmis, plant, proofs, repair

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def case():
    return read_case(ROOT, "wan2014")


@pytest.fixture(scope="module")
def problem(case):
    return lmis.Problem(case)


@pytest.fixture(scope="module")
def multipliers(problem):
    return solve(lmis.farkas_multipliers(problem))


class Undeclared:
    """Tables of the paper with every quantity declared: these tests are about proofs, not about the tables' rows."""

    def __init__(self, case):
        self.case = case

    def exact(self, name):
        return self.case.exact(name)

    def printed(self, name):
        return self.case.printed(name)


@pytest.fixture(autouse=True)
def _any_quantity(monkeypatch):
    monkeypatch.setattr(CaseTables, "has_quantity", lambda self, name: True)


def _formula(case, text, values, definitions):
    """Evaluate a certificate formula at floats (exactly, as the checker does)."""
    with precision(128):
        scope = Scope(
            Certificate(
                id="t",
                paper="wan2014",
                statement="",
                kind="definite",
                fields={},
                definitions=tuple(definitions.items()),
            ),
            CaseTables(case),
        )
        for name, value in values.items():
            scope.names[name] = _exact(value)
        scope.define()
        return np.array([[float(str(x.p)) / float(str(x.q)) for x in row] for row in scope.evaluate(text).rows()])


def _exact(value):
    from gainsay.exact.matrix import Matrix
    from gainsay.exact.rational import rational_matrix

    return Matrix(rational_matrix(np.atleast_2d(value).tolist()))


def _random_point(seed=0):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(6, 6))
    return {"X": X + X.T, "Y": rng.normal(size=(3, 6)), "eps": 0.7, "rho": 1.3}


@pytest.mark.parametrize(
    ("build", "formula"),
    [
        (lambda p, X, Y, e, r: lmis.inequality_14(p, X, Y, e), formulas.EQUATION_14),
        (lambda p, X, Y, e, r: lmis.inequality_14_corrected(p, X, Y, e), formulas.EQUATION_14_CORRECTED),
        (
            lambda p, X, Y, e, r: lmis.inequality_14(p, X, Y, e, r).sub("state", "uncertainty", "input", "weight"),
            formulas.SUBPROBLEM_14,
        ),
    ],
)
def test_formulas_of_certificates_are_the_programs_blocks(case, problem, build, formula):
    # two independent writings of the same printed matrix: block by block in the program, as text in the certificate
    point = _random_point()
    block = build(problem, symmetric("X", 6), matrix("Y", 3, 6), positive("eps"), positive("rho"))
    written = _formula(case, formula, point, formulas.model(case))
    np.testing.assert_allclose(written, block.value(point), rtol=1e-12, atol=1e-18)


def test_closed_loop_formulas_are_the_programs_matrices(case, problem):
    loop = lmis.closed_loop(problem, case.matrix("K"))
    definitions = formulas.closed_loop(case, "printed('K')")
    for name, value in {
        "Acl": loop.A,
        "H": loop.E,
        "Cz": loop.F,
        "k": loop.k,
        "weight": loop.Q,
        "xi0": problem.xi0,
    }.items():
        np.testing.assert_allclose(_formula(case, name, {}, definitions), value, rtol=1e-13, atol=1e-18)


def test_printed_14_differs_from_the_corrected_one_in_its_columns_alone(problem):
    X, Y, eps = symmetric("X", 6), matrix("Y", 3, 6), positive("eps")
    printed, corrected = lmis.inequality_14(problem, X, Y, eps), lmis.inequality_14_corrected(problem, X, Y, eps)
    assert set(printed.names) - set(corrected.names) == {"input again"}
    assert printed.sub(*corrected.names).differences(corrected) == ()


def test_multipliers_leave_trace_W_X_alone(problem, multipliers):
    # the identity behind the refutation, at random X, Y, eps: <V, core of (14)> = tr(W X) + eps |V^(1/2) [E1; E1]|^2
    V1, V3 = multipliers["V1"], multipliers["V3"]
    V2 = np.vstack([multipliers["V2"], V1[3:]])
    V = np.block([[V1, V2], [V2.T, V3]])
    A, Ac, E1 = problem.model.A, problem.observer, problem.model.E1
    W = A.T @ V1 + V1 @ A + Ac.T @ V3 + V3 @ Ac
    assert np.linalg.eigvalsh(V)[0] > 0 and np.linalg.eigvalsh(W)[0] > 0
    both = np.vstack([E1, E1])
    for seed in range(3):
        p = _random_point(seed)
        core = lmis.inequality_14(problem, symmetric("X", 6), matrix("Y", 3, 6), positive("eps")).value(p)[:12, :12]
        expected = np.trace(W @ p["X"]) + p["eps"] * np.trace(both.T @ V @ both)
        assert np.sum(V * core) == pytest.approx(expected, rel=1e-9)


def test_refutation_is_accepted_and_cannot_be_forged(case, multipliers):
    certificate = proofs.infeasible_14(case, multipliers.values)
    assert [(c.quantity, c.relation) for c in check(certificate, case).conclusions] == [("eq14.feasible", "fails")]
    # the same multipliers say nothing about (14) without the plant's coupling through A - LC
    weaker = {
        **certificate.fields,
        "constraints": [["(14)", formulas.EQUATION_14.replace("sym(Ac@X)", "-sym(Ac@X)") + " < 0"],
                        *certificate.fields["constraints"][1:]],
    }  # fmt: skip
    with pytest.raises(CertificateError):
        check(certificate.changed(fields=weaker), case)


def test_a_problem_with_a_solution_is_not_refuted(problem):
    # with the states measured (error block left out) the same machinery finds a point: the refutation is no artefact
    assert isinstance(solve(lmis.state_feedback(problem)), Solved)
    assert isinstance(solve(lmis.problem_38(problem)), Infeasible)


def test_margin_is_enclosed_by_proofs(case, problem):
    found = infimum(lmis.farkas_multipliers(problem))
    (below,) = proofs.margin_below(case, found.solved.values).conclusions
    (above,) = proofs.margin_above(case, found.multipliers).conclusions
    assert (below.relation, above.relation) == ("at_least", "at_most")
    assert 0 < float(below.value) <= -found.value <= float(above.value) < 1.0001 * float(below.value)


def test_wrong_diagonal_by_hand(case, problem):
    # entry (4,4) of sym((A - LC) X) with the printed X; the eps term only adds
    X, row = case.matrix("X"), problem.observer[3]
    assert 2 * row @ X[:, 3] > 0
    proofs.wrong_diagonal(case)


def test_small_certificates(case):
    for build in (proofs.input_counted_twice, proofs.empty_row_14, proofs.infeasible_29):
        check(build(case), case)


def test_consistent_digits(case):
    X, K = digits.consistent_point(case)
    for value, name in ((X, "X"), (K, "K"), (K @ X, "Y")):
        for i, row in enumerate(case.printed(name).rows):
            for j, entry in enumerate(row):
                assert float(entry.low) <= value[i, j] <= float(entry.high)
    proofs.consistent_digits(case, X, K)


def test_no_consistent_digits_is_an_error(case, monkeypatch):
    monkeypatch.setattr(digits, "_step", lambda X, K, *_: (0 * X, 0 * K))
    with pytest.raises(ArithmeticError, match="half units remain"):
        digits.consistent_point(case)


def _corners(problem, count=6):
    """Constant uncertainties with entries in -1..1: corners and points inside."""
    rng = np.random.default_rng(1)
    channels = lmis.closed_loop(problem, np.zeros((3, 6))).E.shape[1]
    return [np.diag(rng.choice([-1.0, 1.0, 0.3], channels)) for _ in range(count)]


def test_bounds_hold_on_trajectories_and_are_tight(case, problem):
    """Cost of every constant Lambda by a Lyapunov equation, thrust by the matrix exponential: an independent route."""
    K = case.matrix("K")
    loop, bounds = lmis.closed_loop(problem, K), repair.certify(problem, K)
    costs, peaks = [], []
    for Lambda in _corners(problem):
        A = loop.A + loop.E @ Lambda @ loop.F
        P = solve_continuous_lyapunov(A.T, -loop.Q)
        costs.append((problem.xi0.T @ P @ problem.xi0).item())
        step, x, peak = expm(A * 0.5), problem.xi0, np.zeros(3)
        for _ in range(1200):
            peak = np.maximum(peak, np.abs(loop.k @ x).ravel())
            x = step @ x
        peaks.append(peak)
    assert max(costs) <= bounds.cost.upper and bounds.cost.upper < 1.05 * max(costs)
    assert (np.max(peaks, axis=0) <= bounds.peaks * (1 + 1e-12)).all()
    # 3000 k11 - 4000 k12 + 20 k13 with the printed digits: the thrust at the start, which no bound can undercut
    assert bounds.peaks[0] == pytest.approx(29.0145574, rel=1e-5) and bounds.peaks[0] >= 29.0145574


def test_certified_bounds_are_checked_by_the_checker(case, problem):
    K = case.matrix("K")
    point = solve(lmis.cost_bound(problem, K))
    arguments = {"id": "c", "quantity": "q.cost", "stable": "q.stable"}
    certificate = proofs.cost_certificate(case, "printed('K')", point.values, **arguments)
    assert {c.quantity for c in certificate.conclusions} == {"q.cost", "q.stable"}
    lower = {**certificate.fields, "cost": "3.8e9"}  # below the cost of a trajectory, so no proof can exist
    with pytest.raises(CertificateError):
        check(certificate.changed(fields=lower), case)


def test_lqr_solves_the_riccati_equation_and_uses_the_limit(problem):
    weight = 1e4
    K = repair.lqr(problem, weight)
    A, B, Q, R = problem.model.A, problem.model.B, problem.Q, weight * problem.R
    P = solve_continuous_lyapunov((A - B @ K).T, -(Q + K.T @ R @ K))
    # stationarity: K = R^-1 B' P for the cost matrix P of K itself
    np.testing.assert_allclose(np.linalg.solve(R, B.T @ P), K, rtol=1e-7, atol=1e-9)


def test_joint_design_is_a_correct_theorem(case, problem):
    """Its bound is above the cost that a full Lyapunov matrix certifies for its own gain."""
    start = plant.observer_start(case, "measured_position").reshape(6, 1)
    cost = solve(lmis.cost_bound(problem, case.matrix("K")))
    joint = solve(repair.joint_design(problem, np.diag(np.diagonal(cost["S"])), start))
    assert isinstance(joint, Solved)
    own = solve(lmis.cost_bound(problem, repair.gain(joint)))
    assert own.objective <= joint.objective


@pytest.mark.slow
def test_subproblem_agrees_with_an_independent_statement(problem):
    """The sub-problem stated again in cvxpy: kilometres, tens of m/s, units of 20 N, costs in 1e9."""
    import cvxpy as cp

    m, unit, newtons, money = problem.model, np.diag([1e-3] * 3 + [0.1] * 3), 20.0, 1e9
    inverse = np.linalg.inv(unit)
    A, B, E1, E2, x0 = unit @ m.A @ inverse, unit @ m.B * newtons, unit @ m.E1, m.E2 @ inverse, unit @ problem.x0
    P, Y, eps, rho = cp.Variable((6, 6), symmetric=True), cp.Variable((3, 6)), cp.Variable(), cp.Variable()
    core = A @ P + P @ A.T - B @ Y - Y.T @ B.T + eps * (E1 @ E1.T)
    root, o = money**-0.5, np.zeros
    form = cp.bmat([
        [core, P @ E2.T, root * newtons * Y.T, root * P @ inverse],
        [E2 @ P, -eps * np.eye(6), o((6, 3)), o((6, 6))],
        [root * newtons * Y, o((3, 6)), -rho * np.eye(3), o((3, 6))],
        [root * inverse @ P, o((6, 6)), o((6, 3)), -rho * np.eye(6)],
    ])  # fmt: skip
    constraints = [form << 0, cp.bmat([[np.eye(1), x0.T], [x0, P]]) >> 0]
    for i, limit in enumerate(problem.limits / newtons):
        row = Y[i : i + 1, :]
        constraints.append(cp.bmat([[P, row.T], [row, np.array([[limit**2 / 2]])]]) >> 0)
    stated = cp.Problem(cp.Minimize(rho), constraints)
    stated.solve(solver=cp.CLARABEL)
    ours = solve(lmis.state_feedback(problem))
    assert rho.value * money == pytest.approx(ours.objective, rel=1e-4)
    K = Y.value @ np.linalg.inv(P.value) @ unit * newtons
    np.testing.assert_allclose(K[:2, [0, 1, 3, 4]], repair.gain(ours)[:2, [0, 1, 3, 4]], rtol=0.02)

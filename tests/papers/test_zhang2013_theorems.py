"""Theorems 1 and 2 of zhang2013: the correction, what it accepts, and second methods for its numbers."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import CertificateError, ComputationError
from gainsay.lmi import Infeasible, Solved
from gainsay.proof import build
from gainsay.statements.floats import Floats
from gainsay.systems.delay_bounds import bessel_legendre, level, proved_delay
from gainsay.systems.delay_spectrum import hinf_norm
from gainsay.tables import Case, read_case
from papers.zhang2013 import derivations, proofs
from papers.zhang2013 import derivations_misprints as misprints
from papers.zhang2013.conditions import channel_blocks, first_refuted, largest_delay, least_gamma, lifted, standing
from papers.zhang2013.plant import Spacecraft
from papers.zhang2013.proofs import gains_of as formulas_of
from papers.zhang2013.searches import gains_of
from papers.zhang2013.statements import (
    FORMS,
    OFFSETS,
    PARTS,
    PRINTED_LOOP,
    ROWS,
    SIGNED,
    UNKNOWNS_23,
    corrected_23,
    equation_23,
    fast_program,
    for_gains,
    least_gamma_program,
    least_squares_program,
    margin_program,
    reduced_theorem_1,
    structured_theorem_1,
    theorem_1,
    theorem_2,
    unsound_program,
)
from papers.zhang2013.synthesis import ROOM, near_optimum
from tests.papers.latex_cells import computed

CASE: Case = read_case(Path(__file__).resolve().parents[2], "zhang2013")
CRAFT = Spacecraft.of(CASE)
K, L = CASE.matrix("K"), CASE.matrix("L")
PRINTED_GAINS = for_gains("printed('K')", "printed('L')")
CELLS = {(c.row, c.column) for part in PARTS for c in corrected_23(part).differences}
NUMBERS = {"d_M": 0.03, "mu": 0.1, "l1": 0.12, "l2": 0.1, "g": 2.25}


def random_point(seed: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    point = {}
    for name, unknown in UNKNOWNS_23.items():
        value = rng.normal(size=(unknown.rows, unknown.columns))
        free = value + 2 * np.eye(*value.shape)
        point[name] = value + value.T if unknown.structure == "symmetric" else free
    return point


def left_side(statement, point: dict, **numbers: float) -> np.ndarray:
    """Left side of an edition of (23) at a point, by the solver's evaluator."""
    texts = {name: repr(value) for name, value in (NUMBERS | numbers).items()}
    definitions = statement.defining(texts).definitions(CASE)
    variables = {name: unknown.variable(name) for name, unknown in UNKNOWNS_23.items()}
    return Floats(CASE, definitions, variables).value(statement.formula).value(point)


def congruence(values: dict, part: str, d_M: float, mu: float, l1: float, l2: float, g: float) -> np.ndarray:
    """T' (9) T under (25) from the original P21 = X^-1, K = M X^-1, L = P22^-T N, typed from (9) in plain numpy."""
    X, P22 = values["X"], values["P22"]
    P21 = np.linalg.inv(X)
    gain, L = values["M"] @ P21, np.linalg.inv(P22).T @ values["N"]
    data = {name: np.asarray(getattr(CRAFT, name), dtype=float) for name in ("A", "B", "C1", "C2", "Cd1", "Cd2")}
    zero = np.zeros
    A = np.block([[data["A"], data["B"]], [zero((1, 2)), -L @ data["B"]]])
    Ad = np.block([[data["B"] @ gain, zero((2, 1))], [zero((1, 3))]])
    B = np.block([[data["B"], zero((2, 1))], [-L @ data["B"], np.eye(1)]])
    C, Cd = np.hstack([data["C1"], data["C2"]]), np.hstack([data["Cd1"], data["Cd2"]])

    def original(hat: str, plain: str) -> np.ndarray:
        return np.block([[P21.T @ values[hat] @ P21, zero((2, 1))], [zero((1, 2)), values[plain]]])

    P1, Q1, Q2, R = (original(*p) for p in (("P11", "P12"), ("Q11", "Q12"), ("Q21", "Q22"), ("R1", "R2")))
    P2 = np.block([[P21, zero((2, 1))], [zero((1, 2)), P22]])
    P3 = np.block([[l1 * P21, zero((2, 1))], [zero((1, 2)), l2 * P22]])
    c, o = (3, 1) if part == "a" else (1, 3)
    O = zero((3, 3))  # noqa: E741
    upper = np.block([
        [P2.T @ A + A.T @ P2 + Q1 + Q2 - c * R / d_M, P1 - P2.T + A.T @ P3, P2.T @ Ad + c * R / d_M, O, P2.T @ B, C.T],
        [O, -P3 - P3.T + d_M * R, P3.T @ Ad, O, P3.T @ B, zero((3, 1))],
        [O, O, -(1 - mu) * Q2 - 4 * R / d_M, o * R / d_M, zero((3, 2)), zero((3, 1))],
        [O, O, O, -Q1 - o * R / d_M, zero((3, 2)), zero((3, 1))],
        [zero((2, 12)), -g * np.eye(2), Cd.T],
        [zero((1, 14)), -np.eye(1)],
    ])  # fmt: skip
    T = np.eye(15)
    for i in range(0, 12, 3):
        T[i : i + 2, i : i + 2] = X
    whole = np.triu(upper) + np.triu(upper, 1).T
    return T.T @ whole @ T


@given(
    st.integers(0, 10_000),
    st.floats(0.01, 2.0),
    st.floats(-1.0, 1.0),
    st.floats(-3.0, 3.0),
    st.floats(-3.0, 3.0),
    st.sampled_from(["a", "b"]),
)
@settings(deadline=None, max_examples=40)
def test_corrected_23_is_the_congruence_of_9_under_25(seed, d_M, mu, lambda1, lambda2, part):
    numbers = {"d_M": d_M, "mu": mu, "l1": lambda1, "l2": lambda2, "g": 2.25}
    point = random_point(seed)
    expected = congruence(point, part, **numbers)
    found = left_side(corrected_23(part), point, **numbers)
    np.testing.assert_allclose(found, expected, atol=1e-9 * (1 + np.abs(expected).max()))


@pytest.mark.parametrize("part", ["a", "b"])
def test_the_difference_to_the_congruence_is_in_the_blocks_found(part):
    # independent of the corrected formulas: printed (23) against T' (9) T, entry by entry, at a random point
    point = random_point(11)
    gap = np.abs(left_side(equation_23(part), point) - congruence(point, part, **NUMBERS)) > 1e-9
    ends = np.cumsum([0, 2, 1, 2, 1, 2, 1, 2, 1, 1, 1, 1])
    found = {
        (ROWS[i], ROWS[j])
        for i in range(11)
        for j in range(i, 11)
        if gap[ends[i] : ends[i + 1], ends[j] : ends[j + 1]].any()
    }
    assert found == CELLS


@given(st.integers(0, 10_000), st.floats(-3.0, 0.0), st.sampled_from(["printed", "corrected"]))
@settings(deadline=None, max_examples=30)
def test_a_form_is_positive_for_every_lambda1_up_to_zero(seed, lambda1, edition):
    rng = np.random.default_rng(seed)
    point = random_point(seed)
    for name, unknown in SIGNED.items():
        half = rng.normal(size=(unknown.rows, unknown.rows))
        point[name] = half @ half.T + 0.1 * np.eye(unknown.rows)
    z = np.zeros(15)
    v = rng.normal(size=2)
    for row, factor in (("x", lambda1), ("x'", -1.0), ("x_d", lambda1), ("x_M", lambda1)):
        start = OFFSETS[row]
        z[start : start + 2] = factor * v
    F = left_side(FORMS[edition]("a"), point, l1=lambda1)
    assert z @ F @ z > 0


def reduced(**texts: str):
    return least_gamma(reduced_theorem_1(CASE, PRINTED_LOOP, g="gamma2", **texts))


def test_least_gamma_is_the_same_with_and_without_slack():
    with_slack = least_gamma(theorem_1(CASE, PRINTED_LOOP, g="gamma2"))
    assert with_slack.upper == pytest.approx(reduced().bound, rel=1e-4)


def test_a_point_without_slack_lifts_to_theorem_1():
    # a point with the room that the solver is asked for: what proves the infimum lies nearer to the edge
    found = least_gamma_program(reduced_theorem_1(CASE, PRINTED_LOOP, g="gamma2")).solve().need("(9) without slack")
    point = lifted(found.values, 0.03)
    assert least_gamma_program(theorem_1(CASE, PRINTED_LOOP, g="gamma2")).program().check(point).holds


def test_theorem_1_lies_between_the_exact_norm_and_its_structured_form():
    exact = hinf_norm(CRAFT.design_loop(CASE.printed("K").exact, CASE.printed("L").exact), 0.03).value
    full = np.sqrt(reduced().bound)
    structured = np.sqrt(least_gamma(structured_theorem_1(CASE, PRINTED_LOOP, g="gamma2")).bound)
    assert exact < full < structured < CASE.number("gamma") / 10  # more than tenfold margin


def test_structured_theorem_1_is_theorem_2_for_given_gains():
    # two parametrisations of the same set: P21, ... of (25), and X = P21^-1 with the hats
    least = least_gamma(structured_theorem_1(CASE, PRINTED_LOOP, g="gamma2"))
    for factor, feasible in ((1.01, True), (0.99, False)):
        found = margin_program(CASE, "corrected", g=repr(least.bound * factor**2), **PRINTED_GAINS).solve()
        assert isinstance(found, Solved)
        assert (-found.objective > 0) == feasible


def test_mu_has_no_effect_on_the_least_gamma():
    # both are enclosed to 1e-5 on every machine: see ROOM
    assert reduced(mu="1").bound == pytest.approx(reduced().bound, rel=2 * ROOM)


@pytest.mark.slow
def test_largest_delay_lies_below_the_exact_margin_and_between_checked_points():
    limit = CRAFT.design_loop(K, L).quasi_polynomial.margin().delay
    feasible, infeasible = largest_delay(
        CASE, lambda case, **texts: reduced_theorem_1(case, PRINTED_LOOP, **texts), 1.5, limit
    )
    assert feasible < infeasible < limit
    assert infeasible - feasible < 2e-4
    for d_M, sign in ((feasible - 1e-3, -1), (infeasible + 1e-3, 1)):
        assert sign * (reduced(d_M=repr(d_M)).bound - 2.25) > 0


def test_theorem_1_of_the_delayed_signal_proves_no_more_than_theorem_1():
    loop = CRAFT.design_loop(K, L)
    parts = loop.A[:2, :2], loop.Bd[:2], loop.Cd[:, :2]
    exact = loop.quasi_polynomial.margin().delay
    proved, _ = proved_delay(lambda d: channel_blocks(*parts, d, 0.1), 1.001 * exact, 1e-3)
    # its stability part is what remains of (9) for a large gamma
    assert reduced(d_M=repr(0.999 * proved)).upper < 1e4
    # and for varying delays it proves what Jensen's inequality proves for constant ones
    jensen, tried = proved_delay(lambda d: bessel_legendre(*parts, d, 0).blocks, 1.001 * exact, 1e-3)
    assert jensen - 1e-9 <= proved <= tried + 1e-9


def test_delays_with_checked_points_and_checked_multipliers_meet():
    loop = CRAFT.design_loop(K, L)
    parts = loop.A[:2, :2], loop.Bd[:2], loop.Cd[:, :2]
    exact = loop.quasi_polynomial.margin().upper
    for degree in (0, 1):
        proved, _ = proved_delay(lambda h, n=degree: bessel_legendre(*parts, h, n).blocks, exact, 1e-6)
        refuted = first_refuted(lambda h, n=degree: level(bessel_legendre(*parts, h, n)).lower > 0, proved, exact)
        assert proved < refuted < exact
        assert refuted - proved < 1e-5 * exact


@given(seed=st.integers(0, 2**32 - 1), d_M=st.floats(0.01, 2.0), mu=st.floats(0.0, 0.9))
@settings(max_examples=25)
def test_9b_with_equal_delays_is_jensens_condition_less_mu_q2(seed, d_M, mu):
    """Identity: Schur complement of the block of R, then z(t - d) = z(t - d_M); hence (9b) implies degree 0."""
    rng = np.random.default_rng(seed)
    A, Bd, Cd = rng.normal(size=(3, 3)), rng.normal(size=(3, 1)), rng.normal(size=(1, 3))
    root = rng.normal(size=(3, 3))
    P, (Q1, Q2, R) = root + root.T, rng.uniform(0.5, 2.0, (3, 1, 1))
    F = -channel_blocks(A, Bd, Cd, d_M, mu)[1].value({"P1": P, "Q1": Q1, "Q2": Q2, "R": R})
    core = F[:5, :5] - F[:5, 5:] @ np.linalg.solve(F[5:, 5:], F[5:, :5])
    T = np.vstack([np.eye(4), np.eye(4)[3:]])
    jensen = bessel_legendre(A, Bd, Cd, d_M, 0).derivative.value({"P": P, "S": Q1 + Q2, "R": R / d_M})
    jensen[3, 3] += mu * Q2.item()
    np.testing.assert_allclose(T.T @ core @ T, jensen, atol=1e-12 * np.abs(F).max() * (1 + d_M))


def test_first_refuted_is_the_limit_where_nothing_is_refuted():
    assert first_refuted(lambda h: False, 1.0, 2.0) == 2.0
    assert first_refuted(lambda h: True, 1.0, 1.0 + 1e-9) == 1.0 + 1e-9
    assert first_refuted(lambda h: h > 1 + 5e-6, 1.0, 2.0) == pytest.approx(1 + 1e-5, rel=1e-12)  # the next step above


def test_unsound_point_has_an_unstable_observer():
    found = unsound_program(CASE, "printed", l1="1").solve()
    assert isinstance(found, Solved)
    _, L_found = gains_of(found.values)
    assert (L_found @ CRAFT.B).item() < 0  # e' = -L B e grows
    # the corrected LMIs accept none such: Theorem 1 would prove it stable
    assert not isinstance(unsound_program(CASE, "corrected").solve(), Solved)


@pytest.mark.parametrize(
    ("design", "program"), [("resynthesised", least_squares_program), ("fast", fast_program)], ids=lambda x: str(x)[:5]
)
def test_committed_designs_of_convex_programs_are_near_the_optimum_and_the_printed_gains_are_not(design, program):
    results = SimpleNamespace(attempted=lambda _, outcome: outcome)
    least = program(CASE).infimum()
    near_optimum(design, program(CASE, **for_gains(*formulas_of(design))), least.lower, results)
    with pytest.raises(ComputationError, match=f"designs/{design}.json reaches"):
        near_optimum(design, program(CASE, **PRINTED_GAINS), least.lower, results)


def test_repaired_design_is_no_worse_than_the_printed_one_in_anything_counted():
    design = CASE.designs["repaired"]["K"], CASE.designs["repaired"]["L"]
    before, after = (standing(CRAFT, *gains, 0.03) for gains in ((K, L), design))
    assert after.margin_paper > before.margin_paper
    assert after.margin_all > before.margin_all
    assert after.abscissa < before.abscissa


def test_certificates_of_misprints_are_accepted():
    for row, column in CELLS:
        assert misprints.differing_block(CASE, row, column).kind == "different"
    assert misprints.corrected_form(CASE).conclusions[0].relation == "holds"
    assert misprints.printed_23_differs(CASE).conclusions[0].relation == "fails"
    assert misprints.printed_26_differs(CASE).conclusions[0].relation == "fails"
    assert {made.id for made in misprints.wrong_sizes(CASE)} == {"eq26-r1", "hats-q12", "eq24-inverse", "eq7-bars"}


def test_a_block_that_is_right_has_no_certificate_of_a_difference():
    with pytest.raises(CertificateError, match="not proved to differ"):
        misprints.differing_block(CASE, "x", "x_d")


def test_infeasibility_at_the_printed_sign_is_certified_and_not_at_plus():
    for edition in ("printed", "corrected"):
        quantity = "theorem2.feasible_printed_sign"
        assert proofs.printed_sign_infeasible(CASE, edition, quantity).conclusions[0].relation == "fails"
    assert proofs.negative_form(CASE).conclusions[0].relation == "holds"

    class Positive:
        """The tables with lambda1 = +0.12 where the paper prints -0.12."""

        def __getattr__(self, name):
            return getattr(CASE, name)

        def exact(self, name):
            return CASE.exact("lambda1_corrected" if name == "lambda1" else name)

    with pytest.raises(CertificateError):
        proofs.printed_sign_infeasible(Positive(), "corrected", "theorem2.feasible_printed_sign")


def certified(maker, edition: str, **witness):
    stated = theorem_2(CASE, edition)
    return maker(
        id="x", statement="", quantities={"feasible": "theorem2.feasible"}, **witness,
        **stated.parts(),
    )  # fmt: skip


def test_printed_lmis_are_infeasible_at_plus_and_the_corrected_ones_are_not():
    found = theorem_2(CASE, "printed").solve()
    assert isinstance(found, Infeasible)
    multipliers = found.farkas.multipliers
    assert certified(build.farkas, "printed", multipliers=multipliers).conclusions[0].relation == "fails"
    renamed = {label.replace(")", ") corrected") if "23" in label else label: z for label, z in multipliers.items()}
    with pytest.raises(CertificateError):  # the same multipliers prove nothing of the corrected LMIs
        certified(build.farkas, "corrected", multipliers=renamed)


def test_a_point_of_the_corrected_lmis_is_no_point_of_the_printed_ones():
    point = margin_program(CASE, "corrected").infimum().solved.values
    point = {name: point[name] for name in UNKNOWNS_23}
    assert certified(build.feasible_point, "corrected", point=point).conclusions[0].relation == "holds"
    with pytest.raises(CertificateError):
        certified(build.feasible_point, "printed", point=point)


def test_gamma_floor_is_the_modulus_of_c2():
    assert proofs.gamma_floor(CASE).conclusions[0].value == "0.01"  # C2 = -0.1
    found = margin_program(CASE, "corrected", g=repr(0.0999**2), **PRINTED_GAINS).solve()
    assert not (isinstance(found, Solved) and found.objective < 0)


def test_derivations_are_tasks():
    assert {task.where for task in derivations.TASKS} >= {"(2), (5), (7)", "(12) to (22)"}


def test_without_slack_refuses_an_unstable_loop():
    unstable = {**PRINTED_LOOP, "A_bar": f"{PRINTED_LOOP['A_bar']} + 0.5*eye(3)"}
    assert not isinstance(reduced_theorem_1(CASE, unstable, g="1e6").solve(), Solved)


def by_cvxpy(edition: str, **numbers: float):
    """The same inequalities through another modelling layer: variables and both left sides."""
    import cvxpy as cp

    values = {}
    for name, unknown in UNKNOWNS_23.items():
        symmetric = unknown.structure == "symmetric" and unknown.rows > 1
        values[name] = cp.Variable((unknown.rows, unknown.columns), symmetric=symmetric)
    origin = {name: np.zeros(value.shape) for name, value in values.items()}
    sides = []
    for part in PARTS:
        statement = FORMS[edition](part)
        constant = left_side(statement, origin, **numbers)
        side = cp.Constant(constant)
        for name, value in values.items():
            for i in range(value.shape[0]):
                for j in range(i if UNKNOWNS_23[name].structure == "symmetric" else 0, value.shape[1]):
                    unit = np.zeros(value.shape)
                    unit[i, j] = 1
                    if UNKNOWNS_23[name].structure == "symmetric":
                        unit[j, i] = 1
                    slope = left_side(statement, {**origin, name: unit}, **numbers) - constant
                    side = side + slope * value[i, j]
        sides.append(side)
    return values, sides


@pytest.mark.slow
@pytest.mark.parametrize(("edition", "lambda1"), [("corrected", 0.12), ("printed", 1.0), ("printed", 0.12)])
def test_margins_agree_with_another_modelling_layer(edition, lambda1):
    import cvxpy as cp

    values, sides = by_cvxpy(edition, l1=lambda1)
    t = cp.Variable()
    held = [side << -t * np.eye(15) for side in sides] + [cp.abs(v) <= 1e4 for v in values.values()]
    held += [values[name] >> t * np.eye(unknown.rows) for name, unknown in SIGNED.items()]
    problem = cp.Problem(cp.Maximize(t), [*held, t <= 1])
    problem.solve(solver="CLARABEL")
    found = margin_program(CASE, edition, l1=repr(lambda1)).infimum()
    assert -found.value == pytest.approx(problem.value, abs=1e-5)


@pytest.mark.slow
def test_least_squares_design_agrees_with_another_modelling_layer():
    import cvxpy as cp

    values, sides = by_cvxpy("corrected")
    held = [side << -1e-3 * np.eye(15) for side in sides]
    held += [values[name] >> 1e-3 * np.eye(unknown.rows) for name, unknown in SIGNED.items()]
    problem = cp.Problem(cp.Minimize(sum(cp.sum_squares(v) for v in values.values())), held)
    problem.solve(solver="CLARABEL")
    found = least_squares_program(CASE).infimum()
    assert found.value == pytest.approx(problem.value, rel=1e-5)
    gain, _ = gains_of(found.values)
    other, _ = gains_of({name: v.value for name, v in values.items()})
    np.testing.assert_allclose(gain, other, rtol=2e-3)  # the second solver's digits


def test_the_functional_in_antiderivatives_is_that_of_11():
    # Expected: (11) with its integrals by Gauss' rule, exact for the polynomials taken, z of degree 3.
    rng, t, d, d_M = np.random.default_rng(2), 0.7, 0.2, 0.5
    motion = [np.polynomial.Polynomial(c) for c in rng.normal(size=(3, 4))]
    P1, Q1, Q2, R = (M + M.T for M in rng.normal(size=(4, 3, 3)))

    def along(s: float, *, rate: bool = False) -> np.ndarray:
        return np.array([(p.deriv() if rate else p)(s) for p in motion])

    def form(M: np.ndarray, *, rate: bool = False) -> np.polynomial.Polynomial:
        z = [p.deriv() if rate else p for p in motion]
        return sum((M[i, j] * z[i] * z[j] for i in range(3) for j in range(3)), np.polynomial.Polynomial([0.0]))

    def integral(of, low: float, high: float) -> float:
        points, weights = np.polynomial.legendre.leggauss(8)
        half = (high - low) / 2
        return half * sum(w * of(low + half * (1 + x)) for x, w in zip(points, weights, strict=True))

    expected = along(t) @ P1 @ along(t) + integral(lambda s: along(s) @ Q1 @ along(s), t - d_M, t)
    expected += integral(lambda s: along(s) @ Q2 @ along(s), t - d, t)
    turned = lambda s: along(s, rate=True) @ R @ along(s, rate=True)  # noqa: E731  # the integrand of R
    expected += integral(lambda angle: integral(turned, t + angle, t), -d_M, 0.0)
    G1, G2, H = form(Q1).integ(), form(Q2).integ(), form(R, rate=True).integ()
    values = {"z": along(t)[:, None], "P1": P1, "d_M": d_M, "G1": G1(t), "G1M": G1(t - d_M), "G2": G2(t),
              "G2d": G2(t - d), "H": H(t), "K": H.integ()(t), "KM": H.integ()(t - d_M)}  # fmt: skip
    text = derivations.FUNCTIONAL.format(**{name: name for name in derivations.LATER})
    assert computed(text, values).item() == pytest.approx(expected, rel=1e-12)


def test_12_is_the_derivative_of_11_and_no_term_may_differ(monkeypatch):
    assert derivations.derivative_of_11(CASE).conclusions[0].relation == "holds"
    for term, other in (("d_M * v.T", "v.T"), ("(1 - mu)", "(1 + mu)"), ("- zM.T", "+ zM.T"), ("2 * z.T", "z.T")):
        with monkeypatch.context() as patched:
            patched.setattr(derivations, "RATE", derivations.RATE.replace(term, other, 1))
            with pytest.raises(CertificateError, match="left and right differ"):
                derivations.derivative_of_11(CASE)

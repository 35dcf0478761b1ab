"""Theorems 1 and 2 of zhang2013: the correction, what it accepts, and second methods for its numbers."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import CertificateError, ComputationError
from gainsay.lmi import Infimum, Program, Solved, infimum, scalar, solve
from gainsay.proof import Conclusion
from gainsay.systems.delay_bounds import bessel_legendre, level, proved_delay
from gainsay.systems.delay_spectrum import hinf_norm
from gainsay.tables import Case, read_case
from papers.zhang2013 import certificates, derivations, misprints
from papers.zhang2013.bounds import Structured, first_refuted, gamma_program, largest_delay, least_gamma, lifted
from papers.zhang2013.design import (
    acceptance_program,
    farkas_multipliers,
    fast_program,
    gains_of,
    inequalities,
    least_squares_program,
    margin_program,
    standing,
    unsound_program,
)
from papers.zhang2013.plant import Spacecraft
from papers.zhang2013.synthesis import near_optimum
from papers.zhang2013.theorem1 import PARTS, Delayed, Functional, channel_blocks, theorem1, without_slack
from papers.zhang2013.theorem2 import (
    EDITIONS,
    FREE,
    ROWS,
    SYMMETRIC,
    Setting,
    Unknowns,
    congruence,
    corrected,
    differing_blocks,
    printed,
)

CASE: Case = read_case(Path(__file__).resolve().parents[2], "zhang2013")
CRAFT = Spacecraft.of(CASE)
K, L = CASE.matrix("K"), CASE.matrix("L")
PLUS = Setting.of(CRAFT, CASE)
LOOP = Delayed.of(CRAFT, CASE.printed("K").exact, CASE.printed("L").exact, 0.03, 0.1)


def random_point(seed: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    point = {}
    for name, size in SYMMETRIC.items():
        value = rng.normal(size=(size, size))
        point[name] = value + value.T
    for name, shape in FREE.items():
        point[name] = rng.normal(size=shape) + 2 * np.eye(*shape)
    return point


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
    setting = replace(PLUS, d_M=d_M, mu=mu, lambda1=lambda1, lambda2=lambda2)
    point = random_point(seed)
    expected = congruence(setting, point, part)
    found = corrected(setting, Unknowns(), part).value(point)
    np.testing.assert_allclose(found, expected, atol=1e-9 * (1 + np.abs(expected).max()))


@pytest.mark.parametrize("part", ["a", "b"])
def test_the_difference_to_the_congruence_is_in_the_blocks_found(part):
    # independent of the corrected formulas: printed (23) against T' (9) T, entry by entry, at a random point
    point = random_point(11)
    gap = np.abs(printed(PLUS, Unknowns(), part).value(point) - congruence(PLUS, point, part)) > 1e-9
    ends = np.cumsum([0, 2, 1, 2, 1, 2, 1, 2, 1, 1, 1, 1])
    found = {
        (i + 1, j + 1)
        for i in range(11)
        for j in range(i, 11)
        if gap[ends[i] : ends[i + 1], ends[j] : ends[j + 1]].any()
    }
    assert found == set(differing_blocks(PLUS))


@given(st.integers(0, 10_000), st.floats(-3.0, 0.0), st.sampled_from(["printed", "corrected"]))
@settings(deadline=None, max_examples=30)
def test_a_form_is_positive_for_every_lambda1_up_to_zero(seed, lambda1, edition):
    rng = np.random.default_rng(seed)
    point = random_point(seed)
    for name, size in SYMMETRIC.items():
        half = rng.normal(size=(size, size))
        point[name] = half @ half.T + 0.1 * np.eye(size)
    z = np.zeros(15)
    v = rng.normal(size=2)
    for row, factor in (("x", lambda1), ("x'", -1.0), ("x_d", lambda1), ("x_M", lambda1)):
        start = certificates.OFFSETS[row]
        z[start : start + 2] = factor * v
    F = EDITIONS[edition](replace(PLUS, lambda1=lambda1), Unknowns(), "a").value(point)
    assert z @ F @ z > 0


def test_least_gamma_is_the_same_with_and_without_slack():
    with_slack = infimum(gamma_program(LOOP, Functional(3), theorem1))
    assert isinstance(with_slack, Infimum)
    assert with_slack.upper == pytest.approx(least_gamma(LOOP).value, rel=1e-4)


def test_a_point_without_slack_lifts_to_theorem_1():
    found = least_gamma(LOOP)
    point = lifted(LOOP, found.solved.values)
    gamma_squared, v = scalar("gamma2"), Functional(3)
    held = [theorem1(LOOP, v, gamma_squared, part) < 0 for part in PARTS]
    assert Program(minimise=gamma_squared, subject_to=[*held, *v.positive]).check(point).holds


def test_theorem_1_lies_between_the_exact_norm_and_its_structured_form():
    exact = hinf_norm(CRAFT.design_loop(CASE.printed("K").exact, CASE.printed("L").exact), 0.03).value
    full = np.sqrt(least_gamma(LOOP).value)
    structured = np.sqrt(least_gamma(LOOP, Structured(0.12, 0.1), theorem1).value)
    assert exact < full < structured < CASE.number("gamma") / 10  # more than tenfold margin


def test_structured_theorem_1_is_theorem_2_for_given_gains():
    # two parametrisations of the same set: P21, ... of (25), and X = P21^-1 with the hats
    least = least_gamma(LOOP, Structured(0.12, 0.1), theorem1)
    for factor, feasible in ((1.01, True), (0.99, False)):
        setting = replace(PLUS, gamma=float(np.sqrt(least.value) * factor))
        found = solve(acceptance_program(setting, K, L, corrected))
        assert isinstance(found, Solved)
        assert (-found.objective > 0) == feasible


def test_mu_has_no_effect_on_the_least_gamma():
    assert least_gamma(replace(LOOP, mu=1.0)).value == pytest.approx(least_gamma(LOOP).value, rel=1e-6)


@pytest.mark.slow
def test_largest_delay_lies_below_the_exact_margin_and_between_checked_points():
    limit = CRAFT.design_loop(K, L).quasi_polynomial.margin().delay
    feasible, infeasible = largest_delay(LOOP, 1.5, limit)
    assert feasible < infeasible < limit
    assert infeasible - feasible < 2e-4
    for d_M, sign in ((feasible - 1e-3, -1), (infeasible + 1e-3, 1)):
        assert sign * (least_gamma(replace(LOOP, d_M=d_M)).value - 2.25) > 0


def test_theorem_1_of_the_delayed_signal_proves_no_more_than_theorem_1():
    loop = CRAFT.design_loop(K, L)
    parts = loop.A[:2, :2], loop.Bd[:2], loop.Cd[:, :2]
    exact = loop.quasi_polynomial.margin().delay
    proved, _ = proved_delay(lambda d: channel_blocks(*parts, d, 0.1), 1.001 * exact, 1e-3)
    # its stability part is what remains of (9) for a large gamma
    assert least_gamma(replace(LOOP, d_M=0.999 * proved)).upper < 1e4
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


def test_multipliers_of_contradicting_bounds_are_their_closed_form():
    """x > 0 and -1 - x > 0 contradict each other with equal weights alone; the sum is -1 times the weight."""
    x = scalar("x")
    program = Program(subject_to=[(x > 0).named("above"), ((-x - 1) > 0).named("below")], label="bounds")
    found = farkas_multipliers(program)
    assert found["above"].item() == pytest.approx(found["below"].item(), rel=1e-9)
    assert found["above"].item() > 0


def test_a_feasible_program_has_no_multipliers():
    x = scalar("x")
    with pytest.raises(ComputationError, match="no multipliers"):
        farkas_multipliers(Program(subject_to=[(x > 0).named("above"), ((1 - x) > 0).named("below")], label="bounds"))


def test_first_refuted_is_the_limit_where_nothing_is_refuted():
    assert first_refuted(lambda h: False, 1.0, 2.0) == 2.0
    assert first_refuted(lambda h: True, 1.0, 1.0 + 1e-9) == 1.0 + 1e-9
    assert first_refuted(lambda h: h > 1 + 5e-6, 1.0, 2.0) == pytest.approx(1 + 1e-5, rel=1e-12)  # the next step above


def test_unsound_point_has_an_unstable_observer():
    found = solve(unsound_program(replace(PLUS, lambda1=1.0), EDITIONS["printed"]))
    assert isinstance(found, Solved)
    _, L_found = gains_of(found.values)
    assert (L_found @ PLUS.B).item() < 0  # e' = -L B e grows
    # the corrected LMIs accept none such: Theorem 1 would prove it stable
    assert not isinstance(solve(unsound_program(PLUS, EDITIONS["corrected"])), Solved)


@pytest.mark.parametrize(
    ("design", "program"), [("resynthesised", least_squares_program), ("fast", fast_program)], ids=lambda x: str(x)[:5]
)
def test_committed_designs_of_convex_programs_are_near_the_optimum_and_the_printed_gains_are_not(design, program):
    committed = CASE.designs[design]["K"], CASE.designs[design]["L"]
    results = SimpleNamespace(attempt=lambda *_: None)
    least = infimum(program(PLUS))
    near_optimum(design, program(PLUS, committed), least.lower, results)
    with pytest.raises(ComputationError, match=f"designs/{design}.json reaches"):
        near_optimum(design, program(PLUS, (K, L)), least.lower, results)


def test_an_enclosure_is_the_value_between_its_neighbours():
    """-1/2 is a double, so that both ends are its neighbours; a bound on one side is not taken for an enclosure."""
    proved = SimpleNamespace(
        conclusions=[Conclusion("q", "greater_than", "-1"), Conclusion("q", "inside", "-1/2..-0.5")]
    )
    assert certificates.enclosure(proved) == {
        "value": -0.5, "lower": np.nextafter(-0.5, -1), "upper": np.nextafter(-0.5, 0)
    }  # fmt: skip


def test_repaired_design_is_no_worse_than_the_printed_one_in_anything_counted():
    design = CASE.designs["repaired"]["K"], CASE.designs["repaired"]["L"]
    before, after = (standing(CRAFT, *gains, 0.03) for gains in ((K, L), design))
    assert after.margin_paper > before.margin_paper
    assert after.margin_all > before.margin_all
    assert after.abscissa < before.abscissa


def test_certificates_of_misprints_are_accepted():
    blocks = differing_blocks(PLUS)
    for i, j in blocks:
        assert misprints.differing_block(CASE, ROWS[i - 1], ROWS[j - 1]).kind == "different"
    assert misprints.corrected_form(CASE).conclusions[0].relation == "holds"
    assert misprints.printed23_differs(CASE).conclusions[0].relation == "fails"
    assert misprints.printed26_differs(CASE).conclusions[0].relation == "fails"
    assert {made.id for made in misprints.wrong_sizes(CASE)} == {"eq26-r1", "hats-q12", "eq24-inverse", "eq7-bars"}


def test_a_block_that_is_right_has_no_certificate_of_a_difference():
    with pytest.raises(CertificateError, match="not proved to differ"):
        misprints.differing_block(CASE, "x", "x_d")


def test_infeasibility_at_the_printed_sign_is_certified_and_not_at_plus():
    for edition in EDITIONS:
        quantity = "theorem2.feasible_printed_sign"
        assert certificates.printed_sign_infeasible(CASE, edition, quantity).conclusions[0].relation == "fails"
    assert certificates.negative_form(CASE).conclusions[0].relation == "holds"

    class Positive:
        """The tables with lambda1 = +0.12 where the paper prints -0.12."""

        def __getattr__(self, name):
            return getattr(CASE, name)

        def exact(self, name):
            return CASE.exact("lambda1_corrected" if name == "lambda1" else name)

    with pytest.raises(CertificateError):
        certificates.printed_sign_infeasible(Positive(), "corrected", "theorem2.feasible_printed_sign")


def test_printed_lmis_are_infeasible_at_plus_and_the_corrected_ones_are_not():
    program = Program(subject_to=inequalities(PLUS, Unknowns(), EDITIONS["printed"], 0.0), label="(23) printed")
    multipliers = farkas_multipliers(program)
    named = "theorem2.printed_feasible"
    made = certificates.infeasible(CASE, "x", "printed", "number('lambda1_corrected')", multipliers, named)
    assert made.conclusions[0].relation == "fails"
    with pytest.raises(CertificateError):  # the same multipliers prove nothing of the corrected LMIs
        certificates.infeasible(CASE, "x", "corrected", "number('lambda1_corrected')", multipliers, named)


def test_a_point_of_the_corrected_lmis_is_no_point_of_the_printed_ones():
    found = infimum(margin_program(PLUS, "corrected"))
    plus, quantity = "number('lambda1_corrected')", "theorem2.feasible"
    made = certificates.feasible(CASE, "x", "corrected", plus, found.solved.values, quantity)
    assert made.conclusions[0].relation == "holds"
    with pytest.raises(CertificateError):
        certificates.feasible(CASE, "x", "printed", plus, found.solved.values, quantity)


def test_gamma_floor_is_the_modulus_of_c2():
    assert certificates.gamma_floor(CASE).conclusions[0].value == "0.01"  # C2 = -0.1
    found = solve(acceptance_program(replace(PLUS, gamma=0.0999), K, L, corrected))
    assert not (isinstance(found, Solved) and found.objective < 0)


def test_derivations_are_tasks():
    assert {task.where for task in derivations.TASKS} >= {"(2), (5), (7)", "(12) to (22)"}


def test_without_slack_refuses_an_unstable_loop():
    unstable = replace(LOOP, A=LOOP.A + 0.5 * np.eye(3))
    v = Functional(3)
    held = [without_slack(unstable, v, 1e6, part) < 0 for part in PARTS]
    assert not isinstance(solve(Program(subject_to=[*held, *v.positive])), Solved)


def by_cvxpy(setting: Setting, edition: str):
    """The same inequalities through another modelling layer: variables and both left sides."""
    import cvxpy as cp

    values = {n: cp.Variable((k, k), symmetric=True) if k > 1 else cp.Variable((1, 1)) for n, k in SYMMETRIC.items()}
    values |= {name: cp.Variable(shape) for name, shape in FREE.items()}
    sides = []
    for part in PARTS:
        whole = EDITIONS[edition](setting, Unknowns(), part).assembled
        side = cp.Constant(whole.constant)
        for variable, tensor in whole.terms.items():
            for k, (i, j) in enumerate(variable.index):
                side = side + tensor[:, :, k] * values[variable.name][i, j]
        sides.append(side)
    return values, sides


@pytest.mark.slow
@pytest.mark.parametrize(("edition", "lambda1"), [("corrected", 0.12), ("printed", 1.0), ("printed", 0.12)])
def test_margins_agree_with_another_modelling_layer(edition, lambda1):
    import cvxpy as cp

    setting = Setting.of(CRAFT, CASE, lambda1=lambda1)
    values, sides = by_cvxpy(setting, edition)
    t = cp.Variable()
    held = [side << -t * np.eye(15) for side in sides] + [cp.abs(v) <= 1e4 for v in values.values()]
    held += [values[name] >> t * np.eye(size) for name, size in SYMMETRIC.items()]
    problem = cp.Problem(cp.Maximize(t), [*held, t <= 1])
    problem.solve(solver="CLARABEL")
    found = infimum(margin_program(setting, edition))
    assert -found.value == pytest.approx(problem.value, abs=1e-5)


@pytest.mark.slow
def test_least_squares_design_agrees_with_another_modelling_layer():
    import cvxpy as cp

    from papers.zhang2013.design import least_squares_program

    values, sides = by_cvxpy(PLUS, "corrected")
    held = [side << -1e-3 * np.eye(15) for side in sides]
    held += [values[name] >> 1e-3 * np.eye(size) for name, size in SYMMETRIC.items()]
    problem = cp.Problem(cp.Minimize(sum(cp.sum_squares(v) for v in values.values())), held)
    problem.solve(solver="CLARABEL")
    found = infimum(least_squares_program(PLUS))
    assert found.value == pytest.approx(problem.value, rel=1e-5)
    gain, _ = gains_of(found.values)
    other, _ = gains_of({name: v.value for name, v in values.items()})
    np.testing.assert_allclose(gain, other, rtol=2e-3)  # the second solver's digits

"""The campaigns of the papers: rows and modules fit, and their expansions hold against the plants themselves."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gainsay.campaigns.box import PROVED
from gainsay.errors import CertificateError
from gainsay.proof import Conclusion
from gainsay.steps.campaign import plan_digest, plan_of
from gainsay.tables import paper_names, read_case
from papers.li2021 import plant
from papers.li2021.campaigns import loops_of
from papers.li2021.campaigns_box import INPUTS, gain_box

ROOT = Path(__file__).resolve().parents[2]
CASES = {name: read_case(ROOT, name) for name in paper_names(ROOT)}
CAMPAIGNS = [(paper, name) for paper, case in CASES.items() for name in case.campaigns]


@pytest.mark.parametrize(("paper", "name"), CAMPAIGNS)
def test_every_row_has_its_evaluation(paper, name):
    assert plan_of(CASES[paper], name).chunks > 0


def test_a_digest_changes_with_the_tables_and_not_with_the_chunks():
    case = CASES["li2021"]
    row = case.campaigns["random-gains"]
    assert plan_digest(case, row) == plan_digest(case, row.model_copy(update={"chunk": "2000", "question": "?"}))
    assert plan_digest(case, row) != plan_digest(case, row.model_copy(update={"seed": "1"}))
    changed = case.parameters["J10"].model_copy(update={"value": "1"})
    assert plan_digest(case, row) != plan_digest(replace(case, parameters={**case.parameters, "J10": changed}), row)


def test_the_digest_of_code_is_that_of_what_it_does(tmp_path):
    from gainsay.steps.campaign import _code

    text = '"""Module."""\n\n\ndef f(x):\n    """Say."""\n    return x in {"a", "b", 2.5}\n'
    same = text, text.replace("Say.", "Tell.").replace("    return", "    # why\n\n    return")
    changed = text.replace("2.5", "2.50001"), text.replace("{", "[").replace("}", "]"), text.replace(" in ", " not in ")
    digests = []
    for number, content in enumerate((*same, *changed)):
        path = tmp_path / f"{number}.py"
        path.write_text(content)
        digests.append(_code(path))
    assert digests[0] == digests[1]
    assert len(set(digests)) == 4


def test_the_digest_of_code_is_the_same_in_every_process():
    """The order of a set of texts differs from process to process."""
    command = f"from gainsay.steps.campaign import _code; from pathlib import Path; print(_code(Path({__file__!r})))"
    found = {
        subprocess.run(
            [sys.executable, "-c", command], env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True, check=True
        ).stdout
        for seed in ("1", "2", "3")
    }
    assert len(found) == 1
    assert "a" in {"a", "b", "c"}  # so that there is one in this file


@pytest.fixture(scope="module")
def box():
    return gain_box(CASES["li2021"])


def exact_loop(point):
    """(10) by the exact plant, at inertias delta and common variations of the three gains."""
    case = CASES["li2021"]
    from fractions import Fraction

    exact = [Fraction(float(x)) for x in point]
    gains = plant.controller(case, "proposed", exact=True)
    ones = np.array([Fraction(1)] * 6)
    rigid = plant.rigid(plant.exact_constants(case), exact[:3])
    return plant.closed_loop(rigid, gains, ones + exact[3], ones[:3] + exact[4], ones[:3] + exact[5])


def test_the_pencil_of_a_box_is_that_of_the_loop_within_its_bound(box):
    """Against the plant in rationals, an independent transcription of (10)."""
    rng = np.random.default_rng(7)
    for reach in (0.0, 1e-3, 1.0):
        point = reach * rng.uniform(-1, 1, 6)
        _, loop, _, error = box.at_middle(point, point)
        assert (np.abs((exact_loop(point) - loop).astype(float)) <= error).all()
        assert error.max() < 1e-10


def test_what_is_proved_of_a_box_holds_at_its_points(box):
    half = np.array([1.0, 1.0, 1.0, 0.01, 0.01, 0.01])
    (outcome,), _ = box(-half[None], half[None])
    assert outcome == PROVED
    rng = np.random.default_rng(3)
    for _ in range(50):
        A = exact_loop(rng.uniform(-half, half)).astype(float)
        assert np.abs(np.linalg.eigvals(A) + 1.01).max() < 1


def test_a_box_outside_is_never_proved(box):
    """At A_f lower by 30 % a pole lies outside the disk: eigenvalues of the plant in rationals, rounded once."""
    point = np.array([0, 0, 0, -0.3, 0, 0])
    assert np.abs(np.linalg.eigvals(exact_loop(point).astype(float)) + 1.01).max() > 1.1
    for size in (0.0, 1e-6, 0.01, 0.2):
        (outcome,), _ = box((point - size)[None], (point + size)[None])
        assert outcome != PROVED


def test_the_loops_of_draws_are_the_exact_ones_within_their_bound():
    from fractions import Fraction

    case = CASES["li2021"]
    factors = 1 + np.random.default_rng(5).random((3, 12))
    for name in ("proposed", "comparison"):
        loops, error = loops_of(case, name, factors)
        gains = plant.controller(case, name, exact=True)
        rigid = plant.rigid(plant.exact_constants(case))
        for row, near, bound in zip(factors, loops, error, strict=True):
            f = np.array([Fraction(x) for x in row])
            exact = plant.closed_loop(rigid, gains, f[:6], f[6:9], f[9:])
            away = exact - np.array([[Fraction(x) for x in line] for line in near])
            assert (np.abs(away.astype(float)) <= bound).all()


@pytest.mark.slow
def test_small_campaigns_agree_with_what_is_known_of_the_papers():
    """(12) against the band of lambda and the least gamma that other certificates enclose, (23) against its signs."""
    case = CASES["li2021"]
    band = {key: float(value.floats[0, 0]) for key, value in case.designs["lambda_band"].matrices.items()}
    least = float(case.recorded["lemma3.gamma_min"].value)
    points = [
        (1.0, 0.99 * least), (1.0, 1.01 * least), (0.98 * band["low_outside"], 10), (1.02 * band["low_inside"], 10),
        (0.98 * band["high_inside"], 10), (1.02 * band["high_outside"], 10),
    ]  # fmt: skip
    from gainsay.campaigns.feasibility import certified
    from papers.li2021.campaigns import equation_12

    found = [
        certified(equation_12(case, {"lambda": f"{lam:.6g}", "gamma": f"{gamma:.6g}"}), "x", "solution")[0]
        for lam, gamma in points
    ]
    assert found == ["infeasible", "feasible", "infeasible", "feasible", "feasible", "infeasible"]
    other = CASES["zhang2013"]
    from papers.zhang2013.campaigns import equation_23

    for edition, l1, outcomes in (
        ("corrected", "0.12", {"feasible"}),
        ("printed", "0.12", {"infeasible"}),
        # block (4,4) needs lambda2 P22 > 0 and (3,3) lambda1 X > 0: none at a negative lambda1, proved or not said
        ("corrected", "-0.12", {"infeasible", "undecided"}),
    ):
        assert certified(equation_23(edition)(other, {"lambda1": l1, "lambda2": "0.1"}), "x", "solution")[0] in outcomes


@pytest.mark.slow
def test_the_map_of_pinheiro2013_turns_at_the_least_trace_that_other_proofs_enclose():
    from gainsay.campaigns.feasibility import certified
    from papers.pinheiro2013.campaigns import equation_21

    case = CASES["pinheiro2013"]
    least = float(case.recorded["a.gamma_2.sqrt_trace.pitch"].value)
    assert case.number("angle_weight") == 0.1
    for share, outcome in ((0.99, "infeasible"), (1.01, "feasible")):
        point = {"inertia": "1", "angle_weight": "0.1", "bound": f"{share * least:.6g}"}
        assert certified(equation_21(case, point), "x", "solution")[0] == outcome


@pytest.mark.slow
def test_the_scan_of_wan2014_gives_the_thrust_of_a_flight_flown_alone():
    """At the start that the other flights of the paper take; the record is of another integrator's run."""
    from papers.wan2014.campaigns import thrust_ratio

    case = CASES["wan2014"]
    points = [{"estimate_position_share": p, "estimate_velocity_share": "0"} for p in ("1", "0.5")]
    alone = float(case.recorded["audit.thrust_ratio"].value)
    assert thrust_ratio(case, points)[0] == pytest.approx(alone, rel=1e-7)


@pytest.mark.slow
def test_draws_are_those_that_floating_point_finds_where_it_is_far_from_the_border():
    from gainsay.campaigns import Plan
    from gainsay.systems.regions import HalfPlane
    from papers.li2021.campaigns import CAMPAIGNS

    case = CASES["li2021"]
    plan = Plan(case, case.campaigns["random-gains"], CAMPAIGNS["random-gains"])
    block = next(plan.blocks())
    (counts,) = [plan.evaluation.count(plan.evaluation.block(case, block))]
    factors = 1 + block.generator().random((block.size, 12))
    for name in ("proposed", "comparison"):
        reach = HalfPlane().reach(loops_of(case, name, factors)[0])
        assert np.abs(reach).min() > 1e-8
        assert counts[f"{name}_unresolved"] == 0
        assert counts[f"{name}_unstable"] == int((reach > 0).sum())


def test_a_box_and_a_point_of_it_have_certificates(box):
    """|s + 1.01| by the plant in rationals at the point: eigenvalues rounded once."""
    ranges = [
        [name, low, high] for name, (low, high) in zip(INPUTS, [("-1", "1")] * 3 + [("0", "0.01")] * 3, strict=True)
    ]
    certificate = box.proof("x", ranges)
    assert Conclusion("", "less_than", "1", "radius") in certificate.conclusions
    point = [0, 0, 0, -0.3, 0, 0]
    assert np.abs(np.linalg.eigvals(exact_loop(np.array(point)).astype(float)) + 1.01).max() > 1.1
    violation = box.violation("x", list(zip(INPUTS, map(str, point), strict=True)))
    assert violation.conclusions == (Conclusion("", "greater_than", "1", "radius"),)
    with pytest.raises(CertificateError):
        box.proof("x", [[name, str(x - 0.01), str(x + 0.01)] for name, x in zip(INPUTS, point, strict=True)])
    with pytest.raises(CertificateError):
        box.violation("x", [(name, "0") for name in INPUTS])


@pytest.mark.slow
def test_every_inertia_and_variation_of_table_1_is_proved_in_the_disk():
    """As the certificate of the printed gains says of independent variations up to 0.067, by another argument."""
    from gainsay.campaigns import Plan
    from papers.li2021.campaigns import CAMPAIGNS, HALVINGS

    case = CASES["li2021"]
    assert float(case.recorded["certified.printed.delta_m"].value) > 0.05
    plan = Plan(case, case.campaigns["gain-box"], CAMPAIGNS["gain-box"])
    counts = [plan.evaluation.count(plan.evaluation.block(case, block)) for block in plan.blocks()]
    assert sum(count["proved"] for count in counts) == plan.points << HALVINGS
    assert sum(count["cells_certified"] for count in counts) == plan.points

"""What a campaign says rests on proofs: intervals, disks of eigenvalues, maps of certificates."""

import math
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.campaigns import Block, Plan
from gainsay.campaigns.box import over_boxes
from gainsay.campaigns.feasibility import FEASIBLE, INFEASIBLE, UNDECIDED, certified, feasibility_map
from gainsay.campaigns.interval import clopper_pearson
from gainsay.campaigns.pencil import PencilBox
from gainsay.campaigns.store import doubts, gather, gathered, manifest_doubt, write_chunk
from gainsay.errors import InputError
from gainsay.lmi.candidates import candidates
from gainsay.statements import Stated, read_constraint, symmetric
from gainsay.systems.enclosed_spectra import INSIDE, OUTSIDE, UNRESOLVED, eigenvalue_disks, resolved
from gainsay.tables import read_case
from gainsay.tables.models import Campaign


def tail(found, draws, probability):
    """P(X >= found) of a binomial, exactly."""
    p = Fraction(probability)
    return sum(math.comb(draws, k) * p**k * (1 - p) ** (draws - k) for k in range(found, draws + 1))


@settings(deadline=None)  # the first example loads scipy
@given(st.integers(1, 60), st.data())
def test_the_interval_is_that_of_the_exact_tails(draws, data):
    found = data.draw(st.integers(0, draws))
    low, high = clopper_pearson(found, draws)
    side = Fraction(1, 40)
    # Clopper and Pearson 1934: each end is where its tail is 2.5 %; on the safe side, and not further than 1e-9
    assert low == 0.0 or tail(found, draws, low) <= side < tail(found, draws, low + 1e-9)
    assert high == 1.0 or 1 - tail(found + 1, draws, high) <= side < 1 - tail(found + 1, draws, high - 1e-9)
    assert (low == 0.0) == (found == 0)
    assert (high == 1.0) == (found == draws)


def test_a_published_interval():
    # closed form where nothing is found: 1 - (alpha/2)^(1/n)
    assert clopper_pearson(0, 20)[1] == pytest.approx(1 - 0.025 ** (1 / 20), abs=1e-12)
    low, high = clopper_pearson(142_540, 10**6)
    assert 0 < high - low < 4.2 * math.sqrt(0.1425 * 0.8575 / 10**6)  # the normal approximation is 2 * 1.96 errors


@settings(deadline=None)
@given(st.integers(0, 40), st.integers(0, 40), st.integers(1, 40))
def test_what_is_unresolved_widens_the_interval(found, open_, rest):
    draws = found + open_ + rest
    low, high = clopper_pearson(found, draws, open_)
    assert low == clopper_pearson(found, draws)[0]
    assert high == clopper_pearson(found + open_, draws)[1]
    assert clopper_pearson(found + open_ // 2, draws)[0] >= low


@pytest.mark.parametrize("counts", [(-1, 3, 0), (2, 3, 2), (0, 0, 0)])
def test_counts_that_do_not_fit_are_refused(counts):
    with pytest.raises(InputError, match="counts"):
        clopper_pearson(*counts)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32), st.floats(-3, 6))
def test_disks_hold_the_eigenvalues_that_a_matrix_was_made_of(seed, spread):
    """An integer triangular matrix turned by integer matrices of determinant one has its diagonal as eigenvalues."""
    rng = np.random.default_rng(seed)
    n = 5
    known = rng.integers(-9, 10, n)
    T = np.triu(rng.integers(-3, 4, (n, n)), 1) + np.diag(known)
    L = np.tril(rng.integers(-2, 3, (n, n)), -1) + np.eye(n, dtype=int)
    inverse = np.rint(np.linalg.inv(L)).astype(int)
    assert (L @ inverse == np.eye(n)).all()
    A = (L @ T @ inverse).astype(float)
    error = 10.0**-spread * 1e-6 * rng.random((n, n))
    centres, radii = eigenvalue_disks(A, error)
    for value in known:
        assert (np.abs(centres - value) <= radii).any()
    inside = resolved(A, lambda s: s.real, error)
    assert inside == UNRESOLVED or (inside == INSIDE) == (known.max() < 0)


def test_what_cannot_be_told_is_not():
    turning = np.array([[0.0, 1.0], [-1.0, 0.0]])  # on the border of the left half plane
    jordan = np.array([[-1e-9, 1.0], [0.0, -1e-9]])  # 1e-12 in its corner moves the eigenvalues by 1e-6
    stack = np.array([turning, jordan, -np.eye(2), [[1.0, 0.0], [0.0, -1.0]]])
    assert list(resolved(stack, lambda s: s.real)) == [UNRESOLVED, INSIDE, INSIDE, OUTSIDE]
    assert list(resolved(stack, lambda s: s.real, 1e-12)) == [UNRESOLVED, UNRESOLVED, INSIDE, OUTSIDE]
    assert list(resolved(stack, lambda s: s.real, 1.1)) == [UNRESOLVED] * 4
    assert resolved(np.full((2, 2), np.nan), lambda s: s.real) == UNRESOLVED
    assert resolved(-0.5 * np.eye(2), lambda s: np.abs(s + 1) - 1) == INSIDE
    assert resolved(0.5 * np.eye(2), lambda s: np.abs(s + 1) - 1) == OUTSIDE


TABLES = "[[-1, 1], [0, -2]]"


def lyapunov(case, point):
    """A'P + PA + s I < 0 with P < 1: has a point where s is small enough, none where it is not."""
    held = [
        read_constraint(f"sym(P @ {TABLES}) + ({point['s']}) * eye(2) < 0", "Lyapunov"),
        read_constraint("P > 0", "P"),
        read_constraint("eye(2) - P > 0", "P < 1"),
    ]
    return Stated(case, held, unknowns={"P": symmetric(2)}, label="toy")


def test_a_program_is_decided_by_a_certificate_alone(project):
    case = read_case(project.root, "toy")
    # diag(x, y) shows: at the largest P, I, A + A' = [[-2, 1], [1, -4]] has -3 + sqrt(2) as largest eigenvalue
    for s, outcome in (("0.5", FEASIBLE), ("1.58", FEASIBLE), ("1.7", INFEASIBLE), ("5", INFEASIBLE)):
        found, certificate = certified(lyapunov(case, {"s": s}), "x", "P")
        assert found == outcome
        assert certificate.conclusions[0].relation == {"feasible": "holds", "infeasible": "fails"}[outcome]


def test_candidates_prove_nothing_and_say_so(project):
    case = read_case(project.root, "toy")
    (one, *_) = candidates(lyapunov(case, {"s": "0.5"}).program())
    assert one.level > 0
    assert set(one.values) == {"P"}
    for other in candidates(lyapunov(case, {"s": "5"}).program()):
        assert not other.values
        assert set(other.multipliers) == {"Lyapunov", "P", "P < 1"}


MAP = Campaign(name="m", kind="map", inputs="s=1.4..1.8", resolution="5", seed="", block="1", chunk="2", claim="",
               question="q")  # fmt: skip


def test_a_figure_of_a_large_map_shows_some_of_its_points_and_counts_all(project):
    from gainsay.campaigns.feasibility import _seen

    row = MAP.model_copy(update={"inputs": "a=0..1; b=0..1; c=0..1", "resolution": "401x2x2"})
    plan = Plan(read_case(project.root, "toy"), row, feasibility_map(("a", "b", "c"), lyapunov, "P"), "0" * 16)
    index = np.arange(401 * 4)
    outcome = np.where(index % 4 == 3, INFEASIBLE, np.where(index < 400, FEASIBLE, UNDECIDED))
    seen, counted = _seen(plan, iter([{"index": index, "outcome": outcome}]), 2)
    assert counted == {FEASIBLE: 300, INFEASIBLE: 401, UNDECIDED: 903}
    assert plan.step == 3
    assert {grid.shape for grid in seen.values()} == {(134, 1)}
    # the last input runs fastest, b = 1 is left out: infeasible points stand at b = 1 alone
    assert not seen[0, INFEASIBLE].any()
    assert not seen[1, INFEASIBLE].any()
    assert seen[0, FEASIBLE].sum() == seen[1, FEASIBLE].sum() == 34
    assert seen[1, UNDECIDED].sum() == 100


def test_a_map_carries_its_proofs_and_a_row_that_lies_is_found(project, monkeypatch):
    case = read_case(project.root, "toy")
    plan = Plan(case, MAP, feasibility_map(("s",), lyapunov, "P at s = {s}"), "0" * 16)
    for number in range(plan.chunks):
        write_chunk(plan, number)
    manifest = gather(plan)
    assert manifest["counts"][FEASIBLE] >= 2
    assert manifest["counts"][INFEASIBLE] >= 2
    assert [doubt for _, doubt in doubts(plan)] == [""] * 5
    (rows,) = gathered(plan, ["outcome", "certificate"])
    from gainsay.campaigns.feasibility import _doubt

    first, last = ({key: rows[key][k] for key in rows} for k in (0, 4))
    own, other = lyapunov(case, {"s": "1.4"}), lyapunov(case, {"s": "1.5"})
    assert _doubt(own, first) == ""
    assert "another program" in _doubt(other, first)  # a proof of another point
    assert "but the certificate" in _doubt(own, {**first, "outcome": INFEASIBLE})
    assert "undecided" in _doubt(own, {**first, "outcome": UNDECIDED})
    assert _doubt(own, {**first, "certificate": first["certificate"].replace("(1.4)", "(1.2)")}) != ""
    assert _doubt(lyapunov(case, {"s": "1.8"}), {**last, "certificate": "{}"}) != ""


def test_without_a_proof_a_point_is_undecided_whatever_the_solver_said(project, monkeypatch):
    case = read_case(project.root, "toy")
    wrong = SimpleNamespace(level=1.0, values={"P": np.eye(2) * 2}, multipliers={})
    monkeypatch.setattr("gainsay.campaigns.feasibility.candidates", lambda program: iter([wrong]))
    assert certified(lyapunov(case, {"s": "0.5"}), "x", "P") == (UNDECIDED, None)


def test_a_map_over_three_inputs_has_a_panel_for_each_value_of_the_third(project):
    from matplotlib.figure import Figure

    case = read_case(project.root, "toy")
    row = MAP.model_copy(update={"inputs": "s=1..2; t=1..2; u=1..100 log", "resolution": "2x2x3"})
    plan = Plan(case, row, feasibility_map(("s", "t", "u"), lyapunov, "P at s = {s}"), "0" * 16)
    points = [point for block in plan.blocks() for point in block.points()]
    outcome = [FEASIBLE if p["u"] == "10" else INFEASIBLE for p in points]
    rows = {name: np.array([float(p[name]) for p in points]) for name in ("s", "t", "u")}
    figure = Figure()
    plan.evaluation.draw(figure, plan, iter([{**rows, "index": np.arange(12), "outcome": np.array(outcome)}]))
    drawn = [[len(held.get_offsets()) for held in axes.collections] for axes in figure.axes]
    # feasible, infeasible, undecided in each of the panels u = 1, 10, 100
    assert drawn == [[0, 4, 0], [4, 0, 0], [0, 4, 0]]
    assert [axes.get_title() for axes in figure.axes] == ["u = 1", "u = 10", "u = 100"]


BOX = Campaign(name="b", kind="box", inputs="m=0.5..1.5; k=0.5..1.5", resolution="4", seed="", block="1", chunk="7",
               claim="", question="q")  # fmt: skip


def spring(case):
    """m x' = -k x in the disk |s + 1| < 0.6: for 0.4 m < k < 1.6 m."""
    return PencilBox(case, ("m", "k"), "-K", "m", "1", "0.6", [("K", "k")], "the pole lies in the disk")


@pytest.fixture
def boxed(project):
    plan = Plan(
        read_case(project.root, "toy"), BOX, over_boxes(("m", "k"), spring, 5, "the pole lies in the disk"), "0" * 16
    )
    for number in range(plan.chunks):
        write_chunk(plan, number)
    return plan, gather(plan)


def test_a_box_carries_proofs_of_whole_cells_and_points_of_those_that_fail(boxed):
    plan, manifest = boxed
    counts = manifest["counts"]
    # cells m, k of side 1/4 from 1/2: whole where k > 0.4 m and k < 1.6 m at the corners that are nearest, strictly
    sides = [0.5 + 0.25 * k for k in range(5)]
    cells = [(m, k) for m in range(4) for k in range(4)]
    whole = [(m, k) for m, k in cells if sides[k] > 0.4 * sides[m + 1] and sides[k + 1] < 1.6 * sides[m]]
    assert counts["cells_proved"] == counts["cells_certified"] == len(whole)
    apart = [(m, k) for m, k in cells if sides[k + 1] <= 0.4 * sides[m] or sides[k] >= 1.6 * sides[m + 1]]
    assert len(apart) <= counts["cells_refuted"] <= 16 - len(whole)
    assert counts["proved"] + counts["refuted"] + counts["open"] == 16 * 32
    assert [doubt for _, doubt in doubts(plan)] == [""] * 16
    assert manifest["told"]["cells"].startswith(
        f"of 16 cells {len(whole)} are proved whole, {len(whole)} of them by cert"
    )
    assert manifest_doubt(plan) == ""


def test_a_cell_whose_certificates_are_not_of_it_is_found(boxed):
    plan, _ = boxed
    (rows,) = gathered(plan, ["index", *plan.evaluation.columns])
    row = [{name: rows[name][k] for name in rows} for k in range(16)]
    one, other = [k for k in range(16) if row[k]["proved"] == 32 and row[k]["certified"] == 1][:2]
    broken = next(k for k in range(16) if row[k]["proved"] < 32 and row[k]["certified"] == 1)

    def doubt(k, **changes):
        return plan.evaluation.recheck(plan.case, Block(plan, k, 1), {**row[k], **changes})

    assert "are counted" in doubt(one, certificate="")
    assert "another cell" in doubt(one, certificate=row[other]["certificate"])
    assert doubt(one, certificate=row[broken]["certificate"]) != ""
    assert doubt(broken, certificate=row[one]["certificate"]) != ""
    assert doubt(one, certificate=row[one]["certificate"].replace("0.6", "0.7")) != ""
    assert doubt(one, certificate="{}") != ""
    # true and accepted, but of another disk
    wider = PencilBox(plan.case, ("m", "k"), "-K", "m", "1", "0.9", [("K", "k")], "the pole lies in the disk")
    ends = Block(plan, one, 1).cells()[0]
    proof = wider.proof("x", [[name, *map(str, ends[name])] for name in ("m", "k")])
    assert "something else" in doubt(one, certificate=proof.to_json(compact=True))


def test_the_parts_of_a_cell_cover_it(project, monkeypatch):
    """0.407 m <= k <= 1.583 m over the whole cell: within the disk, by halves of it."""
    row = BOX.model_copy(update={"inputs": "m=0.6..1.4; k=0.57..0.95", "resolution": "1"})
    plan = Plan(read_case(project.root, "toy"), row, over_boxes(("m", "k"), spring, 8, "in the disk"), "0" * 16)
    cell = Block(plan, 0, 1)
    made = {name: values[0] for name, values in plan.evaluation.block(plan.case, cell).items()}
    lines = made["certificate"].splitlines()
    assert made["certified"] == len(lines) > 2
    assert made["proved"] == 2**8

    def doubt(lines):
        return plan.evaluation.recheck(
            plan.case, cell, {**made, "certificate": "\n".join(lines), "certified": len(lines)}
        )

    assert doubt(lines) == ""
    assert doubt(lines[::-1]) == ""
    for k in range(len(lines)):
        assert "leave out a part" in doubt(lines[:k] + lines[k + 1 :])
        assert "leave out a part" in doubt(lines[:k] + lines[k + 1 :] + [lines[k - 1]])
    assert "leave out" not in doubt([])  # a cell need not be certified, and is counted so
    monkeypatch.setattr("gainsay.campaigns.box.MOST_PARTS", len(lines) - 1)
    counts = plan.evaluation.count(plan.evaluation.block(plan.case, cell))
    assert (counts["cells_proved"], counts["cells_certified"], counts["certified"]) == (1, 0, 0)

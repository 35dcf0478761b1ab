"""campaigns.csv: what it says is read, what it cannot mean is refused in one line with the nearest name."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gainsay.errors import InputError
from gainsay.tables import read_case
from gainsay.tables.campaigns import Axis, axes, check_inputs, counts, named

HEADER = "name,kind,inputs,resolution,seed,block,chunk,claim,question\n"
MAP = "plane,map,lambda=0.1..10 log; gamma=1..5,4x3,,1,2,lmi,where it holds\n"
DRAWS = "luck,draws,factor=1..2,1000,7,100,300,,how often\n"


def written(project, rows, header=HEADER):
    (project.root / "papers" / "toy" / "campaigns.csv").write_text(header + rows)
    return read_case(project.root, "toy")


def test_a_campaign_is_read(project):
    case = written(project, MAP + DRAWS)
    plane, luck = case.campaigns["plane"], case.campaigns["luck"]
    assert axes(plane) == (Axis("lambda", 0.1, 10.0, True), Axis("gamma", 1.0, 5.0, False))
    assert counts(plane) == (4, 3)
    assert counts(luck) == (1000,)


def test_a_paper_needs_no_campaigns(project):
    assert not read_case(project.root, "toy").campaigns


@pytest.mark.parametrize(
    ("row", "fault"),
    [
        (MAP.replace(",map,", ",maps,"), "kind 'maps': expected 'scan', 'map', 'draws' or 'box'"),
        (MAP.replace("0.1..10 log", "0.1-10"), "inputs 'lambda=0.1-10': expected `name=low..high"),
        (MAP.replace("0.1..10", "10..0.1"), "expected a range whose low end is below its high end"),
        (MAP.replace("0.1..10", "0..10"), "expected a range above 0, since it is logarithmic"),
        (MAP.replace("0.1..10", "0.1..1e999999999"), "inputs 'lambda=0.1..1e999999999 log': expected"),
        (MAP.replace("0.1..10", "0.1..nan"), "expected decimal numbers"),
        (MAP.replace("gamma", "lambda"), "inputs 'lambda': expected each input once"),
        (MAP.replace("4x3", "0"), "resolution '0': expected a whole number from 1"),
        (MAP.replace("4x3", "4x3x2"), "resolution '4x3x2': expected one number, or one for each of 2 inputs"),
        (MAP.replace("4x3", "10000000"), "points at most"),
        (MAP.replace("1..5", "1..1.00001"), "expected values of gamma that differ in 6 digits: fewer of them"),
        (MAP.replace("4x3", "1000000x3"), "expected values of lambda that differ in 6 digits: fewer of them"),
        (MAP.replace(",,1,2,", ",5,1,2,"), "seed '5': expected nothing, since a map draws nothing"),
        (MAP.replace(",,1,2,", ",,3,2,"), "chunk '2': expected a multiple of the block of 3 points"),
        (MAP.replace(",,1,2,", ",,-1,2,"), "block '-1': expected a whole number from 1"),
        (MAP.replace(",lmi,", ",lmy,"), "claim 'lmy': expected a claim of claims.csv, 'lmi'?"),
        (DRAWS.replace(",7,", ",,"), "seed '': expected a whole number from 0, since the campaign draws"),
        (DRAWS.replace("1000", "10x10"), "resolution '10x10': expected the number of draws alone"),
        (
            DRAWS.replace(",1000,7,100,300,", ",1000000000,7,1,100,"),
            "chunk '100': expected 1000 or more, since 1e+06 chunks",
        ),
        (MAP.replace("map", "box"), "an even range of lambda: the cells of a box are halved"),
        (
            MAP.replace("map,lambda=0.1..10 log", "box,lambda=1..1.000001").replace("4x3", "1000x3"),
            "resolution '1000x3': expected cells of lambda wider than 1e-9 of its values",
        ),
        (MAP + MAP, "expected a name not used above"),
    ],
)
def test_what_a_row_cannot_mean_is_refused_in_one_line(project, row, fault):
    with pytest.raises(InputError) as refused:
        written(project, row)
    said = str(refused.value)
    assert said.startswith("papers/toy/campaigns.csv:")
    assert fault in said
    assert "\n" not in said


def test_an_unknown_column_is_refused(project):
    with pytest.raises(InputError, match="header"):
        written(project, MAP, HEADER.replace("claim", "clam"))


def test_names_and_inputs_that_are_not_known_are_refused_with_the_nearest(project):
    case = written(project, MAP)
    with pytest.raises(InputError, match="'plane'\\?"):
        named(case.campaigns, "plain", "campaigns.csv")
    with pytest.raises(InputError, match="'lambda': expected 'lambda1'\\?"):
        check_inputs(case.campaigns["plane"], ("lambda1", "gamma"), "campaigns.csv")
    with pytest.raises(InputError, match="a range of mu too"):
        check_inputs(case.campaigns["plane"], ("lambda", "gamma", "mu"), "campaigns.csv")


@given(st.floats(1e-6, 1e6), st.floats(1.001, 1e6), st.integers(2, 10**9), st.booleans(), st.data())
def test_a_grid_has_its_ends_and_rises(low, ratio, count, logarithmic, data):
    axis = Axis("x", low, low * ratio, logarithmic)
    # six significant digits: half a unit of the sixth is at most 5e-6 of the value
    assert float(axis.value(0, count)) == pytest.approx(low, rel=5.1e-6)
    assert float(axis.value(count - 1, count)) == pytest.approx(low * ratio, rel=5.1e-6)
    k = data.draw(st.integers(0, count - 2))
    assert float(axis.value(k, count)) <= float(axis.value(k + 1, count))


@given(st.floats(1e-6, 1e6), st.floats(1e-7, 1e3), st.integers(2, 10**7), st.booleans(), st.booleans(), st.data())
def test_points_of_a_grid_that_is_taken_are_different_ones(low, width, count, logarithmic, below, data):
    end = low * (1 + width)
    axis = Axis("x", -end, -low) if below and not logarithmic else Axis("x", low, end, logarithmic)
    k = data.draw(st.integers(0, count - 2))
    assert not axis.tells_apart(count) or axis.value(k, count) != axis.value(k + 1, count)
    assert axis.tells_apart(2) or width < 1.1e-5


@given(st.floats(-1e6, 1e6), st.floats(1e-6, 1e6), st.integers(1, 1000), st.data())
def test_cells_cover_the_range_without_a_gap(low, width, count, data):
    axis = Axis("x", low, low + width)
    k = data.draw(st.integers(0, count - 1))
    left, right = axis.cell(k, count)
    assert left <= right
    assert axis.cell(0, count)[0] == axis.low
    assert axis.cell(count - 1, count)[1] == axis.high
    if k:
        assert axis.cell(k - 1, count)[1] == left  # by definition of a cover
    assert math.isfinite(left + right)

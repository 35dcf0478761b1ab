"""The digest of what a certificate states: the same for any witness, another for any other formula."""

import pytest

from gainsay.errors import CertificateError
from gainsay.proof import Certificate, Conclusion, by_ends, formulas_digest
from gainsay.proof import kinds as kinds_package

LYAPUNOV = Certificate(
    "c",
    "p",
    "Every pole lies left of -0.3, as (14) of Theorem 1 says.",
    "lyapunov",
    {"matrix": "A", "alpha": "-0.3"},
    definitions=(("A", "printed('A')"),),
    unknowns={},
    witness={"P": [["1", "0"], ["0", "1"]]},
    conclusions=(Conclusion("loop.abscissa", "less_than", "-0.3", "abscissa"),),
    data={"printed": {"A": [["-1", "0"], ["0", "-2"]]}},
)
LEVEL = LYAPUNOV.changed(
    kind="level",
    definitions=(("d", "0.25"), ("A", "d*printed('A')")),
    fields={
        "level": "d",
        "parts": [
            {"name": "disk", "kind": "contour", "fields": {"A": "A", "arcs": ["0", "0.5", "1"], "radius": "2"}},
        ],
    },
)


@pytest.mark.parametrize(
    "parts",
    [
        {"witness": {"P": [["2", "0"], ["0", "1"]]}},
        {"precision": 256},
        {"fields": {"matrix": "A", "alpha": "-0.30000001"}},
        {"conclusions": (Conclusion("loop.abscissa", "less_than", "-0.30000001", "abscissa"),)},
        {"statement": "Every pole lies left of -0.30000001, as (14) of Theorem 1 says."},
        {"data": {"printed": {"A": [["-3", "0"], ["0", "-4"]]}}},  # the checker compares values with the tables
    ],
)
def test_what_a_search_finds_changes_nothing(parts):
    assert formulas_digest(LYAPUNOV.changed(**parts)) == formulas_digest(LYAPUNOV)


@pytest.mark.parametrize(
    "parts",
    [
        {"id": "d"},
        {"paper": "q"},
        {"kind": "stein"},
        {"statement": "Every pole lies left of -0.3, as (15) of Theorem 1 says."},
        {"statement": "Every pole lies left of -0.3, as (14) of Theorem 2 says."},
        {"definitions": (("A", "printed('B')"),)},
        {"definitions": (("A", "2"),)},
        {"unknowns": {"X": {}}},
        {"fields": {"matrix": "A.T", "alpha": "-0.3"}},
        {"fields": {"matrix": "2", "alpha": "-0.3"}},
        {"fields": {"matrix": "A", "alpha": "number('alpha')"}},
        {"conclusions": ()},
        {"conclusions": (Conclusion("loop.abscissa", "at_most", "-0.3", "abscissa"),)},
        {"conclusions": (Conclusion("other.abscissa", "less_than", "-0.3", "abscissa"),)},
        {"data": {"printed": {"A": [], "B": []}}},
        {"faith": ()},
    ],
)
def test_what_is_stated_changes_the_digest(parts):
    assert formulas_digest(LYAPUNOV.changed(**parts)) != formulas_digest(LYAPUNOV)


def test_the_level_and_the_arcs_are_found_and_the_radius_of_a_part_is_stated():
    def disk(**fields):
        part = LEVEL.fields["parts"][0]
        return {**LEVEL.fields, "parts": [{**part, "fields": {**part["fields"], **fields}}]}

    digest = formulas_digest(LEVEL)
    assert formulas_digest(LEVEL.changed(definitions=(("d", "0.26"), ("A", "d*printed('A')")))) == digest
    assert formulas_digest(LEVEL.changed(fields=disk(arcs=["0", "0.3", "0.6", "1"]))) == digest
    assert formulas_digest(LEVEL.changed(fields=disk(radius="3"))) != digest  # no conclusion would show it
    assert formulas_digest(LEVEL.changed(definitions=(("d", "0.25"), ("A", "printed('A')")))) != digest


def test_the_same_after_writing_and_reading():
    assert formulas_digest(Certificate.from_json(LEVEL.to_json())) == formulas_digest(LEVEL)


def test_a_kind_that_does_not_exist_is_refused():
    with pytest.raises(CertificateError, match="wishful"):
        formulas_digest(LYAPUNOV.changed(kind="wishful"))


@pytest.mark.parametrize("name", kinds_package.names())
def test_levels_and_found_fields_are_fields_of_the_kind(name):
    kind = kinds_package.load(name)
    assert {f.partition(".")[0] for f in (*kind.LEVELS, *kind.FOUND)} <= {*kind.REQUIRED, *kind.OPTIONAL}


BOX = {"matrix": "A*m", "alpha": "0", "ranges": [["m", "ends('m')[0, 0]", "ends('m')[0,1]"]]}


@pytest.mark.parametrize(
    ("parts", "ends"),
    [
        ({"fields": BOX}, set()),
        ({"fields": {**BOX, "ranges": [["m", "ends('m')[0, 0]", "ends('m')[0, 0]"]]}}, {"m"}),
        ({"fields": {**BOX, "ranges": [["m", "ends('m')[0, 0]", "ends('k')[0, 1]"]]}}, {"m", "k"}),
        ({"fields": {**BOX, "ranges": [["m", "1/ends('m')[0, 1]", "1/ends('m')[0, 0]"]]}}, {"m"}),
        ({"fields": {**BOX, "alpha": "ends('k')[0, 1]"}}, {"k"}),
        ({"definitions": (("x0", "col(1, ends('m'))"),)}, {"m"}),
        ({"definitions": (("x0", "plausible('m')"),)}, set()),
        ({"kind": "level", "fields": {"parts": [{"name": "a", "kind": "lyapunov", "fields": BOX}]}}, set()),
        ({"kind": "level", "fields": {"parts": [{"fields": {"x0": "ends( 'm' )[0, 0]"}}]}}, {"m"}),
    ],
)
def test_ranges_of_which_an_end_alone_is_read(parts, ends):
    assert by_ends(LYAPUNOV.changed(**parts)) == ends

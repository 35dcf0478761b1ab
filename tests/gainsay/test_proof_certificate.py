"""The format, and certificates changed after they were made: refused unless the mathematics still holds."""

import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay.errors import CertificateError
from gainsay.proof import Certificate, Conclusion, MappingTables, build, check, check_file
from gainsay.proof.certificate import _digest
from gainsay.tables import read_case
from gainsay.tables.designs import FoundDesign, read_design, write_design


def tables(**changes):
    entries = {
        "numbers": {"k": "2", "other": "5"},
        "printed": {"c": [["3.00"]]},
        "designs": {("repaired", "K"): [[0.1]]},
        "name": "spring",
    }
    return MappingTables(**{**entries, **changes})


def example():
    return build.certificate(
        "lyapunov",
        id="stable",
        statement="The loop is stable.",
        tables=tables(),
        definitions={"k": "number('k')", "A": "[[0, 1], [-k, -printed('c')]]"},
        fields={"matrix": "A + 0*design('repaired', 'K')[0,0]*eye(2)", "alpha": "-0.3"},
        # A'P + PA = -2 I for A = [[0, 1], [-2, -3]] in closed form
        witness={"P": [["2.5", "0.5"], ["0.5", "0.5"]]},
        quantities={"abscissa": "loop.abscissa", "stable": "loop.stable"},
    )


def changed(certificate, path, value, *, reseal=True):
    body = json.loads(certificate.to_json())
    digest = body.pop("digest")
    place = body
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    if not reseal:
        return json.dumps({**body, "digest": digest})
    # a forger who recomputes the digest: take it from the class itself
    return Certificate._from_body({**body, "digest": ""}, "forged").to_json()


def refusal(text, against=None):
    with pytest.raises(CertificateError) as caught:
        check(Certificate.from_json(text), against or tables())
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_round_trip_and_bytes():
    certificate = example()
    text = certificate.to_json()
    assert text == example().to_json()
    assert Certificate.from_json(text).to_json() == text
    assert text.endswith("}\n")
    proof = check(Certificate.from_json(text), tables())
    assert [(c.quantity, c.relation, c.value) for c in proof.conclusions] == [
        ("loop.abscissa", "less_than", "-0.3"),
        ("loop.stable", "holds", None),
    ]
    assert "Lyapunov" in proof.theorem
    assert any("formulas" in sentence for sentence in proof.faith)


PARTS = [
    ("statement", "Another sentence."),
    ("definitions", []),
    ("precision", 200),
    ("paper", "other"),
    ("faith", []),
    ("witness", {}),
]


@pytest.mark.parametrize(("key", "value"), PARTS)
def test_any_change_without_a_new_digest_is_refused(key, value):
    assert "digest" in refusal(changed(example(), [key], value, reseal=False))


def test_a_changed_digit_of_the_witness_is_refused_when_it_breaks_the_proof():
    assert "not symmetric" in refusal(changed(example(), ["witness", "P", 0, 1], "0.6"))
    assert "not proved" in refusal(changed(example(), ["witness", "P", 0, 0], "0.5"))


def test_a_changed_witness_that_still_proves_it_is_accepted():
    text = changed(example(), ["witness", "P", 0, 0], "2.51")
    assert check(Certificate.from_json(text), tables()).conclusions


def test_changed_data_are_named():
    message = refusal(changed(example(), ["data", "number", "k"], "2.1"))
    assert "'k'" in message
    assert "2.1" in message
    assert "row 1, column 1" in refusal(changed(example(), ["data", "printed", "c", 0, 0], "3.1"))
    assert "'repaired.K'" in refusal(changed(example(), ["data", "design", "repaired.K", 0, 0], "0.2"))


@pytest.mark.parametrize(
    ("part", "value", "named"),
    [
        ("numbers", {"k": "2.1"}, "'k'"),
        ("numbers", {}, "'k'"),
        ("printed", {"c": [["3.01"]]}, "'c'"),
        ("printed", {"c": [["3.00", "1"]]}, "'c'"),
        ("designs", {("repaired", "K"): [[0.2]]}, "repaired.K"),
    ],
)
def test_changed_tables_are_named(part, value, named):
    assert named in refusal(example().to_json(), tables(**{part: value}))


def test_data_left_out_or_added_are_refused():
    body = json.loads(example().to_json())
    assert "not among its data" in refusal(changed(example(), ["data", "number"], {}))
    numbers = {**body["data"]["number"], "other": "5"}
    assert "no formula reads" in refusal(changed(example(), ["data", "number"], numbers))
    assert "unknown group" in refusal(changed(example(), ["data", "weather"], {"k": "1"}))


@pytest.mark.parametrize(
    ("index", "key", "value"),
    [
        (0, "value", "-0.6"),
        (0, "relation", "greater_than"),
        (0, "relation", "holds"),
        (0, "of", "norm"),
        (0, "value", None),
        (0, "value", "fast"),
        (1, "relation", "fails"),
        (1, "value", "1"),
    ],
)
def test_conclusions_that_do_not_follow_are_refused(index, key, value):
    refusal(changed(example(), ["conclusions", index, key], value))


@pytest.mark.parametrize(("relation", "value"), [("at_most", "-0.3"), ("less_than", "-0.2"), ("at_most", "0")])
def test_weaker_conclusions_follow(relation, value):
    certificate = example().changed(conclusions=(Conclusion("loop.abscissa", relation, value, "abscissa"),))
    assert check(certificate, tables()).conclusions[0].value == value


def test_a_formula_that_reads_something_else_is_refused():
    assert "not among its data" in refusal(changed(example(), ["definitions", 0, 1], "number('other')"))
    assert "'k'" in refusal(changed(example(), ["definitions", 1, 0], "k"))


@pytest.mark.parametrize(
    ("path", "value", "named"),
    [
        (["fields", "alpha"], "-5", "not proved"),
        (["fields", "beta"], "1", "'beta'"),
        (["fields"], {"matrix": "A"}, "'alpha'"),
        (["kind"], "wishful", "'wishful'"),
        (["witness", "P"], [["1"]], "shape"),
        (["witness", "P"], [["1", "2"], ["3"]], "length"),
        (["witness", "P", 0, 0], "one", "exact number"),
        (["witness", "P"], "1", "shape"),
        (["witness"], {"Q": [["1"]]}, "'P'"),
    ],
)
def test_malformed_parts_are_named(path, value, named):
    assert named in refusal(changed(example(), path, value))


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        "null",
        '{"format": "gainsay certificate"}',
        '{"format": "gainsay certificate", "version": 3}',
        "NaN",
    ],
)
def test_what_is_no_certificate_is_refused(text):
    refusal(text)


def test_floats_never_stand_in_a_certificate():
    body = json.loads(example().to_json())
    body["witness"]["P"][0][0] = 2.5
    assert "exact" in refusal(json.dumps(body))
    with pytest.raises(CertificateError, match="exact texts"):
        example().changed(witness={"P": [[2.5]]}).to_json()


@settings(max_examples=80)
@given(st.data())
def test_any_change_of_one_text_is_refused_or_proves_the_same(data):
    """Whatever single text is changed with a fresh digest, what is accepted still has the proved conclusions."""
    body = json.loads(example().to_json())
    leaves = []

    def collect(value, path):
        if isinstance(value, dict | list):
            for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
                collect(inner, [*path, key])
        elif isinstance(value, str):
            leaves.append(path)

    collect({k: body[k] for k in ("definitions", "fields", "witness", "data", "conclusions")}, [])
    path = data.draw(st.sampled_from(leaves))
    value = data.draw(st.sampled_from(["0", "1", "-1", "2.5", "1e-9", "A", "-A", "holds", "abscissa", "number('k')"]))
    try:
        proof = check(Certificate.from_json(changed(example(), path, value)), tables())
    except CertificateError:
        return
    # eigenvalues of the table's matrix are -1 and -2: nothing may be concluded that is false for it ...
    if path[0] != "definitions" and path[:2] != ["fields", "matrix"]:
        for conclusion in proof.conclusions:
            assert conclusion.relation in ("less_than", "at_most", "holds")
            assert conclusion.value is None or float(conclusion.value) > -1


JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-3, 10**6) | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner, max_size=2),
    max_leaves=4,
)


@settings(max_examples=150)
@given(st.data())
def test_whatever_stands_in_a_certificate_is_refused_in_one_line_or_accepted(data):
    body = json.loads(example().to_json())
    del body["digest"]
    place, key = body, data.draw(st.sampled_from(sorted(body)))
    while isinstance(place[key], dict | list) and place[key] and data.draw(st.booleans()):
        place = place[key]
        key = data.draw(st.sampled_from(sorted(place) if isinstance(place, dict) else range(len(place))))
    place[key] = data.draw(JSON)
    text = json.dumps({**body, "digest": _digest(body)})
    try:
        check(Certificate.from_json(text), tables())
    except CertificateError as error:
        assert "\n" not in str(error)


def test_checking_imports_no_solver_and_no_paper():
    text = example().to_json()
    code = (
        "import sys; from gainsay.proof import Certificate, MappingTables, check;"
        "t = MappingTables({'k': '2'}, {'c': [['3.00']]}, {('repaired', 'K'): [[0.1]]}, 'spring');"
        "print(len(check(Certificate.from_json(sys.stdin.read()), t).conclusions));"
        "bad = {'cvxpy', 'clarabel', 'scipy', 'papers', 'numpy'} & {m.split('.')[0] for m in sys.modules};"
        "print(sorted(bad))"
    )
    run = subprocess.run([sys.executable, "-c", code], input=text, capture_output=True, text=True, check=False)
    assert run.stdout.split("\n")[:2] == ["2", "[]"], run.stderr


def test_importing_the_package_imports_nothing_heavy():
    code = "import sys, gainsay.proof; print(sorted({'flint', 'numpy', 'scipy', 'cvxpy'} & set(sys.modules)))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


ROOT = Path(__file__).resolve().parents[2]


def factorisation(case, **parts):
    """Identity (3) of wan2014, Delta A = E1 Lambda E2, for every e, n, sin M and cos M."""
    return build.certificate(
        "identity",
        **{
            "id": "factorisation",
            "statement": "Delta A of (2) factors as (3) says.",
            "tables": case,
            "unknowns": {"e": {}, "n": {}, "s": {}, "c": {}},
            "definitions": {
                "E1": "e*printed('E1_over_e')",
                "E2": "[[n**2,0,0,0,0,0],[0,n**2,0,0,0,0],[2.5*n**2,0,n**2,0,n,0],[0,0.25*n**2,0,-n,0,0],"
                "[0,0,n**2,0,0,0],[0,0,0,0,0,n**2]]",
                "lower": "[[10*e*n**2*c, -2*e*n**2*s, 0, 0, 4*e*n*c, 0],"
                "[2*e*n**2*s, e*n**2*c, 0, -4*e*n*c, 0, 0], [0, 0, -3*e*n**2*c, 0, 0, 0]]",
            },
            "fields": {"left": "col(zeros(3, 6), lower)", "right": "E1@diag(s, -s, c, c, -0.5*c, c)@E2"},
            **parts,
        },
    )


def test_a_file_is_checked_against_the_tables_of_its_paper(tmp_path):
    case = read_case(ROOT, "wan2014")
    certificate = factorisation(case)
    path = tmp_path / "factorisation.json"
    certificate.write(path)
    assert check_file(path, ROOT).proved[0].relation == "holds"
    other = tmp_path / "renamed.json"
    other.write_text(certificate.to_json())
    with pytest.raises(CertificateError, match="holds the certificate 'factorisation'"):
        check_file(other, ROOT)
    with pytest.raises(CertificateError, match="not readable"):
        check_file(tmp_path / "missing.json", ROOT)
    certificate.changed(data={"printed": {"E1_over_e": [["0"]]}}).write(path)
    with pytest.raises(CertificateError, match="E1_over_e"):
        check_file(path, ROOT)
    with pytest.raises(CertificateError, match="nothing"):
        factorisation(case, definitions={"E1": "printed('nothing')"})
    with pytest.raises(CertificateError, match="checked against the tables of 'wan2014'"):
        check(certificate.changed(paper="other"), case)
    with pytest.raises(CertificateError, match="not declared"):
        factorisation(case, quantities={"identity": "no.such.quantity"})


def test_checking_a_file_imports_no_solver_and_no_paper(tmp_path):
    path = tmp_path / "factorisation.json"
    factorisation(read_case(ROOT, "wan2014")).write(path)
    code = (
        "import sys; from pathlib import Path; from gainsay.proof import check_file;"
        "check_file(Path(sys.argv[1]), Path(sys.argv[2]));"
        "print(sorted({'cvxpy', 'clarabel', 'scipy', 'papers'} & {m.split('.')[0] for m in sys.modules}))"
    )
    run = subprocess.run([sys.executable, "-c", code, path, ROOT], capture_output=True, text=True, check=False)
    assert run.stdout.strip() == "[]", run.stderr


def test_a_certificate_names_no_claim():
    body = {**json.loads(example().to_json()), "claims": ["stable"]}
    with pytest.raises(CertificateError, match="unknown key 'claims'"):
        Certificate.from_json(json.dumps(body))


def test_designs_are_read_from_the_tables_exactly(tmp_path):
    def case(second):
        found = FoundDesign("one", "picked", {"K": np.array([[0.1, second]])}, True, {})
        designs = {"repaired": read_design(write_design(tmp_path, "repaired", found))}
        quantities = {"gain": SimpleNamespace(requirements=frozenset())}
        return SimpleNamespace(designs=designs, root=tmp_path, name="spring", quantities=quantities)

    certificate = build.certificate(
        "enclosed",
        id="gain",
        statement="The second gain.",
        tables=case(-2.5),
        fields={"formula": "design('repaired', 'K')[0, 1]"},
        quantities={"value": "gain"},
    )
    assert [c.value for c in check(certificate, case(-2.5)).conclusions] == ["-2.5..-2.5"]
    with pytest.raises(CertificateError, match=r"repaired\.K"):
        check(certificate, case(-2.6))
    gone = case(-2.5)
    gone.designs = {}
    with pytest.raises(CertificateError, match=r"repaired\.K"):
        check(certificate, gone)

"""Certificates from strangers: falsehoods in disguise, and formulas of a few bytes that would run for ever."""

import json
import os
import re
import time
from pathlib import Path

import pytest

from gainsay.cli import main
from gainsay.errors import CertificateError
from gainsay.exact.budget import BudgetError, budget
from gainsay.exact.matrix import Matrix, RingError, eye, zeros
from gainsay.exact.rational import exact
from gainsay.proof import Certificate, Conclusion, MappingTables, build, check, formulas
from gainsay.proof.certificate import LARGEST_FILE, _digest
from gainsay.proof.guarded import check_file_within

ROOT = Path(__file__).resolve().parents[2]
TABLES = MappingTables(numbers={"b": "1.5"}, printed={"A": [["0", "1"], ["-2", "-3"]]}, name="wan2014")
OF = {
    "contour": "stable",
    "delays": "stable",
    "implication": "implication",
    "not_an_eigenvalue": "eigenvalue",
    "norm_at_least": "norm",
    "identity": "identity",
    "definite": "definite",
    "farkas": "feasible",
    "feasible": "feasible",
    "wrong_inertia": "feasible",
    "enclosed": "value",
}


def body(kind, fields, relation="holds", **parts):
    """Plain values of a certificate that concludes what its kind is about."""
    conclusions = [{"of": OF[kind], "quantity": "", "relation": relation, "value": None}]
    draft = Certificate("c", "wan2014", "A sentence.", kind, fields, **parts).body()
    return {**draft, "conclusions": conclusions}


def sealed(plain, **changes):
    plain = {**plain, **changes}
    return json.dumps({**plain, "digest": _digest(plain)})


def refused(text):
    with pytest.raises(CertificateError) as caught:
        check(Certificate.from_json(text, "c"), TABLES)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 700
    return message


def test_the_frame_of_these_tests_is_accepted():
    check(Certificate.from_json(sealed(body("definite", {"constraint": "2 > 0"}))), TABLES)


SCALAR, C = {"c": {}}, {"c": "0"}
VACUOUS = [
    # c^2 = -1 has no real solution
    ({"left": "c**2", "right": "-1 + 0*c", "modulo": ["c**2 + 1"]}, C),
    ({"left": "c", "right": "c + 1", "modulo": ["1 + 0*c"]}, C),
    # two circles that do not meet
    ({"left": "c", "right": "5*c - 2", "modulo": ["c - 1", "c - 2"]}, {"c": "1"}),
    ({"left": "c**2", "right": "0*c", "modulo": ["c**2"]}, {}),
    ({"left": "c**2", "right": "2 + 0*c", "modulo": ["c**2 - 2"]}, {"c": "1.4142135623730951"}),
]


@pytest.mark.parametrize(("fields", "witness"), VACUOUS)
def test_relations_must_meet_at_a_point_that_is_shown(fields, witness):
    refused(sealed(body("identity", fields, unknowns=SCALAR, witness=witness)))


def test_an_identity_under_relations_that_meet_is_accepted():
    fields = {"left": "c**3", "right": "c", "modulo": ["c**2 - 1"]}
    check(Certificate.from_json(sealed(body("identity", fields, unknowns=SCALAR, witness={"c": "-1"}))), TABLES)
    fields = {"left": "c**3", "right": "-c", "modulo": ["c**2 - 1"]}
    assert "differ" in refused(sealed(body("identity", fields, unknowns=SCALAR, witness={"c": "-1"})))


NAMES = [
    "pi",
    "eye",
    "sqrt",
    "number",
    "𝐚",
    "ﬁ",
    "é",
    "e\u0301",
    "a b",
    "",
    "1a",
    "lambda",
    "None",
    "a" * 65,
    "_\u200b",
]


@pytest.mark.parametrize("name", NAMES)
def test_names_that_mean_or_look_like_something_else(name):
    point = {"constraints": [["a", "1 > 0"]]}
    refused(sealed(body("feasible", point, unknowns={name: {}}, witness={name: "3"})))
    refused(sealed(body("definite", {"constraint": "1 > 0"}), definitions=[[name, "3"]]))


@pytest.mark.parametrize("field", ["unknown", "inequality", "positive", "constraints"])
@pytest.mark.parametrize("value", [["P"], {"P": "F"}, None, "", "Q", [["F", "P > 0"], ["F", "P < 0"]], 1])
def test_fields_of_another_form_are_refused(field, value):
    fields = {"constraints": [["F", "2*P < 0"], ["G", "P > 0"]], "unknown": "P", "inequality": "F", "positive": "G"}
    witness = {"drift": "1", "inertia": "-1", "direction": "1", "inequality": "1", "positive": "1"}
    unknowns = {"P": {"structure": "symmetric"}}
    good = body("wrong_inertia", fields, "fails", unknowns=unknowns, witness=witness)
    check(Certificate.from_json(sealed(good), "c"), TABLES)
    refused(sealed({**good, "fields": {**fields, field: value}}))


def test_pi_is_pi():
    point = {"constraints": [["a", "pi == 3"]]}
    assert "'pi'" in refused(sealed(body("feasible", point, unknowns={"pi": {}}, witness={"pi": "3"})))


def test_a_name_is_defined_once():
    assert "twice" in refused(sealed(body("definite", {"constraint": "a > 0"}, definitions=[("a", "1"), ("a", "2")])))
    shadow = body("feasible", {"constraints": [["a", "x > 2"]]}, unknowns={"x": {}}, witness={"x": "1"})
    assert "twice" in refused(sealed(shadow, definitions=[["x", "3"]]))


# Python reads the identifier K (the Kelvin sign) as K: two definitions that a reader tells apart would be one.
@pytest.mark.parametrize("text", ["\u212a > 0", "２ > 0", "1 > 0 # a remark", "1\\\n > 0", "'\\x41' > 0", "1 >\t0"])
def test_formulas_hold_nothing_that_reads_as_something_else(text):
    refused(sealed(body("definite", {"constraint": text})))


@pytest.mark.parametrize(
    "digits", ["１", "٣", "1_000", "0x10", " 1\u00a0", "1e9999", "nan", "inf", "1/0", "--1", "1 2"]
)
def test_numbers_are_ascii_decimals_or_ratios(digits):
    with pytest.raises(ValueError, match="exact number"):
        exact(digits)
    refused(sealed(body("feasible", {"constraints": [["a", "x > 0"]]}, unknowns={"x": {}}, witness={"x": digits})))


EMPTY = ["zeros(0, 0) > 0", "eye(0) > 0", "zeros(0, 3) == 0", "[[1]][0:0, 0:0] > 0", "diag() > 0", "[[]] > 0"]


@pytest.mark.parametrize("text", EMPTY)
def test_there_are_no_empty_matrices(text):
    refused(sealed(body("definite", {"constraint": text})))
    for make in (lambda: zeros(0, 2), lambda: eye(0), lambda: Matrix([])):
        with pytest.raises((RingError, ValueError)):
            make()


def test_witnesses_have_entries():
    for rows in ([], [[]], [[], []]):
        refused(sealed(body("feasible", {"constraints": [["a", "x > 0"]]}, unknowns={"x": {}}, witness={"x": rows})))


def test_keys_stand_once():
    text = sealed(body("definite", {"constraint": "1 > 0"}))
    assert "twice" in refused(text.replace('"statement":', '"statement": "SHOWN FIRST", "statement":'))
    assert "twice" in refused(text.replace('"constraint":', '"constraint": "0 > 1", "constraint":'))


@pytest.mark.parametrize("version", [True, 2.0, "2", 1, 3, None, [2]])
def test_the_version_is_the_integer_two(version):
    plain = body("definite", {"constraint": "1 > 0"})
    text = json.dumps({**plain, "version": version, "digest": _digest({**plain, "version": version})})
    refused(text)


CONTROL = ["a\nb", "a\rb", "a\x1b[2Jb", "a\x00b", "a\u202eb", "a\ud800b", "a\u2028b", "a\u200bb", "a\ue000b", "e\u0301"]


@pytest.mark.parametrize("text", CONTROL)
@pytest.mark.parametrize("part", ["statement", "faith", "id", "conclusions"])
def test_texts_show_what_they_hold(part, text):
    value = {
        "faith": [text],
        "conclusions": [{"of": "definite", "quantity": text, "relation": "holds", "value": None}],
    }.get(part, text)
    plain = {**body("definite", {"constraint": "1 > 0"}), part: value}
    refused(json.dumps({**plain, "digest": "sha256:" + "0" * 64}))


def test_a_certificate_without_a_conclusion_proves_nothing():
    assert "proves nothing" in refused(sealed(body("definite", {"constraint": "1 > 0"}), conclusions=[]))


@pytest.mark.parametrize("paper", ["../secret", "/etc", "Wan2014", "a;b", "-h", ""])
def test_papers_and_ids_are_plain_names(paper):
    refused(sealed(body("definite", {"constraint": "1 > 0"}), paper=paper))
    refused(sealed(body("definite", {"constraint": "1 > 0"}), id=paper + "/"))


def squares(count):
    return [["a0", "2/3 + 1/7"], *([f"a{i}", f"a{i - 1} * a{i - 1}"] for i in range(1, count))]


wide = " + ".join(f"x[{i},0]" for i in range(40))
BOMBS = {
    "tower of powers": ("definite", {"constraint": "(((((3**64)**64)**64)**64)**64)**64 > 0"}, {}),
    "tower in balls": ("definite", {"constraint": "(" * 40 + "pi" + "**64)" * 40 + " > 0"}, {}),
    "exponentials": ("enclosed", {"formula": "exp(" * 9 + "9" + ")" * 9}, {}),
    "an exponential that no memory holds": ("enclosed", {"formula": "exp(1e15)"}, {}),
    "squares in definitions": ("definite", {"constraint": "a60 > 0"}, {"definitions": squares(61)}),
    "squares nobody uses": ("definite", {"constraint": "1 > 0"}, {"definitions": squares(61)}),
    "wide polynomial": ("identity", {"left": f"({wide})**64", "right": "0"}, {"unknowns": {"x": {"shape": [40, 1]}}}),
    "high degree": ("identity", {"left": "((x**64)**64)**64", "right": "0"}, {"unknowns": {"x": {}}}),
    "long division": (
        "identity",
        {"left": "(x**60)**6*y", "right": "0*x", "modulo": ["x - y - z - w"]},
        {"unknowns": {name: {} for name in "wxyz"}, "witness": dict.fromkeys("wxyz", "0")},
    ),
    "huge unknown": ("farkas", {"constraints": [["a", "1 > 0"]]},
                     {"unknowns": {"x": {"shape": [20000, 20000]}}, "witness": {"a": [["1"]]}}),
    "many unknowns": ("farkas", {"constraints": [["a", "1 > 0"]]},
                      {"unknowns": {f"x{i}": {"shape": [99, 99]} for i in range(99)}, "witness": {"a": [["1"]]}}),
    "a product of thousands of unknowns": ("identity", {"left": "x @ x", "right": "x"},
                                           {"unknowns": {"x": {"shape": [60, 60]}}}),
    "a square of thousands of unknowns": ("identity", {"left": "a*a", "right": "0"}, {
        "unknowns": {"x": {"shape": [60, 60]}},
        "definitions": [("a", f"row({','.join('1' * 60)}) @ x @ col({','.join('1' * 60)})")]}),
    "sine of the largest": ("enclosed", {"formula": "1/(sin(exp(1e15)) + cos(exp(exp(1e9))))"}, {}),
    "many arcs": ("contour", {"A": "-1", "H": "0.1", "Cz": "0.1", "blocks": [["repeated", 1]], "shift": "1",
                              "radius": "0.5", "arcs": [f"{k}/60000" for k in range(60001)]},
                  {"witness": {"P": [["1"]], "d": [["1"]] * 60000}}),
    "huge zeros": ("definite", {"constraint": "zeros(400, 400) >= 0", }, {"definitions": [
        ("a", "zeros(400, 400)"), ("b", "kron(a, a)")]}),
    "selection": ("definite", {"constraint": f"take(1, [{','.join('0' * 3000)}], [{','.join('0' * 3000)}]) >= 0"}, {}),
    "nested brackets": ("definite", {"constraint": "[" * 3000 + "1" + "]" * 3000 + " > 0"}, {}),
    "nested signs": ("definite", {"constraint": "-" * 15000 + "1 > 0"}, {}),
    "long chain": ("definite", {"constraint": "+".join("1" * 9000) + " > 0"}, {}),
    "long literal": ("definite", {"constraint": "9" * 19000 + " > 0"}, {}),
    "long witness": ("feasible", {"constraints": [["a", "x > 0"]]},
                     {"unknowns": {"x": {}}, "witness": {"x": "9" * 19000}}),
    "dense inverse": ("definite", {"constraint": "a > 0"}, {"definitions": [
        ("r", "row(" + ",".join(f"1/{k}" for k in range(7, 407)) + ")"), ("h", "r.T @ r + eye(400)"),
        ("g", "inverse(h) @ inverse(h + h @ h)"), ("a", "sym(inverse(g + g @ g))")]}),
    "semidefinite": ("definite", {"constraint": "r.T @ r >= 0"}, {"definitions": [
        ("r", "row(" + ",".join(f"1/{k}" for k in range(1007, 1407)) + ")")]}),
    "squares of sums of words": ("implication", {"given": [["h", "X > 0"]], "then": "X > 0",
                                                 "by": [{"of": "h", "with": "eye(2)"}]},
                                 {"definitions": [("a", "(x + y + z + w + v)**16"), ("b", "a*a"), ("c", "b*b")],
                                  "unknowns": {"X": {"shape": [2, 2], "structure": "symmetric"},
                                               **{name: {} for name in "xyzwv"}}}),
    "an inverse in long balls": ("not_an_eigenvalue", {"matrix": "sqrt(2)*eye(200)", "real": "1", "imaginary": "0"},
                                 {"precision": 4096}),
    "a response in long balls": ("norm_at_least", {"A": "sqrt(2)*eye(250)", "B": "unit(250, 0)", "C": "unit(250, 0).T",
                                                   "frequency": "1", "gamma": "0"},
                                 {"precision": 4096, "witness": {"u": [["1", "0"]]}}),
    "arcs in long balls": ("contour", {"A": "-1*eye(40)", "H": "0.9*eye(40)", "Cz": "eye(40)",
                                       "blocks": [["full", 40, 40]], "arcs": [f"{k}/300" for k in range(301)],
                                       "alpha": "0", "scale": "1"},
                           {"precision": 4096, "witness": {"d": [["1"]] * 300, "P": [
                               ["1" if i == j else "0" for j in range(40)] for i in range(40)]}}),
    "delays of a year": ("delays", {"A": "-1", "delayed": ["-0.5", "0.4"], "delays": [["0", "3e7"], ["0", "3e7"]]}, {}),
    "many definitions": ("definite", {"constraint": "1 > 0"}, {"definitions": [
        (f"a{i}", "inverse(eye(300)*3)") for i in range(3000)]}),
}  # fmt: skip


SLOW = (
    "delays of a year",
    "a product of thousands of unknowns",
    "a square of thousands of unknowns",
    "many definitions",
)


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in BOMBS])
def test_what_would_run_for_ever_is_refused(name):
    kind, fields, parts = BOMBS[name]
    plain = body(kind, fields, "fails" if kind == "farkas" else "holds", **parts)
    start = time.process_time()
    refused(sealed(plain))
    # not a measurement of speed: without budgets these run for hours or fill the memory
    assert time.process_time() - start < 60


def test_nested_json_and_large_files_are_refused():
    for text in ("[" * 100_000, '{"a":' * 5000, "[" * 40 + "]" * 40, "1" * 5000, "-" * 10, '"\\ud800"'):
        refused(text)
    plain = body("definite", {"constraint": "1 > 0"})
    assert "nested" in refused(json.dumps({**plain, "data": json.loads('{"a":' * 20 + "1" + "}" * 20), "digest": ""}))
    assert "values" in refused(json.dumps({**plain, "faith": ["a"] * 300_000, "digest": ""}))
    assert "at most" in refused(" " * (LARGEST_FILE + 1))


def test_work_is_counted_across_operations_and_blocks():
    with pytest.raises(BudgetError, match="more work"), budget(1e6), budget(1e12):
        for _ in range(1000):
            eye(30) @ eye(30)
    for _ in range(100):  # outside of a budget nothing is counted
        eye(30) @ eye(30)


def test_only_declared_designs_are_read(tmp_path):
    from gainsay.tables import read_case

    case = read_case(ROOT, "wan2014")
    for name in ("../../../pyproject", "../designs/repaired", "/etc/passwd", "x", "", "repaired/"):
        with pytest.raises(CertificateError, match=r"not a design|expected"):
            build.certificate(
                "definite", id="c", statement="s", tables=case, fields={"constraint": f"design('{name}', 'K') > 0"}
            )


# ---------------------------------------------------------------------------------------------- the command


def written(folder, text, name="c"):
    path = folder / f"{name}.json"
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    return path


def good(**changes):
    fields = {"constraint": "[[2, 1], [..., 2]] > a*eye(2)"}
    return sealed(body("definite", fields, definitions=[("a", "1/2")]), **changes)


def test_prove_says_what_is_concluded_from_which_formulas_and_what_stays_on_faith(tmp_path, capsys):
    path = written(tmp_path, good(statement="Everything is proved.", faith=["A step in prose."]))
    assert main(["--root", str(ROOT), "prove", str(path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"{path}: accepted"
    assert "  concluded: c, definite: holds, by a symmetric matrix is positive definite" in lines[1]
    assert "  formula: a = 1/2" in lines
    assert "  formula: constraint = [[2, 1], [..., 2]] > a*eye(2)" in lines
    assert "  on faith: That the formulas of this certificate are those of the paper." in lines
    assert "  on faith: A step in prose." in lines
    # the sentence stands once, among what is on faith, and never as what was proved
    faith = '  on faith: That its sentence says what its conclusions say. "Everything is proved."'
    assert [line for line in lines if "Everything" in line] == [faith]


def test_prove_refuses_in_one_line_and_goes_on(tmp_path, capsys):
    bad = written(tmp_path, good(statement="a\u001b[2J"), "bad")
    assert main(["--root", str(ROOT), "prove", str(bad), str(written(tmp_path, good()))]) == 1
    out = capsys.readouterr().out
    assert re.match(rf"{re.escape(str(bad))}: REFUSED: [^\n]*U\+001B[^\n]*\n[^\n]*c.json: accepted\n", out)
    assert "\x1b" not in out


@pytest.mark.parametrize("kind", ["os", "lyapunow", "x" * 200])
def test_a_refusal_by_prove_is_300_characters_at_most(tmp_path, capsys, kind):
    """The names of all kinds made it 405, a list of printed matrices 347."""
    (tmp_path / ("a" * 100)).mkdir()
    path = written(tmp_path / ("a" * 100), good(kind=kind))
    assert main(["--root", str(ROOT), "prove", str(path)]) == 1
    out = capsys.readouterr().out
    assert out.count("\n") == 1
    assert len(out) <= 301
    assert ": REFUSED: c" in out


def test_prove_without_a_file_is_bad_input(tmp_path, capsys):
    here = written(tmp_path, good())
    assert main(["--root", str(ROOT), "prove", str(here), str(tmp_path / "no.json")]) == 2
    assert "no.json" in capsys.readouterr().err
    assert main(["--root", str(ROOT), "prove", str(tmp_path)]) == 2
    assert main(["--root", str(ROOT), "prove", "a" * 5000]) == 2
    os.mkfifo(tmp_path / "pipe.json")
    assert main(["--root", str(ROOT), "prove", str(tmp_path / "pipe.json")]) == 2


def test_a_paper_that_is_not_there_is_refused(tmp_path, capsys):
    assert main(["--root", str(ROOT), "prove", str(written(tmp_path, good(paper="nobody2020")))]) == 1
    assert "REFUSED: c: about 'nobody2020'" in capsys.readouterr().out


def test_time_and_memory_have_an_end(tmp_path, monkeypatch):
    import gainsay.proof.guarded as guarded

    path = written(tmp_path, good())
    monkeypatch.setattr(guarded, "check_file", lambda *_: time.sleep(60))
    with pytest.raises(CertificateError, match=r"c: not checked within 0\.2 s"):
        check_file_within(path, ROOT, 0.2)
    monkeypatch.setattr(guarded, "check_file", lambda *_: os.abort())
    with pytest.raises(CertificateError, match="broke off"):
        check_file_within(path, ROOT, 60)
    monkeypatch.setattr(guarded, "check_file", lambda *_: bytearray(1 << 40))
    with pytest.raises(CertificateError, match="MemoryError"):
        check_file_within(path, ROOT, 60)
    monkeypatch.setattr(guarded, "check_file", lambda *_: Conclusion("q", "holds"))
    assert check_file_within(path, ROOT, 60) == Conclusion("q", "holds")


@pytest.mark.parametrize("seconds", ["0", "-1", "nan", "inf", "soon"])
def test_the_timeout_is_a_time(seconds, tmp_path):
    with pytest.raises(SystemExit):
        main(["--root", str(ROOT), "prove", "--timeout", seconds, str(tmp_path)])


def test_a_formula_that_was_read_before_costs_what_it_cost():
    """What is kept of it saves time, no work: otherwise a refusal would hang on what was read before."""
    text = "first_a + second_b"
    for _ in range(3):
        with pytest.raises(CertificateError), budget(49 * len(text)):
            formulas.names_in(text)
        with budget(51 * len(text)):
            assert formulas.names_in(text) == {"first_a", "second_b"}

import doctest
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gainsay import lmi
from gainsay.errors import CertificateError, ComputationError, InputError
from gainsay.exact.matrix import Matrix
from gainsay.lmi import Infeasible, Infimum, Solved, Undecided, infimum, interior_multipliers, solve
from gainsay.proof import formulas
from gainsay.proof.scope import MappingTables, Reader
from gainsay.results import Results
from gainsay.results.returned import read_part
from gainsay.statements import (
    Stated,
    Statement,
    diagonal,
    enclose,
    floats,
    matrix,
    over,
    positive,
    prove,
    read_constraint,
    scalar,
    statement,
    symmetric,
)
from gainsay.statements.instability import wrong_inertia

PRINTED = {"A": [["0", "1"], ["-2", "-3"]], "B": [["0"], ["1"]], "L": [["0.1", "-0.25"], ["4e-3", "7"]]}
TABLES = MappingTables(numbers={"mass": "2.5", "third": "1/3"}, printed=PRINTED)
UNKNOWNS = {
    "P": symmetric(2),
    "Y": matrix(1, 2),
    "D": diagonal(2),
    "eps": positive(),
    "mu": scalar(),
}
WHERE = {"A": "printed('A')", "B": "printed('B')", "m": "number('mass')", "Acl": "A - B@Y"}
#: every construction of the language that may hold unknowns, and constants of every kind inside
FORMULAS = (
    "P", "-P", "+P", "sym(P@A)", "A.T@P + P@A", "2*P - P/3", "P*number('third')", "eps*A", "A*eps", "eps*eye(2)",
    "[[P, Y.T], [..., -eps]]", "[[P, 0], [0, D]]", "[[A@P, zeros(2,1)], [Y, mu]]", "col(P, Y)", "row(P, Y.T)",
    "diag(P, eps, Y)", "trace(P@A)", "P[0:2, 1]", "P[1, 0]", "Y[0:1, 1]", "Y[1]", "take(P, [1, 0], [1])", "kron(A, Y)",
    "kron(Y, A)", "block([[P]])", "P/(m - 2)", "inverse(A)@P@unit(2, 0)", "sqrt(m)*P", "sin(m)*cos(m)*D", "pi*P",
    "exp(m)*log(m)*P + eps*interval(1, 1)*eye(2)", "Acl + A", "P@A**3", "box('L')@P", "mu - 1e-3",
)  # fmt: skip

rationals = st.fractions(-3, 3, max_denominator=8)


def point(numbers) -> dict[str, list[list]]:
    """Values of the unknowns of their structures."""
    a, b, c, d, e, f, g, h = numbers
    return {"P": [[a, b], [b, c]], "Y": [[d, e]], "D": [[f, 0], [0, g]], "eps": [[h]], "mu": [[a - h]]}


@pytest.mark.parametrize("text", FORMULAS)
@settings(max_examples=5, deadline=None)
@given(st.lists(rationals, min_size=8, max_size=8))
def test_the_solver_sees_what_the_checker_sees(text, numbers):
    """Provenance: the checker's own evaluator, at the same point in exact numbers."""
    values = point(numbers)
    variables = {name: unknown.variable(name) for name, unknown in UNKNOWNS.items()}
    seen = floats.Floats(TABLES, WHERE, variables).value(text)
    names = {name: Matrix.of(rows) for name, rows in values.items()}
    reader = Reader(TABLES, "test")
    for name, definition in WHERE.items():
        names[name] = formulas.evaluate(definition, names, reader)
    exact = floats.nearest(formulas.evaluate(text, names, reader))
    given_floats = {name: np.array([[float(x) for x in row] for row in rows]) for name, rows in values.items()}
    assert seen.value(given_floats) == pytest.approx(exact, rel=1e-14, abs=1e-14)


def test_both_evaluators_know_the_same_functions():
    """A function of the language either may hold unknowns, or gives constants alone."""
    constants = {"number", "printed", "box", "design", "interval", "eye", "zeros", "unit", "inverse", "sqrt"}
    constants |= {"sin", "cos", "exp", "log", "plausible", "ends"}
    assert set(formulas._FUNCTIONS) == set(floats._FUNCTIONS) | constants
    assert not set(floats._FUNCTIONS) & constants


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("P@P", "not affine"),
        ("P**2", "power of an unknown"),
        ("A/eps", "division by an unknown"),
        ("inverse(P)", "not affine"),
        ("sqrt(eps)", "not affine"),
        ("eps*mu", "not affine"),
        ("P@B@Y", "not affine"),
        ("P + Y", "shapes"),
        ("[[P, B], [A, eps]]", "rows"),
        ("[[P], [P, P]]", "same number"),
        ("P[2, 0]", "literal integer"),
        ("Q", "unknown name"),
        ("P.inv", "not affine|attribute"),
        ("trace(P, P)", "arguments"),
    ],
)
def test_what_is_not_affine_or_does_not_fit_is_refused_with_the_formula(text, reason):
    variables = {name: unknown.variable(name) for name, unknown in UNKNOWNS.items()}
    with pytest.raises((CertificateError, InputError), match=reason):
        floats.Floats(TABLES, WHERE, variables).value(text)


def test_constants_are_rounded_once():
    """0.1 + 0.2 - 0.3 is zero exactly and 5.6e-17 in doubles."""
    tables = MappingTables(numbers={"a": "0.1", "b": "0.2", "c": "0.3"})
    found = floats.Floats(tables, {"d": "number('a') + number('b') - number('c')"}, {}).constant("d*1e20")
    assert found[0, 0] == 0.0


OTHER_TABLES = MappingTables(numbers={"mass": "3.5", "third": "1/3"}, printed=PRINTED)


@pytest.mark.parametrize(
    ("tables", "where", "unknowns", "kept"),
    [
        (TABLES, WHERE, UNKNOWNS, set(FORMULAS)),
        (TABLES, {**WHERE, "m": "3.5"}, UNKNOWNS, {t for t in FORMULAS if "m)" not in t and "m -" not in t}),
        (TABLES, {**WHERE, "B": "2*printed('B')"}, UNKNOWNS, {t for t in FORMULAS if t != "Acl + A"}),
        (TABLES, WHERE, {**UNKNOWNS, "P": matrix(2, 2)}, {t for t in FORMULAS if "P" not in t}),
        (OTHER_TABLES, WHERE, UNKNOWNS, set()),
    ],
    ids=["the same", "a parameter", "a matrix behind a definition", "a structure", "the tables"],
)
def test_what_means_the_same_in_another_program_is_taken_over_and_nothing_else(tables, where, unknowns, kept):
    """Provenance: the same formulas evaluated anew."""
    first = floats.Floats(TABLES, WHERE, {name: unknown.variable(name) for name, unknown in UNKNOWNS.items()})
    before = {text: first.value(text) for text in FORMULAS}
    variables = {name: unknown.variable(name) for name, unknown in unknowns.items()}
    second, anew = floats.Floats(tables, where, variables, first), floats.Floats(tables, where, variables)
    assert {text for text in FORMULAS if second.value(text) is before[text]} == kept
    for text in FORMULAS:
        found, expected = second.value(text), anew.value(text)
        assert found.constant.tobytes() == expected.constant.tobytes(), text
        coefficients = [{v.name: c.tobytes() for v, c in value.terms.items()} for value in (found, expected)]
        assert coefficients[0] == coefficients[1], text
    assert second.exact("m*A").rows() == anew.exact("m*A").rows()


def lyapunov(**parts) -> Statement:
    whole = {
        "label": "(3)",
        "source": "Theorem 1",
        "rows": ("state", "input", "empty"),
        "blocks": {("state", "state"): "sym(A@P - B@Y)", ("input", "state"): "Y", ("input", "input"): "-eps",
                   ("empty", "empty"): "-eye(2)"},
        "unknowns": UNKNOWNS,
        "where": WHERE,
    }  # fmt: skip
    return Statement(**{**whole, **parts})


def test_a_statement_reads_as_one_formula():
    assert lyapunov().formula == "[[sym(A@P - B@Y), (Y).T, 0], [..., -eps, 0], [..., ..., -eye(2)]]"
    assert (lyapunov() < 0).text.endswith(" < 0")
    assert lyapunov().sub("empty", label="part").formula == "-eye(2)"


def test_an_edition_names_the_cells_that_differ():
    other = lyapunov().corrected({("input", "input"): "-2*eps", ("state", "empty"): "P"}, without=["input"])
    assert other.label == "(3) corrected"
    assert [(c.row, c.column, c.printed, c.corrected) for c in other.differences] == [
        ("state", "input", "(Y).T", ""),
        ("state", "empty", "", "P"),
        ("input", "input", "-eps", ""),
    ]
    assert other.rows == ["state", "empty"]


@pytest.mark.parametrize(
    ("parts", "reason"),
    [
        ({"rows": ("state", "state")}, "block rows"),
        ({"blocks": {("state", "output"): "P"}}, "output"),
        ({"blocks": {("state", "input"): "Y.T", ("input", "state"): "Y"}}, "twice"),
        ({"blocks": {("state", "state"): "import os"}}, "not an expression"),
        ({"unknowns": {"sym": symmetric(2)}}, "belongs to the formula language"),
    ],
)
def test_a_statement_that_is_none_is_refused(parts, reason):
    with pytest.raises((InputError, CertificateError), match=reason):
        lyapunov(**parts)


@pytest.mark.parametrize(
    ("where", "reason"),
    [
        (
            {"Acl": "A - B@Y", **{name: text for name, text in WHERE.items() if name != "Acl"}},
            "'A' is not defined before",
        ),
        ({**WHERE, "B": "B + B"}, "'B' is not defined before"),
        ({**WHERE, "P": "eye(2)"}, "'P' is defined twice"),
        ({**WHERE, "eye": "A"}, "belongs to the formula language"),
    ],
)
def test_a_name_means_one_thing_and_is_defined_before_it_is_used(where, reason):
    used = Statement("(5)", "", ("state",), {("state", "state"): "sym(Acl@P) - eye(2)"}, UNKNOWNS, where)
    with pytest.raises(CertificateError, match=reason):
        Stated(TABLES, [used < 0]).program()


@pytest.mark.parametrize(
    "corrected", [{"blocks": {("input", "input"): "-eps"}}, {"blocks": {}}, {"blocks": {}, "without": ["inputs"]}]
)
def test_an_edition_that_corrects_nothing_is_refused(corrected):
    with pytest.raises(InputError, match=r"\(3\)"):
        lyapunov().corrected(**corrected)


def test_two_meanings_of_one_name_are_refused():
    other = lyapunov(label="(4)", where={**WHERE, "A": "2*printed('A')"})
    with pytest.raises(InputError, match="another meaning"):
        Stated(TABLES, [lyapunov() < 0, other < 0])


def test_a_program_states_positive_unknowns_and_carries_its_block_rows():
    program = Stated(TABLES, [lyapunov() < 0, "P > 0"], minimise="trace(P)").program()
    assert [c.label for c in program.constraints] == ["(3)", "P > 0", "eps > 0"]
    assert program.constraints[0].rows == (("state", 2), ("input", 1), ("empty", 2))
    assert program.objective.value({"P": np.eye(2)})[0, 0] == 2


def test_definitions_that_nothing_uses_stay_out_of_the_certificate():
    assert list(Stated(TABLES, ["sym(P@A) < 0"], unknowns=UNKNOWNS, where=WHERE).parts()["definitions"]) == ["A"]


def test_a_family_and_a_sum_fill_in_their_names():
    row = Statement("(31) {axis}", "", ("input",), {("input", "input"): "Y[0, {i}]*{i}"}, UNKNOWNS, WHERE)
    assert row.given(i=1, axis="y").formula == "Y[0, 1]*1"
    assert row.given(i=1, axis="y").label == "(31) y"
    assert over("q{k}*A{k}", k=range(2)) == "q0*A0 + q1*A1"
    with pytest.raises(InputError, match="a value to sum over"):
        over("q{k}*A{k}", k=[])
    assert row.defining(m="3").definitions(None)["m"] == "3"


def outcome(program: Stated):
    return program.solve()


def prepared(project) -> Results:
    return Results(project.case(), "audit")


def rows(results: Results) -> dict[str, dict]:
    results.close()
    return {row["quantity"]: row for row in read_part(results.case, "quantities")}


def stated(project, matrix_text: str) -> Stated:
    return Stated(
        project.case(),
        [f"sym({matrix_text}@P) < 0", "P > 0"],
        unknowns={"P": symmetric(2)},
        label="Lyapunov",
    )


@pytest.mark.parametrize(
    ("A", "value"),
    [("[[-1, 1], [0, -2]]", 1.0), ("[[1, 1], [0, 2]]", 0.0), ("[[0, 1], [-1, 0]]", 0.0)],
    ids=["stable", "unstable", "on the axis"],
)
def test_the_outcome_chooses_the_proof(project, A, value):
    """Lyapunov: there is such a P if and only if every eigenvalue lies in the open left half plane."""
    results, program = prepared(project), stated(project, A)
    certificate = prove(
        results, "audit.holds", program, outcome(program), sentence="P > 0 that satisfies Lyapunov's inequality"
    )
    assert certificate is not None
    assert certificate.conclusions[0].relation == ("holds" if value else "fails")
    row = rows(results)["audit.holds"]
    assert float(row["value"]) == value
    assert row["method"] == "proved by certificate audit-holds"


#: inequalities of A = [[1/10, 2], [3/10, -17/10]], whose eigenvalues (-16 +- sqrt(564))/20 are irrational, one positive
UNSTABLE = [
    ("sym(P@A) < 0", "P > 0"),
    ("A@P + P@A.T < 0", "P > eye(2)"),
    ("sym(P@A) <= -eye(2)", "P >= 0"),
    ("diag(-eye(3), sym(P@A)) < 0", "P > 0"),
    ("(3/2*A).T@P@(3/2*A) - P < 0", "P > 0"),  # the spectral radius is 2.98
    ("(3*A - 2*eye(2)).T@P@(3*A - 2*eye(2)) < 4*P", "P > 0"),  # the disk |s - 2/3| < 2/3
    ("[[P, 3/2*A.T@P], [..., P]] > 0", "P >= 0"),
    ("[[P, 3/2*P@A], [..., P]] > 0", "P >= 0"),
]


# a shift by 2 moves both eigenvalues to the left
@pytest.mark.parametrize(("texts", "shift"), [*((t, "0") for t in UNSTABLE), *((t, "2") for t in UNSTABLE[:4])])
def test_lyapunov_and_stein_inequalities_are_refuted_where_the_matrix_is_unstable(project, texts, shift):
    """Lyapunov 1892, Stein 1952: feasible exactly if the spectrum is in the region; multipliers would be irrational."""
    results = prepared(project)
    program = Stated(
        project.case(), texts, unknowns={"P": symmetric(2)}, where={"A": f"[[0.1, 2], [0.3, -1.7]] - {shift}*eye(2)"}
    )
    certificate = prove(results, "audit.holds", program, outcome(program), sentence="such a P")
    assert certificate is not None
    assert certificate.conclusions[0].relation == ("fails" if shift == "0" else "holds")


@pytest.mark.parametrize("more", ["mu*eye(2)", "mu*P", "P[0, 0]*P"])
def test_a_lyapunov_inequality_with_other_terms_is_not_read_as_one(project, more):
    """It holds another unknown, or a square of its own: whether there is such a P is then another question."""
    texts = [f"sym(P@[[0.1, 2], [0.3, -1.7]]) + {more} < 0", "P > 0"]
    unknowns = {"P": symmetric(2), **({"mu": scalar()} if "mu" in more else {})}
    program = Stated(project.case(), texts, unknowns=unknowns)
    with pytest.raises(CertificateError, match="no Lyapunov or Stein inequality"):
        wrong_inertia(program, id="c", statement="s", **program.parts())


def test_a_plant_of_ten_states_is_refuted(project):
    """A companion matrix of (s - 1/7) (s + 1)^9: one eigenvalue to the right."""
    coefficients = np.convolve(np.poly(-np.ones(9)), [7, -1])
    top = ", ".join(f"{int(-c)}/7" for c in coefficients[1:])
    A = f"col([[{top}]], row(eye(9), zeros(9, 1)))"
    program = Stated(project.case(), [f"sym(P@{A}) < 0", "P > 0"], unknowns={"P": symmetric(10)})
    certificate = prove(prepared(project), "audit.holds", program, outcome(program), sentence="such a P")
    assert certificate is not None and certificate.conclusions[0].relation == "fails"


def test_what_nothing_proves_is_undecided(project):
    results, program = prepared(project), stated(project, "[[-1, 1], [0, -2]]")
    none = Undecided("Lyapunov", ({"solver": "none"},))
    assert prove(results, "audit.holds", program, none, sentence="P") is None
    row = rows(results)["audit.holds"]
    assert row["value"] == "nan"
    assert row["method"].startswith("undecided: Undecided after 1 attempts")


def test_a_wrong_word_of_the_solver_proves_nothing(project):
    """A point that violates the constraint, dressed as a solution, ends as undecided."""
    results, program = prepared(project), stated(project, "[[-1, 1], [0, -2]]")
    found = program.solve()
    assert isinstance(found, Solved)
    wrong = Solved({"P": -np.eye(2)}, 0.0, found.check, 0.0, ())
    assert prove(results, "audit.holds", program, wrong, sentence="P") is None


def test_an_infimum_is_enclosed_by_two_certificates(project):
    """min t with [[t, 1], [1, 2]] > 0 is 1/2: the Schur complement."""
    results = prepared(project)
    program = Stated(project.case(), ["[[t, 1], [1, 2]] > 0"], minimise="t", unknowns={"t": scalar()}, label="Schur")
    lower, upper = enclose(results, "audit.length", program, program.infimum(), sentence="t")
    assert lower <= 0.5 <= upper
    assert upper - lower < 1e-5
    row = rows(results)["audit.length"]
    assert float(row["lower"]) <= 0.5 <= float(row["upper"])
    assert {p.name for p in (results.case.results / "certificates").iterdir()} == {
        "audit-length-above.json",
        "audit-length-below.json",
    }


def test_no_point_is_no_infimum(project):
    program = Stated(project.case(), ["[[t, 1], [1, 0*t]] > 0"], minimise="t", unknowns={"t": scalar()}, label="(7)")
    with pytest.raises(ComputationError, match=r"\(7\)"):
        enclose(prepared(project), "audit.length", program, program.infimum(), sentence="t")


def test_interior_multipliers_have_room_and_cancel_the_unknowns():
    """A'P + PA < 0, P > 0 with an unstable A: any Z > 0 with ZA' + AZ >= 0 refutes it; extreme ones have rank one."""
    A = np.array([[1.0, 1.0], [0.0, 2.0]])
    P = lmi.symmetric("P", 2)
    program = lmi.Program(subject_to=[(lmi.sym(P @ A) < 0).named("Lyapunov"), (P > 0).named("P > 0")])
    found = solve(program)
    assert isinstance(found, Infeasible)
    inside = interior_multipliers(program, found.farkas.multipliers)
    assert inside is not None
    Z, W = inside["Lyapunov"], inside["P > 0"]
    assert np.linalg.eigvalsh(Z)[0] > 0
    assert A @ Z + Z @ A.T == pytest.approx(W, abs=1e-9)


@pytest.mark.parametrize("found", [Undecided("x", ({},)), Infeasible(None, ({},))])
def test_what_was_not_found_cannot_be_used(found):
    with pytest.raises(ComputationError, match=r"\(13\): .* after 1 attempts"):
        found.need("(13)")


def test_an_infimum_without_lower_end_is_bounded_by_its_point():
    t = lmi.scalar("t")
    found = infimum(lmi.Program(t, [t > 1]))
    assert isinstance(found, Infimum)
    assert found.need("t") is found
    assert found.bound == pytest.approx(1.0, abs=1e-5)


def test_a_constraint_is_a_comparison():
    read = read_constraint("trace(P) == 1")
    assert (read.left, read.relation, read.right) == ("trace(P)", "==", "1")
    with pytest.raises(InputError, match="two formulas"):
        read_constraint("P + 1")


def test_quantities_follow_from_conclusions(project):
    """A bound proved from above is an upper end, on the safe side of its decimal: 1/3 has no double."""
    from gainsay.proof import build

    results = prepared(project)
    certificate = build.certificate(
        "enclosed",
        id="third",
        statement="A third.",
        tables=project.case(),
        fields={"formula": "1/3", "low": "0.333", "high": "0.334"},
        quantities={"value": "audit.length"},
    )
    results.prove(certificate, source="(1)", values={"audit.length": 1 / 3})
    row = rows(results)["audit.length"]
    assert Fraction(float(row["lower"])) <= Fraction(1, 3) <= Fraction(float(row["upper"]))
    assert float(row["value"]) == 1 / 3


def test_examples_of_the_docstrings():
    assert doctest.testmod(statement).failed == 0

"""Derivations in unknown matrices: textbook implications are proved, what does not follow is refused."""

import numpy as np
import pytest

from gainsay.errors import CertificateError, InputError
from gainsay.exact.matrix import Matrix
from gainsay.exact.words import Letter, WordsError
from gainsay.proof import build, derivation, formulas
from gainsay.proof.scope import MappingTables
from gainsay.statements import Statement, Step, Unknown, implication, matrix, positive, symmetric

LETTERS = {
    letter.name: letter
    for letter in (
        Letter("A", 4, 4), Letter("B", 4, 2), Letter("K", 2, 4), Letter("P", 4, 4, 1, True), Letter("G", 4, 4, -1),
        Letter("V", 4, 4, 0, True), Letter("x", 4, 1), Letter("e", 1, 1, 1, True),
    )
}  # fmt: skip
FORMULAS = (
    "A@B", "sym(P@A)", "(A@B@K).T", "G@P - P@G.T", "inverse(P)@P@A", "V@inverse(V) + eye(4)", "inverse(V).T@V.T@B",
    "x.T@A@x", "e*A - A/e", "[[P, A@B], [..., -e*eye(2)]]", "[[P, 0], [K, eye(2)]]", "diag(P, e)", "col(K, x.T)",
    "row(B, x)", "col(eye(4), K) @ row(eye(4), -B)", "zeros(4,2) + B", "e**2*P**2",
    "eye(6)@diag(A, eye(2)) - 2*zeros(6,6)",
    "inverse(diag(2*P, e))@col(P@B, x.T@B)", "1.5*B@K + x@x.T", "x.T@G@x", "block([[B.T, zeros(2,2)]])@col(A, K)",
)  # fmt: skip


def numbers(seed: int) -> dict[str, np.ndarray]:
    """Random values of the letters, of their symmetries."""
    rng = np.random.default_rng(seed)
    values = {}
    for name, letter in LETTERS.items():
        value = rng.integers(-4, 5, (letter.rows, letter.columns)) / 2 + np.eye(letter.rows, letter.columns) * 6
        values[name] = (value + letter.symmetry * value.T) / 2 if letter.symmetry else value
    return values


def by_words(text: str, values: dict[str, np.ndarray]) -> np.ndarray:
    """Value of a formula through its sums of words."""
    words = derivation.evaluate(text, {}, LETTERS)
    corners = [np.cumsum([0, *sizes]) for sizes in (words.heights, words.widths)]
    total = np.zeros(words.shape)
    for (i, j), terms in words.blocks.items():
        block = np.zeros((words.heights[i], words.widths[j]))
        for (scalars, word), coefficient in terms.items():
            product = float(coefficient) * np.prod([values[n][0, 0] ** p for n, p in scalars])
            matrices = []
            for name, inverse, turned in word:
                value = np.linalg.inv(values[name]) if inverse else values[name]
                matrices.append(value.T if turned else value)
            product = product * (
                np.linalg.multi_dot(matrices) if len(matrices) > 1 else (*matrices, np.eye(len(block)))[0]
            )
            block = block + product
        total[corners[0][i] : corners[0][i + 1], corners[1][j] : corners[1][j + 1]] = block
    return total


@pytest.mark.parametrize("text", FORMULAS)
@pytest.mark.parametrize("seed", [1, 2])
def test_sums_of_words_have_the_value_of_the_formula(text, seed):
    """Provenance: the checker's evaluator in exact numbers, which shares no code with the words."""
    values = numbers(seed)
    names = {n: Matrix.of(v.tolist()) for n, v in values.items()}
    exact = formulas.evaluate(text, names, MappingTables())
    expected = np.array([[int(x.p) / int(x.q) for x in row] for row in exact.rows()])
    assert by_words(text, values) == pytest.approx(expected, rel=1e-10, abs=1e-10)


@pytest.mark.parametrize(
    ("text", "other"),
    [
        ("inverse(P)@P", "eye(4)"),
        ("(A@V).T", "V.T@A.T"),
        ("x.T@A@x", "x.T@A.T@x"),
        ("x.T@G@x", "0"),
        ("e*inverse(e)", "1"),
        ("col(eye(4), K)@A", "col(A, K@A)"),
    ],
)
def test_equal_expressions_are_seen_to_be_equal(text, other):
    assert derivation.evaluate(text, {}, LETTERS).equals(derivation.evaluate(other, {}, LETTERS))


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("inverse(A)", "not said to be invertible"),
        ("inverse(P + V)", "inverse of a sum"),
        ("A@K", "shapes"),
        ("A + B", "shapes"),
        ("A/B", "not part of a derivation"),
        ("A*B", "takes a number"),
        ("x.T@x * A", "a product of matrices"),
        ("(e + x.T@x) * A", "a product of matrices"),
        ("printed('A')", "not part of a derivation"),
        ("A[0:2, 0:2]", "not part of a derivation"),
        ("Q", "unknown name"),
        ("[[A, B], [P, K]]", "do not fit|cut"),
        ("eye(2.5)", "literal integer"),
        ("A@diag(eye(2), e*eye(1), 1)@diag(K@B, eye(2))", "cut"),
    ],
)
def test_what_is_no_derivation_is_refused(text, reason):
    with pytest.raises(CertificateError, match=reason):
        derivation.evaluate(text, {}, LETTERS)


class Toy(MappingTables):
    name = "toy"


SHAPES = {
    "A": symmetric(4), "B": matrix(4, 2), "C": symmetric(2), "M": matrix(4, 3), "N": matrix(3, 4), "L": matrix(3, 3),
    "e": positive(), "P": symmetric(4), "F": matrix(4, 4), "K": matrix(2, 4), "Q": matrix(4, 4), "s": Unknown(1, 1),
}  # fmt: skip
SCHUR = "[[A, B], [..., C]] < 0"
DOWN = Step(SCHUR, "col(eye(4), -inverse(C)@B.T)", left_inverse="row(eye(4), zeros(4,2))")


def follows(**parts):
    whole = {
        "id": "step", "quantity": "step.follows", "sentence": "It follows.", "given": [SCHUR],
        "then": "A - B@inverse(C)@B.T < 0", "by": [DOWN], "invertible": ["C"], "unknowns": SHAPES,
    }  # fmt: skip
    return implication(Toy(), **{**whole, **parts})


def test_a_schur_complement_is_proved():
    """Boyd, El Ghaoui, Feron, Balakrishnan 1994, section 2.1."""
    assert follows().conclusions[0].relation == "holds"


def test_a_congruence_with_a_change_of_variables_is_proved():
    """State feedback: affine in X = P^-1 and Y = K X (Bernussou, Peres, Geromel 1989)."""
    loop = "sym(P@F - P@B@K) < 0"
    certificate = follows(
        given=[loop],
        then="sym(F@X - B@Y) < 0",
        by=[Step(loop, "X", left_inverse="P")],
        expand={"X": "inverse(P)", "Y": "K@X"},
        invertible=["P"],
    )
    assert certificate.conclusions[0].relation == "holds"


def test_uncertainty_bounded_in_norm_is_eliminated_by_a_completed_square():
    """Petersen 1987: M L N + its transpose is at most e M M' + N'N/e where L'L <= I."""
    nominal, bounded = "sym(Q) + e*M@M.T + N.T@N/e < 0", "eye(3) - L.T@L >= 0"
    certificate = follows(
        given=[nominal, bounded],
        then="sym(Q) + sym(M@L@N) < 0",
        by=[
            Step(nominal, "eye(4)", left_inverse="eye(4)"),
            Step("", "e*M.T - L@N", scale="1/e"),
            Step(bounded, "N", scale="1/e"),
        ],
    )
    assert certificate.conclusions[0].relation == "holds"


def test_hypotheses_that_are_definite_only_together_give_a_strict_conclusion():
    """The converse Schur complement: A - B C^-1 B' < 0 and C < 0 make the whole matrix negative; neither alone does."""
    upper, lower = "A - B@inverse(C)@B.T < 0", "C < 0"
    by = [
        Step(upper, "row(eye(4), zeros(4,2))", left_inverse="col(eye(4), -inverse(C)@B.T)"),
        Step(lower, "row(inverse(C)@B.T, eye(2))", left_inverse="col(zeros(4,2), eye(2))"),
    ]
    assert follows(given=[upper, lower], then=SCHUR, by=by).conclusions[0].relation == "holds"
    alone = [by[0], Step(lower, by[1].factor)]
    with pytest.raises(CertificateError, match="left inverses"):
        follows(given=[upper, lower], then=SCHUR, by=alone)


@pytest.mark.parametrize(
    ("parts", "reason"),
    [
        ({"then": "A - B@inverse(C)@B.T + eye(4) < 0"}, "not proved to be the sum"),
        ({"then": "A + B@inverse(C)@B.T < 0"}, "not proved to be the sum"),
        ({"then": "A - B@inverse(C)@B.T > 0"}, "not proved to be the sum"),
        ({"then": "A - B@inverse(C)@B.T"}, "two formulas"),
        ({"then": "A@F < 0"}, "not symmetric"),
        ({"given": ["[[A, B], [..., C]] <= 0"], "by": [Step("[[A, B], [..., C]] <= 0", DOWN.factor)]}, "strict"),
        ({"by": [Step(SCHUR, DOWN.factor)]}, "strict"),
        ({"by": [Step(SCHUR, DOWN.factor, left_inverse="zeros(4,6)")]}, "left inverses"),
        ({"by": [Step(SCHUR, DOWN.factor, scale="-1", left_inverse=DOWN.left_inverse)]}, "not proved positive"),
        ({"by": [Step(SCHUR, DOWN.factor, scale="s", left_inverse=DOWN.left_inverse)]}, "not proved positive"),
        ({"by": [Step(SCHUR, DOWN.factor, scale="s**2", left_inverse=DOWN.left_inverse)]}, "may be zero"),
        ({"by": [Step(SCHUR, DOWN.factor, scale="1 + e", left_inverse=DOWN.left_inverse)]}, "product of positive"),
        ({"by": [Step("C < 0", DOWN.factor)]}, "not a hypothesis"),
        ({"invertible": []}, "not said to be invertible"),
        ({"given": [], "then": "-A@A >= 0", "by": [Step("", "A")]}, "not proved to be the sum"),
        ({"given": [SCHUR, SCHUR]}, "different names"),
        ({"invertible": ["C", "B"]}, "not a square unknown"),
    ],
)
def test_what_does_not_follow_is_refused(parts, reason):
    with pytest.raises((CertificateError, InputError), match=reason):
        follows(**parts)


def test_matrices_of_the_plant_are_unknown_in_a_derivation():
    """Definitions of a statement count by shape; what is said to be symmetric is held against the tables."""
    tables = Toy(printed={"A": [["1", "2"], ["3", "4"]], "R": [["2", "1"], ["1", "2"]]})
    statement = Statement(
        "(1)", "", ("x",), {("x", "x"): "sym(P@A) + R"}, {"P": symmetric(2)}, {"A": "printed('A')", "R": "printed('R')"}
    )
    parts = {
        "id": "step", "quantity": "step.follows", "sentence": "It follows.", "given": [statement < 0, "P > 0"],
        "then": "sym(A@X) + X@R@X < 0", "by": [Step("(1)", "X", left_inverse="P")], "expand": {"X": "inverse(P)"},
        "invertible": ["P"],
    }  # fmt: skip
    certificate = implication(tables, symmetric=["R"], **parts)
    assert certificate.unknowns["R"] == {"shape": [2, 2], "structure": "symmetric"}
    assert not certificate.data
    with pytest.raises(InputError, match="its own transpose"):
        implication(tables, symmetric=["A"], **parts)
    with pytest.raises(CertificateError, match="not symmetric"):
        implication(tables, **parts)


@pytest.mark.parametrize("field", ["given", "by", "positive", "invertible"])
@pytest.mark.parametrize("value", ["x", 3, [3], [["a"]], [{"of": "a"}], [["a", "b", "c"]], {}])
def test_damaged_fields_are_refused(field, value):
    certificate = follows()
    with pytest.raises(CertificateError):
        build.finish(certificate.changed(fields={**certificate.fields, field: value}), Toy())


def test_words_of_a_ring_do_not_divide_by_zero():
    with pytest.raises((WordsError, CertificateError), match="inverse"):
        derivation.evaluate("A/0", {}, LETTERS)

from xml.etree import ElementTree as Tree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gainsay.errors import CertificateError, InputError
from gainsay.proof.typeset import name_tex, tex
from gainsay.tables import mathematics
from gainsay.tables.mathematics import COMMANDS, mathml, parts, plain

MATHML = {"math", "mrow", "mi", "mn", "mo", "mtext", "mspace", "msub", "msup", "msubsup", "mfrac", "msqrt", "mroot",
          "mover", "munder", "munderover", "mtable", "mtr", "mtd", "mstyle", "mpadded", "menclose"}  # fmt: skip
HOSTILE = [
    r"\text{<script>alert(1)</script>}", r"\text{<b>x</b>}", r"\text{&lt;}", r"\href{javascript:alert(1)}{x}",
    r"\class{a onclick=x}{y}", r"\style{position:fixed}{x}", r"\includegraphics{x}", r"\color{red}x",
    r"\text{</mtext></math><script>alert(1)</script>}", r"\unicode{x3c}", r"\frac{1}", r"\left(x", "", " ", "{",
]  # fmt: skip


def tags(markup: str) -> set[str]:
    return {element.tag for element in Tree.fromstring(markup).iter()}


@pytest.mark.parametrize("text", HOSTILE)
def test_what_is_no_mathematics_is_refused(text):
    with pytest.raises(InputError, match="mathematics"):
        mathml(text)


def test_signs_of_markup_are_signs():
    # "<" and "&" between dollars are relations and text, as in TeX; nothing of them becomes an element.
    shown = mathml(r"x < y")
    assert tags(shown) <= MATHML
    assert "".join(Tree.fromstring(shown).itertext()) == "x<y"
    assert tags(mathml("<script>alert(1)</script>")) <= MATHML


@given(st.text(alphabet="ab1<>&\"'{}^_ \\$\u2028\x00", max_size=30) | st.text(max_size=20))
def test_any_text_gives_mathematics_or_is_refused(text):
    try:
        shown = mathml(text)
    except InputError:
        return
    root = Tree.fromstring(shown)
    assert {element.tag for element in root.iter()} <= MATHML
    assert not {key for element in root.iter() for key in element.attrib} & {"href", "class", "style", "onclick", "src"}


@given(st.sampled_from(sorted(COMMANDS)), st.text(alphabet="ab{}<>", max_size=12))
def test_no_known_command_lets_markup_through(command, text):
    try:
        shown = mathml(f"\\{command}{{{text}}}")
    except InputError:
        return
    assert tags(shown) <= MATHML


def test_sentences_split_at_dollars():
    assert parts(r"costs \$ 3 and $x$") == [("costs $ 3 and ", False), ("x", True)]
    assert parts("no mathematics") == [("no mathematics", False)]
    with pytest.raises(InputError, match="dollars in pairs"):
        parts("one $ alone")


@given(st.lists(st.text(alphabet="ab <1", min_size=1, max_size=6), max_size=5))
def test_parts_hold_all_of_a_sentence(pieces):
    # TeX between dollars: odd pieces; joined again they are the sentence.
    sentence = "$".join(pieces)
    try:
        found = parts(sentence)
    except InputError:
        return
    assert "".join(f"${piece}$" if is_tex else piece for piece, is_tex in found) == sentence


@pytest.mark.parametrize(
    ("sentence", "said"),
    [
        (r"$\lVert w_1\rVert \le \delta_1$", "||w_1|| <= delta_1"),
        (r"$\bar{A}_{11}^{-1}$", "Abar_11^-1"),
        (r"$n^2 J_{20} - J_{10}$ is off", "n^2 J_20 - J_10 is off"),
        (r"$\frac{1}{I + p\delta}$", "(1)/(I + pdelta)"),
        ("plain", "plain"),
    ],
)
def test_mathematics_for_a_terminal(sentence, said):
    assert plain(sentence).replace("p delta", "pdelta") == said


@pytest.mark.parametrize(
    ("formula", "shown"),
    [  # as one writes them by hand
        ("a - (b - c)", r"a - \left(b - c\right)"),
        ("a - b - c", "a - b - c"),
        ("a - (b + c)", r"a - \left(b + c\right)"),
        ("(a + b) @ c.T", r"\left(a + b\right) c^{\top}"),
        ("(a @ b).T", r"\left(a b\right)^{\top}"),
        ("-(a + b)", r"-\left(a + b\right)"),
        ("a * -b", r"a \left(-b\right)"),
        ("a + -b", r"a + \left(-b\right)"),
        ("a ** 2 ** 3", "a^{2^{3}}"),
        ("(a ** 2) ** 3", r"\left(a^{2}\right)^{3}"),
        ("a.T ** 2", r"\left(a^{\top}\right)^{2}"),
        ("(-a) ** 2", r"\left(-a\right)^{2}"),
        ("-a ** 2", "-a^{2}"),
        ("-a * b + c", "-a b + c"),
        ("d * (-a * b)", r"d \left(-a b\right)"),
        ("d - -a * b", r"d - \left(-a b\right)"),
        ("P21hat @ Rinverse.T", r"\hat{P}_{21} \left(R^{-1}\right)^{\top}"),
        ("2 * 3", r"2 \cdot 3"),
        ("1.5e-3 * a", r"1.5\cdot 10^{-3} a"),
        ("a / (b + c)", r"\frac{a}{b + c}"),
        ("[[A, B], [..., 0]] <= 0", r"\begin{bmatrix}A & B \\ \star & 0\end{bmatrix} \le 0"),
        ("Y[1, 0:6]", r"Y_{2,\,1:6}"),
        ("X1[0, 0]", r"\left[X_{1}\right]_{1,\,1}"),
        ("inverse(X1)", "X_{1}^{-1}"),
        ("number('mass') * box('L')", r"\mathrm{mass} \langle L\rangle"),
        ("design('our_own', 'K')", r"{K}_{\mathrm{our\,own}}"),
        ("kron(A, B) + C", r"A \otimes B + C"),
        ("kron(A, B) @ C", r"\left(A \otimes B\right) C"),
        ("eye(3) - unit(3, 0) @ zeros(1, 3)", r"I - e_{1} \cdot 0"),
        ("take(A, [0, 2], [1])", r"\left[A\right]_{\{1,3\},\,\{2\}}"),
    ],
)
def test_formulas_read_as_in_print(formula, shown):
    assert tex(formula) == shown
    assert tags(mathml(shown)) <= MATHML


@pytest.mark.parametrize(
    "formula", ["a if b else c", "f(x)(y)", "'text'", "a.b", "(" * 300 + "a" + ")" * 300, "kron(A)"]
)
def test_what_is_no_formula_is_refused(formula):
    with pytest.raises(CertificateError):
        tex(formula)


@given(st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,20}", fullmatch=True))
def test_every_name_can_be_typeset(name):
    assert tags(mathml(name_tex(name))) <= MATHML


@pytest.mark.parametrize(
    "markup",
    ["<script>alert(1)</script>", "<mi>x</mi>text", '<html:img xmlns:html="http://www.w3.org/1999/xhtml" src="x"/>'],
)
def test_only_known_elements_of_the_library_are_kept(markup, monkeypatch):
    space = "http://www.w3.org/1998/Math/MathML"
    monkeypatch.setattr(mathematics, "convert", lambda tex: f'<math xmlns="{space}">{markup}</math>')
    with pytest.raises(InputError, match="mathematics alone"):
        mathml(f"x {len(markup)}")  # a text of its own: answers are kept


def test_only_known_attributes_of_the_library_are_kept(monkeypatch):
    hostile = '<mi onclick="alert(1)" href="javascript:x" style="y" mathvariant="normal">x</mi>'
    space = "http://www.w3.org/1998/Math/MathML"
    monkeypatch.setattr(mathematics, "convert", lambda tex: f'<math xmlns="{space}">{hostile}</math>')
    assert mathml("x attributes") == '<math><mi mathvariant="normal">x</mi></math>'

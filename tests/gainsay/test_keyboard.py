import re
from html import unescape

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gainsay.report.keyboard import typed
from gainsay.report.sentences import said
from gainsay.tables.mathematics import mathml


@pytest.mark.parametrize(
    ("written", "tex"),
    [
        ("X^-1", "X^{-1}"), ("d_M", "d_{M}"), ("lambda1", r"\lambda_{1}"), ("eps", r"\varepsilon"),
        ("gamma^2", r"\gamma^{2}"), ("P11-bar", r"\bar{P}_{11}"), ("w2hat", r"\hat{w}_{2}"), ("d~", r"\tilde{d}"),
        ("u_max", r"u_{\mathrm{max}}"), ("Lambda_ii", r"\Lambda_{ii}"), ("J_i0", "J_{i0}"),
        ("P22^-T", "P_{22}^{-T}"), ("printed('K')", r"K_{\text{printed}}"),
        ("design('near_limit', 'K')", r"K_{\text{near limit}}"),
    ],
)  # fmt: skip
def test_what_is_written_on_a_keyboard_is_typeset(written, tex):
    assert typed(f"with {written}, so") == f"with {mathml(tex)}, so"


@pytest.mark.parametrize(
    "sentence",
    ["see eq13-eq15, w1-l2 and lambda1-sign-corrected", "the loop a_h2, pitch, A", "the paper's A's delta-v", "OCR: no",
     "rows 1 and 2 of Table 1, Appendix B, reconstruction B", "at 40 N of thrust and 0.15 N m", "audit.h2.b at 1e4",
     "A point bounds it, I think", "a 'B' in quotes"],
)  # fmt: skip
def test_words_names_and_units_are_left_as_they_are(sentence):
    assert unescape(str(typed(sentence))) == sentence


def test_primes_follow_their_symbol():
    eta = mathml(chr(92) + "eta")
    assert typed("F'F and eta''") == f"{mathml('F')}\u2032{mathml('F')} and {eta}\u2032\u2032"
    assert typed("x'X^-1 x") == f"{mathml('x')}\u2032{mathml('X^{-1}')} x"


def test_what_stands_in_brackets_is_raised_too():
    x, s = mathml("x"), mathml("S")
    assert typed("the inverse (1 + d/I)^-1 of it") == "the inverse (1 + d/I)<sup>\u22121</sup> of it"
    assert typed("x(0)'S x' and [K, 0]'") == f"x(0)\u2032{s} {x}\u2032 and [{mathml('K')}, 0]\u2032"
    assert "'" in unescape(str(typed("as in (3)'s proof")))


def test_a_matrix_in_blocks_is_a_table_of_its_blocks():
    shown = str(typed("P = [[Y, -S'], [., b^2 W]] of which"))
    cells = re.findall("<mtd><mrow>(.*?)</mrow></mtd>", shown)
    inside = [mathml(tex).removeprefix("<math>").removesuffix("</math>") for tex in ("Y", "S", "b^2", "W")]
    assert cells[0] == inside[0] and cells[2] == "<mo>⋆</mo>"
    assert cells[1] == f"<mtext>\u2212</mtext>{inside[1]}<mtext>\u2032</mtext>"
    assert cells[3] == f"{inside[2]}<mtext>\u00a0</mtext>{inside[3]}"
    assert shown.count("<mtr>") == 2 and shown.count("<math>") == 2  # none inside another


def test_a_letter_of_the_formulas_is_a_symbol_and_an_article_none():
    assert typed("whatever m and a point", {"m", "a"}) == f"whatever {mathml('m')} and a point"
    assert typed("2 I + p delta") == f"2 {mathml('I')} + {mathml('p')} {mathml(chr(92) + 'delta')}"
    assert typed("I think") == "I think"


def test_a_name_of_several_letters_is_one_identifier():
    assert mathml(r"\mathrm{share}") == "<math><mrow><mi>share</mi></mrow></math>"  # upright by itself, MathML 3, 3.2.3


def test_units_relations_and_code():
    assert typed("6.7 kg m^2 <= 3 m^3/s^2, see `robust`") == (
        "6.7 kg m<sup>2</sup> ≤ 3 m<sup>3</sup>/s<sup>2</sup>, see <code>robust</code>"
    )
    assert typed("lambda1 = number('lambda1_corrected')").endswith("= <i>lambda1 corrected</i>")
    assert typed("A - LC") == f"{mathml('A')} \u2212 {mathml('L C')}"
    assert typed("-0.5 of x-axis and (-3)") == "\u22120.5 of x-axis and (\u22123)"
    assert typed("W2 s^2") == f"{mathml('W_{2}')} {mathml('s^{2}')}"  # a symbol, no second


def test_dollars_and_keyboard_stand_in_one_sentence():
    assert said("H_2/H_∞ of $P$ <b>") == f"{mathml('H_{2}')}/{mathml(chr(72) + '_' + chr(92) + 'infty')} of " \
        f"{mathml('P')} &lt;b&gt;"  # fmt: skip


@given(st.text(alphabet=st.sampled_from("abdxAKNPI 0129_^-'~<>=&\"`()/.,gamma"), max_size=40))
def test_no_text_becomes_a_tag_and_none_is_lost(text):
    shown = str(typed(text))
    tags = set(re.findall(r"</?([a-z]+)>", shown))
    assert tags <= {"math", "mi", "mn", "mo", "mrow", "msub", "msup", "msubsup", "mover", "mtext", "code", "sup"}
    bare = unescape(re.sub(r"<[^>]*>", "", shown))
    kept = re.sub(r"[\s_^'′″~¯`{}<>=≤≥≠→\-−]", "", bare)
    plain = text
    for name, letter in {"gamma": "γ", "mu": "μ"}.items():
        plain, kept = plain.replace(name, "*"), kept.replace(letter, "*").replace(name, "*")
    assert sorted(kept) == sorted(re.sub(r"[\s_^'~`<>=\-]", "", plain))

r"""Mathematics as one writes it on a keyboard (``X^-1``, ``lambda1``, ``d_M <= 1``), typeset where it surely is some.

Sentences of certificates and notes are read on a terminal too, so they hold no TeX. What is not recognised here stands
as it was written: nothing is lost, and nothing but the look is changed.
"""

import re
import string
from collections.abc import Collection

from markupsafe import Markup, escape

from gainsay.errors import InputError
from gainsay.tables.mathematics import mathml

__all__ = ["typed"]

_GREEK = (
    "alpha|beta|gamma|delta|epsilon|eps|zeta|eta|theta|iota|kappa|lambda|mu|nu|xi|pi|rho|sigma|tau|phi|chi|psi|omega|"
    "Gamma|Delta|Theta|Lambda|Xi|Pi|Sigma|Phi|Psi|Omega"
)
_TOKEN = re.compile(
    rf"""
    (?P<code>`[^`]+`)
  | (?P<matrix>\[\[[^\[\]]*\](?:,\ \[[^\[\]]*\])*\])
  | (?P<minus>(?<=\s)-(?=\s)|(?<![^\s(\[,=])-(?=[\d.(A-Za-z]))
  | (?P<relation>(?<=\s)(?:<=|>=|!=|->)(?=\s))
  | (?P<unit>(?:(?<=[\d.\s]\d\s)|(?<=[gmsd]\s)|(?<=[gmsd]/)|(?<=m\^\d/)|\bkg(?=\^))(?:m|s)?)
    \^(?P<power>-?\d(?:\.\d)?)(?![\w.]\d)
  | (?<=[)\]])(?:\^(?P<raised>-?[\dA-Z])(?!\w)|(?P<mark>'{{1,2}})(?![a-z]))  # what stands in brackets, transposed
  | \b(?:(?P<table>printed|number)|design)\('(?P<first>\w+)'(?:,\ '(?P<second>\w+)')?\)
  | (?<![\w."`\\])(?<!(?<![\d)'])/)(?<!\w-)(?<!(?<![\w)\]])')(?:  # no part of a name, a path or what stands in quotes
        (?P<base>(?:{_GREEK})(?=[\d_^'~]|\b)|[A-Za-z](?=[\d_^'~]|\b)|(?<=[-+]\s)[A-Z]{{2}}\b)
        (?P<index>\d{{1,3}}|_(?:max|min|ii|ij|i?\d{{1,3}}|[A-Za-z]|∞))?
        (?P<over>-?(?:hat|bar)\b|~)?
        (?:\^(?P<exponent>-?(?:[\dA-Z]|[a-z]\b)))?
        (?P<prime>'{{1,2}}(?![a-z]))?
    )(?!(?<!')\w|[`"]|-\w|\.\w|'[a-z])
    """,
    re.VERBOSE,
)
#: in a block of a matrix no letter is a word
_LETTERS = frozenset(string.ascii_letters)
_RELATIONS = {"<=": "≤", ">=": "≥", "!=": "≠", "->": "→"}
_NAMES = {"eps": "varepsilon", "epsilon": "varepsilon"}
_OVER = {"hat": "hat", "bar": "bar", "~": "tilde"}
_COMPARED = re.compile(r" (?:<=|>=|[<>=]) ")
#: what stands before a capital that is a name and no symbol, or a unit and no force
_NAMED = re.compile(r"(?:\d|reconstruction|Appendix|Section|Theorem|Lemma|Table|Figure|group|case|pitch,|yaw,) $")


def _is_symbol(match: re.Match[str], symbols: Collection[str]) -> bool:
    """Whether a name is a symbol and no word: known, of several signs, a Greek letter, a capital, or compared."""
    base = match["base"]
    if base in symbols and base != "a":
        return True
    if len(base) > 1 or any(match[part] for part in ("index", "over", "prime", "exponent")):
        return True
    before, after = match.string[: match.start()], match.string[match.end() :]
    if _COMPARED.match(after):
        return base != "I"
    if base == "A" and re.match(" [-+] [A-Z]", after):
        return True
    if base == "I" and (re.search(r"(?:[-+/(<>=]|\^2) ?$", before) or re.match(" ?[-+/)]", after)):
        return True
    if base != "a" and re.match(rf" (?:{_GREEK})\b", after) and re.search(r"[-+*/(] ?$", before):
        return True
    capital = base.isupper() and base not in "AI"
    return capital and not _NAMED.search(before) and not (base == "N" and after.startswith((" m", " s")))


def _tex(match: re.Match[str]) -> str:
    base = match["base"]
    symbol = base if len(base) == 1 else " ".join(base) if base.isupper() else f"\\{_NAMES.get(base, base)}"
    if match["over"]:
        symbol = rf"\{_OVER[match['over'].lstrip('-')]}{{{symbol}}}"
    index = (match["index"] or "").lstrip("_")
    if index:
        symbol += (
            r"_\infty" if index == "∞" else rf"_{{\mathrm{{{index}}}}}" if index in ("max", "min") else f"_{{{index}}}"
        )
    return f"{symbol}^{{{match['exponent']}}}" if match["exponent"] else symbol


def _shown(match: re.Match[str], symbols: Collection[str]) -> Markup:
    if match["code"]:
        return Markup("<code>{}</code>").format(match["code"][1:-1])
    if match["matrix"]:
        return _matrix(match["matrix"])
    if match["minus"]:
        return Markup("\N{MINUS SIGN}")
    if match["relation"]:
        return Markup(_RELATIONS[match["relation"]])
    if match["first"]:
        return _entry(match)
    if match["unit"]:
        power = match["power"].replace("-", "\N{MINUS SIGN}")
        return Markup("{}<sup>{}</sup>").format(match["unit"], power)
    if match["raised"]:
        return Markup("<sup>{}</sup>").format(match["raised"].replace("-", "\N{MINUS SIGN}"))
    if match["mark"]:
        return Markup("\N{PRIME}" * len(match["mark"]))
    if not _is_symbol(match, symbols):
        return escape(match[0])
    # a prime of MathML stands too high in most fonts: it follows as text
    return _mathematics(_tex(match), match[0]) + (match["prime"] or "").replace("'", "\N{PRIME}")


def _matrix(written: str) -> Markup:
    """Typeset a matrix in blocks, written row by row: ``[[A, B], [., -C]]``; a point stands for the mirrored block."""
    rows = [re.split(r", ?", row) for row in re.findall(r"\[([^\[\]]*)\]", written[1:-1])]
    shown = Markup("").join(
        Markup("<mtr>{}</mtr>").format(
            Markup("").join(Markup("<mtd><mrow>{}</mrow></mtd>").format(_block(entry)) for entry in row)
        )
        for row in rows
    )
    table = Markup("<math><mrow><mo>[</mo><mtable>{}</mtable><mo>]</mo></mrow></math>").format(shown)
    return Markup('<span class="scroll">{}</span>').format(table)  # no line breaks inside it


def _block(written: str) -> Markup:
    """Typeset a block inside of mathematics, where no text stands by itself."""
    if written == ".":
        return Markup("<mo>⋆</mo>")
    pieces = re.split(r"(<math>.*?</math>|<sup>.*?</sup>)", str(typed(written, _LETTERS)))
    inside = [
        piece.removeprefix("<math>").removesuffix("</math>")
        if piece.startswith("<math>")
        else re.sub("<sup>(.*)</sup>", r"<msup><mrow></mrow><mn>\1</mn></msup>", piece)
        if piece.startswith("<sup>")
        else f"<mtext>{piece.replace(' ', chr(160))}</mtext>"
        for piece in pieces
        if piece
    ]
    return Markup("".join(inside))


def _entry(match: re.Match[str]) -> Markup:
    """Say which entry of a table or of a design is meant: ``printed('K')`` is K with the index printed."""
    if match["table"] == "number":
        return Markup("<i>{}</i>").format(match["first"].replace("_", " "))
    of, symbol = ("printed", match["first"]) if match["table"] else (match["first"], match["second"] or "")
    return _mathematics(rf"{symbol}_{{\text{{{of.replace('_', ' ')}}}}}", match[0])


def _mathematics(tex: str, written: str) -> Markup:
    try:
        return Markup(mathml(tex))
    except InputError:
        return escape(written)


def typed(text: str, symbols: Collection[str] = ()) -> Markup:
    """Return a piece of a sentence that holds no TeX with what is mathematics in it typeset.

    Parameters
    ----------
    text : str
    symbols : collection of str, optional
        Single letters that are symbols wherever they stand.

    Examples
    --------
    >>> typed("a <b> of d_M <= 1 s for reconstruction B")
    Markup('a &lt;b&gt; of <math><msub><mi>d</mi><mi>M</mi></msub></math> ≤ 1 s for reconstruction B')
    """
    pieces, last = [], 0
    for match in _TOKEN.finditer(text):
        pieces += [escape(text[last : match.start()]), _shown(match, symbols)]
        last = match.end()
    return Markup("").join([*pieces, escape(text[last:])])

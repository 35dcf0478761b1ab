"""Mathematics in the sentences of the tables: TeX between dollars, typeset as MathML that needs no script.

Only commands named here are known, and of what the library returns only elements and attributes named here are
kept: whatever a table holds, a page gets text and mathematics and nothing else.
"""

import re
from collections.abc import Iterator
from functools import cache
from html import escape
from xml.etree import ElementTree as Tree

from latex2mathml.converter import convert

from gainsay.errors import InputError
from gainsay.tables.case import Case

__all__ = ["COMMANDS", "check_sentences", "mathml", "parts", "plain"]

_NAMESPACE = "{http://www.w3.org/1998/Math/MathML}"
_LONGEST = 20_000
_PART = re.compile(r"(\\\$)|\$([^$]*)\$|(\$)|([^$\\]+|\\)")
#: letters of a name that the library sets one by one: an identifier of several is upright by itself
_UPRIGHT = re.compile(r'(?:<mi mathvariant="normal">[A-Za-z]</mi>){2,}')
_LETTER = re.compile(r"<[^>]*>")
_COMMAND = re.compile(r"\\([A-Za-z]+|.)", re.DOTALL)
_LETTERS = {
    "alpha", "beta", "gamma", "delta", "epsilon", "varepsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu",
    "nu", "xi", "pi", "rho", "sigma", "tau", "phi", "varphi", "chi", "psi", "omega", "Gamma", "Delta", "Theta",
    "Lambda", "Xi", "Pi", "Sigma", "Phi", "Psi", "Omega", "ell", "infty", "partial",
}  # fmt: skip
#: what a sentence may use
COMMANDS = frozenset(_LETTERS | {
    "frac", "sqrt", "bar", "hat", "tilde", "dot", "ddot", "mathrm", "mathbb", "mathcal", "operatorname", "text",
    "left", "right", "begin", "end", "le", "ge", "ne", "in", "subset", "to", "Rightarrow", "Leftrightarrow", "prec",
    "succ", "preceq", "succeq", "approx", "ll", "gg", "times", "cdot", "otimes", "star", "pm", "top", "sum", "int",
    "max", "min", "sup", "inf", "sin", "cos", "exp", "log", "det", "lVert", "rVert", "lvert", "rvert", "langle",
    "rangle", "quad", "dots", "ldots", "cdots", ",", ";", " ", "{", "}", "\\", "%",
})  # fmt: skip
_ELEMENTS = {
    "math", "mrow", "mi", "mn", "mo", "mtext", "mspace", "msub", "msup", "msubsup", "mfrac", "msqrt", "mroot", "mover",
    "munder", "munderover", "mtable", "mtr", "mtd", "mstyle", "mpadded", "menclose",
}  # fmt: skip
_CHILDREN = {"mfrac": 2, "msub": 2, "msup": 2, "msubsup": 3, "mroot": 2, "mover": 2, "munder": 2, "munderover": 3}
_ATTRIBUTES = {"display", "stretchy", "fence", "form", "mathvariant", "width", "accent", "movablelimits", "separator",
               "columnalign", "displaystyle", "scriptlevel", "minsize", "maxsize", "lspace", "rspace", "linebreak",
               "symmetric", "largeop"}  # fmt: skip


def _refuse(tex: str, expected: str) -> InputError:
    return InputError("mathematics", value=tex if len(tex) <= 80 else tex[:77] + "...", expected=expected)


def _cleaned(element: Tree.Element, tex: str) -> Iterator[str]:
    """Write an element again, of known parts only."""
    name = element.tag.removeprefix(_NAMESPACE)
    if name == "mrow" and len(element) == 1:
        yield from _cleaned(element[0], tex)
        return
    if name not in _ELEMENTS or len(element) != _CHILDREN.get(name, len(element)):
        raise _refuse(tex, "mathematics alone")
    attributes = "".join(
        f' {key}="{escape(value)}"' for key, value in element.attrib.items() if key in _ATTRIBUTES and name != "math"
    )
    text = element.text or ""
    if name == "mtext":
        text = text.replace("\u00a0", " ").replace(" ", "\u00a0")
    yield f"<{name}{attributes}>{escape(text)}"
    for child in element:
        yield from _cleaned(child, tex)
        if (child.tail or "").strip():
            raise _refuse(tex, "mathematics alone")
    yield f"</{name}>"


@cache
def mathml(tex: str, *, display: bool = False) -> str:
    r"""Return TeX as a MathML element, safe to stand in a page.

    Parameters
    ----------
    tex : str
        Without dollars.
    display : bool
        Whether it stands on a line of its own.

    Raises
    ------
    InputError
        If it uses a command that is not in `COMMANDS`, or is no TeX.

    Examples
    --------
    >>> mathml(r"\eta^2")
    '<math><msup><mi>η</mi><mn>2</mn></msup></math>'
    """
    if len(tex) > _LONGEST or not tex.strip():
        raise _refuse(tex, f"1 to {_LONGEST} characters")
    for command in _COMMAND.findall(tex):
        if command not in COMMANDS:
            raise _refuse(tex, f"no command \\{command}; known are those of gainsay.tables.mathematics")
    if re.search(r"[<>&]", "".join(re.findall(r"\\text\{([^}]*)\}", tex))):
        raise _refuse(tex, "words alone in \\text")
    try:
        # the sign of the tack stands too high in most fonts: a transpose is an upright T
        root = Tree.fromstring(convert(re.sub(r"\\top(?![A-Za-z])", r"\\mathrm{T}", tex)))
    except Exception as error:  # whatever the library says of it, it cannot be typeset
        raise _refuse(tex, "TeX that can be typeset") from error
    written = _UPRIGHT.sub(lambda word: f"<mi>{_LETTER.sub('', word[0])}</mi>", "".join(_cleaned(root, tex)))
    return written.replace("<math>", '<math display="block">', 1) if display else written


def parts(sentence: str) -> list[tuple[str, bool]]:
    r"""Split a sentence into pieces of text and of TeX.

    Parameters
    ----------
    sentence : str
        Text with TeX between dollars; ``\$`` is a dollar.

    Returns
    -------
    list of (str, bool)
        Pieces in order; the second says whether it is TeX.

    Raises
    ------
    InputError
        If a dollar has no partner.

    Examples
    --------
    >>> parts("the matrix $A$ is stable")
    [('the matrix ', False), ('A', True), (' is stable', False)]
    """
    pieces: list[tuple[str, bool]] = []
    for dollar, tex, single, text in _PART.findall(sentence):
        if single:
            raise InputError("sentence", value=sentence, expected="dollars in pairs, \\$ for a dollar itself")
        if tex:
            pieces.append((tex, True))
        elif dollar or text:
            output = "$" if dollar else text
            if pieces and not pieces[-1][1]:
                output = pieces.pop()[0] + output
            pieces.append((output, False))
    return pieces


_WORDS = {
    r"\le": "<=", r"\ge": ">=", r"\ne": "!=", r"\times": "x", r"\cdot": "*", r"\to": "->", r"\infty": "inf",
    r"\lVert": "||", r"\rVert": "||", r"\lvert": "|", r"\rvert": "|", r"\top": "T", r"\star": "*", r"\left": "",
    r"\right": "", r"\,": " ", r"\;": " ", r"\quad": " ", r"\langle": "<", r"\rangle": ">", r"\{": "{", r"\}": "}",
    r"\ ": " ", r"\%": "%", r"\\": "; ",
}  # fmt: skip
#: columns that hold sentences
SENTENCES = {
    "claims": ("statement", "basis", "note"),
    "errata": ("printed", "corrected", "effect"),
    "not_checked": ("what", "reason"),
    "replies": ("disputed", "ground", "done"),
    "parameters": ("note",),
    "quantities": ("meaning",),
}


def _script(match: re.Match[str]) -> str:
    return match[1] + (match[2] if re.fullmatch(r"-?\w+", match[2]) else f"({match[2]})")


def plain(sentence: str) -> str:
    r"""Return a sentence for a terminal, its mathematics as one writes it on a keyboard.

    Examples
    --------
    >>> plain(r"$\lVert w_1\rVert \le \delta_1$ and $\bar{A}_{11}^{-1} > 0$")
    '||w_1|| <= delta_1 and Abar_11^-1 > 0'
    """
    output = []
    for piece, is_tex in parts(sentence):
        if not is_tex:
            output.append(piece)
            continue
        text = re.sub(r"\\(?:mathrm|mathbb|mathcal|operatorname|text)\{([^{}]*)\}", r"\1", piece)
        text = re.sub(r"\\(bar|hat|tilde|dot|ddot) ?(?:\{([^{}]*)\}|(\\[A-Za-z]+|\w))", r"\2\3\1", text)
        text = re.sub(r"([_^])\{([^{}]*)\}", _script, text)  # first, so that fractions hold no braces
        text = re.sub(r"\\frac\{([^{}]*)\}\{([^{}]*)\}", r"(\1)/(\2)", text)
        text = re.sub(r"\\sqrt\{([^{}]*)\}", r"sqrt(\1)", text)
        text = re.sub(r"\\(?:begin|end)\{\w+\}", "", text)
        text = _COMMAND.sub(lambda match: _WORDS.get(match[0], match[1] if match[1].isalpha() else match[0]), text)
        text = re.sub(r"(\|{1,2}) (?=\w)", r"\1", text)  # the blank that ends a command
        text = re.sub(r"([_^])\{([^{}]*)\}", _script, text)
        output.append(re.sub(r" {2,}", " ", text).strip())
    return "".join(output)


def check_sentences(case: Case) -> None:
    """Check that every sentence of a paper's tables can be typeset.

    Raises
    ------
    InputError
        At the first that cannot, naming file, row, field and what was expected.
    """
    paper = case.paper
    headed = [("title", paper.title), *(("finding", text) for text in paper.finding)] + [
        (f"{table}.{name}", text)
        for table in ("designs", "runs", "figures")
        for name, text in getattr(paper, table).items()
    ]
    for field, text in headed:
        _check(text, f"papers/{case.name}/paper.toml", None, field)
    for table, fields in SENTENCES.items():
        rows = getattr(case, table)
        for number, row in enumerate(rows.values() if hasattr(rows, "values") else rows, start=2):
            for field in fields:
                _check(getattr(row, field), f"papers/{case.name}/{table}.csv", number, field)


def _check(sentence: str, file: str, row: int | None, field: str) -> None:
    if "$" not in sentence:
        return
    try:
        for piece, is_tex in parts(sentence):
            if is_tex:
                mathml(piece)
    except InputError as error:
        raise InputError(file=file, row=row, field=field, value=error.value, expected=error.expected) from error

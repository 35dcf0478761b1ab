r"""Formulas of the checker's language as TeX: what a reader holds against the paper.

Entries count from 1, as in print; ``...`` is the star of the papers; ``sym(A)`` is :math:`A + A^T`. A box of printed
digits stands in angle brackets, a matrix of a design of ours carries the design's name.
"""

import ast
import re
from collections.abc import Callable, Mapping, Sequence
from typing import TypeGuard

from gainsay.errors import CertificateError
from gainsay.proof.syntax import one_line, parse

__all__ = ["name_tex", "tex"]

_GREEK = {
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
    "pi", "rho", "sigma", "tau", "phi", "chi", "psi", "omega", "Gamma", "Delta", "Theta", "Lambda", "Xi", "Pi",
    "Sigma", "Phi", "Psi", "Omega",
}  # fmt: skip
_ALIASES = {"eps": r"\varepsilon", "lam": r"\lambda", "epsilon": r"\varepsilon", "phi": r"\varphi"}
_SUFFIXES = {"bar": r"\bar{{{}}}", "hat": r"\hat{{{}}}", "tilde": r"\tilde{{{}}}", "dot": r"\dot{{{}}}",
             "inverse": "{}^{{-1}}"}  # fmt: skip
_WORD = re.compile(r"([A-Za-z]+?)(\d*)(bar|hat|tilde|inverse)?")
_RELATIONS = {ast.Lt: "<", ast.LtE: r"\le", ast.Eq: "=", ast.GtE: r"\ge", ast.Gt: ">"}
#: how tightly a piece holds together
_SUM, _PRODUCT, _SIGNED, _POWER, _ATOM = range(5)
_FUNCTIONS = {"sin": r"\sin", "cos": r"\cos", "exp": r"\exp", "log": r"\log", "trace": r"\operatorname{tr}",
              "sym": r"\operatorname{sym}", "diag": r"\operatorname{diag}"}  # fmt: skip

Piece = tuple[str, int]


def _letter(word: str) -> str:
    if word in _ALIASES:
        return _ALIASES[word]
    if word in _GREEK:
        return f"\\{word}"
    if len(word) == 1:
        return word
    return rf"\mathrm{{{word}}}"


def name_tex(name: str) -> str:
    r"""Return a name as TeX: digits and what follows an underscore stand below the line, Greek names are letters.

    Examples
    --------
    >>> name_tex("J20"), name_tex("eps"), name_tex("P21bar"), name_tex("Rinverse"), name_tex("thrust_x")
    ('J_{20}', '\\varepsilon', '\\bar{P}_{21}', 'R^{-1}', '\\mathrm{thrust}_{x}')
    """
    parts = [part for part in name.split("_") if part] or [name]
    first = parts[0]
    below: list[str] = []
    suffixes: list[str] = []
    for part in parts[1:]:
        (suffixes if part in _SUFFIXES else below).append(part)
    match = _WORD.fullmatch(first)
    if match and match[3] and (len(match[1]) == 1 or match[1] in _GREEK):
        first, below, suffixes = match[1], [match[2], *below], [match[3], *suffixes]
    elif match and match[2] and not match[3]:
        first, below = match[1], [match[2], *below]
    shown = _letter(first) if first.isalpha() else rf"\mathrm{{{first}}}"
    for suffix in suffixes:
        shown = _SUFFIXES[suffix].format(shown)
    below = [part for part in below if part]
    if below:
        power = "^{-1}" if shown.endswith("^{-1}") else ""
        shown = f"{shown.removesuffix(power)}_{{{','.join(map(_below, below))}}}{power}"
    return shown


def _below(part: str) -> str:
    match = re.fullmatch(r"([A-Za-z]*)(\d*)", part)
    return (_letter(match[1]) if match[1] else "") + match[2] if match else rf"\mathrm{{{part}}}"


def _literal(text: str) -> str:
    mantissa, _, power = text.lower().partition("e")
    if not power:
        return text
    ten = f"10^{{{int(power)}}}"
    return ten if mantissa in ("1", "1.0") else rf"{mantissa}\cdot {ten}"


def _matrix(rows: Sequence[Sequence[str]]) -> str:
    return r"\begin{bmatrix}" + r" \\ ".join(" & ".join(row) for row in rows) + r"\end{bmatrix}"


class _Typesetter:
    def __init__(self, text: str, notation: Mapping[str, str]) -> None:
        self.text = one_line(text)
        self.notation = notation

    def fail(self, node: ast.AST) -> CertificateError:
        return CertificateError(f"formula {self.text[:80]!r}: {type(node).__name__} cannot be typeset")

    def at_least(self, node: ast.AST, level: int) -> str:
        shown, own = self.visit(node)
        return shown if own >= level else rf"\left({shown}\right)"

    def plain(self, node: ast.AST) -> str:
        return self.visit(node)[0]

    def visit(self, node: ast.AST) -> Piece:
        match node:
            case ast.Compare(left=left, ops=[sign], comparators=[right]) if type(sign) in _RELATIONS:
                return f"{self.plain(left)} {_RELATIONS[type(sign)]} {self.plain(right)}", _SUM
            case ast.Constant(value=value):
                return self.constant(node, value)
            case ast.Name(id=name):
                shown = self.notation.get(name) or name_tex(name)
                return shown, _POWER if "^" in shown else _ATOM
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return f"-{self.at_least(operand, _PRODUCT)}", _SIGNED if self.is_number(operand) else _SUM
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.visit(operand)
            case ast.BinOp():
                return self.operation(node)
            case ast.Attribute(value=value, attr="T"):
                return self.raised(value, r"\top")
            case ast.List():
                return self.listed(node), _ATOM
            case ast.Subscript():
                return self.subscript(node)
            case ast.Call(func=ast.Name(id=name), args=[_, *_], keywords=[]):
                return self.call(name, node.args)
        raise self.fail(node)

    def constant(self, node: ast.Constant, value: object) -> Piece:
        if value is ...:
            return r"\star", _ATOM
        if type(value) not in (int, float):
            raise self.fail(node)
        literal = self.text[node.col_offset : node.end_col_offset]
        return _literal(literal), _PRODUCT if "e" in literal.lower() else _ATOM

    @staticmethod
    def is_number(node: ast.AST) -> bool:
        return isinstance(node, ast.Constant) and type(node.value) in (int, float)

    @staticmethod
    def is_negative(node: ast.AST) -> TypeGuard[ast.UnaryOp]:
        return isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub)

    def raised(self, node: ast.AST, power: str) -> Piece:
        shown, own = self.visit(node)
        if own < _ATOM:
            shown = rf"\left({shown}\right)"
        elif shown.startswith(r"\begin"):
            shown = f"{{{shown}}}"  # TeX raises a matrix only as a group
        return f"{shown}^{{{power}}}", _POWER

    def operation(self, node: ast.BinOp) -> Piece:
        match node.op:
            case ast.Add():
                return f"{self.plain(node.left)} + {self.right_of_sum(node.right)}", _SUM
            case ast.Sub():
                return f"{self.plain(node.left)} - {self.right_of_sum(node.right, minus=True)}", _SUM
            case ast.Mult() | ast.MatMult() if self.is_negative(node.left):
                return f"-{self.plain(ast.BinOp(node.left.operand, node.op, node.right))}", _SUM
            case ast.Mult() | ast.MatMult():
                left, right = self.at_least(node.left, _PRODUCT), self.factor(node.right)
                return f"{left} {right}" if not right[0].isdigit() else rf"{left} \cdot {right}", _PRODUCT
            case ast.Div():
                return rf"\frac{{{self.plain(node.left)}}}{{{self.plain(node.right)}}}", _ATOM
            case ast.Pow():
                return self.raised(node.left, self.plain(node.right))
        raise self.fail(node.op)

    def right_of_sum(self, node: ast.AST, *, minus: bool = False) -> str:
        shown, own = self.visit(node)
        return rf"\left({shown}\right)" if own == _SIGNED or shown.startswith("-") or (minus and own == _SUM) else shown

    def factor(self, node: ast.AST) -> str:
        shown, own = self.visit(node)
        return shown if own >= _PRODUCT and own != _SIGNED else rf"\left({shown}\right)"

    def listed(self, node: ast.List) -> str:
        rows = [line.elts if isinstance(line, ast.List) else [line] for line in node.elts]
        return _matrix([[self.plain(entry) for entry in row] for row in rows])

    def place(self, node: ast.AST) -> str:
        """Return an index counted from 1, as the papers count."""
        if isinstance(node, ast.Slice):
            low = 1 if node.lower is None else self.integer(node.lower) + 1
            return f"{low}:{'' if node.upper is None else self.integer(node.upper)}"
        return str(self.integer(node) + 1)

    def integer(self, node: ast.AST) -> int:
        if isinstance(node, ast.Constant) and type(node.value) is int:
            return node.value
        raise self.fail(node)

    def subscript(self, node: ast.Subscript) -> Piece:
        parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        places = r",\,".join(self.place(part) for part in parts)
        shown, own = self.visit(node.value)
        if own < _ATOM or "_" in shown:
            return rf"\left[{shown}\right]_{{{places}}}", _ATOM
        return f"{shown}_{{{places}}}", _ATOM

    def word(self, node: ast.AST) -> str:
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            return node.value
        raise self.fail(node)

    def numbers(self, node: ast.AST) -> str:
        if isinstance(node, ast.List):
            return r"\{" + ",".join(str(self.integer(entry) + 1) for entry in node.elts) + r"\}"
        raise self.fail(node)

    def call(self, name: str, nodes: Sequence[ast.expr]) -> Piece:
        special: Callable[[Sequence[ast.expr]], Piece] | None = getattr(self, f"call_{name}", None)
        if special is not None:
            try:
                return special(nodes)
            except IndexError:
                raise self.fail(nodes[0]) from None
        function = _FUNCTIONS.get(name, rf"\operatorname{{{name}}}")
        shown = r",\, ".join(self.plain(node) for node in nodes)
        return rf"{function}\left({shown}\right)", _ATOM

    def call_number(self, nodes: Sequence[ast.expr]) -> Piece:
        return name_tex(self.word(nodes[0])), _ATOM

    def call_plausible(self, nodes: Sequence[ast.expr]) -> Piece:
        return rf"\langle {name_tex(self.word(nodes[0]))}\rangle", _ATOM

    def call_ends(self, nodes: Sequence[ast.expr]) -> Piece:
        return rf"\partial\langle {name_tex(self.word(nodes[0]))}\rangle", _ATOM

    def call_printed(self, nodes: Sequence[ast.expr]) -> Piece:
        return name_tex(self.word(nodes[0])), _ATOM

    def call_box(self, nodes: Sequence[ast.expr]) -> Piece:
        return rf"\langle {name_tex(self.word(nodes[0]))}\rangle", _ATOM

    def call_design(self, nodes: Sequence[ast.expr]) -> Piece:
        design = r"\,".join(self.word(nodes[0]).split("_"))
        return rf"{{{name_tex(self.word(nodes[1]))}}}_{{\mathrm{{{design}}}}}", _ATOM

    def call_interval(self, nodes: Sequence[ast.expr]) -> Piece:
        return rf"\left[{self.plain(nodes[0])},\, {self.plain(nodes[1])}\right]", _ATOM

    def call_eye(self, nodes: Sequence[ast.expr]) -> Piece:
        return "I", _ATOM  # the papers print no sizes

    def call_zeros(self, nodes: Sequence[ast.expr]) -> Piece:
        return "0", _ATOM

    def call_unit(self, nodes: Sequence[ast.expr]) -> Piece:
        return f"e_{{{self.integer(nodes[1]) + 1}}}", _ATOM

    def call_block(self, nodes: Sequence[ast.expr]) -> Piece:
        return self.plain(nodes[0]), _ATOM

    def call_col(self, nodes: Sequence[ast.expr]) -> Piece:
        return _matrix([[self.plain(node)] for node in nodes]), _ATOM

    def call_row(self, nodes: Sequence[ast.expr]) -> Piece:
        return _matrix([[self.plain(node) for node in nodes]]), _ATOM

    def call_take(self, nodes: Sequence[ast.expr]) -> Piece:
        places = r",\,".join(self.numbers(node) for node in nodes[1:])
        return rf"\left[{self.plain(nodes[0])}\right]_{{{places}}}", _ATOM

    def call_inverse(self, nodes: Sequence[ast.expr]) -> Piece:
        return self.raised(nodes[0], "-1")

    def call_kron(self, nodes: Sequence[ast.expr]) -> Piece:
        return rf"{self.at_least(nodes[0], _POWER)} \otimes {self.at_least(nodes[1], _POWER)}", _SUM

    def call_sqrt(self, nodes: Sequence[ast.expr]) -> Piece:
        return rf"\sqrt{{{self.plain(nodes[0])}}}", _ATOM


def tex(text: str, notation: Mapping[str, str] | None = None) -> str:
    r"""Return a formula or a constraint of the checker's language as TeX.

    Parameters
    ----------
    text : str
    notation : mapping of str to str, optional
        How the paper writes names that would be typeset otherwise: ``{"g": r"\gamma^{2}"}``.

    Returns
    -------
    str
        TeX without dollars, of the few commands that `gainsay.tables.mathematics` knows.

    Raises
    ------
    CertificateError
        If the text is not a formula.

    Examples
    --------
    >>> tex("sym(A@X - B@Y) + eps*E1@E1.T < 0")
    '\\operatorname{sym}\\left(A X - B Y\\right) + \\varepsilon E_{1} E_{1}^{\\top} < 0'
    """
    try:
        return _Typesetter(text, notation or {}).plain(parse(text))
    except RecursionError:
        raise CertificateError(f"formula {one_line(text)[:80]!r}: nested too deeply to be typeset") from None

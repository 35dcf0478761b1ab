"""Values of cells as a paper spells them in LaTeX, and of formulas, on matrices of doubles."""

import re
from collections.abc import Mapping
from fractions import Fraction

import numpy as np

from gainsay.exact.matrix import Matrix
from gainsay.exact.rational import rational_matrix
from gainsay.proof import formulas

Value = float | np.ndarray
TOKEN = re.compile(
    r"\s*(?P<power>\^(?:\{(?P<long>[^}]*)\}|(?P<short>\\top|\d)))"
    r"|\s*\\frac\{(?P<above>[^{}]*)\}\{(?P<below>[^{}]*)\}|\s*(?P<sign>[-+/()])|\s*(?P<number>\d+)"
    r"|\s*(?P<name>(?:\\(?:hat|bar|tilde)\{\\?[A-Za-z]+\}|\\[A-Za-z]+|[A-Za-z])(?:_(?:\{\w+\}|\w))?)"
)


class _Reader:
    """A sum of products, juxtaposition being the product."""

    def __init__(self, text: str, names: Mapping[str, Value]) -> None:
        self.names, self.tokens, place = names, [], 0
        while text[place:].strip():
            found = TOKEN.match(text, place)
            assert found, f"{text!r} at {text[place:]!r}"
            self.tokens.append(found)
            place = found.end()

    def _sign(self, signs: str) -> str:
        if self.tokens and self.tokens[0]["sign"] and self.tokens[0]["sign"] in signs:
            return self.tokens.pop(0)["sign"]
        return ""

    def sum(self) -> Value:
        total = -self.product() if self._sign("+-") == "-" else self.product()
        while sign := self._sign("+-"):
            term = self.product()
            total = total + term if sign == "+" else total - term
        return total

    def product(self) -> Value:
        value = self.factor()
        while self.tokens and (not self.tokens[0]["sign"] or self.tokens[0]["sign"] in "/("):
            divided = self._sign("/")
            other = self.factor()
            scalar = np.ndim(value) == 0 or np.ndim(other) == 0
            value = value / other if divided else value * other if scalar else value @ other
        return value

    def _single(self, token: re.Match) -> Value:
        if token["above"]:
            return spelled(token["above"], self.names) / spelled(token["below"], self.names)
        if token["number"]:
            return float(token["number"])
        return self.names[re.sub(r"_\{(\w+)\}$", r"_\1", token["name"])]

    def factor(self) -> Value:
        if self._sign("("):
            value = self.sum()
            assert self._sign(")"), "a bracket stays open"
        else:
            value = self._single(self.tokens.pop(0))
        while self.tokens and self.tokens[0]["power"]:
            power = self.tokens.pop(0)
            value = _raised(value, power["long"] or power["short"])
        return value


def _raised(value: Value, power: str) -> Value:
    if power == r"\top":
        return value.T
    if power == "-1":
        return 1 / value if np.ndim(value) == 0 else np.linalg.inv(value)
    return value ** int(power)


def spelled(text: str, names: Mapping[str, Value]) -> Value:
    """Value of LaTeX at doubles; the names are those of the paper, indices without braces."""
    return _Reader(text, names).sum()


def computed(text: str, values: Mapping[str, Value]) -> np.ndarray:
    """Value of a certificate's formula at doubles, by the checker's own evaluator."""
    exact = {
        name: Matrix(rational_matrix([[Fraction(float(x)) for x in row] for row in np.atleast_2d(value).tolist()]))
        for name, value in values.items()
    }
    rows = formulas.evaluate(text, exact, None).rows()
    return np.array([[int(x.p) / int(x.q) for x in row] for row in rows])

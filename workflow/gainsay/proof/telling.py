"""What an accepted certificate says, in lines: conclusions first, then formulas, then what stays on faith."""

import unicodedata
from collections.abc import Iterator

from gainsay.proof.certificate import SENTENCE_ON_FAITH, Conclusion
from gainsay.proof.checker import Proof
from gainsay.proof.kinds import Proved

__all__ = ["concluded", "lines", "one_line"]

_WORDS = {
    "at_most": "at most",
    "at_least": "at least",
    "less_than": "less than",
    "greater_than": "greater than",
    "inside": "from",
}
_LONGEST = 400


def one_line(text: str) -> str:
    """Text that takes one line of a terminal and shows everything that it holds, shortened where it is long."""
    shown = "".join(
        c if unicodedata.category(c)[0] != "C" and unicodedata.category(c) not in ("Zl", "Zp") else f"<U+{ord(c):04X}>"
        for c in text
    )
    return shown if len(shown) <= _LONGEST else shown[: _LONGEST - 3] + "..."


def _says(conclusion: Conclusion | Proved) -> str:
    value = (conclusion.value or "").replace("..", " to ")
    return f"{_WORDS.get(conclusion.relation, conclusion.relation)} {value}".strip()


def concluded(conclusion: Conclusion, proof: Proof) -> str:
    """Sentence of a conclusion: ``eq14.feasible: fails, by Farkas' lemma``."""
    about = conclusion.quantity or f"{proof.id}, {conclusion.of}"
    return f"{about}: {_says(conclusion)}, by {proof.theorem}"


def lines(proof: Proof) -> Iterator[str]:
    """Lines about an accepted certificate, without a sentence that was not checked but for those on faith."""
    for conclusion in proof.conclusions:
        yield f"concluded: {concluded(conclusion, proof)}"
    about = {conclusion.of for conclusion in proof.conclusions}
    for step in proof.proved:
        if step.of not in about:
            yield f"proved on the way: {step.of} {_says(step)}"
    for name, text in proof.formulas:
        yield f"formula: {name} = {text}" if not name.startswith("unknown ") else f"formula: {name}, {text}"
    for sentence in proof.faith:
        quoted = f' "{proof.statement}"' if sentence == SENTENCE_ON_FAITH else ""
        yield f"on faith: {sentence}{quoted}"

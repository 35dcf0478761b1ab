"""Sentences of the tables and formulas of certificates as a page shows them: text, and mathematics as MathML."""

from collections.abc import Collection, Iterable

from markupsafe import Markup, escape

from gainsay.errors import GainsayError, InputError
from gainsay.proof.typeset import name_tex, tex
from gainsay.report.keyboard import typed
from gainsay.tables.mathematics import mathml, parts, plain

__all__ = ["LONGEST_FORMULA", "formula", "listed", "name", "plain_text", "said"]

#: characters of a formula above which it is named and not shown: nobody compares two thousand by eye
LONGEST_FORMULA = 2_500


def said(sentence: str, symbols: Collection[str] = ()) -> Markup:
    r"""Return a sentence with its mathematics typeset, that between dollars and that written as on a keyboard.

    A sentence that cannot be typeset stands as it was written: `gainsay lint` refuses it, the page never fails.
    Single letters among `symbols` are symbols wherever they stand.

    Examples
    --------
    >>> said("the weight $R$ is < 1")
    Markup('the weight <math><mi>R</mi></math> is &lt; 1')
    """
    try:
        return Markup("").join(
            Markup(mathml(piece)) if is_tex else typed(piece, symbols) for piece, is_tex in parts(sentence)
        )
    except InputError:
        return escape(sentence)


def plain_text(sentence: str) -> str:
    """Return a sentence for places that hold text alone: titles, alternative texts."""
    try:
        return plain(sentence)
    except InputError:
        return sentence


def formula(text: str) -> Markup:
    """Return a formula of the checker's language, typeset; as code where it cannot be, by its length where it is long.

    Examples
    --------
    >>> formula("P > 0")
    Markup('<math><mrow><mi>P</mi><mo>&gt;</mo><mn>0</mn></mrow></math>')
    """
    if len(text) > LONGEST_FORMULA:
        return Markup('<span class="none">a formula of {} characters, in the file</span>').format(len(text))
    try:
        return Markup(mathml(tex(text)))
    except GainsayError:
        return Markup("<code>{}</code>").format(text)


def name(identifier: str) -> Markup:
    """Return a name of the checker's language, typeset."""
    try:
        return Markup(mathml(name_tex(identifier)))
    except GainsayError:
        return Markup("<code>{}</code>").format(identifier)


def listed(pieces: Iterable[Markup | str], last: str = "and") -> Markup:
    """Join pieces as one says them: "a, b and c"."""
    pieces = [escape(piece) for piece in pieces]
    if len(pieces) < 2:
        return Markup("").join(pieces)
    return Markup("{} {} {}").format(Markup(", ").join(pieces[:-1]), last, pieces[-1])

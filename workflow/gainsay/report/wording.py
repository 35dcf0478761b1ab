"""Published and recomputed in words that read forwards: what the paper says, what was found, and why it matters."""

import re
from collections.abc import Sequence

from markupsafe import Markup, escape

from gainsay.report.numbers import digits_apart, number, span, typeset, with_unit
from gainsay.report.reading import PaperResults, Row
from gainsay.report.sentences import listed, said
from gainsay.scans.outcome import Outcome
from gainsay.tables import Case
from gainsay.tables.models import Claim
from gainsay.tables.units import to_si

__all__ = [
    "condition",
    "input_name",
    "input_value",
    "is_truth",
    "published_value",
    "reason",
    "recomputed_value",
    "turning_point",
]

_NUMERIC = ("equal", "at_most", "at_least")
#: comparators that hold a truth against a quantity that is 1 or 0
_TRUTHS = {"feasible": 1.0, "infeasible": 0.0, "holds": 1.0, "fails": 0.0}
#: digits of an input at which an outcome turns
_DIGITS_OF_INPUT = 4
#: what is said where each of so many joined claims holds; of more they are counted
_ALL_HOLD = {1: "it holds", 2: "both hold"}


def is_truth(claim: Claim) -> bool:
    """Whether what a claim is held against is a truth, not a number."""
    return claim.comparator in _TRUTHS


def _agrees(claim: Claim, recomputed: str) -> bool:
    return float(recomputed) == _TRUTHS[claim.comparator]


def _joined(results: PaperResults, claim: Claim) -> list[str]:
    parts = claim.quantity.split()
    return [results.verdicts[part]["verdict"] if part in results.verdicts else "" for part in parts]


def published_value(results: PaperResults, claim: Claim) -> Markup:
    """Return what the paper says: a number with its unit, ``feasible``, ``it holds``; empty where it gives none."""
    if claim.comparator == "feasible":
        return escape("feasible")
    if claim.comparator == "all_of":
        many = len(claim.quantity.split())
        return escape(_ALL_HOLD.get(many, f"all {many} hold"))
    if claim.comparator == "less_than":
        other = results.quantities.get(claim.published)
        bound = number(other["value"], other["unit"], digits=4) if other else escape("the other")
        return Markup("less than {}").format(bound)
    if is_truth(claim):
        return escape("it holds")
    if not claim.published:
        return Markup("")
    low, dots, high = claim.published.partition("..")
    shown = Markup("{} to {}").format(typeset(low), typeset(high)) if dots else typeset(low)
    sign = {"at_most": "at most ", "at_least": "at least "}.get(claim.comparator, "")
    return with_unit(sign + shown, claim.unit)


def recomputed_value(results: PaperResults, claim: Claim, row: Row) -> Markup:
    """Return what was found, in the words of what the paper says; empty where nothing was."""
    text = row["recomputed"]
    if claim.comparator == "all_of":
        verdicts = _joined(results, claim)
        held = verdicts.count("reproduced")
        if not row["verdict"]:
            return Markup("")
        if held == len(verdicts):
            return escape(_ALL_HOLD.get(held, f"all {held} hold"))
        return escape("it does not hold" if len(verdicts) == 1 else f"{held} of {len(verdicts)} hold")
    if is_truth(claim) and text:
        if claim.comparator == "feasible":
            return escape("feasible" if _agrees(claim, text) else "infeasible")
        return escape("it holds" if _agrees(claim, text) else "it does not hold")
    if not text:
        return span(row["range_low"], row["range_high"], claim.unit)
    # where a bound is nearly met, or an equality missed, as many digits as tell the two numbers apart
    near = claim.comparator in ("at_most", "at_least", "inside") or row["verdict"] != "reproduced"
    ends = claim.published.split("..") if near and claim.comparator != "less_than" else ()
    power = re.fullmatch(r"[-+.\d]+e([-+]?\d+)", claim.published.lower()) if claim.comparator in _NUMERIC else None
    return number(text, claim.unit, digits=digits_apart(text, ends), power=int(power[1]) if power else None)


def condition(results: PaperResults, given: str) -> Markup:
    """Return the condition of a claim in words: ``horizon=300`` reads "horizon = 300 s", each name linked."""
    parts = []
    for part in given.split(";"):
        name, _, value = (text.strip() for text in part.partition("="))
        parameter = results.case.parameters.get(name)
        shown = typeset(value) if re.fullmatch(r"[-+.\d]+(e[-+]?\d+)?", value) else escape(value.replace("_", " "))
        printed = " as printed" if parameter and parameter.status == "printed" else ""
        value_shown = with_unit(shown, parameter.unit if parameter else "")
        parts.append(Markup("{} = {}{}").format(input_name(results.case, name), value_shown, printed))
    return Markup(", ").join(parts)


def input_name(case: Case, parameter: str) -> Markup:
    """Return the name of an input in words, linked to what the page says of one that the paper leaves out."""
    words = escape(parameter.replace("_", " "))
    if parameter not in case.assumed:
        return words
    return Markup('<a href="#{}-input-{}">{}</a>').format(case.name, parameter, words)


def input_value(value: object, of: str, digits: int = 6) -> Markup:
    """Return the value of an input of a scan: a word, or a number with its unit."""
    return escape(value) if isinstance(value, str) else number(repr(value), of, digits=digits)


def _name(parameter: str) -> Markup:
    return Markup("<i>{}</i>").format(parameter.replace("_", " "))


def turning_point(scan: Outcome) -> Markup:
    """Return where the outcome of a scan turns: "holds when inertia x is below 8.94 kg m², fails when it is above"."""
    boundary = scan.boundary
    if boundary is None:
        return Markup("")
    units = {entry.name: entry.unit for entry in scan.inputs}
    holds, fails = boundary.holds, boundary.fails
    if isinstance(holds, str) or isinstance(fails, str):
        words = (str(value).replace("_", " ") for value in (holds, fails))
        return Markup("holds with {} = {}, fails with {}").format(_name(boundary.input), *words)
    sides = ("below", "above") if holds < fails else ("above", "below")
    at = input_value(holds, units[boundary.input], _DIGITS_OF_INPUT)
    return Markup("holds when {} is {} {}, fails when it is {}").format(_name(boundary.input), sides[0], at, sides[1])


def _threshold(claim: Claim, low: str, high: str, every: str = "", none: str = "") -> Markup:
    """Say from which reading of a word without a number on a claim holds; ends are rounded away from each other."""
    least = number(low, claim.unit, digits=_DIGITS_OF_INPUT, towards="down")
    greatest = number(high, claim.unit, digits=_DIGITS_OF_INPUT, towards="up")
    if claim.comparator == "at_least":
        told = Markup("Holds{} where the sentence asks for {} or less, fails{} where it asks for more than {}")
        ends = (every, least, none, greatest)
    else:
        told = Markup("Holds{} where the sentence allows {} or more, fails{} where it allows less than {}")
        ends = (every, greatest, none, least)
    return told.format(*ends) + "; it prints no number."


def _scanned(claim: Claim, scan: Outcome) -> Markup:
    where = (
        f"{scan.samples} readings" if scan.finite else f"{scan.samples} plausible values of what the paper leaves out"
    )
    turns = turning_point(scan)
    if not turns:
        low, high = (repr(pair[0] / float(to_si(claim.unit)[1])) for pair in (scan.least, scan.greatest))
        return _threshold(claim, low, high, f" at all {where}", " at all")
    others = len(scan.inputs) - 1
    kept = "" if not others else ", the other input kept" if others == 1 else f", the other {others} inputs kept"
    told = Markup("{}{}{}").format(turns[:1].upper(), turns[1:], kept)
    if scan.holding == scan.at_best:
        return Markup("{}; it holds at {} of {}.").format(told, scan.holding, where)
    return Markup("{}; it holds at {} to {} of {}, over the readings {} of a threshold that it does not print.").format(
        told, scan.holding, scan.at_best, where, published_range(claim)
    )


def published_range(claim: Claim) -> Markup:
    """Return the readings of a threshold that the paper does not print: "0.05 to 0.5"."""
    low, _, high = claim.published.partition("..")
    return with_unit(Markup("{} to {}").format(typeset(low), typeset(high)), claim.unit)


def reason(results: PaperResults, claim: Claim, row: Row, links: Sequence[Markup] = ()) -> Markup:
    """Return one sentence that says why a claim is not simply reproduced; empty where there is nothing to add.

    Parameters
    ----------
    results : PaperResults
    claim : Claim
    row : mapping
        Of verdicts.csv.
    links : sequence of Markup
        The claims that are at fault where it joins others.
    """
    verdict = row["verdict"]
    if verdict == "reproduced" or not verdict:
        return Markup("")
    if links:
        return Markup("See {}.").format(listed(links))
    scan = results.scans.get(claim.id)
    if scan and row["evidence"].startswith("sampled"):
        return _scanned(claim, scan)
    if verdict == "undetermined" and ".." in claim.published and row["range_low"] and row["range_high"]:
        return _threshold(claim, row["range_low"], row["range_high"])
    if verdict == "contradicted" and row["witness"].startswith(f"{claim.quantity} ="):
        return Markup("")  # the number itself, said already
    symbols = {
        letter
        for name in row["certificate"].split()
        if name in results.certificates
        for letter in results.certificates[name].symbols
    }
    return said(row["witness"] or row["note"], symbols)

"""Published and recomputed in words that read forwards: what the paper says, what was found, and why it matters."""

import re
from collections.abc import Sequence

from markupsafe import Markup, escape

from gainsay.report.numbers import digits_apart, number, span, typeset, with_unit
from gainsay.report.reading import PaperResults, Row
from gainsay.report.sentences import listed, said
from gainsay.tables.models import Claim
from gainsay.verdicts.outcome import Outcome

__all__ = ["condition", "found_value", "input_value", "is_truth", "published_value", "reason", "turning_point"]

_NUMERIC = ("equal", "at_most", "at_least")
#: comparators that hold a truth against a quantity that is 1 or 0
_TRUTHS = {"feasible": 1.0, "infeasible": 0.0, "holds": 1.0, "fails": 0.0}
#: digits of an input at which an outcome turns
_DIGITS_OF_INPUT = 4
#: inputs that a sentence names, more are counted
_FEW = 3


def is_truth(claim: Claim) -> bool:
    """Whether what a claim is held against is a truth, not a number."""
    return claim.comparator in _TRUTHS


def _agrees(claim: Claim, recomputed: str) -> bool:
    return float(recomputed) == _TRUTHS[claim.comparator]


def _joined(found: PaperResults, claim: Claim) -> list[str]:
    parts = claim.quantity.split()
    return [found.verdicts[part]["verdict"] if part in found.verdicts else "" for part in parts]


def published_value(found: PaperResults, claim: Claim) -> Markup:
    """Return what the paper says: a number with its unit, ``feasible``, ``it holds``; empty where it gives none."""
    if claim.comparator == "feasible":
        return escape("feasible")
    if claim.comparator == "all_of":
        many = len(claim.quantity.split())
        return escape("both hold" if many == 2 else f"all {many} hold")
    if claim.comparator == "less_than":
        other = found.quantities.get(claim.published)
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


def found_value(found: PaperResults, claim: Claim, row: Row) -> Markup:
    """Return what was found, in the words of what the paper says; empty where nothing was."""
    text = row["recomputed"]
    if claim.comparator == "all_of":
        verdicts = _joined(found, claim)
        held = verdicts.count("reproduced")
        return escape(("both hold" if held == 2 else f"all {held} hold") if held == len(verdicts)
                      else f"{held} of {len(verdicts)} hold") if row["verdict"] else Markup("")  # fmt: skip
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


def condition(given: str) -> str:
    """Return the condition of a claim in words: ``observer_start=exact`` reads "observer start = exact"."""
    parts = (part.partition("=") for part in given.split(";"))
    return ", ".join(
        f"{name.strip().replace('_', ' ')} = {value.strip().replace('_', ' ')}" for name, _, value in parts
    )


def input_value(value: object, of: str, digits: int = 6) -> Markup:
    """Return the value of an input of a scan: a word, or a number with its unit."""
    return escape(value) if isinstance(value, str) else number(repr(value), of, digits=digits)


def _name(parameter: str) -> Markup:
    return Markup("<i>{}</i>").format(parameter.replace("_", " "))


def turning_point(scan: Outcome) -> Markup:
    """Return where the outcome of a scan turns: "it turns where inertia x passes 8.94 kg m², and holds below that"."""
    boundary = scan.boundary
    if boundary is None:
        return Markup("")
    units = {entry.name: entry.unit for entry in scan.inputs}
    holds, fails = boundary.holds, boundary.fails
    if isinstance(holds, str) or isinstance(fails, str):
        return Markup("with {} = {} it holds, with {} it fails").format(_name(boundary.input), holds, fails)
    side = "below" if holds < fails else "above"
    at = input_value(holds, units[boundary.input], _DIGITS_OF_INPUT)
    return Markup("it turns where {} passes {}, and holds {} that").format(_name(boundary.input), at, side)


def _scanned(scan: Outcome) -> Markup:
    names = [entry.name for entry in scan.inputs]
    over = listed(_name(name) for name in names) if len(names) <= _FEW else Markup("{} inputs").format(len(names))
    told = Markup("It depends on {} that the paper leaves out: it holds for {} of {} plausible fillings").format(
        over, scan.holding, scan.samples
    )
    turns = turning_point(scan)
    return Markup("{}; on the way from one to another {}.").format(told, turns) if turns else told + "."


def reason(found: PaperResults, claim: Claim, row: Row, links: Sequence[Markup] = ()) -> Markup:
    """Return one sentence that says why a claim is not simply reproduced; empty where there is nothing to add.

    Parameters
    ----------
    found : PaperResults
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
    scan = found.scans.get(claim.id)
    if scan and row["evidence"].startswith("sampled"):
        return _scanned(scan)
    if verdict == "contradicted" and row["witness"].startswith(f"{claim.quantity} ="):
        return Markup("")  # the number itself, said already
    return said(row["witness"] or row["note"])

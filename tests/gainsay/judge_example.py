"""Claims, evidence and scans in a line each, for the tests of what is judged from them."""

from fractions import Fraction
from typing import get_args

from gainsay.scans.outcome import outcome
from gainsay.tables.models import PROVED, Claim, Kind, Quantity
from gainsay.verdicts.evidence import ComputedQuantity, Concluded, Evidence
from gainsay.verdicts.judge import judge

SAMPLED = sorted(set(get_args(Kind)) - PROVED - {"remark"})


class Tables:
    """What judging needs of a case: the declared quantities, claims that others join, names of parameters."""

    def __init__(self, *parts: Claim, left_out: tuple[str, ...] = (), printed: tuple[str, ...] = ()) -> None:
        self.assumed = dict.fromkeys(left_out)
        self.parameters = dict.fromkeys((*left_out, *printed))
        self.claims = {part.id: part for part in parts}
        units = {"q": "m", "other": "m", "angle": "rad", "flag": "1"}
        self.quantities = {q: Quantity(id=q, unit=unit, step="audit", meaning="m") for q, unit in units.items()}


def claim(comparator="equal", published="1.50", kind="ordering", **more) -> Claim:
    given = {"kind": kind, "comparator": comparator, "published": published, "quantity": "q", "unit": "m", **more}
    rest = {"where": "(1)", "statement": "s", "tolerance": "", "expected": "reproduced", "basis": "b", "note": ""}
    return Claim(**{"id": "c", **rest, **given})


def number(value, lower=None, upper=None, method="m") -> ComputedQuantity:
    return ComputedQuantity(value, lower, upper, method, "s")


def at_most(value, certificate="cert") -> Concluded:
    return Concluded("at_most", None, Fraction(value), certificate, "theorem")


def at_least(value, certificate="cert") -> Concluded:
    return Concluded("at_least", Fraction(value), None, certificate, "theorem")


def says(relation, certificate="cert") -> Concluded:
    return Concluded(relation, None, None, certificate, "theorem")


def evidence(*concluded, value=None, other=None, quantity="q", **more) -> Evidence:
    numbers = {quantity: value} if value is not None else {}
    if other is not None:
        numbers["other"] = other
    return Evidence(
        numbers=numbers, concluded={quantity: list(concluded)} if concluded else {},
        certificates={c.certificate: "a sentence" for c in concluded}, **more,
    )  # fmt: skip


def scans(of: Claim, *values: float) -> dict:
    """What a scan with these values says of a claim."""
    inputs = [{"name": "x", "unit": "1", "low": 0.0, "high": 1.0, "logarithmic": False}]
    points = [[i / len(values)] for i in range(len(values))]
    scan = {"quantity": of.quantity, "inputs": inputs, "values": list(values), "points": points, "crossings": []}
    return {of.id: outcome(of, scan)}


def verdict(of: Claim, on: Evidence) -> str:
    return judge(Tables(), of, on, {}).verdict

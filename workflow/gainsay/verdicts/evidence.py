"""What the steps found about a paper, read from its result files."""

import math
from dataclasses import dataclass, field
from fractions import Fraction

from gainsay.errors import CertificateError
from gainsay.exact.digits import double
from gainsay.proof import by_ends, check, read_certificate
from gainsay.results.returned import UNDECIDED, read_part
from gainsay.scans.outcome import Outcome, outcomes, read_scans
from gainsay.tables import Case


@dataclass(frozen=True)
class ComputedQuantity:
    """A computed quantity.

    Attributes
    ----------
    value : float
    lower, upper : float or None
        Enclosure, where one was computed.
    method, source : str
    """

    value: float
    lower: float | None
    upper: float | None
    method: str
    source: str


@dataclass(frozen=True)
class Concluded:
    """What an accepted certificate says of a quantity.

    Attributes
    ----------
    relation : str
        holds, fails, at_most, less_than, at_least, greater_than or inside.
    low, high : Fraction or None
        The bound or bounds.
    certificate, theorem : str
        Its id and what proves it.
    over : frozenset of str
        What the paper leaves out and the proof covers over its plausible range, of which it reads more than the ends.
    """

    relation: str
    low: Fraction | None
    high: Fraction | None
    certificate: str
    theorem: str
    over: frozenset[str] = frozenset()


@dataclass
class Evidence:
    """All that verdicts rest on.

    Attributes
    ----------
    numbers : dict of quantity to ComputedQuantity
    concluded : dict of quantity to list of Concluded
    certificates : dict of certificate id to sentence
        Accepted ones.
    refused : dict of certificate id to reason
    lost : dict of quantity to list of certificate id
        The quantities on which refused certificates conclude; "" for those that cannot be read.
    scans : dict of claim to Outcome
    failures : list of dict
        step, where, task, message.
    read : dict of certificate id to set of parameter names
        The numbers and printed matrices that an accepted certificate reads.
    undecided : dict of quantity to reason
        What was computed of which neither side could be proved.
    """

    numbers: dict[str, ComputedQuantity] = field(default_factory=dict)
    concluded: dict[str, list[Concluded]] = field(default_factory=dict)
    certificates: dict[str, str] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)
    lost: dict[str, list[str]] = field(default_factory=dict)
    scans: dict[str, Outcome] = field(default_factory=dict)
    failures: list[dict[str, str]] = field(default_factory=list)
    read: dict[str, set[str]] = field(default_factory=dict)
    undecided: dict[str, str] = field(default_factory=dict)

    def proved_range(self, quantity: str) -> tuple[Fraction | float, Fraction | float, list[Concluded]]:
        """Return the tightest proved bounds of a quantity (infinite where none) and the conclusions they rest on."""
        low: Fraction | float = -math.inf
        high: Fraction | float = math.inf
        used: dict[str, Concluded] = {}
        for concluded in self.concluded.get(quantity, []):
            if concluded.low is not None and concluded.low > low:
                low, used["low"] = concluded.low, concluded
            if concluded.high is not None and concluded.high < high:
                high, used["high"] = concluded.high, concluded
        return low, high, list(dict.fromkeys(used.values()))


def _number(text: str) -> float | None:
    return double(text) if text else None


def _ends(relation: str, value: str | None) -> tuple[Fraction | None, Fraction | None]:
    if relation in ("holds", "fails") or value is None:
        return None, None
    if relation in ("at_most", "less_than"):
        return None, Fraction(value)
    if relation in ("at_least", "greater_than"):
        return Fraction(value), None
    low, high = value.split("..")
    return Fraction(low), Fraction(high)


def read_evidence(case: Case) -> Evidence:
    """Read quantities, failures and scans of a paper, and check every certificate again.

    A certificate that the checker refuses counts for nothing and is listed as refused.
    """
    evidence = Evidence(failures=read_part(case, "failures"))
    for row in read_part(case, "quantities"):
        if row["method"].startswith(UNDECIDED):
            evidence.undecided[row["quantity"]] = row["method"].removeprefix(UNDECIDED).strip()
            continue
        evidence.numbers[row["quantity"]] = ComputedQuantity(
            double(row["value"]), _number(row["lower"]), _number(row["upper"]), row["method"], row["source"]
        )
    # Only what a step lists as its own counts: a file left by an interrupted or older step is no evidence.
    listed = sorted({case.results / row["file"] for row in read_part(case, "files")})
    for path in (path for path in listed if path.parent.name == "certificates"):
        certificate = None
        try:
            certificate = read_certificate(path)
            if certificate.paper != case.name:
                raise CertificateError(f"{path.name}: about the paper {certificate.paper!r}, expected {case.name!r}")
            proof = check(certificate, case)
        except Exception as error:  # whatever a check stumbles over, it has not accepted the certificate
            evidence.refused[path.stem] = str(error) or type(error).__name__
            for quantity in {c.quantity for c in certificate.conclusions} if certificate else {""}:
                evidence.lost.setdefault(quantity, []).append(path.stem)
            continue
        evidence.certificates[path.stem] = proof.statement
        entries = (certificate.data.get(sort, {}) for sort in ("number", "printed", "half_units"))
        evidence.read[path.stem] = {name for results in entries for name in results}
        over = frozenset(certificate.data.get("plausible", {})) - by_ends(certificate)
        for conclusion in proof.conclusions:
            low, high = _ends(conclusion.relation, conclusion.value)
            evidence.concluded.setdefault(conclusion.quantity, []).append(
                Concluded(conclusion.relation, low, high, path.stem, proof.theorem, over)
            )
    scans = read_scans((path for path in listed if path.parent.name == "scans"), case.root)
    evidence.scans = outcomes(case, scans)
    return evidence

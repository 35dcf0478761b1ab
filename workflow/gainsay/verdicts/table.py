"""The table of verdicts of a paper."""

from collections import Counter
from collections.abc import Iterable

from gainsay.tables import Case
from gainsay.tables.models import VERDICTS
from gainsay.tables.sentences import of_sentence, sentences
from gainsay.verdicts.evidence import Evidence, read_evidence
from gainsay.verdicts.judge import Judgement, judge


def outcomes(verdicts: Iterable[str]) -> str:
    """Count verdicts, the decided ones first.

    Examples
    --------
    >>> outcomes(["contradicted", "reproduced", "reproduced"])
    '2 reproduced, 1 contradicted'
    """
    counts = Counter(verdicts)
    return ", ".join(f"{counts[verdict]} {verdict}" for verdict in VERDICTS if counts[verdict])


def _from_the_scan(case: Case, judged: Judgement, evidence: Evidence) -> list[str]:
    """Return what a contradiction rests on of which the digits are from a scan of the text alone.

    Where no certificate says what was read, it may be anything that the paper prints.
    """
    if judged.verdict != "contradicted":
        return []
    proofs = judged.certificate.split()
    read = set().union(*(evidence.read[proof] for proof in proofs)) if proofs else set(case.parameters)
    return [name for name, row in case.parameters.items() if name in read and row.unconfirmed]


def _row(case: Case, claim_id: str, judged: Judgement, evidence: Evidence, of: str) -> dict[str, object]:
    claim = case.claims[claim_id]
    return {
        "claim": claim.id,
        "where": claim.where,
        "kind": claim.kind,
        "statement": claim.statement,
        "published": claim.published,
        "recomputed": judged.recomputed,
        "unit": claim.unit,
        "tolerance": judged.tolerance,
        "verdict": judged.verdict,
        "expected": claim.expected,
        "evidence": judged.evidence,
        "range_low": judged.range_low,
        "range_high": judged.range_high,
        "witness": judged.witness,
        "quantity": claim.quantity,
        "certificate": judged.certificate,
        "note": "; ".join(note for note in (judged.note, claim.note) if note),
        "given": claim.given,
        "weight": claim.weight,
        "digits": " ".join(_from_the_scan(case, judged, evidence)),
        "holds_for": claim.holds_for,
        "sentence": claim.sentence,
        "as_read": claim.as_read,
        "of_sentence": of,
    }


def verdict_rows(case: Case) -> tuple[list[dict[str, object]], Evidence]:
    """Judge every claim of a paper, in the order of its table.

    Returns
    -------
    rows : list of dict
        Keys as in `VERDICT_COLUMNS`.
    evidence : Evidence
    """
    evidence = read_evidence(case)
    verdicts: dict[str, str] = {}
    judged: dict[str, Judgement] = {}
    for claim in sorted(case.claims.values(), key=lambda claim: claim.comparator == "all_of"):
        judged[claim.id] = judge(case, claim, evidence, verdicts)
        verdicts[claim.id] = judged[claim.id].verdict
    spoken = sentences(case.claims.values())
    of = {claim.id: of_sentence((c, verdicts[c.id]) for c in together) for together in spoken for claim in together}
    return [_row(case, claim_id, judged[claim_id], evidence, of[claim_id]) for claim_id in case.claims], evidence

"""The sentences of a paper: claims that speak of one sentence are judged together and shown once.

They are its parts, all of which have to hold, or its readings, of which nobody knows which one is meant.
"""

from collections.abc import Iterable

from gainsay.tables.models import Claim

#: worst first: what joins several claims is as good as the worst of them
SEVERITY = ("failed", "contradicted", "undecided", "undetermined", "uncheckable", "reproduced")


def worst(verdicts: Iterable[str]) -> str:
    """Return the worst of some verdicts.

    Examples
    --------
    >>> worst(["reproduced", "undetermined"])
    'undetermined'
    """
    return min(verdicts, key=SEVERITY.index)


def of_sentence(judged: Iterable[tuple[Claim, str]]) -> str:
    """Return the verdict on a sentence: the worst of its parts and of what its readings come to.

    Claims with the same `as_read` make one reading, as good as the worst of them.

    Parameters
    ----------
    judged : iterable of (Claim, str)
        The claims of the sentence, each with its verdict.
    """
    parts: list[str] = []
    readings: dict[str, list[str]] = {}
    for claim, verdict in judged:
        (readings.setdefault(claim.as_read, []) if claim.as_read else parts).append(verdict)
    return worst([*parts, *([_of_readings({worst(of_one) for of_one in readings.values()})] if readings else [])])


def _of_readings(verdicts: set[str]) -> str:
    """Return what readings come to: what one contradicts and another does not hangs on the reading."""
    others = verdicts - {"contradicted"}
    if others == verdicts or not others or "failed" in others:
        return worst(verdicts)
    return "undetermined" if others & {"reproduced", "undetermined"} else worst(others)


def sentences(claims: Iterable[Claim]) -> list[tuple[Claim, ...]]:
    """Return the claims of each sentence together, in the order in which the sentences come first."""
    groups: dict[str, list[Claim]] = {}
    for claim in claims:
        # a claim whose sentence has no name is a sentence of its own: ids hold no blank
        groups.setdefault(claim.sentence or f"claim {claim.id}", []).append(claim)
    return [tuple(together) for together in groups.values()]

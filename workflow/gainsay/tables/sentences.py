"""The sentences of a paper: claims that speak of one sentence are judged together and shown once, with their parts."""

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


def sentences(claims: Iterable[Claim]) -> list[tuple[Claim, ...]]:
    """Return the claims of each sentence together, in the order in which the sentences come first."""
    found: dict[str, list[Claim]] = {}
    for claim in claims:
        # a claim whose sentence has no name is a sentence of its own: ids hold no blank
        found.setdefault(claim.sentence or f"claim {claim.id}", []).append(claim)
    return [tuple(together) for together in found.values()]

# Which campaigns run, and the files of their chunks.

import math

from gainsay.steps.campaign import plan_digest
from gainsay.tables import read_case
from gainsay.tables.campaigns import counts, named, whole


def campaign_names():
    """Papers and campaigns to run: all of the chosen papers, or those named in the configuration."""
    chosen = [name for name in str(config.get("campaigns", "")).split(",") if name]
    found = [
        (paper, row)
        for paper in PAPERS
        for row in read_case(ROOT, paper).campaigns.values()
    ]
    for name in chosen:
        known = [row.name for _, row in found]
        if name not in known:
            refuse(
                InputError("unknown campaign", value=name, expected=one_of(name, known))
            )
    return [
        (paper, row.name) for paper, row in found if not chosen or row.name in chosen
    ]


def campaign_digest(wildcards):
    """Digest of what a campaign depends on."""
    try:
        case = read_case(ROOT, wildcards.paper)
        return plan_digest(case, named(case.campaigns, wildcards.name, "campaigns.csv"))
    except InputError as error:
        refuse(error)


def campaign_chunks(wildcards):
    """Chunks of a campaign, in the order of their points."""
    row = read_case(ROOT, wildcards.paper).campaigns[wildcards.name]
    points = math.prod(counts(row))
    folder = f"{campaign_digest(wildcards)}-{row.chunk}"
    place = Path("results", wildcards.paper, "campaigns", wildcards.name, folder)
    number = -(-points // whole(row, "chunk"))
    return [str(place / f"chunk-{k:07d}.parquet") for k in range(number)]

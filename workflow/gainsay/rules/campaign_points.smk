# Which campaigns run, and the files of their chunks.

import math

from gainsay.results.manifest import manifest_path
from gainsay.steps.campaign import outdated, plan_digest
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


def gathered_anew(wildcards):
    """Manifests of the campaigns to run; those of other tables or code are taken away, so that they are made again.

    Snakemake by itself knows what a file was made from only where it made it, and as long as it keeps its notes.
    """
    names = campaign_names()
    for paper in dict.fromkeys(paper for paper, _ in names):
        case = read_case(ROOT, paper)
        for name in outdated(case):
            if (paper, name) in names:
                print(
                    f"{paper}: {name} is gathered again, its manifest is of other tables or code",
                    flush=True,
                )
                if not workflow.dryrun:
                    manifest_path(case, name).unlink()
    return [f"results/{paper}/campaigns/{name}.json" for paper, name in names]


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

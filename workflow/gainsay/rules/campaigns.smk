# Campaigns: `snakemake campaigns` scatters the points of every campaign of the chosen papers over chunks and gathers
# them. Chunks stand in a folder named by the digest of all that they depend on, so that one that is there is right.

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
    folder = f"results/{wildcards.paper}/campaigns/{wildcards.name}"
    folder += f"/{campaign_digest(wildcards)}-{row.chunk}"
    number = -(-points // whole(row, "chunk"))
    return [f"{folder}/chunk-{k:07d}.parquet" for k in range(number)]


rule campaigns:
    input:
        lambda wildcards: [
            f"results/{paper}/campaigns/{name}.json"
            for paper, name in campaign_names()
        ],
    localrule: True


rule campaign_chunk:
    output:
        "results/{paper}/campaigns/{name}/{digest}-{size}/chunk-{number}.parquet",
    wildcard_constraints:
        digest="[0-9a-f]{16}",
        size="[0-9]+",
        number="[0-9]+",
        name="[a-z0-9][a-z0-9_.-]*",
    retries: 2
    group:
        "chunks"
    resources:
        mem_mb=1500,
        runtime=60,
        one_by_one=1,
    shell:
        "python -m gainsay.steps.campaign {wildcards.paper:q} {wildcards.name:q}"
        " --chunk $((10#{wildcards.number})) --digest {wildcards.digest:q}"


rule campaign_gather:
    input:
        campaign_chunks,
    output:
        "results/{paper}/campaigns/{name}.json",
        "results/{paper}/campaigns/{name}.parquet",
        "results/{paper}/campaigns/{name}.svg",
    wildcard_constraints:
        name="[a-z0-9][a-z0-9_.-]*",
    localrule: True
    params:
        digest=campaign_digest,
    shell:
        "python -m gainsay.steps.campaign {wildcards.paper:q} {wildcards.name:q}"

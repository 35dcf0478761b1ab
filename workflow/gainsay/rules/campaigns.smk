# Campaigns: `snakemake campaigns` scatters the points of every campaign of the chosen papers over chunks and gathers
# them. Chunks stand in a folder named by the digest of all that they depend on, so that one that is there is right.


rule campaigns:
    input:
        gathered_anew,
    localrule: True


rule campaign_chunk:
    output:
        "results/{paper}/campaigns/{name}/{digest}-{size}/chunk-{number}.parquet",
    log:
        "results/{paper}/campaigns/{name}/{digest}-{size}/chunk-{number}.log",
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
        " --chunk $((10#{wildcards.number})) --digest {wildcards.digest:q} 2>&1 | tee {log:q}"


rule campaign_gather:
    input:
        campaign_chunks,
    output:
        "results/{paper}/campaigns/{name}.json",
        "results/{paper}/campaigns/{name}.parquet",
        "results/{paper}/campaigns/{name}.svg",
    log:
        "results/{paper}/campaigns/{name}.log",
    wildcard_constraints:
        name="[a-z0-9][a-z0-9_.-]*",
    localrule: True
    shell:
        "python -m gainsay.steps.campaign {wildcards.paper:q} {wildcards.name:q} 2>&1 | tee {log:q}"

# The whole workflow of a project. Its Snakefile names the configuration, includes this file and asks for WANTED.


include: "common.smk"
include: "paper.smk"
include: "report.smk"
include: "check.smk"
include: "campaign_points.smk"
include: "campaigns.smk"


# A name that no other rule makes: Snakemake would end without a word, for `quiet: all` silences it. Rules without
# wildcards come first, so that a project's own are untouched.
rule unknown:
    output:
        "{target}",
    log:
        "results/unknown/{target}.log",
    wildcard_constraints:
        target="[A-Za-z0-9_-]+",
    localrule: True
    params:
        lambda wildcards: refuse(
            InputError(
                "unknown target",
                value=wildcards.target,
                expected=one_of(wildcards.target, [*ALL, "campaigns"]),
            )
        ),
    shell:
        "false"


# Snakemake is silent itself, and the first step speaks when it has ended.
onstart:
    steps = [job for job in workflow.dag.needrun_jobs() if not job.is_norun]
    print(
        f"{len(steps)} steps to run; each says in a line what it found when it ends,"
        " the first of a first run within a minute"
    )
    sys.stdout.flush()


WANTED = (
    ["results/.checked"]
    if PAPERS == ALL
    else [f"results/{paper}/.checked" for paper in PAPERS]
)

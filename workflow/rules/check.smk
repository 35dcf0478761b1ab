# The differences between results and record are written by a rule that succeeds whatever they are, since Snakemake
# deletes what a failing job wrote; the last rule reads them and alone decides the exit code.


rule differences:
    input:
        "results/index.html",
        [f"results/{paper}/verdicts.csv" for paper in PAPERS],
        [
            f"papers/{paper}/{table}.csv"
            for paper in PAPERS
            for table in ("claims", "errata", "recorded")
        ],
    output:
        "results/differences.csv",
    params:
        papers=PAPERS,
    message:
        "differences from the record"
    shell:
        "python -m gainsay.steps.check {params.papers}"


rule check:
    input:
        "results/differences.csv",
    output:
        touch("results/.checked"),
    params:
        papers=PAPERS,
    message:
        "check"
    shell:
        "gainsay check {params.papers}"

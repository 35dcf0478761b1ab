# The page over all papers, one to attach to each, and one table of verdicts.


rule report:
    input:
        [f"results/{paper}/verdicts.csv" for paper in PAPERS],
        [f"results/{paper}/parts/figures.files.csv" for paper in PAPERS],
        [
            f"papers/{paper}/{table}.csv"
            for paper in PAPERS
            for table in ("errata", "not_checked", "recorded")
        ],
        library("report", "lmi", "systems", "dynamics", "simulation", "figures"),
        sorted(str(path) for path in Path("workflow/report").glob("*")),
    output:
        "results/index.html",
        "results/verdicts.csv",
        [f"results/{paper}/index.html" for paper in PAPERS],
    params:
        papers=PAPERS,
    message:
        "pages over all papers"
    shell:
        "python -m gainsay.steps.report {params.papers}"

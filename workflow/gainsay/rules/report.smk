# The tables and the page over all papers. A run of some papers alone leaves them as they are.


rule report:
    input:
        [listings(paper, "verdicts", "compare", "page") for paper in ALL],
        sources(ROOT, "report"),
        TEMPLATES,
    output:
        "results/index.html",
        "results/verdicts.csv",
        "results/published.csv",
        "results/differences.csv",
        "results/report.files.csv",
    log:
        "results/report.log",
    params:
        papers=ALL,
    shell:
        "python -m gainsay.steps.report {params.papers:q} 2>&1 | tee {log:q}"

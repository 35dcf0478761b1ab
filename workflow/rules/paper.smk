# The rule set of a paper, made once for each: <paper>_synthesis, _audit, _simulation, _figures, _views, _verdicts.

for paper in PAPERS:

    rule:
        name:
            f"{paper}_synthesis"
        input:
            tables=tables(paper),
            code=sources(paper, "audit", "runs", "figures"),
            library=library("synthesis", "logs", "figures", "report"),
        output:
            parts(paper, "synthesis"),
        params:
            paper=paper,
        message:
            f"{paper}: LMIs, certificates, designs"
        shell:
            "python -m gainsay.steps.synthesis {params.paper}"

    rule:
        name:
            f"{paper}_audit"
        input:
            tables=tables(paper),
            designs=parts(paper, "synthesis"),
            code=sources(paper, "synthesis", "runs", "figures"),
            library=library("audit", "logs", "figures", "report"),
        output:
            parts(paper, "audit"),
        params:
            paper=paper,
        message:
            f"{paper}: printed gains"
        shell:
            "python -m gainsay.steps.audit {params.paper}"

    rule:
        name:
            f"{paper}_simulation"
        input:
            tables=tables(paper),
            designs=parts(paper, "synthesis"),
            code=sources(paper, "synthesis", "audit", "figures"),
            library=library(
                "simulation", "lmi", "proof", "figures", "verdicts", "report"
            ),
        output:
            parts(paper, "simulation"),
        params:
            paper=paper,
        message:
            f"{paper}: runs and logs"
        shell:
            "python -m gainsay.steps.simulation {params.paper}"

    rule:
        name:
            f"{paper}_figures"
        input:
            logs=parts(paper, "simulation"),
            code=f"papers/{paper}/figures.py",
            library=library("figures", "lmi", "proof", "verdicts", "report"),
        output:
            parts(paper, "figures"),
        params:
            paper=paper,
        message:
            f"{paper}: figures from the logs"
        shell:
            "python -m gainsay.steps.figures {params.paper}"

    rule:
        name:
            f"{paper}_views"
        input:
            logs=parts(paper, "simulation"),
            code=f"papers/{paper}/runs.py",
            library=library("views", "lmi", "proof", "figures", "verdicts", "report"),
        output:
            parts(paper, "views"),
        params:
            paper=paper,
        message:
            f"{paper}: viewer files"
        shell:
            "python -m gainsay.steps.views {params.paper}"

    rule:
        name:
            f"{paper}_verdicts"
        input:
            parts(paper, "synthesis"),
            parts(paper, "audit"),
            parts(paper, "simulation"),
            parts(paper, "figures"),
            parts(paper, "views"),
            f"papers/{paper}/claims.csv",
            library("verdicts", "logs", "figures", "report"),
        output:
            f"results/{paper}/quantities.csv",
            f"results/{paper}/gains.csv",
            f"results/{paper}/poles.csv",
            f"results/{paper}/failures.csv",
            f"results/{paper}/certificates.csv",
            f"results/{paper}/verdicts.csv",
        params:
            paper=paper,
        message:
            f"{paper}: verdicts"
        shell:
            "python -m gainsay.steps.verdicts {params.paper}"

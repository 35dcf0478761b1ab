# The rule set of a paper, made once for each: <paper>_synthesis, _audit, _simulation, _figures, _views, _verdicts,
# _compare, _page, and <paper>, which checks this paper alone.

for paper in ALL:
    for step in ("synthesis", "audit", "simulation"):

        rule:
            name:
                f"{paper}_{step}"
            input:
                tables=tables(paper),
                code=sources(ROOT, step, paper),
            output:
                made(paper, step),
            log:
                said(paper, step),
            # the longest first, so that no core waits for one of them at the end
            priority: 1 if step == "simulation" else 2
            params:
                paper=paper,
                step=step,
                columns=table_digest(ROOT, paper, step),
            shell:
                "python -m gainsay.steps.{params.step} {params.paper:q} 2>&1 | tee {log:q}"

    rule:
        name:
            f"{paper}_figures"
        input:
            results=[
                file
                for step in ("synthesis", "audit", "simulation")
                for file in made(paper, step)
            ],
            code=sources(ROOT, "figures", paper),
        output:
            made(paper, "figures"),
        log:
            said(paper, "figures"),
        params:
            paper=paper,
            columns=table_digest(ROOT, paper, "figures"),
        shell:
            "python -m gainsay.steps.figures {params.paper:q} 2>&1 | tee {log:q}"

    rule:
        name:
            f"{paper}_views"
        input:
            results=made(paper, "simulation"),
            code=sources(ROOT, "views", paper),
        output:
            made(paper, "views"),
        log:
            said(paper, "views"),
        params:
            paper=paper,
        shell:
            "python -m gainsay.steps.views {params.paper:q} 2>&1 | tee {log:q}"

    rule:
        name:
            f"{paper}_verdicts"
        input:
            results=[file for step in STEPS for file in made(paper, step)],
            tables=tables(paper),
            csv=[f"papers/{paper}/claims.csv", f"papers/{paper}/parameters.csv"],
            code=sources(ROOT, "verdicts", paper),
        output:
            [
                f"results/{paper}/{table}.csv"
                for table in (
                    "quantities",
                    "gains",
                    "poles",
                    "reads",
                    "failures",
                    "certificates",
                )
            ],
            captioned(paper, "verdicts", f"results/{paper}/verdicts.csv"),
            listing(paper, "verdicts"),
        log:
            said(paper, "verdicts"),
        params:
            paper=paper,
            columns=table_digest(ROOT, paper, "verdicts"),
        shell:
            "python -m gainsay.steps.verdicts {params.paper:q} 2>&1 | tee {log:q}"

    rule:
        name:
            f"{paper}_compare"
        input:
            results=listings(paper, *STEPS, "verdicts"),
            record=present(
                paper,
                "recorded.csv",
                "recorded_scans.csv",
                "recorded_reads.csv",
                "recorded_certificates.csv",
                "recorded_published.csv",
                "errata.csv",
            ),
            tables=[f"papers/{paper}/quantities.csv", f"papers/{paper}/paper.toml"],
            code=sources(ROOT, "compare", paper),
        output:
            captioned(paper, "published", f"results/{paper}/published.csv"),
            captioned(paper, "differences", f"results/{paper}/differences.csv"),
            f"results/{paper}/errata.csv",
            listing(paper, "compare"),
        log:
            said(paper, "compare"),
        params:
            paper=paper,
        shell:
            "python -m gainsay.steps.compare {params.paper:q} 2>&1 | tee {log:q}"

    rule:
        name:
            f"{paper}_page"
        input:
            results=listings(paper, *STEPS, "verdicts", "compare"),
            tables=tables(paper),
            csv=sorted(map(str, Path("papers", paper).glob("*.csv"))),
            paper=f"papers/{paper}/paper.toml",
            code=sources(ROOT, "page", paper),
            lock=sorted(map(str, Path().glob("requirements.lock"))),
            templates=TEMPLATES,
        output:
            captioned(paper, "page", f"results/{paper}/index.html"),
            listing(paper, "page"),
        log:
            said(paper, "page"),
        params:
            paper=paper,
            # by content, not as input: a page shows the campaigns there are, and asks for none
            campaigns=contents(f"results/{paper}/campaigns/*.json"),
        shell:
            "python -m gainsay.steps.page {params.paper:q} 2>&1 | tee {log:q}"

    rule:
        name:
            paper
        input:
            listing(paper, "page"),
            sources(ROOT, "check"),
        output:
            touch(f"results/{paper}/.checked"),
        log:
            said(paper, "check"),
        params:
            paper=paper,
        shell:
            "gainsay check --brief {params.paper:q} 2>&1 | tee {log:q}"

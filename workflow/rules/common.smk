# What the rules share: the papers, the sources a step depends on, the environment of a step.

PAPERS = sorted(path.parent.name for path in Path("papers").glob("*/paper.toml"))
if config["papers"]:
    PAPERS = str(config["papers"]).split(",")

FLOORS = "errors exact tables proof lmi systems dynamics simulation logs figures verdicts report".split()

THREADS = " ".join(
    f"{library}_NUM_THREADS={config['numeric_threads']}"
    for library in ("OMP", "OPENBLAS", "MKL", "RAYON")
)

shell.prefix(f"export {THREADS}; ")


def library(step, *without):
    """Sources of the library that a step depends on: Snakemake does not see imports."""
    floors = [floor for floor in FLOORS if floor not in without]
    files = [f"workflow/gainsay/steps/{name}.py" for name in (step, "command", "tasks")]
    files.append("workflow/gainsay/errors.py")
    for floor in floors:
        files += sorted(
            str(path) for path in Path("workflow/gainsay", floor).rglob("*.py")
        )
    return files


def sources(paper, *without):
    """Modules of a paper that a step depends on: all but those that other steps have to themselves."""
    return sorted(
        str(path)
        for path in Path("papers", paper).glob("*.py")
        if path.stem not in without
    )


def tables(paper):
    """Tables of a paper that computations read; certificates quote the claims that they bear on."""
    names = ["paper.toml", "parameters.csv", "quantities.csv", "claims.csv"]
    printed = sorted(
        str(path) for path in Path("papers", paper, "printed").glob("*.csv")
    )
    return [f"papers/{paper}/{name}" for name in names] + printed


def parts(paper, step):
    """Records that a step leaves whatever happens inside it."""
    kinds = ("quantities", "gains", "poles", "failures", "files")
    return [f"results/{paper}/parts/{step}.{kind}.csv" for kind in kinds]

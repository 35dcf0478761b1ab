# What the rules share: the papers, what a step depends on, the environment of a step.

import hashlib
import math
import shlex
from functools import cache

ROOT = Path(workflow.basedir).resolve()
LIBRARY = Path(workflow.current_basedir).resolve().parents[1]
# The code that these rules belong to, whatever project the active environment was made for.
if str(LIBRARY) not in sys.path:
    sys.path.insert(0, str(LIBRARY))

from gainsay.errors import InputError, one_of
from gainsay.results.returned import STEPS
from gainsay.steps.closure import sources, table_digest
from gainsay.steps.holding import hold_results
from gainsay.steps.resume import forget_damaged
from gainsay.tables import read_case
from gainsay.tables.files import short_path
from gainsay.tables.folder import checked_name, paper_names


def refuse(error):
    """End with exit code 2 and one line, as every command does on bad input."""
    print(f"bad input: {error}", file=sys.stderr)
    sys.stderr.flush()
    os._exit(2)


def chosen_papers():
    """Names of the papers to work on, each checked: a name becomes a module, a rule and part of a command."""
    settings = ("papers", "numeric_threads", "campaigns")
    for name in config:
        if name not in settings:
            raise InputError(
                "configuration", value=name, expected=one_of(name, settings)
            )
    known = paper_names(ROOT)
    asked = config.get("papers") or []
    asked = asked if isinstance(asked, list) else str(asked).split(",")
    chosen = [checked_name(str(name).strip()) for name in asked if str(name).strip()]
    for name in chosen:
        if name not in known:
            raise InputError("unknown paper", value=name, expected=one_of(name, known))
    if not known:
        raise InputError(
            "no paper", file="papers", expected="a folder with a paper.toml"
        )
    return known, chosen or known


def numeric_threads():
    """The number of threads of each numeric library."""
    count = str(config.get("numeric_threads", 1))
    if not (count.isascii() and count.isdigit() and 0 < int(count) < 1000):
        raise InputError(
            "configuration", field="numeric_threads", value=count, expected="1 or more"
        )
    return count


try:
    ALL, PAPERS = chosen_papers()
    THREADS = numeric_threads()
    # For a plan as well (`snakemake -n`), which then says what a run would do.
    if workflow.is_main_process:
        hold_results(ROOT)
        for line in forget_damaged(ROOT, PAPERS, whole=PAPERS == ALL):
            print(line, flush=True)
except InputError as error:
    refuse(error)

# The interpreter that runs Snakemake is the one of the steps, also where its environment is not activated.
ENVIRONMENT = " ".join(
    [f"PATH={shlex.quote(str(Path(sys.executable).parent))}:$PATH"]
    + [f"PYTHONPATH={shlex.quote(str(LIBRARY))}"] * LIBRARY.is_relative_to(ROOT)
    + [
        f"{library}_NUM_THREADS={THREADS}"
        for library in ("OMP", "OPENBLAS", "MKL", "RAYON")
    ]
)

TEMPLATES = sorted(
    short_path(path, ROOT) for path in LIBRARY.glob("gainsay/report/templates/*")
)

# A prefix of our own takes the place of Snakemake's, and with it of its options of bash.
shell.prefix(f"set -euo pipefail; export {ENVIRONMENT}; ")


def tables(paper):
    """What a computing step reads of a paper's folder, but for the tables of which `table_digest` covers a part.

    As a function of the wildcards, which Snakemake calls for a paper that it works on: bad tables are refused then,
    once, before anything is computed, and those of other papers are not looked at.
    """
    folder = Path("papers", paper)
    found = sorted(
        str(path)
        for kind in ("printed/*.csv", "designs/*.json")
        for path in folder.glob(kind)
    )

    def well_formed(wildcards):
        require_tables(paper)
        return found

    return well_formed


@cache
def require_tables(paper):
    """Refuse bad tables, looked at once for all the rules that ask."""
    try:
        read_case(ROOT, paper)
    except InputError as error:
        refuse(error)


def present(paper, *tables):
    """Those of some tables of a paper that it has; an empty one needs no file."""
    files = [f"papers/{paper}/{table}" for table in tables]
    return [file for file in files if Path(file).is_file()]


def listing(paper, step):
    """The list of all files that a step leaves whatever happens inside it, each with its digest."""
    return f"results/{paper}/parts/{step}.files.csv"


def contents(pattern):
    """Digest of the files that match a pattern."""
    found = [(str(path), path.read_bytes()) for path in sorted(Path().glob(pattern))]
    return hashlib.sha256(repr(found).encode()).hexdigest()


def listings(paper, *steps):
    """The lists of all files of some steps: whoever reads files of a step goes by the bytes that its list names.

    A run that is killed between two steps leaves a list that is newer, and a step in between that may have come out as
    before; Snakemake goes by contents, so each list that matters is an input of its own.
    """
    return [listing(paper, step) for step in steps]


def made(paper, step):
    """Result files of a step that other steps read."""
    kinds = ("quantities", "gains", "poles", "reads", "failures")
    return [f"results/{paper}/parts/{step}.{kind}.csv" for kind in kinds] + [
        listing(paper, step)
    ]


def said(paper, step):
    """The file that keeps what a step says on the terminal."""
    return f"results/{paper}/attempts/{step}.terminal.log"


def captioned(paper, what, file):
    """An output that stands in `snakemake --report` with its caption."""
    caption = LIBRARY / "gainsay" / "rules" / "captions" / f"{what}.rst"
    return report(file, caption=str(caption), category=paper)

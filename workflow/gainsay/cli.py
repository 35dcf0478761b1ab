"""The command `gainsay`."""

import argparse
import math
import os
import sys
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path

from gainsay import __version__
from gainsay.errors import LONGEST as LONGEST_REFUSAL
from gainsay.errors import LONGEST_FILE, ComputationError, GainsayError, InputError, missing_extra, one_line, one_of
from gainsay.steps.command import BAD_INPUT, CLEAN, DIFFERENCES, broken_off, refuse, whole_streams
from gainsay.tables import Case, find_root, paper_names, read_case
from gainsay.tables.files import real_path

#: differences that `check --brief` names at most, so that `make` stays on a screen or two; characters of a line
MOST_LINES, LONGEST = 10, 160
EXIT_CODES = "exit codes: 0 clean, 1 differences, 2 bad input, 3 not checked"


def _papers(root: Path, names: Sequence[str]) -> list[str]:
    papers = list(names) or paper_names(root)
    if not papers:
        raise InputError("no paper", file="papers", expected="a folder with a paper.toml")
    return papers


def lint(options: argparse.Namespace) -> int:
    """Read and validate every table of every paper, and see that its modules are rooms of a paper."""
    from gainsay.tables.mathematics import check_sentences
    from gainsay.tables.rooms import check_rooms

    for paper in _papers(options.root, options.papers):
        case = read_case(options.root, paper)
        check_sentences(case)
        check_rooms(case)
        print(
            f"{paper}  tables     {len(case.parameters)} parameters, {len(case.claims)} claims, "
            f"{len(case.errata)} errata, {len(case.not_checked)} not checked: well-formed"
        )
    return CLEAN


def _published(case: Case) -> list[dict[str, str]]:
    """Published numbers of a paper; none where its results are damaged, which is a difference already."""
    from gainsay.verdicts.published import published_rows

    try:
        return published_rows(case)
    except InputError:
        return []


def check(options: argparse.Namespace) -> int:
    """Say whether files, certificates, numbers and verdicts are as on record; writes nothing."""
    from gainsay.steps.check import check as differing
    from gainsay.steps.check import shared_differences
    from gainsay.steps.machine_readable import annotations, write_junit
    from gainsay.verdicts.published import record_line, summary

    cases = [read_case(options.root, paper) for paper in _papers(options.root, options.papers)]
    differing_rows = differing(cases)
    rest = [paper for paper in paper_names(options.root) if paper not in {case.name for case in cases}]
    if not options.papers:
        differing_rows += shared_differences(cases)
    for line in summary(row for case in cases for row in _published(case)):
        print(line)
    shown = differing_rows[:MOST_LINES] if options.brief else differing_rows
    for paper, what, item, expected, value, note in shown:
        line = f"{paper}  {what} {item}: expected {expected or 'nothing'}, found {value or 'nothing'}"
        print((f"{line}: {note}" if note else line)[:LONGEST])
    if len(differing_rows) > len(shown):
        print(f"and {len(differing_rows) - len(shown)} more, which `gainsay check` names")
    if options.junit is not None:
        write_junit(real_path(options.junit), cases, differing_rows)
    for line in annotations(cases, differing_rows) if options.annotations else ():
        print(line)
    drafts = [case.name for case in cases if case.paper.draft]
    if differing_rows or len(drafts) < len(cases):
        print(record_line(differing_rows, [f"results/{paper}" for paper in options.papers] or ["results"]))
    for paper in drafts:
        print(f"{paper}: a draft, what is not on record is no difference; `gainsay record`, then take `draft` out")
    if rest:
        print(f"not checked: {', '.join(rest)}")
    return DIFFERENCES if differing_rows else CLEAN


def explain(options: argparse.Namespace) -> int:
    """Say all that the verdict on a claim rests on: sentence, table rows, number, evidence, and how to check it."""
    from gainsay.steps.explain import explain as lines_on

    print("\n".join(lines_on(read_case(options.root, options.paper), options.claim)))
    return CLEAN


def status(options: argparse.Namespace) -> int:
    """Say in a line a paper where its results stand; computes nothing."""
    from gainsay.steps.explain import status as lines_on

    print("\n".join(lines_on(options.root, _papers(options.root, options.papers))))
    return CLEAN


def diff(options: argparse.Namespace) -> int:
    """Say in what two folders of results differ."""
    from gainsay.steps.between import between

    rows = list(between(options.one, options.other))
    for line in rows:
        print(line)
    return DIFFERENCES if rows else CLEAN


def new(options: argparse.Namespace) -> int:
    """Write a new paper, or a new project with one, as a worked example to replace."""
    from gainsay.scaffold.new import new_paper, new_project

    if options.project is None:
        folder = new_paper(options.root, options.id)
    else:
        folder = new_project(real_path(options.project), options.id)
    print(f"{one_line(str(folder))}: a worked example; next: gainsay lint, snakemake --cores 2, gainsay check")
    if find_spec("snakemake") is None:
        print(f"snakemake is not installed here: it comes with {missing_extra('snakemake')}")
    return CLEAN


def export(options: argparse.Namespace) -> int:
    """Write a run as a Workflow Run RO-Crate: inputs, outputs, digests, versions, and who is responsible."""
    from gainsay.steps.archive import Responsible, export

    responsible = Responsible(options.responsible, options.license, options.id)
    cases = [read_case(options.root, paper) for paper in dict.fromkeys(_papers(options.root, options.papers))]
    print(one_line(export(cases, real_path(options.crate), responsible)))
    return CLEAN


def verify(options: argparse.Namespace) -> int:
    """Check a crate without computing: files, certificates, and that its tables follow from its results."""
    from gainsay.steps.verify import verify as verified

    wrong, checked = verified(real_path(options.crate))
    for line in [*checked, *wrong[:MOST_LINES]]:
        print(one_line(line, LONGEST))
    if len(wrong) > MOST_LINES:
        print(f"and {len(wrong) - MOST_LINES} more")
    print(f"{one_line(str(options.crate))}: {'REFUSED' if wrong else 'clean'}")
    return DIFFERENCES if wrong else CLEAN


def record(options: argparse.Namespace) -> int:
    """Put today's values on record and show what changed."""
    from gainsay.verdicts.record import record_paper

    refused = False
    for paper in _papers(options.root, options.papers):
        try:
            lines = list(record_paper(read_case(options.root, paper)))
        except (ComputationError, InputError) as error:  # the other papers are put on record all the same
            lines, refused = [str(error)], True
        for line in lines:
            print(f"{one_line(paper, LONGEST)}  {line}")
    return DIFFERENCES if refused else CLEAN


def search(options: argparse.Namespace) -> int:
    """Find designs of a paper and write them into its folder; a run only reads them."""
    from gainsay.steps.search import search as find

    find(read_case(options.root, options.paper), options.design)
    return CLEAN


def campaigns(options: argparse.Namespace) -> int:
    """Say where campaigns stand, in a line each; or check manifests and the proofs of maps and boxes again."""
    from gainsay.campaigns.status import progress
    from gainsay.campaigns.store import doubts, manifest_doubt
    from gainsay.steps.campaign import plan_of

    code = CLEAN
    cases = [read_case(options.root, paper) for paper in _papers(options.root, options.papers)]
    for plan in (plan_of(case, name) for case in cases for name in case.campaigns):
        named = f"{plan.case.name}  {plan.row.name}"
        if options.action == "status":
            print(f"{plan.case.name}  {progress(plan)}"[:LONGEST], flush=True)
            continue
        wrong, count = [manifest_doubt(plan)], 0
        if plan.evaluation.recheck is not None:
            for count, (index, doubt) in enumerate(doubts(plan), start=1):  # noqa: B007  # the last number is said
                wrong += [f"point {index}: {doubt}"] * bool(doubt)
        wrong = [f"{named}: {doubt}" for doubt in wrong if doubt]
        proofs = f"proofs of {count} rows, " if count else ""
        print("\n".join([*wrong, f"{named}: {proofs}{len(wrong)} wrong"]), flush=True)
        code = DIFFERENCES if wrong else code
    return code


def docs(options: argparse.Namespace) -> int:
    """Write the documentation that is generated from code and tables, or say whether it is stale."""
    from gainsay.steps.reference import reference
    from gainsay.tables.docs import documents
    from gainsay.tables.files import write_atomically

    stale = []
    if not (options.root / "workflow" / "gainsay").is_dir():
        raise InputError("documentation", value=str(options.root), expected="the repository of Gainsay itself")
    for file, text in (documents(options.root) | reference(_parser())).items():
        path = options.root / file
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            stale.append(file)
            if not options.check:
                write_atomically(path, text)
    for file in stale:
        print(f"{file}: {'stale, run `make docs`' if options.check else 'written'}")
    return DIFFERENCES if stale and options.check else CLEAN


def prove(options: argparse.Namespace) -> int:
    """Check certificates again and say what each concludes, from which formulas, and what stays on faith."""
    from gainsay.proof.guarded import check_file_within
    from gainsay.proof.telling import lines
    from gainsay.proof.telling import one_line as shown

    for path in options.certificates:
        if not os.path.isfile(path):  # noqa: PTH113  # unlike Path.is_file it has an answer for names of any length
            raise InputError("file not found", file=shown(str(path)), expected="a certificate")
    refused = 0
    for path in options.certificates:
        try:
            proof = check_file_within(real_path(path), options.root, options.timeout)
        except InputError:
            raise
        except GainsayError as error:
            refusal = f"{one_line(shown(str(path)), LONGEST_FILE)}: REFUSED: "
            print(refusal + one_line(shown(str(error)), LONGEST_REFUSAL - len(refusal)), flush=True)
            refused += 1
            continue
        print(f"{shown(str(path))}: accepted")
        for line in lines(proof):
            print(f"  {line}", flush=True)
    return DIFFERENCES if refused else CLEAN


def _seconds(text: str) -> float:
    seconds = float(text)
    if not 0 < seconds < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r}: expected seconds, more than 0")
    return seconds


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="gainsay",
        description="Recompute what a control paper prints and says, claim by claim, whether it holds.",
        epilog=EXIT_CODES + ". To compute everything: snakemake --cores 2.",
    )
    parser.add_argument("--version", action="version", version=f"gainsay {__version__}")
    parser.add_argument("--root", type=Path, help="project root; default: the project around the current folder")
    commands = parser.add_subparsers(required=True, metavar="command")

    def add(name: str, work: Callable[[argparse.Namespace], int]) -> argparse.ArgumentParser:
        about = (work.__doc__ or "").splitlines()[0]
        command = commands.add_parser(name, help=about, description=about, epilog=EXIT_CODES)
        command.set_defaults(work=work)
        return command

    for name, work in (("lint", lint), ("check", check), ("record", record)):
        command = add(name, work)
        command.add_argument("papers", nargs="*", help="folder names below papers/; default: all")
        if work is check:
            command.add_argument("--brief", action="store_true", help=f"name {MOST_LINES} differences at most")
            command.add_argument("--junit", type=Path, metavar="FILE", help="write JUnit XML there as well")
            command.add_argument("--annotations", action="store_true", help="as annotations for GitHub Actions as well")
    explaining = add("explain", explain)
    explaining.add_argument("paper", help="folder name below papers/")
    explaining.add_argument("claim", help="id of a claim of claims.csv")
    add("status", status).add_argument("papers", nargs="*", help="default: all")
    comparing = add("diff", diff)
    comparing.add_argument("one", type=Path, help="a folder of results")
    comparing.add_argument("other", type=Path, help="another one")
    making = add("new", new)
    making.add_argument("id", help="name of the paper's folder, such as wan2014")
    making.add_argument("--project", type=Path, metavar="DIR", help="make a project of its own in this empty folder")
    exporting = add("export", export)
    exporting.add_argument("crate", type=Path, help="a new folder, or a new file that ends in .zip")
    exporting.add_argument("papers", nargs="*", help="default: all")
    exporting.add_argument("--responsible", required=True, metavar="NAME", help="who answers for the run")
    exporting.add_argument("--license", required=True, help="a name of the SPDX list such as CC-BY-4.0, or an address")
    exporting.add_argument("--id", default="", metavar="URL", help="ORCID or ROR address of who is responsible")
    add("verify", verify).add_argument("crate", type=Path, help="a folder or a zip file written by `gainsay export`")
    searched = add("search", search)
    searched.add_argument("paper", help="folder name below papers/")
    searched.add_argument("design", nargs="?", help="a name of [designs] in paper.toml; default: all")
    large = add("campaigns", campaigns)
    large.add_argument(
        "action", choices=("status", "prove"), help="where they stand, or check manifests and proofs again"
    )
    large.add_argument("papers", nargs="*", help="folder names below papers/; default: all")
    add("docs", docs).add_argument("--check", action="store_true", help="only say whether they are stale")
    proving = add("prove", prove)
    proving.add_argument("certificates", nargs="+", type=Path, help="results/<paper>/certificates/*.json")
    proving.add_argument("--timeout", type=_seconds, default=120, help="seconds for each; refused after that")
    _add_log_commands(add)
    return parser


def logs(options: argparse.Namespace) -> int:
    """List the runs, what each is, with its duration and size; or the topics of one file, which may be anybody's."""
    from gainsay.logs.commands import list_logs

    return list_logs(options.root, options.paper)


def view(options: argparse.Namespace) -> int:
    """Open a run in the Rerun viewer with its layout."""
    from gainsay.logs.commands import view as open_run

    return open_run(options.root, options.paper, options.run, web=options.web)


def gallery(options: argparse.Namespace) -> int:
    """Render every run without a screen and check that no view is broken or empty."""
    from gainsay.logs.commands import gallery as render_all
    from gainsay.steps.report import main as report

    code = render_all(options.root, options.papers)
    if (options.root / "results" / "index.html").is_file():  # it links the gallery from now on
        report([*paper_names(options.root), "--root", str(options.root)])
    return code


def replay(options: argparse.Namespace) -> int:
    """Recompute every quantity and figure of a run from its log alone and say where they differ from those on file."""
    from gainsay.steps.replay import replay as replay_log

    code = CLEAN
    for path in options.logs:
        try:
            name, lines = replay_log(options.root, real_path(path), figures=not options.numbers_only)
        except InputError as error:  # one bad log hides no other
            code = refuse(error)
            continue
        for line in lines:
            print(f"{name}  {line}"[:LONGEST])
        if not lines:
            what = "quantity" if options.numbers_only else "quantity and figure"
            print(f"{name}  samples, parameters and every {what} are as on file")
        elif code == CLEAN:
            code = DIFFERENCES
    return code


def _add_log_commands(add: Callable[..., argparse.ArgumentParser]) -> None:
    """Add the commands that work on logs."""
    add("logs", logs).add_argument("paper", nargs="?", help="a paper, or a file ending in .mcap; default: all papers")
    opened = add("view", view)
    opened.add_argument("paper", help="folder name below papers/")
    opened.add_argument("run", nargs="?", help="default: the nominal run")
    opened.add_argument("--web", action="store_true", help="in the web browser")
    add("gallery", gallery).add_argument("papers", nargs="*", help="default: all")
    replayed = add("replay", replay)
    replayed.add_argument("logs", nargs="+", type=Path, metavar="log.mcap")
    replayed.add_argument("--numbers-only", action="store_true", help="leave the figures out")


def _refuse_unknown(parser: argparse.ArgumentParser, arguments: Sequence[str]) -> None:
    """Refuse a first word that is no command, with the nearest one; what begins with a dash is for the parser."""
    (commands,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    first = arguments[0] if arguments else "-"
    if not first.startswith("-") and first not in commands.choices:
        raise InputError("unknown command", value=first, expected=one_of(first, commands.choices, most=20))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code."""
    whole_streams()
    parser = _parser()
    try:
        _refuse_unknown(parser, sys.argv[1:] if arguments is None else arguments)
        options = parser.parse_args(arguments)
        if options.work not in (diff, verify) and getattr(options, "project", None) is None:  # these need no project
            options.root = find_root(options.root)
        code = options.work(options)
        sys.stdout.flush()
        return code
    except InputError as error:
        return refuse(error)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # nobody reads what is left to say
        return BAD_INPUT
    except OSError as error:
        return broken_off(error)


if __name__ == "__main__":
    sys.exit(main())

"""The reference below `docs/reference`, generated from the code: what the code says of itself is what is documented."""

import argparse
import ast
import inspect
import re
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from textwrap import indent, wrap
from types import ModuleType
from typing import get_args

from gainsay.proof import formulas, kinds
from gainsay.tables.models import PROVED, Comparator, Kind

_NOTE = "Generated from the code by `make docs`; do not edit.\n"

#: kind of claim -> what it says, and the call that gives its evidence
KINDS = {
    "parameter": ("a printed number", "`results.quantity` with ends, or a certificate of kind `enclosed`"),
    "gain": ("a printed gain", "`results.gains` beside `results.quantity`"),
    "identity": (
        "two expressions are equal",
        "`statements.identical(case, quantity, ...)`, or `differing`",
    ),
    "definiteness": ("a matrix is definite", "`build.certificate('definite', ...)`, or `'not_definite'`"),
    "feasibility": ("an LMI has a solution", "`statements.prove(results, quantity, stated, stated.solve(), ...)`"),
    "stability": (
        "every trajectory decays",
        "`loop_proofs.abscissa`, `poles_left_of`, `pole_right_of`; kinds `'contour'` (uncertain), `'delays'`",
    ),
    "pole-region": (
        "all poles lie in a region",
        "`loop_proofs.poles_in_disk`, `pole_outside_disk`; kinds `'eigenvalues'`, `'robust_disk'`, `'descriptor_disk'`",
    ),
    "norm-bound": (
        "an H-infinity or H2 norm is bounded, or what is left of every response after a time",
        "`norm_proofs.prove_norm`; kinds `'norm_at_least'`, `'level'`; `'quadratic_bound'`, `'delay_peak'`",
    ),
    "cost-bound": ("a quadratic cost is bounded", "`'quadratic_bound'`, or `statements.enclose`"),
    "input-bound": ("the input stays below a bound over a set", "`'quadratic_bound'`, `'linear_box'`"),
    "delay-margin": ("stable for all delays up to one", "`'delays'` with a `scale`, `'feasible'` of a delay condition"),
    "trajectory": (
        "a peak, time or final value of one run",
        "`linear_run` or `RunSpec.measure`, with a band; or `results.scan`",
    ),
    "ordering": ("one thing is larger, faster, smaller than another", "`less_than` between two quantities"),
    "figure": ("what a caption or a sentence says of a curve", "`RunSpec.measure`, or `results.scan`"),
    "remark": ("nothing that can be computed", "none: `uncheckable`"),
}
#: comparator -> what it means for the quantity
COMPARATORS = {
    "equal": "within half a unit of the last printed digit, or within `tolerance`",
    "at_most": "at most `published`; a range `low..high` where the paper prints no threshold, with a `reading`",
    "at_least": "at least `published`; a range as for `at_most`",
    "inside": "between the two ends of `published`, `low..high`",
    "holds": "a certificate concludes that it holds",
    "fails": "a certificate concludes that it fails",
    "feasible": "a certificate holds a point of the program",
    "infeasible": "a certificate holds multipliers that refute the program",
    "less_than": "less than another quantity, named in `published`",
    "all_of": "every claim named in `quantity` has the verdict reproduced",
    "": "only for remarks",
}
#: what the modules of a paper call, by subject
LIBRARY = {
    "Statements: an inequality once, for solver, certificate and page": (
        "gainsay.statements",
        ("Statement", "Stated", "prove", "enclose", "optimum", "identical", "differing", "implication", "Step",
         "symmetric", "matrix", "diagonal", "positive", "scalar"),
    ),
    "Certificates": ("gainsay.proof.build", ("certificate", "feasible_point", "farkas", "dual_bound")),
    "Tables": ("gainsay.tables", ("Case",)),
    "Results of a step": ("gainsay.results", ("task", "Results")),
    "Designs found by a search": ("gainsay.tables.designs", ("FoundDesign",)),
    "Scans over missing inputs": ("gainsay.scans", ("plausible", "scan", "scans", "over_choice")),
    "Ready proofs of a loop": ("gainsay.systems.loop_proofs", ("values", "poles_left_of", "poles_in_disk",
                                                               "pole_right_of", "pole_outside_disk", "abscissa",
                                                               "pole_distance", "norm_below", "h2_norm_below")),
    "Plants over a box of uncertain numbers": ("gainsay.systems.uncertain_plant", ("UncertainPlant",)),
    "Ready proofs of a norm": ("gainsay.systems.norm_proofs", ("prove_norm",)),
    "Norms": ("gainsay.systems.norms", ("hinf_norm", "hinf_enclosure", "h2_norm", "h2_enclosure",
                                        "bounded_real_certificate_matrix")),
    "Synthesis": ("gainsay.systems.synthesis", ("StandardPlant", "hinf_state_feedback", "h2_state_feedback",
                                                "hinf_output_feedback", "h2_output_feedback", "hinf_least_level",
                                                "h2_least")),
    "Systems with delays": ("gainsay.systems.delay", ("DelaySystem",)),
    "Roots and norms under delays": ("gainsay.systems.delay_spectrum", (
        "rightmost_roots", "spectral_abscissa", "unstable_root_count", "hinf_norm", "gain_stays_below")),
    "Delay margin of several delays": ("gainsay.systems.scaled_margin", ("scaled_delay_margin",)),
    "Matrix inequalities for delays": ("gainsay.systems.delay_bounds", ("bessel_legendre", "proved_delay")),
    "Margins": ("gainsay.systems.margins", ("disk_margin", "structured_bounds")),
    "Structured singular values over frequency": ("gainsay.systems.structured", ("structured_peak",)),
    "Real and repeated uncertainty": ("gainsay.systems.mixed_mu", ("Block", "mixed_bounds")),
    "Simulation of linear systems": ("gainsay.simulation.linear", ("Response", "with_harmonics")),
    "Simulation of other systems": ("gainsay.simulation.ode", ("integrate", "largest", "last_crossing")),
    "Simulation under periodic gains": ("gainsay.simulation.periodic", ("PeriodicSolution", "piecewise")),
    "Simulation with delays": ("gainsay.simulation.delay", ("simulate_delay",)),
    "Runs and logs": ("gainsay.logs", ("linear_run", "RunSpec", "Measured", "located", "measuring", "LogWriter",
                                        "read_log")),
    "Layouts of viewers": ("gainsay.logs", ("Layout", "Tab", "Rows", "Columns", "Plot", "Line", "Bound", "EventLog",
                                            "Text", "lines", "tab", "default_layout")),
    "Figures": ("gainsay.figures", ("FigureSpec", "figure_of_run", "panels", "curves", "compare", "curve", "bound",
                                    "finish")),
}  # fmt: skip

#: classes whose methods are documented in full
IN_FULL = ("Results", "LogWriter", "Response", "Case")


def _escaped(text: str) -> str:
    return text.replace("|", "\\|")


def _plain(text: str) -> str:
    """A docstring as Markdown: what is literal in it is literal here."""
    return inspect.cleandoc(text).replace("``", "`")


def _formulas() -> str:
    description = inspect.cleandoc(formulas.__doc__ or "")
    return f"# The formula language\n\n{_NOTE}\n```text\n{description}\n```\n"


def _conclusions(module: ModuleType) -> list[str]:
    """Return what a kind of proof may conclude, read from its calls of `Proved`."""
    sentences: dict[str, None] = {}
    for node in ast.walk(ast.parse(inspect.getsource(module))):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Proved":
            of, relation, *value = (ast.unparse(part) for part in node.args)
            words = re.sub(r"['\"]", "", f"{of} {relation}")
            sentences[words + (" a value" if value else "")] = None
    return list(sentences)


def _proofs() -> str:
    lines = [
        "# Kinds of proof",
        "",
        _NOTE,
        "`gainsay.proof.build.certificate(kind, fields={...}, witness={...}, "
        "quantities={of: quantity}, ...)` makes a certificate, checked. A kind concludes on what stands under "
        "*concludes*; `quantities` says which quantity that is.",
        "",
    ]
    for name in kinds.names():
        module = kinds.load(name)
        head, _, rest = _plain(module.__doc__ or "").partition("\n")
        optional = f"; optional {', '.join(f'`{field}`' for field in module.OPTIONAL)}" if module.OPTIONAL else ""
        fields = ", ".join(f"`{field}`" for field in module.REQUIRED)
        concludes = "; ".join(f"`{text}`" for text in _conclusions(module)) or "see above"
        lines += [f"## `{name}`", "", head, rest, "", f"Needs {fields}{optional}. Concludes {concludes}.", ""]
    return "\n".join(lines).rstrip() + "\n"


def _claims() -> str:
    lines = [
        "# Kinds of claim and comparators",
        "",
        _NOTE,
        "## Kinds",
        "",
        "| kind | what is claimed | evidence | call |",
        "| --- | --- | --- | --- |",
    ]
    for kind in get_args(Kind):
        description, call = KINDS[kind]
        needs = "certificate" if kind in PROVED else ("none" if kind == "remark" else "number with its band")
        lines.append(f"| `{kind}` | {description} | {needs} | {_escaped(call)} |")
    lines += ["", "## Comparators", "", "| comparator | the claim holds where the quantity is |", "| --- | --- |"]
    lines += [f"| {f'`{name}`' if name else '(empty)'} | {COMPARATORS[name]} |" for name in get_args(Comparator)]
    return "\n".join(lines) + "\n"


def _signature(value: Callable) -> str:
    """Names and plain defaults of the arguments: the same under every version of Python."""
    shown, star = [], False
    for parameter in inspect.signature(value).parameters.values():
        if parameter.kind is parameter.KEYWORD_ONLY and not star:
            shown.append("*")
            star = True
        star = star or parameter.kind is parameter.VAR_POSITIONAL
        prefix = "*" if parameter.kind is parameter.VAR_POSITIONAL else ""
        prefix = "**" if parameter.kind is parameter.VAR_KEYWORD else prefix
        default = parameter.default
        plain = isinstance(default, str | int | float | tuple | None) and len(repr(default)) < 40
        given = "" if default is parameter.empty else f"={default!r}" if plain else "=..."
        shown.append(f"{prefix}{parameter.name}{given}")
    return f"({', '.join(shown)})"


def _entry(name: str, value: Callable) -> Iterator[str]:
    yield from (
        f"### `{name}`",
        "",
        "```text",
        *wrap(f"{name}{_signature(value)}", 116, subsequent_indent="    "),
        "",
        inspect.cleandoc(value.__doc__ or ""),
    )
    if inspect.isclass(value):
        for method, function in vars(value).items():
            if not method.startswith("_") and inspect.isfunction(function) and function.__doc__:
                yield from (
                    "",
                    *wrap(f".{method}{_signature(function)}", 116, subsequent_indent="    "),
                    *indent(_summary(value, function), "    ").splitlines(),
                )
    yield from ("```", "")


def _summary(owner: type, method: Callable) -> str:
    """Docstring of a method: in full where the modules of a paper call it by its arguments, else its first line."""
    text = inspect.cleandoc(method.__doc__ or "")
    return text if owner.__name__ in IN_FULL else text.partition("\n")[0]


def _library() -> str:
    lines = ["# What the modules of a paper call", "", _NOTE]
    for subject, (module, names) in LIBRARY.items():
        lines += [f"## {subject}", "", f"`from {module} import {', '.join(names)}`", ""]
        for name in names:
            lines += _entry(name, getattr(import_module(module), name))
    return "\n".join(lines).rstrip() + "\n"


def _commands(parser: argparse.ArgumentParser) -> str:
    (choices,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    lines = [
        "# Commands",
        "",
        _NOTE,
        "Every command takes `gainsay --root DIR` before its name: the project; by "
        "default the one around the current folder.",
        "",
        "| exit code | meaning |",
        "| --- | --- |",
        "| 0 | clean |",
        "| 1 | differences: something is not as on record, or a certificate is refused |",
        "| 2 | bad input, refused in one line before anything was computed |",
        "| 3 | not checked: what is needed for it is not there, such as a screen |",
        "",
    ]
    for name, command in choices.choices.items():
        lines += [f"## `gainsay {name}`", "", command.description or "", ""]
        rows = []
        for action in command._actions:
            if isinstance(action, argparse._HelpAction):
                continue
            shown = " ".join(action.option_strings) or (action.metavar or action.dest)
            rows.append(f"| `{shown}` | {_escaped(action.help or '')} |")
        lines += ["| argument | meaning |", "| --- | --- |", *rows, ""] if rows else []
    lines += [
        "## Steps",
        "",
        "`snakemake --cores 2` runs what is needed; `snakemake --cores 2 PAPER` one paper. Any "
        "step by hand: `python -m gainsay.steps.STEP PAPER`, STEP being one of synthesis, audit, simulation, "
        "figures, views, verdicts, compare, page.",
        "",
    ]
    return "\n".join(lines).rstrip() + "\n"


def reference(parser: argparse.ArgumentParser) -> dict[str, str]:
    """Return every page of the reference: file below the project root -> text.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        That of the command `gainsay`.
    """
    pages = {
        "formulas": _formulas(),
        "proofs": _proofs(),
        "claims": _claims(),
        "library": _library(),
        "commands": _commands(parser),
    }
    return {str(Path("docs/reference", f"{name}.md")): text for name, text in pages.items()}

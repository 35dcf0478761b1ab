"""Maps of feasibility: at every point of a grid a certificate that the checker accepts, or no word."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from gainsay.campaigns.plan import Block, Columns, Evaluation, Plan
from gainsay.errors import CertificateError, GainsayError
from gainsay.lmi.candidates import candidates
from gainsay.proof import Certificate, build, check
from gainsay.statements import Stated
from gainsay.statements.floats import Floats
from gainsay.tables import Case

FEASIBLE, INFEASIBLE, UNDECIDED = "feasible", "infeasible", "undecided"
#: what is proved inside, proved outside, and the band between
COLOURS = {FEASIBLE: "#4c9f70", INFEASIBLE: "#b5495b", UNDECIDED: "#c9c9c9"}
_MARKERS = {FEASIBLE: "o", INFEASIBLE: "x", UNDECIDED: "s"}
#: values of a third input that are drawn beside each other
_PANELS = 4
#: points of type that the marks along a side may take together, so that they do not hide each other
_ROOM = 400
#: digits that multipliers are rounded to: with fewer, hardly any keep the room that they were given
_DIGITS = (9, 12)


def certified(stated: Stated, name: str, sentence: str, floats: Floats | None = None) -> tuple[str, Certificate | None]:
    """Decide whether a program has a point, by a certificate over the tables alone.

    Parameters
    ----------
    stated : Stated
        Matrix inequalities.
    name : str
        Id of the certificate.
    sentence : str
        The program, for people.
    floats : Floats, optional
        The program's evaluator; a new one unless given.

    Returns
    -------
    (outcome, certificate)
        `UNDECIDED` and None where the checker accepted neither a point nor multipliers.
    """
    parts = {**stated.parts(), "id": name}
    for candidate in candidates(stated.program(floats)):
        try:
            if candidate.values:
                point = {unknown: candidate.values[unknown] for unknown in stated.unknowns}
                return FEASIBLE, build.feasible_point(statement=f"There is {sentence}.", point=point, **parts)
            refuting, statement = dict(candidate.multipliers), f"There is no {sentence}."
            return INFEASIBLE, build.farkas(statement=statement, multipliers=refuting, digits=_DIGITS, **parts)
        except CertificateError:
            continue
    return UNDECIDED, None


def feasibility_map(
    inputs: tuple[str, ...], stated: Callable[[Case, Mapping[str, str]], Stated], sentence: str
) -> Evaluation:
    """Campaign of kind ``map``: whether a program has a point, proved at each point of a grid.

    Parameters
    ----------
    inputs : tuple of str
        The first two are the sides of the map.
    stated : callable
        ``(case, inputs as decimals) -> Stated``: a program of matrix inequalities, each decimal taken exactly.
    sentence : str
        The program, for people, with ``{name}`` for an input: ``"solution of (12) at lambda = {lambda}"``.
    """
    floats: Floats | None = None  # of the last point: what points share is evaluated once in a process

    def block(case: Case, of: Block) -> Columns:
        nonlocal floats
        points, outcomes, certificates = of.points(), [], []
        for index, point in zip(of.indices, points, strict=True):
            program = stated(case, point)
            floats = program.floats(floats)
            name = f"{of.plan.row.name}-{index}"
            outcome, made = certified(program, name, sentence.format(**point), floats)
            outcomes.append(outcome)
            certificates.append(made.to_json(compact=True) if made is not None else "")
        coordinates = {name: [float(point[name]) for point in points] for name in inputs}
        return {**coordinates, "outcome": outcomes, "certificate": certificates}

    def recheck(case: Case, of: Block, row: Mapping[str, Any]) -> str:
        return _doubt(stated(case, of.points()[0]), row)

    def count(columns: Columns) -> dict[str, int]:
        return {outcome: list(columns["outcome"]).count(outcome) for outcome in COLOURS}

    def findings(plan: Plan, counts: Mapping[str, int]) -> dict[str, Any]:
        return {outcome: f"{outcome} at {counts[outcome]} of {plan.points} points" for outcome in COLOURS}

    columns = {**dict.fromkeys(inputs, "float64"), "outcome": "string", "certificate": "string"}
    return Evaluation("map", inputs, columns, block, count, findings, _draw, recheck)


def _doubt(stated: Stated, row: Mapping[str, Any]) -> str:
    """Say what is wrong with a row of a map: its certificate states another program, is refused, or says otherwise."""
    if row["outcome"] == UNDECIDED:
        return "a certificate of an undecided point" if row["certificate"] else ""
    try:
        certificate = Certificate.from_json(row["certificate"], "row")
        check(certificate, stated.case)
    except GainsayError as error:
        return str(error)
    parts = stated.parts()
    fields = {key: value for key, value in certificate.fields.items() if key == "constraints"}
    found = fields, dict(certificate.definitions)
    if found != tuple(map(build.one_line, (parts["fields"], parts["definitions"]))):
        return "its certificate states another program"
    wanted = {FEASIBLE: ("feasible", "holds"), INFEASIBLE: ("farkas", "fails")}.get(row["outcome"])
    concluded = {(certificate.kind, conclusion.relation) for conclusion in certificate.conclusions}
    return "" if concluded == {wanted} else f"{row['outcome']}, but the certificate is {concluded}"


def _draw(figure: Any, plan: Plan, rows: Iterator[Mapping[str, np.ndarray]]) -> None:
    """Points by outcome over the first two inputs, a panel for each value of a third; of more inputs all together."""
    plane = len(plan.axes) > 1
    layers = plan.counts[2] if len(plan.axes) == 3 and plan.counts[2] <= _PANELS else 1
    panels = figure.subplots(1, layers, sharex=True, sharey=True, squeeze=False)[0]
    seen, counted = _seen(plan, rows, layers)
    x, y = plan.side(0), plan.side(1) if plane else np.zeros(1)
    size = min(14.0, (_ROOM / layers / max(len(x), len(y))) ** 2)
    for (layer, outcome), grid in seen.items():
        i, j = np.nonzero(grid)
        panels[layer].scatter(x[i], y[j], s=size, marker=_MARKERS[outcome], color=COLOURS[outcome], linewidths=1)
    for layer, axes in enumerate(panels):
        axes.set_xlabel(plan.label(0))
        axes.set_xscale("log" if plan.axes[0].logarithmic else "linear")
        if layers > 1:  # there is no room for the digits between the decades
            axes.tick_params(axis="x", which="minor", labelbottom=False)
        axes.margins(0.04)
        if layers > 1:
            axes.set_title(f"{plan.axes[2].name} = {plan.axes[2].value(layer, layers)}")
    if plane:
        panels[0].set_ylabel(plan.label(1))
        panels[0].set_yscale("log" if plan.axes[1].logarithmic else "linear")
    labels = [f"{outcome}: {count}" for outcome, count in counted.items()]
    figure.legend(panels[0].collections, labels, loc="outside upper left", ncols=3)


def _seen(
    plan: Plan, rows: Iterator[Mapping[str, np.ndarray]], layers: int
) -> tuple[dict[tuple[int, str], np.ndarray], dict[str, int]]:
    """Where each outcome is seen among the places that a figure shows, by panel; and how often it is found in all."""
    shape = [len(range(0, count, plan.step)) for count in plan.sides]
    seen = {(layer, outcome): np.zeros(shape, dtype=bool) for layer in range(layers) for outcome in COLOURS}
    counted = dict.fromkeys(COLOURS, 0)
    for batch in rows:
        i, j = plan.places(batch["index"])
        shown = (i % plan.step == 0) & (j % plan.step == 0)
        for outcome in COLOURS:
            found = batch["outcome"] == outcome
            counted[outcome] += int(found.sum())
            for layer in range(layers):  # the last input runs fastest
                chosen = found & shown & (batch["index"] % layers == layer)
                seen[layer, outcome][i[chosen] // plan.step, j[chosen] // plan.step] = True
    return seen, counted

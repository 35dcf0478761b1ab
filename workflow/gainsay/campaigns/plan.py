"""What a campaign evaluates: points by index, blocks of one fixed size, chunks of whole blocks."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

import numpy as np

from gainsay.errors import InputError
from gainsay.tables import Case
from gainsay.tables.campaigns import Axis, axes, check_inputs, counts, whole
from gainsay.tables.models import Campaign

#: values that a figure shows along a side at most
_SHOWN = 200
Columns = Mapping[str, Sequence[Any]]
P = ParamSpec("P")
R = TypeVar("R")


@dataclass(frozen=True)
class Evaluation:
    """How the blocks of a campaign are evaluated, what is counted of them, and how it is told and drawn.

    Attributes
    ----------
    kind : str
        As in `campaigns.csv`.
    inputs : tuple of str
        Names of the inputs that it knows; the row gives a range to each.
    columns : mapping of str to str
        Column of the results to its type: ``int64``, ``float64`` or ``string``.
    block : callable
        ``(case, block) -> columns``: a function of the tables and of the block alone.
    count : callable
        ``columns -> {name: whole number}``: counts that add up over blocks in any order.
    findings : callable
        ``(plan, counts) -> {name: number or text}``: what the counts say.
    draw : callable
        ``(figure, plan, rows) -> None``: rows are batches of columns, each a mapping of name to array, in order.
    recheck : callable, optional
        ``(case, block of one point, row) -> text``: what is wrong with a row that carries its proof, or nothing.
    group : int, optional
        Rows of a row group of its tables: what is held in memory at a time.
    """

    kind: str
    inputs: tuple[str, ...]
    columns: Mapping[str, str]
    block: Callable[[Case, "Block"], Columns]
    count: Callable[[Columns], dict[str, int]]
    findings: Callable[["Plan", Mapping[str, int]], dict[str, Any]]
    draw: Callable[[Any, "Plan", Iterator[Mapping[str, np.ndarray]]], None]
    recheck: Callable[[Case, "Block", Mapping[str, Any]], str] | None = None
    group: int = 4096


@dataclass(frozen=True)
class Plan:
    """A campaign of a paper, ready to be evaluated.

    Parameters
    ----------
    case : Case
    row : Campaign
    evaluation : Evaluation
    digest : str
        Of all that its results depend on: tables, code and libraries; names the folder of its chunks.

    Raises
    ------
    InputError
        If the row is of another kind than the evaluation, or its inputs are not those that it knows.
    """

    case: Case
    row: Campaign
    evaluation: Evaluation
    digest: str = ""

    def __post_init__(self) -> None:
        file = f"papers/{self.case.name}/campaigns.csv"
        if self.row.kind != self.evaluation.kind:
            raise InputError(self.row.name, file=file, field="kind", value=self.row.kind, expected=self.evaluation.kind)
        check_inputs(self.row, self.evaluation.inputs, file)

    @cached_property
    def axes(self) -> tuple[Axis, ...]:
        """The inputs, in the order of the row."""
        return axes(self.row)

    @cached_property
    def counts(self) -> tuple[int, ...]:
        """Points along each input; the number of draws."""
        return counts(self.row)

    @cached_property
    def points(self) -> int:
        """All points, cells or draws."""
        return math.prod(self.counts)

    @cached_property
    def block(self) -> int:
        """Points of a block; the last one may be shorter."""
        return whole(self.row, "block")

    @property
    def chunks(self) -> int:
        """Number of chunks."""
        return -(-self.points // whole(self.row, "chunk"))

    @property
    def sides(self) -> tuple[int, int]:
        """Points along the first two inputs, the sides of a figure; 1 where there is no second."""
        return self.counts[0], self.counts[1] if len(self.counts) > 1 else 1

    @property
    def step(self) -> int:
        """Every how manieth value of each side a figure shows: it stays small however many points there are."""
        return -(-max(self.sides) // _SHOWN)

    def places(self, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Place along the first two inputs of points by their index."""
        across, up = self.sides
        return np.divmod(index // (self.points // (across * up)), up)

    def side(self, number: int) -> np.ndarray:
        """Values of an input that a figure shows."""
        axis, count = self.axes[number], self.counts[number]
        return np.array([float(axis.value(k, count)) for k in range(0, count, self.step)])

    def label(self, number: int) -> str:
        """Name of an input as a figure shows it."""
        return self.axes[number].name + (f" (one of {self.step} values)" if self.step > 1 else "")

    def blocks(self, chunk: int | None = None) -> Iterator["Block"]:
        """Yield the blocks of one chunk, or all, in the order of their points.

        Raises
        ------
        InputError
            If there is no such chunk.
        """
        size = whole(self.row, "chunk")
        if chunk is not None and not 0 <= chunk < self.chunks:
            raise InputError(self.row.name, field="chunk", value=chunk, expected=f"0 to {self.chunks - 1}")
        first, end = (0, self.points) if chunk is None else (chunk * size, min((chunk + 1) * size, self.points))
        for start in range(first, end, self.block):
            yield Block(self, start, min(self.block, end - start))


@dataclass(frozen=True)
class Block:
    """Points that are evaluated together.

    Attributes
    ----------
    plan : Plan
    first, size : int
        Index of the first point, and how many.
    """

    plan: Plan
    first: int
    size: int

    @property
    def indices(self) -> range:
        """Indices of its points."""
        return range(self.first, self.first + self.size)

    def _places(self) -> Iterator[tuple[int, ...]]:
        sizes = self.plan.counts[::-1]
        for index in self.indices:
            place = []
            for count in sizes:
                index, rest = divmod(index, count)
                place.append(rest)
            yield tuple(reversed(place))

    def points(self) -> list[dict[str, str]]:
        """Inputs of each point of a grid as decimals, the last input running fastest."""
        grid = list(zip(self.plan.axes, self.plan.counts, strict=True))
        return [
            {axis.name: axis.value(k, count) for (axis, count), k in zip(grid, place, strict=True)}
            for place in self._places()
        ]

    def cells(self) -> list[dict[str, tuple[float, float]]]:
        """Ends of each cell of a box, the last input running fastest."""
        grid = list(zip(self.plan.axes, self.plan.counts, strict=True))
        return [
            {axis.name: axis.cell(k, count) for (axis, count), k in zip(grid, place, strict=True)}
            for place in self._places()
        ]

    def generator(self, stream: int = 0) -> np.random.Generator:
        """Random numbers of this block alone: the counter-based generator Philox, keyed by seed and first draw.

        Parameters
        ----------
        stream : int
            Streams of one block with different numbers are independent.
        """
        key = np.random.SeedSequence((int(self.plan.row.seed), self.first, stream)).generate_state(2, np.uint64)
        return np.random.Generator(np.random.Philox(key=key))


def once_a_case(work: Callable[Concatenate[Case, P], R]) -> Callable[Concatenate[Case, P], R]:
    """Make a function of a case and of texts or numbers be evaluated once for each in a process: what blocks share."""
    kept: dict[Any, tuple[Case, R]] = {}

    @wraps(work)
    def once(case: Case, *more: P.args, **named: P.kwargs) -> R:
        key = id(case), more, tuple(named.items())
        if key not in kept:
            kept[key] = case, work(case, *more, **named)  # with the case, so that its id is nobody else's
        return kept[key][1]

    return once

"""Shares among random draws: counts a block, an exact interval over what was resolved and what was not."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from gainsay.campaigns.interval import clopper_pearson
from gainsay.campaigns.plan import Block, Columns, Evaluation, Plan
from gainsay.tables import Case

#: confidence level of every interval
LEVEL = 0.95
#: blocks whose running share a figure shows at most
_SHOWN = 2000


def counted_draws(
    inputs: tuple[str, ...],
    event: str,
    shares: Mapping[str, str],
    evaluate: Callable[[Case, Block], Mapping[str, tuple[int, int]]],
) -> Evaluation:
    """Campaign of kind ``draws``: how often an event occurs, with an exact binomial interval.

    Parameters
    ----------
    inputs : tuple of str
    event : str
        What is counted, for people: ``"unstable"``.
    shares : mapping of str to str
        Name of each share to what it is a share of, for people.
    evaluate : callable
        ``(case, block) -> {share: (proved to occur, unresolved)}``: draws taken from `Block.generator` alone.
    """
    columns = {"draws": "int64"}
    for name in shares:
        columns |= {f"{name}_{event}": "int64", f"{name}_unresolved": "int64"}

    def block(case: Case, of: Block) -> Columns:
        row: dict[str, list[int]] = {"draws": [of.size]}
        for name, (occurred, open_) in evaluate(case, of).items():
            row |= {f"{name}_{event}": [int(occurred)], f"{name}_unresolved": [int(open_)]}
        return row

    def count(counts: Columns) -> dict[str, int]:
        return {name: int(sum(counts[name])) for name in columns}

    def findings(plan: Plan, counts: Mapping[str, int]) -> dict[str, Any]:
        draws = counts["draws"]
        answers: dict[str, Any] = {}
        for name, about in shares.items():
            occurred, open_ = counts[f"{name}_{event}"], counts[f"{name}_unresolved"]
            low, high = clopper_pearson(occurred, draws, open_, LEVEL)
            answers[name] = (
                f"{event} in {occurred} of {draws} draws of {about}, unresolved {open_}: share "
                f"{low:.6f} to {high:.6f} at {LEVEL:.0%} confidence"
            )
            answers |= {f"{name}_low": low, f"{name}_high": high, f"{name}_share": occurred / draws}
        return answers

    def draw(figure: Any, plan: Plan, rows: Iterator[Mapping[str, np.ndarray]]) -> None:
        _draw(figure, plan, rows, event, shares)

    return Evaluation("draws", inputs, columns, block, count, findings, draw)


def _draw(
    figure: Any, plan: Plan, rows: Iterator[Mapping[str, np.ndarray]], event: str, shares: Mapping[str, str]
) -> None:
    """Share so far over the number of draws, at so many of the blocks as are seen, with the interval at the end."""
    step = -(-plan.points // (plan.block * _SHOWN))
    names = ["draws", *(f"{name}_{kind}" for name in shares for kind in (event, "unresolved"))]
    total, seen = np.zeros(len(names), dtype=np.int64), []
    for batch in rows:
        so_far = total + np.cumsum([batch[name] for name in names], axis=1).T
        seen.append(so_far[batch["index"] // plan.block % step == 0])
        total = so_far[-1]
    seen.append(total[None])
    so_far_of = dict(zip(names, np.concatenate(seen).T, strict=True))
    axes = figure.subplots()
    for number, (name, about) in enumerate(shares.items()):
        draws, occurred = so_far_of["draws"], so_far_of[f"{name}_{event}"]
        open_ = int(so_far_of[f"{name}_unresolved"][-1])
        low, high = clopper_pearson(int(occurred[-1]), int(draws[-1]), open_, LEVEL)
        axes.plot(draws, occurred / draws, color=f"C{number}", label=f"{about}: {low:.4f} to {high:.4f}")
        axes.axhspan(low, high, color=f"C{number}", alpha=0.3, linewidth=0)
    axes.set_xscale("log")
    axes.set_xlabel("draws")
    axes.set_ylabel(f"share {event}")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper left", ncols=2)

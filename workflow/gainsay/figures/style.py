"""The look of all figures, in one place: type, lines, sizes, and what each journal has room for."""

from typing import Any

from gainsay.tables import Case

#: matplotlib's settings
STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 8,
    "mathtext.fontset": "dejavusans",
    "axes.titlesize": 8,
    "axes.titlelocation": "left",
    "axes.labelsize": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.xmargin": 0.0,
    "axes.ymargin": 0.06,
    "axes.formatter.limits": (-3, 5),  # a run of three hours has ticks in seconds
    "axes.formatter.use_mathtext": True,
    "grid.alpha": 0.25,
    "grid.linewidth": 0.5,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "legend.handlelength": 1.8,
    "legend.columnspacing": 1.2,
    "lines.linewidth": 1.2,
    "lines.solid_capstyle": "butt",
    "svg.hashsalt": "gainsay",
    "path.simplify": True,
    "path.simplify_threshold": 0.1,
}
DASHES = {"solid": "-", "dashed": (0, (5, 2)), "dotted": (0, (1, 1.5))}
#: dots an inch of the PNG
RESOLUTION = 200
#: width of a figure across the page in inches, by the name of the journal
WIDTHS = {
    "IEEE Access": 7.16,  # both columns, IEEE Author Center
    "Advances in Difference Equations": 170 / 25.4,  # full page width, SpringerOpen
}
WIDTH = 6.9


def width_of(case: Case) -> float:
    """Width of a figure in inches, that of the paper's own journal where it is known."""
    return next((width for journal, width in WIDTHS.items() if case.paper.journal.startswith(journal)), WIDTH)

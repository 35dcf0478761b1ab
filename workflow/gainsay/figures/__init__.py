"""Figures for print, drawn from logs alone, the same to the byte every time; their look is `gainsay.figures.style`."""

from gainsay.figures.drawing import (
    Draw,
    FigureSpec,
    bound,
    compare,
    curve,
    curves,
    ended,
    figure_of_run,
    finish,
    panels,
    save,
)

__all__ = [
    "Draw",
    "FigureSpec",
    "bound",
    "compare",
    "curve",
    "curves",
    "ended",
    "figure_of_run",
    "finish",
    "panels",
    "save",
]

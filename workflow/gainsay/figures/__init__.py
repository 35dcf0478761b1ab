"""Figures for print, drawn from logs alone, the same to the byte every time; their look is `gainsay.figures.style`."""

from gainsay.figures.drawing import Draw, FigureSpec, bound, curve, curves, ended, finish, panels, save

__all__ = ["Draw", "FigureSpec", "bound", "curve", "curves", "ended", "finish", "panels", "save"]

"""Displacement and control over time."""

from gainsay.figures import figure_of_run
from papers.double_integrator.runs import PLOTS

FIGURES = (figure_of_run("figure_1", "nominal", *PLOTS),)

"""The figures of the paper, drawn from the logs alone."""

from gainsay.figures import figure_of_run
from papers.example.runs import PLOTS

FIGURES = (figure_of_run("figure_1", "nominal", PLOTS[0]),)

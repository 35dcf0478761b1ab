"""The static pages, made from tables and result files alone: one over all papers, one of each that stands alone."""

from gainsay.report.page import render_index, render_paper, write_index, write_paper
from gainsay.report.provenance import write_provenance
from gainsay.report.reading import PaperResults, read_results

__all__ = [
    "PaperResults",
    "read_results",
    "render_index",
    "render_paper",
    "write_index",
    "write_paper",
    "write_provenance",
]

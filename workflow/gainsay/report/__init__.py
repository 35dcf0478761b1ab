"""The static page over all papers, made from tables and result files alone."""

from gainsay.report.page import render_index, render_paper, write_index, write_paper
from gainsay.report.reading import PaperResults, read_results

__all__ = ["PaperResults", "read_results", "render_index", "render_paper", "write_index", "write_paper"]

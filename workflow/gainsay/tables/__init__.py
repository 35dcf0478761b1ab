"""The tables of a paper: typed reading, checks between them, and the results that steps write."""

from gainsay.tables.case import Case
from gainsay.tables.folder import find_root, paper_names, read_case
from gainsay.tables.reading import PrintedMatrix

__all__ = ["Case", "PrintedMatrix", "find_root", "paper_names", "read_case"]

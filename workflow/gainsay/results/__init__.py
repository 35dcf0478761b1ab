"""What the steps of a paper write and read back: quantities, certificates, gains, scans and the lists of files."""

from gainsay.results.tasks import run_tasks, task
from gainsay.results.writing import Results

__all__ = ["Results", "run_tasks", "task"]

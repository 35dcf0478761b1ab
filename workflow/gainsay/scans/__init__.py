"""Scans over what a paper leaves out: plausible ranges, the criterion of a claim, samples, and what they come to."""

from gainsay.scans.choices import over_choice
from gainsay.scans.ranges import Plausible, Point, corners, fractions, plausible, sample
from gainsay.scans.sampling import Scan, scan, scans

__all__ = ["Plausible", "Point", "Scan", "corners", "fractions", "over_choice", "plausible", "sample", "scan", "scans"]

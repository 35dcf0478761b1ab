"""Verdicts on claims, from tables and evidence alone; scans over what a paper leaves out."""

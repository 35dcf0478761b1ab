"""Verdicts on claims, from tables and evidence alone, and the record."""

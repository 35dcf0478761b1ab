"""Campaigns: computations too large for a run, evaluated in blocks by index, by chunks that any machine may compute.

A point is known by its index alone, a draw by its seed and block, a block is always evaluated whole: what comes out is
the same however the points are cut into chunks, in whatever order these run, and how often one is done again.
"""

from gainsay.campaigns.plan import Block, Evaluation, Plan, once_a_case

__all__ = ["Block", "Evaluation", "Plan", "once_a_case"]

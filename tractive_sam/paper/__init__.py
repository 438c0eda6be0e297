"""Reproduction of the paper: every figure and table, and its statements with computed results.

The paper is Juliá & Rodríguez-Tembleque, Int. J. Mech. Sci. 294 (2025) 110195. Every chapter
computes a group of its figures and yields statements, figures and tables. No computed number is
stored in the source: each run computes the numbers that it reports.
"""

from tractive_sam.paper.finding import Chapter, Finding, Picture, Statement, Table, Verdict
from tractive_sam.paper.reproduce import CHAPTERS, reproduce
from tractive_sam.paper.size import FULL, REDUCED, Size

__all__ = [
    "CHAPTERS",
    "FULL",
    "REDUCED",
    "Chapter",
    "Finding",
    "Picture",
    "Size",
    "Statement",
    "Table",
    "Verdict",
    "reproduce",
]

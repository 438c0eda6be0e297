"""Reproduction of every figure and table of the paper, and comparison with its statements.

After Juliá & Rodríguez-Tembleque, Int. J. Mech. Sci. 294 (2025) 110195. Every chapter computes a
group of the paper's figures and yields its findings one by one: statements, figures, tables. Every
result on the page is computed in one run.
"""

from tractive_sam.paper.finding import Chapter, Finding, FindingTable, Picture, Statement, Verdict
from tractive_sam.paper.reproduce import CHAPTERS, reproduce
from tractive_sam.paper.size import FULL, REDUCED, Size

__all__ = [
    "CHAPTERS",
    "FULL",
    "REDUCED",
    "Chapter",
    "Finding",
    "FindingTable",
    "Picture",
    "Size",
    "Statement",
    "Verdict",
    "reproduce",
]

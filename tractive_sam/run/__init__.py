"""The front doors of a scene: solve, roll, resume, explain, export, and error bars."""

from tractive_sam.run import explain, memory
from tractive_sam.run.export import export_surface, export_volume
from tractive_sam.run.gap_notes import warn_of_gap
from tractive_sam.run.given import measured_gap
from tractive_sam.run.many import InTurn, nearby, snake, solve_many, under
from tractive_sam.run.pipeline import roll, solve
from tractive_sam.run.progress import progress_shown
from tractive_sam.run.resume import what_differs

__all__ = [
    "InTurn",
    "explain",
    "export_surface",
    "export_volume",
    "measured_gap",
    "memory",
    "nearby",
    "progress_shown",
    "roll",
    "snake",
    "solve",
    "solve_many",
    "under",
    "warn_of_gap",
    "what_differs",
]

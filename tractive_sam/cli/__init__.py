"""The command line: scenes in, results files, tables and figures out.

Modules of commands import what computes only when they are run, so that help comes at once.
"""

from tractive_sam.cli.app import app, main

__all__ = ["app", "main"]

"""``tractive-sam show``: print a results file or a table of creep forces."""

import csv
import json
import sys
from pathlib import Path
from typing import Annotated

import typer

import tractive_sam as ts
from tractive_sam.cli.explain import print_description
from tractive_sam.cli.fit import show_fit
from tractive_sam.cli.output import console, invalid_exit, print_line
from tractive_sam.safe_text import csv_cell

Results = Annotated[Path, typer.Argument(metavar="FILE.h5", help="A results file.")]


def show(
    file: Annotated[Path, typer.Argument(metavar="FILE")],
    as_json: Annotated[bool, typer.Option("--json")] = False,
    as_csv: Annotated[bool, typer.Option("--csv")] = False,
) -> None:
    """Print a results file, even while its run is in progress, a creep-force table, or a fit.

    Parameters
    ----------
    file
        A results file, a creep-force table, or a fit.
    as_json
        Print every record as JSON instead of tables.
    as_csv
        Print every record as a line of CSV instead of tables.
    """
    if as_json and as_csv:
        raise invalid_exit("--json and --csv: use one of them")
    if file.suffix == ".nc" and not file.is_file():
        cure = "tractive-sam fit and tractive-sam table write result files"
        raise invalid_exit(f"{file} does not exist; {cure}")
    if show_fit(file, as_json, as_csv):
        return
    from tractive_sam.tables import is_table

    if is_table(file):
        _show_table(file, as_json, as_csv)
        return
    from tractive_sam.store import open_history

    history = open_history(file)
    if as_json:
        print_line(json.dumps(history.to_dict(), allow_nan=False))
        return
    if as_csv:
        _print_csv(history)
    else:
        _print_tables(history)


def _print_csv(history: "ts.History") -> None:
    """Print a history as CSV, a line for each record."""
    columns = history.numbers()
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(map(csv_cell, columns))
    writer.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))


def _print_tables(history: "ts.History") -> None:
    """Print the tables of a history: the run, its records, and all quantities of the last one."""
    from tractive_sam.cli import tables

    out = console()
    out.print(tables.run_table(history))
    if len(history) > 1:
        out.print(tables.record_table(history))
    if len(history):
        out.print(tables.last_record(history))


def _show_table(file: Path, as_json: bool, as_csv: bool) -> None:
    """Print a creep-force table as a description or as JSON; refuse CSV."""
    from tractive_sam.tables import explain_table, open_table, table_as_dict

    if as_csv:
        cure = f"tractive-sam table {file} --text FILE.txt writes its nodes"
        message = f"--csv prints results, and {file} is a table of creep forces; {cure}"
        raise invalid_exit(message)
    table = open_table(file)
    if as_json:
        print_line(json.dumps(table_as_dict(table), allow_nan=False))
    else:
        print_description(table.title, explain_table(table))

"""``tractive-sam fit``: coefficients from measurements, with intervals."""

import json
from pathlib import Path
from time import monotonic
from typing import Annotated

import typer
from rich import box
from rich.table import Table

import tractive_sam as ts
from tractive_sam.cli.output import (
    Quiet,
    check_folder,
    console,
    incomplete_exit,
    invalid_exit,
    print_line,
    print_message,
    print_note,
    report_compiling,
    report_interrupt,
    report_warnings,
    show_progress,
)
from tractive_sam.cli.scene_input import Allow
from tractive_sam.description import format_duration


def fit(
    file: Annotated[Path, typer.Argument(metavar="FIT.toml")],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE.nc")],
    design: Annotated[bool, typer.Option("--design")] = False,
    scene: Annotated[Path | None, typer.Option(metavar="OUT.toml")] = None,
    workers: Annotated[int, typer.Option(min=0, metavar="N")] = 0,
    overwrite: Annotated[bool, typer.Option("--overwrite")] = False,
    allow: Allow = None,
    quiet: Quiet = False,
) -> None:
    """Fit coefficients to measurements: creep curves, worn masses, worn profiles.

    Parameters
    ----------
    file
        A fit file (TOML).
    output
        The result (netCDF), from which an interrupted fit resumes.
    design
        Also rank the tests [[fit.test]] by the reduction of the uncertainty.
    scene
        Also write the scene with the fitted values.
    workers
        Number of processes on this machine; 0: this process.
    overwrite
        Replace a file that contains the fit of another scene.
    """
    if output.suffix != ".nc":
        raise invalid_exit(f"{output}: the result is a netCDF file; use FILE.nc")
    for path in filter(None, (output, scene)):
        check_folder(path)
    from tractive_sam.fitting import Evaluations
    from tractive_sam.fitting import fit as fit_design

    note = f"{output} holds the computations so far; repeat the command to resume from them"
    with report_interrupt(note), report_compiling(), show_progress() as update, report_warnings():
        began = printed = monotonic()
        iterations = 0

        def report(done: Evaluations) -> None:
            nonlocal printed, iterations
            contacts, rolls, _ = done.cost
            now, left = monotonic(), done.seconds_left()
            text = f"{contacts} contacts, {rolls} rolls, {format_duration(now - began)}"
            if done.searched:
                chi2 = done.searched[-1][1]
                text = f"iteration {len(done.searched)}, chi-square {chi2:.4g}, {text}"
            if left >= 1.0:
                text += f"; search: about {format_duration(left)} left"
            is_due = len(done.searched) > iterations or now - printed > 60.0
            if is_due:
                printed, iterations = now, len(done.searched)
            # The number of iterations is unknown until chi-square falls regularly.
            share = (now - began) / (now - began + left) if left >= 0.0 else 0.0
            update(share, text, text if is_due else "")

        result = fit_design(
            file, output, workers=workers, overwrite=overwrite, next_test=design, progress=report
        )
    if scene is not None:
        from tractive_sam.output_file import write_file

        write_file(scene, result.scene.to_toml())
    if not quiet:
        print_fit(result)
    print_message(f"{output}: {result.status}")
    if result.status != "done":
        raise incomplete_exit(
            "no convergence; raise fit.iterations, or start from the values in the file"
        )


def print_fit(result: "ts.FitResult") -> None:
    """Print the tables of a fit, its summary and its caveats."""
    out = console()
    for rows in result.tables().values():
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
        for number, heading in enumerate(rows[0]):
            table.add_column(heading, justify="right" if number else "left")
        for row in rows:
            table.add_row(*row.values())
        out.print(table)
    for name, text in result.summary().items():
        if name not in result.keys:
            out.print(f"{name}: {text}")
    for text in (*result.undetermined, *result.notes):
        print_note(text)


def show_fit(file: Path, as_json: bool, as_csv: bool) -> bool:
    """Print a fit as text or JSON, exit if CSV is requested; return whether the file is a fit."""
    from tractive_sam import fitting

    if not fitting.is_fit(file):
        return False
    if as_csv:
        raise invalid_exit(f"--csv prints results, and {file} is a fit; use --json")
    result = fitting.open_fit(file)
    if as_json:
        print_line(json.dumps(result.to_dict(), allow_nan=False))
    elif result.finished:
        print_fit(result)
    else:
        for name, text in result.summary().items():
            console().print(f"{name}: {text}")
    return True


def plot_fit(file: Path, folder: Path | None, format: str, dpi: int, measured: bool) -> bool:
    """Save figures of a complete fit, exit with `measured`; return whether the file is a fit."""
    from tractive_sam import fitting

    if not fitting.is_fit(file):
        return False
    _refuse_measured(file, measured)
    result = _open_complete_fit(file)
    folder = folder or Path(f"{file.stem}-figures")
    for path in fitting.save_fit_figures(result, folder, format=format, dpi=dpi):
        print_line(path)
    return True


def write_fit_report(file: Path, output: Path | None, measured: bool) -> bool:
    """Write the page of a complete fit, exit with `measured`; return whether it is a fit."""
    from tractive_sam import fitting

    if not fitting.is_fit(file):
        return False
    _refuse_measured(file, measured)
    result = _open_complete_fit(file)
    print_line(fitting.report_fit(result, output or Path(f"{file.stem}.html")))
    return True


def _refuse_measured(file: Path, measured: bool) -> None:
    """End with an error if `--measured` is given for a fit, which contains its data."""
    if measured:
        cure = "its figures show the data of the fit; --measured is for files of tractive-sam run"
        raise invalid_exit(f"{file} is a fit: {cure}")


def _open_complete_fit(file: Path) -> "ts.FitResult":
    """Open the file of a fit that has estimates; otherwise end with an error."""
    from tractive_sam import fitting

    result = fitting.open_fit(file)
    if not result.finished:
        cure = "tractive-sam fit resumes it"
        raise invalid_exit(f"{file} holds no estimates yet; {cure}")
    return result

"""``tractive-sam run``: compute a scene into a results file."""

from pathlib import Path
from typing import Annotated

import typer

import tractive_sam as ts
from tractive_sam.cli.output import (
    Quiet,
    console,
    incomplete_exit,
    invalid_exit,
    print_message,
    print_note,
    report_compiling,
    report_warnings,
)
from tractive_sam.cli.scene_input import STANDARD_INPUT, Allow, SceneName, Settings, read_scene

Resume = Annotated[
    bool,
    typer.Option(
        "--resume",
        help="Resume from the last record of the results file, if the file exists: after an "
        "interruption, or to compute more revolutions.",
    ),
]


def run(
    scene: SceneName,
    settings: Settings = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", metavar="FILE.h5")] = None,
    start: Annotated[Path | None, typer.Option("--start", metavar="FILE.h5")] = None,
    resume: Resume = False,
    overwrite: Annotated[bool, typer.Option("--overwrite")] = False,
    allow: Allow = None,
    quiet: Quiet = False,
    verbose: Annotated[bool, typer.Option("--verbose", "-v")] = False,
) -> None:
    """Compute a scene, all its revolutions, into a results file.

    Parameters
    ----------
    output
        Results file; by default, named after the scene, in the working folder.
    start
        Start from the worn bodies of another results file.
    overwrite
        Replace the results file if it exists.
    verbose
        Print all quantities, including those of the solver.
    """
    if resume and overwrite:
        message = "--resume continues a results file, --overwrite replaces it: use one of them"
        raise invalid_exit(message)
    if output is None and scene == STANDARD_INPUT:
        raise invalid_exit("-o FILE.h5 is needed for a scene from the standard input")
    path = output or Path(Path(scene).name).with_suffix(".h5")
    from tractive_sam.run import use_stored_files

    with use_stored_files(ts.open_history(path) if resume and path.exists() else None):
        requested = read_scene(scene, settings)
    if path.exists() and not (resume or overwrite):
        raise invalid_exit(_describe_existing(path, requested))
    worn = None if start is None else ts.open_history(start)
    history, printed = _compute(requested, path, worn, resume)
    if not quiet:
        _print_results(history, verbose, printed)
    print_message(f"{path}: {history.status}; {history.message}")
    if not history.finished:
        message = {
            "inaccurate": "less accurate than requested; see the error bars",
            "not resolved": "the mesh does not resolve the contact",
        }.get(history.status, "the computation ended early; the file contains the records so far")
        raise incomplete_exit(message)


def _compute(
    scene: "ts.Scene", path: Path, start: "ts.History | None", resume: bool
) -> tuple["ts.History", set[str]]:
    """Run or resume a scene into a file; return its history, and the notes that were printed."""
    from tractive_sam.run import roll, show_roll_progress

    before = _modified_at(path)
    keeps = f"{path} contains the records so far, and --resume continues it"
    try:
        shown = show_roll_progress(scene, True, console(stderr=True))
        with report_compiling(), shown as progress, report_warnings() as notes:
            history = roll(
                scene, path, start=start, overwrite=True, resume=resume, progress=progress
            )
    except KeyboardInterrupt:
        written = resume or _modified_at(path) != before
        raise incomplete_exit(f"interrupted{f'; {keeps}' if written else ''}") from None
    except MemoryError:
        if _modified_at(path) == before or not len(ts.open_history(path)):
            raise
        raise incomplete_exit(f"the memory is too small; {keeps} where more is free") from None
    except OSError as error:
        raise incomplete_exit(f"{path} cannot be written: {error}") from None
    return history, {str(note.message) for note in notes}


def _print_results(history: "ts.History", verbose: bool, printed: set[str]) -> None:
    """Print the last record (or all patches), the load, and notes; `verbose` for all quantities."""
    from tractive_sam.cli import tables
    from tractive_sam.results import caveats, describe_balances

    if not (history.finished or history.status == "inaccurate"):
        print_message(("not a solution: ", "bold red"), "the computation ended at the last record")
    if len(history):
        if not history.scene.schedule.in_sequence:  # all patches of a wheel
            console().print(tables.record_table(history))
        if verbose:
            console().print(tables.last_record(history, solver=True))
        elif history.scene.schedule.in_sequence:
            console().print(tables.main_results(history))
        console().print(tables.load_table(history))
    for text in describe_balances(history, only_if_open=True).values():
        print_note(text)
    for text in (f"{name}: {text}" for name, text in caveats(history).items()):
        if text not in printed:
            print_note(text)


def _describe_existing(path: Path, scene: "ts.Scene") -> str:
    """Return the message for a results file that exists already: its content, and what to do."""
    from tractive_sam.run import describe_differences

    cure = "-o FILE.h5 writes this run into another file"
    try:
        history = ts.open_history(path)
    except ts.ResultsError as error:
        return f"{path} would be overwritten, but {error}; {cure}"
    if different := describe_differences(history.scene, scene):
        return f"{path} contains another scene ({different}); {cure}, --overwrite replaces it"
    rolled = history[history.coordinate.name][-1] if len(history) else 0
    end, name = scene.schedule.end, history.coordinate.name
    if history.finished and (rolled >= end or not scene.schedule.ends_there):
        return f"{path} contains this scene, complete; --overwrite computes it again, {cure}"
    extent = f"up to {name} {rolled:g} of {end:g}" if end else "not to its end"
    cure = "--resume continues it, --overwrite starts again"
    return f"{path} contains this scene, computed {extent}; {cure}"


def _modified_at(path: Path) -> int | None:
    """Return the modification time of a file, ns, or None if it does not exist."""
    return path.stat().st_mtime_ns if path.exists() else None

"""``tractive-sam run``: computes a scene into a results file."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tractive_sam.cli.output import (
    Quiet,
    Status,
    bad_input_told,
    compiling_told,
    console,
    note,
    say,
    stop,
    warnings_told,
)
from tractive_sam.cli.scene_input import STANDARD_INPUT, SceneName, Settings, read_scene

if TYPE_CHECKING:
    from tractive_sam.results import History
    from tractive_sam.scene import Scene


def run(
    scene: SceneName,
    settings: Settings = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE.h5",
            help="Results file. By default, the name of the scene in the working folder.",
        ),
    ] = None,
    start: Annotated[
        Path | None,
        typer.Option(
            "--start",
            metavar="FILE.h5",
            help="Begin with the worn bodies of another results file.",
        ),
    ] = None,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume",
            help="Go on from the last record of the results file, if there is one: after a run "
            "that was killed or stopped, or to more revolutions than before.",
        ),
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace the results file, if there is one.")
    ] = False,
    quiet: Quiet = False,
    verbose: Annotated[
        bool,
        typer.Option("--verbose", "-v", help="Print all quantities, also those of the solver."),
    ] = False,
) -> None:
    """Compute a scene, all its revolutions, into a results file."""
    from tractive_sam.run import progress_shown, roll
    from tractive_sam.store import open_history

    if resume and overwrite:
        raise stop(Status.INVALID, "--resume goes on, --overwrite starts anew: give one of them")
    with bad_input_told():
        asked = read_scene(scene, settings)
        if output is None and scene == STANDARD_INPUT:
            raise stop(Status.INVALID, "-o FILE.h5 is needed for a scene from the standard input")
        output = output or Path(Path(scene).name).with_suffix(".h5")
        if output.exists() and not (resume or overwrite):
            raise stop(Status.INVALID, _kept(output, asked))
        before, worn = _written(output), None if start is None else open_history(start)
        try:
            shown = progress_shown(asked, True, console(stderr=True))
            with compiling_told(), shown as progress, warnings_told() as notes:
                history = roll(
                    asked, output, start=worn, overwrite=True, resume=resume, progress=progress
                )
        except KeyboardInterrupt:
            held = f"{output} holds what was computed, --resume goes on from there"
            told = f"; {held}" if resume or _written(output) != before else ""
            raise stop(Status.INCOMPLETE, f"interrupted{told}") from None
        except OSError as error:
            raise stop(Status.INCOMPLETE, f"{output} cannot be written: {error}") from None
    if not quiet:
        _print_results(history, verbose, {str(one.message) for one in notes})
    say(f"{output}: {history.status}; {history.message}")
    if not history.finished:
        raise stop(Status.INCOMPLETE, _INCOMPLETE.get(history.status, _ENDED_EARLY))


_ENDED_EARLY = "the computation ended early; the file holds it up to there"
_INCOMPLETE = {
    "inaccurate": "less accurate than asked for; the error bars tell how much",
    "not resolved": "the mesh does not resolve the contact",
}


def _print_results(history: "History", verbose: bool, printed: set[str]) -> None:
    """Print the last record, all of it or the main results, the load, and notes not yet printed."""
    from tractive_sam.cli import tables
    from tractive_sam.results import balances, caveats

    if not (history.finished or history.status == "inaccurate"):
        say(("not a solution: ", "bold red"), "the last record below is where it ended")
    if len(history):
        if verbose:
            console().print(tables.last_record(history, solver=True))
        else:
            console().print(tables.main_results(history))
        console().print(tables.load(history))
    for text in balances(history, only_if_open=True).values():
        note(text)
    for text in (f"{name}: {text}" for name, text in caveats(history).items()):
        if text not in printed:
            note(text)


def _kept(path: Path, scene: "Scene") -> str:
    """What a file holds that is not replaced unasked, and what to do instead."""
    from tractive_sam.run import what_differs
    from tractive_sam.store import ResultsError, open_history

    own = "-o FILE.h5 gives this run a file of its own"
    try:
        history = open_history(path)
    except ResultsError as error:
        return f"{path} would be overwritten, but {error}; {own}"
    if told := what_differs(history.scene, scene):
        return f"{path} holds another scene ({told}); {own}, --overwrite replaces it"
    rolled = history[history.coordinate.name][-1] if len(history) else 0
    asked = scene.schedule.end
    if history.finished and rolled >= asked:
        return f"{path} holds this scene, computed to its end; --overwrite computes it anew, {own}"
    at = history.coordinate.name
    how_far = f"up to {at} {rolled:g} of {asked:g}" if asked else "not to its end"
    return (
        f"{path} holds this scene, computed {how_far}; --resume goes on from there, --overwrite "
        "starts anew"
    )


def _written(path: Path) -> int | None:
    """When a file was last written; None where there is none."""
    return path.stat().st_mtime_ns if path.exists() else None

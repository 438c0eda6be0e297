"""Commands that compute: ``run``, ``wear``, ``locus``, ``reproduce`` and ``validate``."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

import tractive_sam as ts
from tractive_sam.cli.output import (
    Quiet,
    console,
    incomplete_exit,
    invalid_exit,
    print_line,
    print_message,
    print_note,
    print_table,
    refuse,
    report_compiling,
    report_interrupt,
    report_warnings,
    show_progress,
)
from tractive_sam.cli.scene_input import (
    STANDARD_INPUT,
    Allow,
    SceneName,
    Settings,
    complete_scenes,
    read_scene,
)
from tractive_sam.cli.show import Dpi, Format, Width
from tractive_sam.description import TextTable

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
    from tractive_sam.results import (
        caveats,
        describe_balances,
        last_record,
        main_results,
        record_table,
    )
    from tractive_sam.scene import describe_load

    if not (history.finished or history.status == "inaccurate"):
        print_message(("not a solution: ", "bold red"), "the computation ended at the last record")
    if len(history):
        tables = []
        if not history.scene.schedule.in_sequence:  # all patches of a wheel
            tables.append(record_table(history))
        if verbose:
            tables.append(last_record(history, solver=True))
        elif history.scene.schedule.in_sequence:
            tables.append(main_results(history))
        for table in (*tables, TextTable.from_labels(describe_load(history.scene))):
            print_table(table)
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


def locus(
    scene: Annotated[
        str | None, typer.Argument(metavar="SCENE", autocompletion=complete_scenes)
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE.csv", show_default=False)
    ] = None,
    settings: Settings = None,
    reach: float = 6.0,
    positions: Annotated[int, typer.Option(min=3, max=2001)] = 21,
    amplitude: float = 3.0,
    check: Annotated[str | None, typer.Option("--check", metavar="EN15302")] = None,
    format: Format = "png",
    dpi: Dpi = 200,
    width: Width = None,
) -> None:
    """Write contact points, rolling radii and conicity of a wheelset against its position.

    With --check, the command compares equivalent conicities with the reference cases of a standard
    instead. If a conicity is beyond the tolerance of the standard without a reason that the
    computation shows, the exit status is 3.

    Parameters
    ----------
    scene
        A scene file (TOML), the name of a built-in scene, or - for standard input.
    output
        Table to write; the figures are written to the same folder. With --check, it is optional.
    reach
        Largest lateral position on both sides, mm.
    positions
        Number of positions.
    amplitude
        Amplitude for the printed equivalent conicity, mm.
    check
        Standard whose reference cases are computed; without a scene.
    format
        Format of the figures.
    """
    import numpy as np

    from tractive_sam import plot
    from tractive_sam.description import format_number
    from tractive_sam.output_file import write_table
    from tractive_sam.scene import contact_locus

    if check is not None:
        if scene or settings:
            raise invalid_exit("--check: the standard defines the wheels; omit SCENE and --set")
        checks = _print_conicities(check)
        if output:
            names = ("amplitude", "reference", "tolerance", "conicity", "agrees")
            columns = {name: np.concatenate([getattr(c, name) for c in checks]) for name in names}
            sizes = [one.amplitude.size for one in checks]
            case = np.repeat([int(one.title[1]) for one in checks], sizes)
            profiles = np.repeat([one.label == "from profiles" for one in checks], sizes)
            write_table(output, {"case": case, "from_profiles": profiles, **columns})
            print_line(output)
            figure = output.with_name(f"{output.stem}-check.{format}")
            _save_figure(lambda: plot.conicity_checks(checks), figure, dpi, width)
        if any(one.differs.any() for one in checks):
            raise incomplete_exit("conicities differ from those of the standard; see the table")
        return
    if scene is None or output is None:
        missing = "SCENE" if scene is None else "--output"
        raise invalid_exit(f"{missing} is missing: locus SCENE -o FILE.csv, or --check EN15302")
    read = read_scene(scene, settings)
    with refuse(ValueError), report_warnings():
        contacts = contact_locus(read, np.linspace(-reach, reach, positions))
        harmonic = format_number(contacts.conicity(amplitude), contacts.conicity_error(amplitude))
        try:
            klingel = f"{contacts.klingel_conicity(amplitude):.4f} (Klingel's motion)"
        except ValueError as error:
            klingel = f"by Klingel's motion: {error}"
    print_message(f"equivalent conicity at {amplitude:g} mm: {harmonic} (harmonic), {klingel}")
    write_table(output, contacts.columns())
    print_line(output)
    figures: dict[str, Callable[[], ts.plot.Figure]] = {
        "points": lambda: plot.contact_points(read, contacts),
        "radii": lambda: plot.radius_difference(contacts),
        "conicity": lambda: plot.conicity(contacts),
    }
    for name, draw in figures.items():
        _save_figure(draw, output.with_name(f"{output.stem}-{name}.{format}"), dpi, width)


def _print_conicities(standard: str) -> "list[ts.rail.ConicityCheck]":
    """Print the conicities of a standard beside computed ones, and return them."""
    import numpy as np

    from tractive_sam.validation import Verdict, check_locus, find_standard_locus

    with refuse(ValueError):
        checks = check_locus(standard)
    rows = []
    for check in checks:
        for k, amplitude in enumerate(check.amplitude):
            verdict = Verdict.DIFFERS if check.differs[k] else Verdict.EXPLAINED
            verdict = Verdict.AGREES if check.agrees[k] else verdict
            about = f"{check.title}, {check.label}"
            if check.reasons[k]:
                print_note(f"{about}, amplitude {amplitude:g} mm: {check.reasons[k]}")
            if verdict is Verdict.AGREES and amplitude % 1.0:
                continue  # half millimetres are in the table of --output
            numbers = (check.reference[k], check.conicity[k], check.tolerance[k])
            rows.append((about, f"{amplitude:g}", *(f"{n:.4f}" for n in numbers), verdict.value))
    headings = ("case", "amplitude\nmm", "reference", "computed", "tolerance", "verdict")
    print_table(TextTable(rows, headings, frozenset(range(1, 5))))
    for label in dict.fromkeys(check.label for check in checks):
        group = [check for check in checks if check.label == label]
        agree, differ = (np.concatenate([getattr(check, name) for check in group])
                         for name in ("agrees", "differs"))  # fmt: skip
        worst = max(float(np.abs(check.conicity - check.reference).max()) for check in group)
        print_message(
            f"{label}: {agree.sum()} of {agree.size} conicities are within the tolerance, "
            f"{(~agree & ~differ).sum()} differ with a reason, {differ.sum()} without; "
            f"the largest difference is {worst:.4f}"
        )
    positions = [-2.0, -1.0, 0.0, 1.0, 2.0]
    cones = [find_standard_locus("B", positions, roll) for roll in (0.0, None)]
    without, free = (cone.klingel_conicity(2.0) for cone in cones)
    print_message(
        f"the wheelset of the standard does not roll; free roll would raise the conicity of E2 at "
        f"2 mm, of a cone, from {without:.4f} to {free:.4f}"
    )
    return checks


def _save_figure(
    draw: "Callable[[], ts.plot.Figure]", path: Path, dpi: int = 200, width: float | None = None
) -> None:
    """Draw and save a figure and print its path; print a note if it cannot be drawn."""
    from tractive_sam import plot
    from tractive_sam.output_file import omit_failing_figure

    with report_warnings(), omit_failing_figure(path.name):
        plot.draw_in_width(draw, width).savefig(path, dpi=dpi)
        print_line(path)


def wear(
    scene: Annotated[str, typer.Argument(metavar="SCENE")],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FOLDER")],
    settings: Settings = None,
    allow: Allow = None,
    resume: Resume = False,
) -> None:
    """Wear the profiles of a wheel and a rail at the positions of a duty cycle.

    The results file wear.h5 and the files of the worn profiles are written to the output folder.

    Parameters
    ----------
    scene
        A scene (see run), or a results file (.h5).
    output
        Folder of the worn profiles.
    """
    from tractive_sam import plot
    from tractive_sam.results import WornProfiles
    from tractive_sam.run import require_wear

    if scene.endswith(".h5"):
        history = ts.open_history(scene)
    else:
        require_wear(read_scene(scene, settings))
        output.mkdir(parents=True, exist_ok=True)
        run(scene, settings, output / "wear.h5", None, resume, not resume, quiet=True)
        history = ts.open_history(output / "wear.h5")
    with refuse(ValueError):
        worn = WornProfiles.from_history(history)
    for path in worn.write(output):
        print_line(path)
    _save_figure(lambda: plot.worn_wheel_and_rail(worn), output / "profiles.png")
    depths = f"wheel {worn.wheel_depth[-1].max():.4g} mm, rail {worn.rail_depth[-1].max():.4g} mm"
    print_message(f"worn after {worn.revolutions[-1]:g} revolutions: {depths}")


def reproduce(
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR")] = Path("paper"),
    reduced: Annotated[bool, typer.Option("--reduced")] = False,
    format: Format = "png",
) -> None:
    """Reproduce every figure and table of the paper, and compare its statements with results.

    Parameters
    ----------
    output
        Folder of the page, the figures and the results files; existing files are replaced.
    reduced
        Use coarse meshes and few revolutions, for a quick check; the page states this.
    format
        Format of the figures.
    """
    from tractive_sam import paper
    from tractive_sam.results import NotConverged

    size, chapters = paper.REDUCED if reduced else paper.FULL, len(paper.CHAPTERS)
    note = "the page was not written"
    try:
        with report_interrupt(note), show_progress() as update, report_warnings():
            page = paper.reproduce(
                output,
                size=size,
                format=format,
                progress=lambda done, text: update(done / chapters, text, ""),
            )
    except NotConverged as error:
        raise incomplete_exit(f"not a solution: {error}") from None
    except RuntimeError as error:
        raise incomplete_exit(str(error)) from None
    print_message(f"{page} needs no network and no other file: open it in any browser, or print it")
    print_line(page)


def validate(
    words: Annotated[list[str] | None, typer.Argument(metavar="[WORD]...")] = None,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR")] = Path("validation"),
    quick: Annotated[bool, typer.Option("--quick")] = False,
) -> None:
    """Compare computed results with published ones: closed forms, tables, programs, experiments.

    The command prints a line for each published set, and writes a page. If a value differs from the
    published one without an explanation, the exit status is 3.

    Parameters
    ----------
    words
        Compute only the sets whose topic, title or source contains one of these words.
    output
        Folder of the page and the table of all values; existing files are replaced.
    quick
        Compute only the sets of the quick half.
    """
    from tractive_sam.validation import Verdict, select_sets
    from tractive_sam.validation import validate as validate_sets

    try:
        topics = select_sets(quick, words or ())
    except ValueError as error:
        raise invalid_exit(f"WORD: {error}") from None
    if not (count := sum(len(topic.sets) for topic in topics)):
        raise invalid_exit("WORD: no selected set is in the quick half; omit --quick")
    done = 0
    note = f"{output / 'index.html'} contains the sets so far"
    with report_interrupt(note), show_progress() as update:

        def report(outcome: Any) -> None:
            nonlocal done
            done += 1
            agree = sum(one.agrees for one in outcome.comparisons)
            of = len(outcome.comparisons)
            print_line(
                f"{outcome.worst.value:18}  {agree:2} of {of:2}  {outcome.seconds:6.2f} s  "
                f"{outcome.of.title} ({outcome.of.source})"
            )
            update(done / count, outcome.of.title, "")

        outcomes = validate_sets(output, topics, progress=report)
    values = [(outcome, one) for outcome in outcomes for one in outcome.comparisons]
    agree = sum(one.agrees for _, one in values)
    explained = sum(outcome.verdict(one) is Verdict.EXPLAINED for outcome, one in values)
    failed = sum(bool(outcome.failure) for outcome in outcomes)
    print_message(
        f"{len(outcomes)} published sets, {len(values)} values: {agree} agree, {explained} differ "
        f"and are explained, {len(values) - agree - explained} differ; {failed} sets failed"
    )
    print_line(output / "index.html")
    if agree + explained < len(values) or failed:
        raise incomplete_exit("results differ from published ones; the page shows where")

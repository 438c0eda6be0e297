"""Commands ``fit``, ``spread`` and ``design``: questions that many runs of a scene answer."""

from collections.abc import Callable
from pathlib import Path
from time import monotonic
from typing import Annotated, Any

import typer

import tractive_sam as ts
from tractive_sam.cli.output import (
    Quiet,
    check_folder,
    incomplete_exit,
    invalid_exit,
    print_message,
    print_note,
    report_compiling,
    report_interrupt,
    report_warnings,
    show_progress,
)
from tractive_sam.cli.scene_input import Allow
from tractive_sam.cli.show import print_document
from tractive_sam.description import format_duration

Output = Annotated[
    Path,
    typer.Option("--output", "-o", metavar="FILE.nc",
                 help="The result (netCDF), from which an interrupted command resumes."),
]  # fmt: skip
Workers = Annotated[
    int,
    typer.Option(min=0, metavar="N", help="Processes on this machine; 0: this process."),
]
Scheduler = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="Scheduler of dask.distributed, whose workers compute."),
]
Overwrite = Annotated[
    bool, typer.Option("--overwrite", help="Replace a file that contains another scene.")
]


def fit(
    file: Annotated[Path, typer.Argument(metavar="FIT.toml")],
    output: Output,
    design: Annotated[bool, typer.Option("--design")] = False,
    scene: Annotated[Path | None, typer.Option(metavar="OUT.toml")] = None,
    workers: Workers = 0,
    overwrite: Overwrite = False,
    allow: Allow = None,
    quiet: Quiet = False,
) -> None:
    """Fit coefficients to measurements: creep curves, worn masses, worn profiles.

    Parameters
    ----------
    file
        A fit file (TOML).
    design
        Also rank the tests [[fit.test]] by the reduction of the uncertainty.
    scene
        Also write the scene with the fitted values.
    """
    from tractive_sam.output_file import write_file

    step = "first values"

    def describe(done: Any, cost: str, seconds: float) -> tuple[float, str, bool]:
        nonlocal step
        left, before = done.seconds_left(), step
        if done.searched:
            step = f"iteration {len(done.searched)}, chi-square {done.searched[-1][1]:.4g}"
        step = done.part or step
        text = f"{step}, {cost}"
        if left >= 1.0:
            text += f"; search: about {format_duration(left)} left"
        # The number of iterations is unknown until chi-square falls regularly.
        return seconds / (seconds + left) if left >= 0.0 else 0.0, text, step != before

    def compute(*arguments: Any, **options: Any) -> Any:
        result = ts.fit(*arguments, next_test=design, **options)
        if scene is not None:
            write_file(scene, result.rounded_scene().to_toml())
        return result

    if scene is not None:
        check_folder(scene)
    cure = "no convergence; raise fit.iterations, or start from the values in the file"
    options: dict[str, Any] = {"workers": workers, "overwrite": overwrite}
    _answer(compute, file, output, quiet, describe, cure, **options)


def spread(
    file: Annotated[Path, typer.Argument(metavar="SPREAD.toml")],
    output: Output,
    workers: Workers = 0,
    scheduler: Scheduler = None,
    overwrite: Overwrite = False,
    allow: Allow = None,
    quiet: Quiet = False,
) -> None:
    """Compute how far results scatter with uncertain keys, and which keys cause it.

    Parameters
    ----------
    file
        A spread file (TOML): the scene, and the distributions of its uncertain keys.
    """
    options: dict[str, Any] = {"workers": workers, "scheduler": scheduler, "overwrite": overwrite}
    _answer(ts.spread, file, output, quiet, say=print_note, **options)


def design(
    file: Annotated[Path, typer.Argument(metavar="DESIGN.toml")],
    output: Output,
    scene: Annotated[Path | None, typer.Option(metavar="OUT.toml")] = None,
    workers: Workers = 0,
    scheduler: Scheduler = None,
    overwrite: Overwrite = False,
    allow: Allow = None,
    quiet: Quiet = False,
) -> None:
    """Find the values of free keys with the least or largest result within limits.

    Parameters
    ----------
    file
        A design file (TOML): the scene, its free keys, aims and limits.
    scene
        Also write the scene of the optimum; further ones are OUT-2.toml, OUT-3.toml, ....
    """
    from tractive_sam.output_file import write_file

    def compute(*arguments: Any, **options: Any) -> Any:
        result = ts.design(*arguments, **options)
        if scene is not None:
            for n, one in enumerate(result.scenes):  # OUT.toml, OUT-2.toml, ...
                path = scene.with_stem(f"{scene.stem}-{n + 1}") if n else scene
                write_file(path, one.to_toml())
        return result

    if scene is not None:
        check_folder(scene)
    options: dict[str, Any] = {"workers": workers, "scheduler": scheduler, "overwrite": overwrite}
    _answer(compute, file, output, quiet, **options)


def _answer(
    compute: Callable[..., Any],
    file: Path,
    output: Path,
    quiet: bool,
    describe: Callable[..., tuple[float, str, bool]] | None = None,
    cure: str = "",
    **options: Any,
) -> None:
    """Answer a question with progress, print the result, and exit unless it is done."""
    from tractive_sam.documents import find_kind

    if output.suffix != ".nc":
        raise invalid_exit(f"{output}: the result is a netCDF file; use FILE.nc")
    check_folder(output)
    if options.get("scheduler") is not None and options["workers"]:
        raise invalid_exit("--workers: not with a scheduler; start its workers by dask worker")
    note = f"{output} holds the computations so far; repeat the command to resume from them"
    with report_interrupt(note), report_compiling(), show_progress() as update, report_warnings():
        began = printed = monotonic()

        def report(done: Any) -> None:
            nonlocal printed
            now, (contacts, rolls, _) = monotonic(), done.cost
            cost = f"{contacts} contacts, {rolls} rolls, {format_duration(now - began)}"
            share, text, is_new = done.share, cost, False
            if describe is not None:
                share, text, is_new = describe(done, cost, now - began)
            is_due = is_new or now - printed > 60.0
            printed = now if is_due else printed
            update(share, text, text if is_due else "")

        result = compute(file, output, progress=report, **options)
    if not quiet:
        print_document(find_kind(output)(output, result))
    print_message(f"{output}: {result.status}")
    if result.status != "done":
        raise incomplete_exit(cure or f"{result.status}: {result.message}")

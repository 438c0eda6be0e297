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
    if output.suffix != ".nc":
        raise invalid_exit(f"{output}: the result is a netCDF file; use FILE.nc")
    for path in filter(None, (output, scene)):
        check_folder(path)
    from tractive_sam.documents import FitDocument
    from tractive_sam.fitting import Evaluations
    from tractive_sam.fitting import fit as fit_design

    note = f"{output} holds the computations so far; repeat the command to resume from them"
    with report_interrupt(note), report_compiling(), show_progress() as update, report_warnings():
        began = printed = monotonic()
        step = "first values"

        def report(done: Evaluations) -> None:
            nonlocal printed, step
            contacts, rolls, _ = done.cost
            now, left, before = monotonic(), done.seconds_left(), step
            if done.searched:
                step = f"iteration {len(done.searched)}, chi-square {done.searched[-1][1]:.4g}"
            step = done.part or step
            text = f"{step}, {contacts} contacts, {rolls} rolls, {format_duration(now - began)}"
            if left >= 1.0:
                text += f"; search: about {format_duration(left)} left"
            is_due = step != before or now - printed > 60.0
            printed = now if is_due else printed
            # The number of iterations is unknown until chi-square falls regularly.
            share = (now - began) / (now - began + left) if left >= 0.0 else 0.0
            update(share, text, text if is_due else "")

        result = fit_design(
            file, output, workers=workers, overwrite=overwrite, next_test=design, progress=report
        )
    if scene is not None:
        from tractive_sam.output_file import write_file

        write_file(scene, result.rounded_scene().to_toml())
    if not quiet:
        print_document(FitDocument(output, result))
    print_message(f"{output}: {result.status}")
    if result.status != "done":
        raise incomplete_exit(
            "no convergence; raise fit.iterations, or start from the values in the file"
        )


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
    _answer(ts.spread, file, output, workers, scheduler, overwrite, quiet, say=print_note)


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
    _answer(compute, file, output, workers, scheduler, overwrite, quiet)


def _answer(
    compute: Callable[..., Any], file: Path, output: Path, workers: int, scheduler: str | None,
    overwrite: bool, quiet: bool, **options: Any,
) -> Any:  # fmt: skip
    """Answer a question with progress, print the result, and exit unless it is done."""
    from tractive_sam.documents import open_any

    if output.suffix != ".nc":
        raise invalid_exit(f"{output}: the result is a netCDF file; use FILE.nc")
    check_folder(output)
    if scheduler is not None and workers:
        raise invalid_exit("--workers: not with a scheduler; start its workers by dask worker")
    note = f"{output} holds the computations so far; repeat the command to resume from them"
    with report_interrupt(note), report_compiling(), show_progress() as update, report_warnings():
        began = printed = monotonic()

        def report(done: Any) -> None:
            nonlocal printed
            contacts, rolls, _ = done.cost
            text = f"{contacts} contacts, {rolls} rolls, {format_duration(monotonic() - began)}"
            is_due = monotonic() - printed > 60.0
            printed = monotonic() if is_due else printed
            update(done.share, text, text if is_due else "")

        result = compute(file, output, workers=workers, scheduler=scheduler, overwrite=overwrite,
                         progress=report, **options)  # fmt: skip
    if not quiet:
        print_document(open_any(output))
    print_message(f"{output}: {result.status}")
    if result.status != "done":
        raise incomplete_exit(f"{result.status}: {result.message}")
    return result

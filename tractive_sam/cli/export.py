"""``tractive-sam export``: write stress in a volume, or the surface, for ParaView."""

from pathlib import Path
from typing import Annotated, Literal

import typer

import tractive_sam as ts
from tractive_sam.cli.output import (
    incomplete_exit,
    invalid_exit,
    print_line,
    print_note,
    report_interrupt,
    report_warnings,
)
from tractive_sam.cli.scene_input import RESULTS, Allow, Settings, read_scene


def export(
    source: Annotated[str, typer.Argument(metavar="FILE.h5|SCENE")],
    settings: Settings = None,
    allow: Allow = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", metavar="FILE.vtkhdf")] = None,
    revolution: Annotated[float | None, typer.Option("--revolution", "--distance")] = None,
    body: Literal["A", "B"] = "A",
    block: str | None = None,
    surface: Annotated[bool, typer.Option("--surface")] = False,
    depth: float | None = None,
    elements: int | None = None,
) -> None:
    """Write the stress in a volume of one body, or the surface, for ParaView.

    Parameters
    ----------
    source
        A results file, or a scene; the unworn contact of a scene is solved first.
    output
        File to write; an existing file is replaced. By default, named after the source and the
        body, in the working folder.
    revolution
        Stored revolution, or distance of a transient in mm; by default, the last.
    body
        Body to export.
    block
        Block of a duty cycle, by its name or its index from 0.
    surface
        Write pressure, traction, slip, wear and gap instead of stress; each stored revolution
        is a time step.
    depth
        Depth in units of the semi-axis a of the unworn contact; by default, the depth in the
        scene, or 1.5.
    elements
        Number of points along the depth; by default, the number in the scene, or 64.
    """
    from tractive_sam.run import export_surface, export_volume
    from tractive_sam.store import check_volume

    if surface and (revolution is not None or depth is not None or elements is not None):
        cure = "omit --revolution, --depth and --elements"
        message = f"--surface exports every stored revolution, without a depth; {cure}"
        raise invalid_exit(message)
    output = output or Path(f"{Path(source).stem}-{'surface' if surface else body}.vtkhdf")
    check_volume(output, overwrite=True)
    with report_interrupt(f"{output} was not written"), report_warnings():
        opened = _open_source(source, settings, revolution)
        try:
            opened = _select_block(opened, block)
            if surface:
                export_surface(opened, output, overwrite=True)
            else:
                export_volume(
                    opened, output, body=body, revolution=revolution, depth=depth,
                    elements=elements, overwrite=True,
                )  # fmt: skip
        except (LookupError, ValueError) as error:
            raise invalid_exit(f"{source}: {error}") from None
    print_line(output)


def _select_block(opened: "ts.State | ts.History", block: str | None) -> "ts.State | ts.History":
    """Return the named block of a duty cycle, else the input; LookupError if it must be named."""
    if isinstance(opened, ts.State):
        if block is not None:
            raise LookupError(
                "--block: a scene is solved without its [[duty]]; run it, and export the results"
            )
        return opened
    if block is not None:
        return opened.block(block)
    if names := opened.block_names:
        raise LookupError(f"choose a block of the duty cycle by --block: {', '.join(names)}")
    return opened


def _open_source(
    source: str, settings: list[str] | None, revolution: float | None
) -> "ts.State | ts.History":
    """Return the history in a results file, or the solved contact of a scene."""
    if Path(source).suffix in RESULTS:
        if settings:
            message = f"--set changes a scene, and {source} is a results file; omit --set"
            raise invalid_exit(message)
        history = ts.open_history(source)
        if not history.finished:
            print_note(f"{source} is {history.status}: {history.message}")
        return history
    scene = read_scene(source, settings)
    if revolution is not None:
        cure = f"compute them by tractive-sam run {source}, and export the results file"
        raise invalid_exit(f"--revolution: a scene has no revolutions yet; {cure}")
    contact = ts.solve(scene, throw=False)
    if not contact.converged:
        raise incomplete_exit(f"not a solution: {contact.message}")
    return contact

"""``tractive-sam export``: stress in a volume, or the surface, for ParaView."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tractive_sam.cli.output import Status, bad_input_told, note, stop, tell, warnings_told
from tractive_sam.cli.scene_input import RESULTS, Settings, read_scene

if TYPE_CHECKING:
    from tractive_sam.results import History, State


class Body(StrEnum):
    """The bodies."""

    A = "A"
    B = "B"


def export(
    source: Annotated[
        str,
        typer.Argument(
            metavar="FILE.h5|SCENE",
            help="A results file, or a scene, which is solved for the unworn bodies first.",
        ),
    ],
    settings: Settings = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE.vtkhdf",
            help="The file; that of an earlier export is replaced. By default, the name of the "
            "source and the body in the working folder.",
        ),
    ] = None,
    revolution: Annotated[
        float | None,
        typer.Option(
            "--revolution",
            "--distance",
            help="Revolution, of a transient the distance in mm, of those whose fields the results "
            "file holds; the last.",
        ),
    ] = None,
    body: Annotated[Body, typer.Option(help="Body.")] = Body.A,
    block: Annotated[
        str | None,
        typer.Option(
            help="Block of a duty cycle: its name, or its place in the duty cycle from 0."
        ),
    ] = None,
    surface: Annotated[
        bool,
        typer.Option(
            "--surface",
            help="Write pressure, traction, slip, wear and gap in place of stress: a step for "
            "each stored revolution.",
        ),
    ] = False,
    depth: Annotated[
        float | None,
        typer.Option(
            help="Depth in units of the semi-axis a of the unworn contact; by default that of the "
            "scene, or 1.5."
        ),
    ] = None,
    elements: Annotated[
        int | None,
        typer.Option(help="Points over the depth; by default those of the scene, or 64."),
    ] = None,
) -> None:
    """Write the stress in a volume of one body, or the surface, for ParaView."""
    from tractive_sam.run import export_surface, export_volume
    from tractive_sam.store import check_volume

    if surface and (revolution is not None or depth is not None or elements is not None):
        refusal = "--surface takes every stored revolution, and no depth: omit the other options"
        raise stop(Status.INVALID, refusal)
    output = output or Path(f"{Path(source).stem}-{'surface' if surface else body}.vtkhdf")
    with bad_input_told():
        check_volume(output, overwrite=True)
        try:
            with warnings_told():
                opened = _opened(source, settings, revolution)
                try:
                    opened = _of_block(opened, block)
                    if surface:
                        export_surface(opened, output, overwrite=True)
                    else:
                        export_volume(
                            opened,
                            output,
                            body=body.value,
                            revolution=revolution,
                            depth=depth,
                            elements=elements,
                            overwrite=True,
                        )
                except (LookupError, ValueError) as error:
                    raise stop(Status.INVALID, f"{source}: {error}") from None
        except KeyboardInterrupt:
            raise stop(Status.INCOMPLETE, f"interrupted; {output} was not written") from None
    tell(output)


def _of_block(opened: "State | History", block: str | None) -> "State | History":
    """One block of a duty cycle that was rolled; else what was opened."""
    from tractive_sam.results import History

    if not isinstance(opened, History):
        if block is not None:
            raise LookupError("--block: a scene is solved without its [[duty]]; run it first")
        return opened
    if block is not None:
        return opened.block(block)
    if names := opened.block_names:
        raise LookupError(f"choose a block of the duty cycle by --block: {', '.join(names)}")
    return opened


def _opened(source: str, settings: list[str] | None, revolution: float | None) -> "State | History":
    """The history in a results file, or the contact of a scene."""
    if Path(source).suffix in RESULTS:
        from tractive_sam.store import open_history

        if settings:
            refusal = "--set changes a scene; a results file holds what was computed"
            raise stop(Status.INVALID, refusal)
        history = open_history(source)
        if not history.finished:
            note(f"{source} is {history.status}: {history.message}")
        return history
    from tractive_sam.run import solve

    asked = read_scene(source, settings)
    if revolution is not None:
        cure = f"tractive-sam run {source} computes them into a results file, to be exported then"
        raise stop(Status.INVALID, f"--revolution: a scene has no revolutions yet; {cure}")
    contact = solve(asked, throw=False)
    if not contact.converged:
        raise stop(Status.INCOMPLETE, f"not a solution: {contact.message}")
    return contact

"""``tractive-sam explain``: what will be modelled, before it is."""

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from tractive_sam.cli.output import (
    Status,
    bad_input_told,
    compiling_told,
    console,
    stop,
    warnings_told,
)
from tractive_sam.cli.scene_input import SceneName, Settings, read_scene


def explain(
    scene: SceneName,
    settings: Settings = None,
    workers: Annotated[
        int | None,
        typer.Option(
            min=1, metavar="N", help="Of a study file: processes at work; by default the cores."
        ),
    ] = None,
) -> None:
    """Explain what will be modelled and what is left out, and estimate memory and time.

    A study file is explained, too: its cases, and the time and room that all of them take.
    """
    from tractive_sam.run import explain as explanation
    from tractive_sam.studies import is_study

    with bad_input_told():
        if is_study(scene):
            asked, sections = _study(Path(scene), settings, workers)
        else:
            asked = read_scene(scene, settings)
            with compiling_told(), warnings_told():
                sections = explanation.explain(asked)
    out = console()
    if asked.title:
        out.print(asked.title, style="bold")
    for section in sections:
        out.print(f"\n{section.title}", style="bold")
        table = Table.grid(padding=(0, 2))
        for what, answer in section.rows:
            table.add_row(f"  {what}", answer)
        out.print(table)


def _study(file: Path, settings: list[str] | None, workers: int | None):
    """A study and what there is to say of it."""
    from tractive_sam.operators import cores
    from tractive_sam.studies import Study, explain_study

    if settings:
        cure = "write the setting into the file: set = [...]"
        raise stop(Status.INVALID, f"--set changes a scene, {file} is a study; {cure}")
    with warnings_told():
        asked = Study.from_toml(file)
        return asked, explain_study(asked, workers or cores())

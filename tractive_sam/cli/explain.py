"""``tractive-sam explain``: what will be modelled, before it is."""

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from tractive_sam.cli.output import (
    Status,
    bad_input_told,
    compiling_told,
    console,
    note,
    stop,
    warnings_told,
)
from tractive_sam.cli.scene_input import SceneName, Settings, read_scene

if TYPE_CHECKING:
    from tractive_sam.run import explain as explanation


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

    A study file is explained, too: its cases, and the time and room that all of them take; and what
    a table of creep forces is to hold, or holds.
    """
    from tractive_sam.run import explain as explanation
    from tractive_sam.studies import is_study
    from tractive_sam.tables import is_design, is_table

    with bad_input_told(), warnings_told():
        if is_table(scene) or is_design(scene):
            title, sections = _table(scene, settings)
        elif is_study(scene):
            title, sections = _study(Path(scene), settings, workers)
            _tell_if_design(scene)
        else:
            asked = read_scene(scene, settings)
            with compiling_told():
                title, sections = asked.title, explanation.explain(asked)
    print_sections(title, sections)


def print_sections(title: str, sections: "Iterable[explanation.Section]") -> None:
    """Print an explanation under its title."""
    out = console()
    if title:
        out.print(title, style="bold")
    for section in sections:
        out.print(f"\n{section.title}", style="bold")
        table = Table.grid(padding=(0, 2))
        for what, answer in section.rows:
            table.add_row(f"  {what}", answer)
        out.print(table)


def _table(file: str, settings: list[str] | None):
    """A table of creep forces or its design, and what there is to say of it."""
    from tractive_sam.tables import (
        TableDesign,
        explain_design,
        explain_table,
        is_table,
        open_table,
    )  # fmt: skip

    if settings:
        raise stop(Status.INVALID, f"--set changes a scene, and {file} is of a table of forces")
    if is_table(file):
        table = open_table(file)
        return str(table.about.get("title", "")), explain_table(table)
    design = TableDesign.from_toml(file)
    return design.title, explain_design(design)


def _tell_if_design(study: str) -> None:
    """Say of a study that it could as well be a table of creep forces."""
    from tractive_sam.schema import SceneError
    from tractive_sam.tables import TableDesign

    with suppress(SceneError):
        TableDesign.from_toml(study)
        cure = "for a table of creep forces write its tolerance into the file: tolerance = 0.02"
        note(f"{study} is read as a study; {cure}")


def _study(file: Path, settings: list[str] | None, workers: int | None):
    """A study and what there is to say of it."""
    from tractive_sam.operators import cores
    from tractive_sam.studies import Study, explain_study

    if settings:
        cure = "write the setting into the file: set = [...]"
        raise stop(Status.INVALID, f"--set changes a scene, {file} is a study; {cure}")
    asked = Study.from_toml(file)
    return asked.title, explain_study(asked, workers or cores())

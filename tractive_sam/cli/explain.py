"""Commands ``explain``, ``keys`` and ``scenes``: what is modelled, every key, built-in scenes."""

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import typer
from rich import box
from rich.table import Table

import tractive_sam as ts
from tractive_sam.cli.output import (
    ExitStatus,
    console,
    invalid_exit,
    print_line,
    print_note,
    refuse,
    report_compiling,
    report_warnings,
)
from tractive_sam.cli.scene_input import (
    STANDARD_INPUT,
    Allow,
    SceneName,
    Settings,
    complete_builtin,
    complete_tables,
    read_scene,
)
from tractive_sam.description import Description


def explain(
    scene: SceneName,
    settings: Settings = None,
    allow: Allow = None,
    workers: Annotated[int | None, typer.Option(min=1, metavar="N")] = None,
    error: Annotated[float | None, typer.Option(min=1e-4, max=0.5, metavar="SHARE")] = None,
) -> None:
    """Describe what the model includes and neglects, and estimate memory and time.

    SCENE may also be a study, a fit, a spread, a design, a creep-force table, or the design of
    such a table.

    Parameters
    ----------
    workers
        Number of processes that run a study; by default, one for each core.
    error
        Also compare closed forms, simplified theories, tables and meshes for the unworn contact of
        a scene, and name the cheapest one whose relative error of forces and peak pressure is below
        this one, for example 0.02.
    """
    from tractive_sam.documents import SceneRequest, StudyRequest, find_kind

    kind = find_kind(scene)
    is_scene = scene == STANDARD_INPUT or kind is SceneRequest
    if settings and not is_scene:
        cure = "write the setting into the file"
        raise invalid_exit(f"--set changes a scene only, and {scene} is {kind.noun}; {cure}")
    with report_warnings(), report_compiling():
        content = read_scene(scene, settings) if is_scene else kind.read(scene)
        document = kind(scene, content)
        sections = document.explain(workers)
        if error is not None:
            if not isinstance(document, SceneRequest):
                raise invalid_exit(f"--error: {scene} is {kind.noun}, and levels are of a scene")
            with refuse(ts.NotConverged, status=ExitStatus.INCOMPLETE):
                levels = ts.compare_levels(document.content, max(error / 10.0, 1e-4))
            sections = Description((*sections, levels.section(error)))
        for note in document.notes() if isinstance(document, StudyRequest) else ():
            print_note(note)
    print_description(document.title, sections)


def print_description(title: str, sections: Iterable[Any]) -> None:
    """Print a title and the sections of a `Description`, each with its rows."""
    out = console()
    if title:
        out.print(title, style="bold")
    for section in sections:
        out.print(f"\n{section.title}", style="bold")
        table = Table.grid(padding=(0, 2))
        for label, text in section.rows:
            table.add_row(f"  {label}", text)
        out.print(table)


_Table = Annotated[str | None, typer.Argument(metavar="TABLE", autocompletion=complete_tables)]


def keys(table: _Table = None) -> None:
    """List every key of a scene with its meaning, unit, allowed values and default.

    Parameters
    ----------
    table
        A table, for example wear or body.A; by default, all tables.
    """
    from tractive_sam.scene import Scene
    from tractive_sam.schema import key_groups, shorten, suggest_name

    groups = list(key_groups(Scene))
    names = [name for group in groups for name in group.names if name]
    wanted = None if table is None else table.strip("[]")
    if wanted is not None and wanted not in names:
        allowed = suggest_name(wanted, names)
        raise invalid_exit(f"a scene has no table {shorten(table)}; {allowed}")
    out = console()
    for group in groups:
        inside = wanted is None or any(f"{name}.".startswith(f"{wanted}.") for name in group.names)
        if not (inside and group.keys):
            continue
        out.print(f"\n{group.headings or 'Above all tables'}", style="bold")
        out.print(group.about.split("\n\n")[0].replace("\n", " "))
        rows = Table(box=box.SIMPLE_HEAD, pad_edge=False)
        for head in ("key", "meaning, unit", "allowed", "default"):
            rows.add_column(head, overflow="fold")
        for key in group.keys:
            rows.add_row(key.name, key.meaning, key.allowed, key.default)
        out.print(rows)


_Name = Annotated[str | None, typer.Option(metavar="NAME", autocompletion=complete_builtin)]


def scenes(write: _Name = None) -> None:
    """List the built-in scenes, or write one to a file that you can edit.

    Parameters
    ----------
    write
        Write this scene to NAME.toml, with a comment on each of its keys.
    """
    from tractive_sam.output_file import write_file
    from tractive_sam.scene import Scene, builtin_names, commented_scene

    if write is not None:
        path = Path(f"{write}.toml")
        write_file(path, commented_scene(write), exclusive=True)
        print_line(path)
        return
    table = Table.grid(padding=(0, 2))
    for name in builtin_names():
        table.add_row(name, Scene.builtin(name).title)
    console().print(table)

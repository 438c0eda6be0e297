"""Commands ``explain``, ``keys`` and ``scenes``: what is modelled, every key, built-in scenes."""

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any

import typer
from rich import box
from rich.table import Table

from tractive_sam.cli.output import (
    console,
    invalid_exit,
    print_line,
    print_note,
    report_compiling,
    report_warnings,
)
from tractive_sam.cli.scene_input import (
    Allow,
    SceneName,
    Settings,
    complete_builtin,
    complete_tables,
    read_scene,
)


def explain(
    scene: SceneName,
    settings: Settings = None,
    allow: Allow = None,
    workers: Annotated[int | None, typer.Option(min=1, metavar="N")] = None,
) -> None:
    """Describe what the model includes and neglects, and estimate memory and time.

    SCENE may also be a study, a fit, a creep-force table, or the design of a table.

    Parameters
    ----------
    workers
        Number of processes that run a study; by default, one for each core.
    """
    from tractive_sam.fitting import FitDesign, explain_fit, is_fit_design
    from tractive_sam.run import explain as explanation
    from tractive_sam.studies import is_study
    from tractive_sam.tables import is_design, is_table

    with report_warnings():
        if is_table(scene) or is_design(scene):
            title, sections = _describe_table(scene, settings)
        elif is_fit_design(scene):
            _refuse_settings(scene, settings, "a fit; write the setting into its scene")
            fit = FitDesign.from_toml(scene)
            title, sections = fit.fit.title, explain_fit(fit)
        elif is_study(scene):
            title, sections = _describe_study(Path(scene), settings, workers)
            _mention_tables(scene)
        else:
            requested = read_scene(scene, settings)
            with report_compiling():
                title, sections = requested.title, explanation.explain(requested)
    print_description(title, sections)


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


def _describe_table(file: str, settings: list[str] | None) -> tuple[str, Iterable[Any]]:
    """Return title and description of a creep-force table, or of the design of one."""
    from tractive_sam import tables

    _refuse_settings(file, settings, "a table of creep forces")
    if tables.is_table(file):
        table = tables.open_table(file)
        return table.title, tables.explain_table(table)
    design = tables.TableDesign.from_toml(file)
    return design.title, tables.explain_design(design)


def _describe_study(
    file: Path, settings: list[str] | None, workers: int | None
) -> tuple[str, Iterable[Any]]:
    """Return title and description of a study: its cases, memory and time."""
    from tractive_sam.compute import cores
    from tractive_sam.studies import Study, explain_study

    _refuse_settings(file, settings, "a study; write the setting into the file: set = [...]")
    study = Study.from_toml(file)
    return study.title, explain_study(study, workers or cores())


def _refuse_settings(file: str | Path, settings: list[str] | None, kind: str) -> None:
    """End with an error if `--set` is given for a file that is not a scene."""
    if settings:
        raise invalid_exit(f"--set changes a scene only, and {file} is {kind}")


def _mention_tables(study: str) -> None:
    """Print a note if a study file could also be the design of a creep-force table."""
    from tractive_sam.schema import SceneError
    from tractive_sam.tables import TableDesign

    with suppress(SceneError):
        TableDesign.from_toml(study)
        cure = "for a table of creep forces write its tolerance into the file: tolerance = 0.02"
        print_note(f"{study} is read as a study; {cure}")


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

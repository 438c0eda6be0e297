"""``tractive-sam explain``: what will be modelled, before it is."""

from rich.table import Table

from tractive_sam.cli.output import bad_input_told, console
from tractive_sam.cli.scene_input import SceneName, Settings, read_scene


def explain(scene: SceneName, settings: Settings = None) -> None:
    """Explain what will be modelled and what is left out, and estimate memory and time."""
    from tractive_sam import explain as explanation

    with bad_input_told():
        asked = read_scene(scene, settings)
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

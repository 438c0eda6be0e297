"""``tractive-sam locus`` and ``wear``: contact points and worn profiles of wheel and rail."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

import tractive_sam as ts
from tractive_sam.cli.output import print_line, print_message, refuse, report_warnings
from tractive_sam.cli.run import Resume, run
from tractive_sam.cli.scene_input import Allow, SceneName, Settings, read_scene
from tractive_sam.cli.show import Dpi, Format, Width


def locus(
    scene: SceneName,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE.csv")],
    settings: Settings = None,
    reach: float = 6.0,
    positions: Annotated[int, typer.Option(min=3, max=2001)] = 21,
    amplitude: float = 3.0,
    format: Format = "png",
    dpi: Dpi = 200,
    width: Width = None,
) -> None:
    """Write contact points, rolling radii and conicity of a wheelset against its position.

    Parameters
    ----------
    output
        Table to write; the figures are written to the same folder.
    reach
        Largest lateral position on both sides, mm.
    positions
        Number of positions.
    amplitude
        Amplitude for the printed equivalent conicity, mm.
    format
        Format of the figures.
    """
    import numpy as np

    from tractive_sam import plot
    from tractive_sam.description import format_number
    from tractive_sam.output_file import write_table
    from tractive_sam.scene import contact_locus

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

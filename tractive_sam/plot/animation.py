"""The contact and the track it wears, moving over the stored revolutions."""

from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import matplotlib as mpl
import numpy as np
from PIL import Image

from tractive_sam import interrupt
from tractive_sam.output_file import write_file
from tractive_sam.plot.conditions import WIDE
from tractive_sam.plot.drawn import Drawn, chosen
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.frame import Frame
from tractive_sam.plot.map import BOTTOM, LEFT, RIGHT, Map, paper, placed
from tractive_sam.plot.style import BLUE, MICRON, PRESSURE, WIDTH, styled
from tractive_sam.plot.transient import SHIFTS, traction_picture
from tractive_sam.results import History

MOST = 100
"""Pictures of an animation, which are in memory together; of more revolutions some are left out."""

TRACK = 1.6
"""Width of the axes of the profile, inches."""

RESOLUTION = 110
"""Dots per inch."""


@styled
def animate(history: History, path: str | Path, rate: float = 2.0) -> Path:
    """Draw the pressure and the profile worn so far at the stored revolutions, as a moving GIF.

    Of a [transient] the traction and the edge of stick at the stored distances.

    Parameters
    ----------
    history : History
        What to draw; its fields are read one revolution after another.
    path : path-like
        Where to; a name that ends in ".gif".
    rate : float
        Revolutions shown in a second.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ValueError
        If the name has another ending, fewer than two revolutions were stored, or it is a line
        contact, of which there is no map.

    Examples
    --------
    >>> plot.animate(history, "discs.gif").name
    'discs.gif'
    """
    path = Path(path)
    if path.suffix.lower() != ".gif":
        raise ValueError(f'path: a name that ends in ".gif"; not {path.name!r}')
    WIDE.check(history)
    if len(history.saved) < 2:
        raise ValueError(
            "an animation needs at least two stored records, there is "
            f"{len(history.saved)}: list more in {history.scene.schedule.save_key}"
        )
    envelope = _envelope(history)
    frame = Frame.around(envelope, width=0.6 * WIDTH)
    beside, draw = TRACK, _picture
    if {*SHIFTS} <= {*history.columns}:  # the edge of stick moves as the bodies shift
        beside, draw = 0.0, traction_picture
    figure = paper(LEFT + frame.width + RIGHT + beside + 0.2, frame, f"{history.title}\n")
    pictures = []
    # Once saved, a figure without a layout takes that of the settings.
    unplaced = mpl.rc_context({"figure.constrained_layout.use": False})
    with unplaced:
        for state in _states(history):
            draw(figure, frame, state, envelope)
            pictures.append(_drawn(figure))
    memory, duration = BytesIO(), int(1000 / rate)
    pictures[0].save(
        memory, "gif", save_all=True, append_images=pictures[1:], duration=duration, loop=0
    )
    return write_file(path, memory.getbuffer())


def _drawn(figure: Figure) -> Image.Image:
    """Return the figure in dots."""
    memory = BytesIO()
    figure.savefig(memory, format="png", dpi=RESOLUTION)
    return Image.open(memory).convert("RGB")


def _states(history: History) -> Iterator[Drawn]:
    for at in chosen(history.saved, MOST):
        interrupt.heed()
        yield Drawn.of(history, at)


def _envelope(history: History) -> Drawn:
    """The peak contact pressure and depth that each element sees at any of the revolutions."""
    states = _states(history)
    envelope = next(states)
    for state in states:
        pressure = np.maximum(envelope.contact.pressure, state.contact.pressure)
        wear = np.maximum(envelope.contact.wear, state.contact.wear)
        contact = replace(envelope.contact, pressure=pressure, wear=wear)
        envelope = replace(envelope, contact=contact)
    return envelope


def _picture(figure: Figure, frame: Frame, state: Drawn, envelope: Drawn) -> None:
    """One picture in place of what was drawn before."""
    for axes in list(figure.axes):
        axes.remove()
    chart = Map(figure, LEFT, state, frame)
    chart.axes.set_title(state.place, loc="center")
    p = state.scale.pressure
    highest = envelope.contact.pressure.max() / p
    mesh = chart.fill(state.contact.pressure / p, cmap=PRESSURE, vmin=0.0, vmax=highest)
    chart.colour_bar(mesh, f"contact pressure {state.scale.of_pressure('p_n')}")
    track = placed(figure, LEFT + frame.width + RIGHT, BOTTOM, TRACK, frame.height)
    track.plot(MICRON * state.contact.wear[0], state.y_over_a, color=BLUE)
    track.set(
        xlim=(0.0, 1.05 * MICRON * envelope.contact.wear.max() or 1.0),
        ylim=(frame.bottom, frame.top),
    )
    track.set_xlabel(r"$w$ ($\mathrm{\mu m}$)")
    track.yaxis.set_major_locator(chart.axes.yaxis.get_major_locator())
    track.tick_params(labelleft=False)

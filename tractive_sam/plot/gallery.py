"""All figures of a history, as files."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import chain
from pathlib import Path

import numpy as np

from tractive_sam import interrupt
from tractive_sam.output_file import make_folder
from tractive_sam.plot.courses import (
    creepages,
    forces,
    stress_course,
    wear_depth,
    widths,
    worn_mass,
)
from tractive_sam.plot.drawn import Drawn
from tractive_sam.plot.duty import block_shares, wear_regimes, worn_by_block
from tractive_sam.plot.evolution import (
    pressure_over_revolutions,
    slip_over_revolutions,
    wear_over_revolutions,
)
from tractive_sam.plot.fatigue import (
    damage,
    fatigue_course,
    shakedown_map,
    utilisation,
    wear_against_fatigue,
)
from tractive_sam.plot.fields import pressure, stick_slip_map, traction, wear_map
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.heat import friction, temperature
from tractive_sam.plot.line_contact import line_pressure, line_pressures, line_slip, line_traction
from tractive_sam.plot.profiles import pressure_profiles, wear_profiles, worn_profiles
from tractive_sam.plot.scale import units as drawn_in
from tractive_sam.plot.sections import traction_sections
from tractive_sam.plot.stress import von_mises_sections
from tractive_sam.plot.transient import energies, hysteresis, stick_course, worn_track
from tractive_sam.results import PARTS, History

FORMATS = ("png", "pdf", "svg")

DPI = 200
"""Dots per inch of figures that are written."""


def save_all(
    history: History,
    directory: str | Path,
    format: str = "png",
    *,
    units: str = "hertz",
    dpi: float | None = None,
    blocks: Iterable[int | str] = (),
) -> list[Path]:
    """Draw every figure that a history has something to show in.

    Figures of one state are drawn for the first and the last stored revolution at which the bodies
    touch, which their names then end in.

    Parameters
    ----------
    history : History
        What to draw.
    directory : path-like
        Where to; made if it does not exist.
    format : str
        One of `FORMATS`.
    units : str
        "hertz", over the half widths and the pressure of Hertz; or "si-mm", in mm and MPa.
    dpi : float, optional
        Dots per inch of PNG; by default 200.
    blocks : iterable of int or str
        Blocks of a duty cycle to draw as well, by place or name: into folders block-0, ... of their
        places.

    Raises
    ------
    LookupError
        If there is no such block.

    Returns
    -------
    list of Path
        The files.

    Examples
    --------
    >>> flat = ts.roll(ts.Scene.builtin("cylinders"))
    >>> plot.save_all(flat, "figures", "svg")[0].name
    'pressure.svg'
    """
    directory = Path(directory)
    chosen = {history.place_of(block): history.block(block) for block in blocks}
    make_folder(directory)
    paths = []
    with drawn_in(units):
        for name, figure in chain(_all(history), _of_blocks(chosen)):
            interrupt.heed()
            paths.append(directory / f"{name}.{format}")
            make_folder(paths[-1].parent)
            figure.savefig(paths[-1], dpi=dpi or DPI)
    return paths


def _all(history: History) -> Iterator[tuple[str, Figure]]:
    """Names of figures, and the figures."""
    if history.scene.duty:
        yield from _of_cycle(history)
        return
    yield from _figures(history)
    if len(history) == 1 and history.scene.gap is not None:
        yield "profiles", worn_profiles(history)
    yield from _of_fatigue(history)
    wear = None if "wear" in history.law_records else history.scene.wear
    if wear is not None and not wear.together and np.any(history["wear_profile"]):
        yield "wear-regimes", wear_regimes(history)


def _figures(history: History) -> Iterator[tuple[str, Figure]]:
    """Names of figures, and the figures."""
    stored = history.saved.tolist()
    ends = _ends(history)
    for at in ends:
        ending = f"-{at:{history.coordinate.format}}" if len(history) > 1 else ""
        state = Drawn.of(history, at)
        for name, draw in _of_state(state).items():
            yield name + ending, draw(state)
        for plane, bodies in _planes(history).items():
            name = f"von-mises-{plane.replace('=', '')}{ending}"
            yield name, von_mises_sections(history, plane, bodies, at)
    transient = history.scene.transient is not None
    if len(history) > 1:
        for name, draw in (_TRANSIENTS if transient else _COURSES).items():
            yield name, draw(history)
        if "worn_volume" in history.columns and np.isfinite(history["worn_volume"]).any():
            yield "worn-mass", worn_mass(history)
        if np.isfinite(history.values.get("creepage_found", np.nan)).any():
            yield "creepages", creepages(history)
        if history.bodies:
            yield history.of_role("stress_max").name.replace("_", "-"), stress_course(history)
    if len(stored) > 1 and ends:
        evolutions = _LINE_EVOLUTIONS if history.line else _EVOLUTIONS
        for name, draw in (_MOVING if transient and not history.line else evolutions).items():
            yield name, draw(history)
        if not (history.line or transient) and np.any(history["wear_profile"]):
            yield "worn-profiles", worn_profiles(history)
    if transient and history.scene.wear is not None:
        yield from _of_moving_wear(history)


def _ends(history: History) -> list[float]:
    """The first and the last stored place at which the bodies touch; of one contact its own."""
    stored = history.saved.tolist()
    if len(history) == 1:
        return stored  # without contact its figures tell that there is nothing to draw

    def touch(at: float) -> bool:
        return bool(history.field("pressure", at).any())

    found = (next(filter(touch, one), None) for one in (stored, stored[::-1]))
    return [*dict.fromkeys(at for at in found if at is not None)]


def _of_moving_wear(history: History) -> Iterator[tuple[str, Figure]]:
    """Figures of what a transient wears."""
    if not np.any(history["wear_max"]):
        return
    yield "wear-depth", wear_depth(history)
    if history.scene.transient.rolls:
        yield "worn-track", worn_track(history)
    if len(history.saved) > 1 and not history.line:
        yield "wear-profiles", wear_profiles(history)
        if _ends(history):
            yield "wear-over-distance", wear_over_revolutions(history)


def _of_fatigue(history: History) -> Iterator[tuple[str, Figure]]:
    """Figures of what rolling does to the material."""
    if "shakedown_lower" in history.columns:
        yield "shakedown-map", shakedown_map(history)
    if history.scene.fatigue is not None and len(history) > 1:
        yield "fatigue-course", fatigue_course(history)
    for body in history.cycles if "damage" in history.columns else ():
        yield f"utilisation-{body}", utilisation(history, body)
        if history.fatigue(body).damage_max[0] > 0.0:
            yield f"damage-{body}", damage(history, body)
        if history.scene.wear is not None and not history.line:
            yield f"wear-against-fatigue-{body}", wear_against_fatigue(history, body)


def _of_cycle(history: History) -> Iterator[tuple[str, Figure]]:
    """Those of a duty cycle."""
    wears = bool(np.any(history[PARTS.name]))
    for name, draw in _CYCLES.items() if wears else ():
        yield name, draw(history)
    if len(history) > 1 and np.isfinite(history["worn_volume"]).any():
        yield "worn-mass", worn_mass(history)
    yield from _of_fatigue(history)


def _of_blocks(blocks: Mapping[int, History]) -> Iterator[tuple[str, Figure]]:
    """Those of blocks of a duty cycle, in folders of their own."""
    for k, block in blocks.items():
        for name, figure in _figures(block):
            if name not in _OF_BODIES:
                yield f"block-{k}/{name}", figure


def _planes(history: History) -> dict[str, tuple[str, ...]]:
    """Planes whose stress was kept, each with its bodies."""
    planes: dict[str, tuple[str, ...]] = {}
    for body, plane in history.planes:
        # Below a line contact, stress is the same all along y: other planes are only lines.
        if not history.line or plane.startswith("y"):
            planes[plane] = (*planes.get(plane, ()), body)
    return planes


_CYCLES = {
    "worn-by-block": worn_by_block,
    "block-shares": block_shares,
    "wear-regimes": wear_regimes,
    "wear-profiles": wear_profiles,
    "worn-profiles": worn_profiles,
    "wear-depth": wear_depth,
}

_OF_BODIES = ("worn-mass", "wear-profiles", "worn-profiles", "wear-depth")
"""Figures that are the same of all blocks."""

_COURSES = {"forces": forces, "widths": widths, "wear-depth": wear_depth}

_TRANSIENTS = {
    "forces": forces,
    "widths": widths,
    "stick": stick_course,
    "hysteresis": hysteresis,
    "energies": energies,
}

_EVOLUTIONS = {
    "wear-profiles": wear_profiles,
    "pressure-profiles": pressure_profiles,
    "pressure-over-revolutions": pressure_over_revolutions,
    "slip-over-revolutions": slip_over_revolutions,
    "wear-over-revolutions": wear_over_revolutions,
}

_MOVING = {
    "pressure-profiles": pressure_profiles,
    "pressure-over-distance": pressure_over_revolutions,
    "slip-over-distance": slip_over_revolutions,
}

_LINE_EVOLUTIONS = {"pressure-profiles": line_pressures}


def _of_state(state: Drawn) -> dict[str, Callable[[Drawn], Figure]]:
    """Names and functions of the figures of a state that would not be empty."""
    warm = {}
    if state.contact.friction_varies:
        warm = {"friction": friction}
    if state.contact.heat is not None:
        warm |= {"temperature": temperature}
    if state.line:
        figures = {"pressure": line_pressure}
        if np.any(state.contact.traction):
            figures |= {"traction": line_traction, "slip": line_slip}
        return figures | warm
    figures = {"pressure": pressure}
    if np.any(state.contact.traction):
        figures |= {"traction": traction, "traction-sections": traction_sections}
        figures |= {"stick-slip": stick_slip_map}
    if np.any(state.contact.wear):
        figures |= {"wear": wear_map}
    return figures | warm

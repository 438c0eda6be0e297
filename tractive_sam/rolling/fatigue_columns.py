"""Columns of a record with the fatigue, the shakedown and the life of both bodies."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.mechanics import VolumeLife, Woehler
from tractive_sam.results import BodyFatigue
from tractive_sam.rolling.body_damage import BodyDamage
from tractive_sam.scene import Fatigue, Scene
from tractive_sam.schema import required

AT_TOP = 0.9
"""`VolumeLife.surface_density_ratio` above which the life of a volume depends on the mesh."""


def fatigue_columns(bodies: Mapping[str, BodyDamage], model: Model) -> dict[str, Any]:
    """Return all fatigue columns of a record, values by name and body."""
    life, shares = model.laws.life, model.weights
    columns = cycle_columns({body: part.fatigue for body, part in bodies.items()})
    if model.laws.volume is not None:
        columns |= _volume_columns(bodies, model, model.laws.volume)
    for body, part in bodies.items():
        for name, value in part.columns(life, shares).items():
            if name == "balancing_wear":
                columns[f"{name}_{body}"] = value
            else:
                columns.setdefault(name, {})[body] = value
    return columns


def cycle_columns(cycles: Mapping[str, BodyFatigue]) -> dict[str, Any]:
    """Return the columns of utilisation and shakedown, values by name and body."""
    residual = {body: cycle.largest("residual_shear") for body, cycle in cycles.items()}

    def factors(name: str) -> dict[str, float]:
        return {k: cycle.load_factor(getattr(residual[k], name)) for k, cycle in cycles.items()}

    return utilisation_columns(cycles) | {
        "shakedown_lower": factors("value"),
        "shakedown_interior": factors("interior"),
        "shakedown_surface": factors("surface"),
        "shakedown_lower_at": {body: maximum.at for body, maximum in residual.items()},
        "shakedown_upper": {body: cycle.shakedown_upper for body, cycle in cycles.items()},
    }


def shakedown_remark(cycles: Mapping[str, BodyFatigue]) -> str:
    """Return a remark on bodies loaded above the shakedown limit; empty if there are none."""
    factors = {body: cycle.shakedown_lower for body, cycle in cycles.items()}
    above = [f"{body} {factor:.2f}" for body, factor in factors.items() if factor < 1.0]
    if not above:
        return ""
    return (
        f"; stress is above the shakedown limit (load factor of body {', of '.join(above)}): the "
        "material yields, and this elastic stress is not its stress"
    )


def _volume_columns(
    bodies: Mapping[str, BodyDamage], model: Model, law: VolumeLife
) -> dict[str, Any]:
    """Return the columns of stressed volume and its life; blocks add up by Miner's rule."""
    survival = required(_table(model.scene).volume, "fatigue.volume").survival
    columns: dict[str, Any] = {"stressed_volume": {}, "volume_life": {}}
    for body, part in bodies.items():
        volumes = [
            stressed_volume(replace(part.fatigue, utilisation=used), model.scene, law)
            for used in part.utilisation
        ]
        lives = [law.life(volume, survival) for volume in volumes]
        used = sum(share / each for share, each in zip(model.weights, lives, strict=True))
        columns["stressed_volume"][body] = float(np.dot(model.weights, volumes))
        life = 1.0 / (used * (part.passes or 1.0)) if used else math.inf
        columns["volume_life"][body] = life
    return columns | {"volume_at_top": surface_density_ratios(bodies, model, law)}


def stressed_volume(cycle: BodyFatigue, scene: Scene, law: VolumeLife) -> float:
    """Return the integral of stress over a body's volume; of a flat one, over 1 mm of track."""
    radius = getattr(scene.body, cycle.body).radius_x
    around = 2.0 * math.pi * abs(radius) if math.isfinite(radius) else 1.0
    limit = required(_table(scene).limit, "fatigue.limit")
    return law.volume(cycle.y, cycle.depth, cycle.utilisation * limit, around)


def volume_error_bars(
    columns: Mapping[str, Any], bars: Mapping[str, float], law: VolumeLife
) -> dict[str, dict[str, float]]:
    """Return the error bars of `stressed_volume` and `volume_life` due to the mesh, by body.

    If the integral depends on the mesh, its error bar is infinite.
    """
    errors: dict[str, dict[str, float]] = {"stressed_volume": {}, "volume_life": {}}
    for body, volume in columns["stressed_volume"].items():
        bar = math.inf if columns["volume_at_top"][body] > AT_TOP else bars.get(body, math.nan)
        errors["stressed_volume"][body] = bar
        if volume > 0.0:
            smallest = 1.0 - bar / volume
            longer = math.inf if smallest <= 0.0 else smallest ** (-1.0 / law.slope) - 1.0
            errors["volume_life"][body] = columns["volume_life"][body] * longer
    return errors


def life_error_bars(columns: Mapping[str, Any], bars: Mapping[str, float], life: Woehler) -> dict:
    """Return the error bars of `fatigue_life` by body, from those of the utilisation.

    They are the increase of the life for the smallest utilisation; for the largest it changes less.
    """
    errors = {}
    for body, used in columns["utilisation"].items():
        low, here = life.damage(np.array([used - bars[body], used]))
        if here > 0.0 and not math.isnan(bars[body]):
            longer = here / low - 1.0 if low > 0.0 else math.inf
            errors[body] = columns["fatigue_life"][body] * longer
    return errors


def utilisation_columns(cycles: Mapping[str, BodyFatigue]) -> dict[str, Any]:
    """Return the columns of largest utilisation: of all, interior, surface; and its position."""
    maxima = {body: cycle.largest() for body, cycle in cycles.items()}
    return {
        "utilisation": {body: maximum.value for body, maximum in maxima.items()},
        "utilisation_interior": {body: maximum.interior for body, maximum in maxima.items()},
        "utilisation_surface": {body: maximum.surface for body, maximum in maxima.items()},
        "utilisation_at": {body: maximum.at for body, maximum in maxima.items()},
    }


def surface_density_ratios(
    bodies: Mapping[str, BodyDamage], model: Model, law: VolumeLife
) -> dict[str, float]:
    """Return each body's largest density of the stressed volume at the top over its maximum."""
    limit = required(_table(model.scene).limit, "fatigue.limit")
    return {
        body: max(
            law.surface_density_ratio(damage.fatigue.depth, used * limit)
            for used in damage.utilisation
        )
        for body, damage in bodies.items()
    }


def _table(scene: Scene) -> Fatigue:
    """Return the table [fatigue] of a scene."""
    return required(scene.fatigue, "fatigue")

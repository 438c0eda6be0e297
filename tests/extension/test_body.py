"""A kind of body of another package: its response to waves, its table, and one row for it."""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.mechanics import SurfaceResponse, pair
from tractive_sam.scene.layers import BodyPart
from tractive_sam.schema import InnerTable, entry, optional

STEEL = ts.Material.from_young(208e3, 0.3)
COATED = ts.LayeredBody((ts.Layer(0.05, ts.Material.from_young(20e3, 0.35)),), STEEL)
WAVES = tuple(np.geomspace(1e-2, 1e3, 200))


@dataclass(frozen=True)
class MeasuredBody(SurfaceResponse):
    """Half-space whose response was measured at some waves; between them it is smooth."""

    waves: tuple[float, ...]
    values: tuple[tuple[float, ...], ...]  # k S_zz, S_LL, S_TT and S_Lz at the waves, 1/MPa

    @property
    def compliances(self):
        return np.array(self.values)[:, -1]

    @cached_property
    def images(self):
        heights = 2.0 / np.array(self.waves[::4])
        fall = np.exp(-np.outer(self.waves, heights))
        change = np.array(self.values) - self.compliances[:, None]
        return heights, np.linalg.lstsq(fall, change.T, rcond=1e-14)[0].T


class Measured(BodyPart):
    """Response of the surface of a body, measured at some waves."""

    waves: tuple[float, ...] = entry("wave numbers, 1/mm")
    values: tuple[tuple[float, ...], ...] = entry("k S_zz, S_LL, S_TT and S_Lz, 1/MPa")
    excludes = BodyPart.excludes | {"subsurface": "the stress below the surface is not measured"}

    @classmethod
    def change(cls, parts, body):
        return MeasuredBody(parts[0].waves, parts[0].values) if parts else body

    @classmethod
    def describe_part(cls, parts, body):
        yield from (("response", f"measured at {len(part.waves)} waves") for part in parts)


class Body(ts.Body):
    """Body that may have a measured response."""

    measured: InnerTable[Measured | None] = optional("measured response")
    parts: ClassVar = {"measured": Measured, **ts.Body.parts}


class Bodies(ts.Bodies):
    """Two of them."""

    A: InnerTable[Body] = entry("the upper body")
    B: InnerTable[Body] = entry("the lower body")


class Scene(ts.Scene):
    """Scene with such bodies."""

    body: InnerTable[Bodies] = entry("the two bodies")


def scene_of(kind, load=None, **changes):
    ball = {"young": 208e3, "poisson": 0.3, "radius_x": 10.0, "radius_y": 10.0}
    return kind(
        body={"A": ball | changes, "B": ball},
        load={"normal": 20.0} if load is None else load,
        creepage={"longitudinal": 2e-3, "speed": 100.0},
        friction={"mu": 0.3},
        grid={"elements": (31, 31)},
    )


def measured():
    values = tuple(map(tuple, COATED.response(np.array(WAVES)).tolist()))
    return {"waves": WAVES, "values": values}


def test_contact_of_a_measured_response_is_that_of_the_coating():
    """The measured body is a steel ball with a coating, whose response has a closed form."""
    coating = {"thickness": 0.05, "young": 20e3, "poisson": 0.35}
    by_layer = ts.solve(scene_of(ts.Scene, layer=[coating]))
    scene = scene_of(Scene, measured=measured())
    contact = ts.solve(scene)
    for name in ("Qx", "approach", "p_max"):
        # Exponentials fit the response to 1e-5.
        assert getattr(contact, name) == pytest.approx(getattr(by_layer, name), rel=1e-4)
    # The mesh follows from the contact that both estimate.
    assert contact.grid.half_length == pytest.approx(by_layer.grid.half_length, rel=1e-4)
    assert Scene.from_toml_text(scene.to_toml()) == scene
    assert "measured at 200 waves" in str(ts.explain(scene))


def test_a_measured_body_combines_with_parts_of_this_package():
    """Its response in rolling is the measured one times the factor of its memory."""
    terms = [{"ratio": 1.0, "time": 1e-3}]
    scene = scene_of(Scene, measured=measured(), relaxation=terms)
    law = ts.Laws.of(scene).elasticity
    assert isinstance(law, ts.RelaxingHalfSpaces)
    stiff = pair(scene.body.A.response.body, STEEL).contact_modulus(0.1)
    assert pair(scene.body.A.response, STEEL).contact_modulus(0.1) < stiff
    assert ts.solve(scene).My > 0.0


@pytest.mark.parametrize(
    ("key", "changes"),
    [
        ("subsurface: given with body.A.measured", {"subsurface": {"planes": ["y=0"]}}),
        ("elasticity.law: given with body.A.measured", {"elasticity": {"law": "film:Law"}}),
        ("body.A.measured.waves", {"body.A.measured": {"values": ((1.0,),) * 4}}),
    ],
)
def test_what_it_excludes_is_reported(key, changes):
    with pytest.raises(ts.SceneError) as error:
        scene_of(Scene, measured=measured()).replace(**changes)
    assert key in str(error.value)

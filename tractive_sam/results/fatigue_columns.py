"""The columns of the fatigue of each body: shakedown, utilisation, damage and life."""

import math
from functools import partial
from typing import Any

import numpy as np

from tractive_sam.results.quantity import Quantity
from tractive_sam.results.state import State
from tractive_sam.scene import Scene
from tractive_sam.schema import required


def _bars_of_damage(contact: State) -> Any:
    """Return the error bars of the damage of a contact, by body; empty if there are none."""
    return contact.error_bars.get("damage", {})


def _has_fatigue(body: str, scene: Scene) -> bool:
    """Return whether [fatigue] of a scene covers a body."""
    return body in required(scene.fatigue, "fatigue").bodies


def _surface_fatigue_index(contact: State) -> float:
    """Return the surface fatigue index: the largest |p_t|/p_n - k/p_n in contact; nan without."""
    k = required(contact.scene.fatigue, "fatigue").shear_yield_stress
    touching = contact.touching
    if not touching.any():
        return math.nan
    shear = np.hypot(*contact.traction[:, touching]) - k
    return float((shear / contact.pressure[touching]).max())


_of_bodies = partial(Quantity, dims=("body",), bodies_of="fatigue")
_fatigue = partial(_of_bodies, needs=("fatigue.limit",))
_volume = partial(_of_bodies, needs=("fatigue.volume",))
_shakedown = partial(_of_bodies, needs=("fatigue.shear_yield_stress",))
_position = partial(_fatigue, dims=("body", "position"))

# fmt: off
FATIGUE_COLUMNS = (
    _shakedown("shakedown_lower", "1", "load factor up to which elastic shakedown is certain",
               symbol=r"\lambda_-", format=".3f", over_blocks="smallest"),
    _shakedown("shakedown_upper", "1", "load factor from which elastic shakedown is impossible",
               symbol=r"\lambda_+", format=".3f", over_blocks="smallest"),
    _shakedown("shakedown_interior", "1", "load factor up to which elastic shakedown is certain "
                                          "inside the body",
               format=".3f", over_blocks="smallest"),
    _shakedown("shakedown_surface", "1", "load factor up to which elastic shakedown is certain "
                                         "at the surface",
               format=".3f", over_blocks="smallest"),
    _shakedown("shakedown_lower_at", "mm",
               "position (x is nan, y, depth) that determines shakedown_lower",
               dims=("body", "position"), place_of="shakedown_lower"),
    Quantity("fi_surf", "1", "surface fatigue index, the largest |p_t|/p_n - k/p_n",
             _surface_fatigue_index, symbol=r"FI_\mathrm{surf}", format=".4f",
             needs=("fatigue.shear_yield_stress", "friction"), over_blocks="largest"),
    _fatigue("utilisation", "1", "largest ratio of the equivalent stress of the cycle to its limit",
             symbol="u", format=".3f", over_blocks="largest"),
    _fatigue("utilisation_interior", "1", "largest utilisation inside the body",
             format=".3f", over_blocks="largest"),
    _fatigue("utilisation_surface", "1", "largest utilisation at the surface",
             format=".3f", over_blocks="largest"),
    _position("utilisation_at", "mm", "position of the largest utilisation (x only in a "
                                      "transient, y, depth)", place_of="utilisation"),
    _fatigue("damage", "1", "largest damage of the remaining material; at 1 a crack starts",
             symbol="D", format=".3g"),
    _position("damage_at", "mm", "position of the largest damage (x only in a transient, y, "
                                 "depth below the unworn surface)", place_of="damage"),
    _fatigue("damage_error", "1", "error of the damage due to the length of jumps, the order of "
                                  "blocks and the points of stress paths; with [accuracy], also "
                                  "due to the mesh", _bars_of_damage,
             format=".1g", error_of="damage"),
    _fatigue("initiation", "1", "revolution at which the damage reached 1", format=".4g"),
    _fatigue("fatigue_life", "1", "revolutions, or repetitions of a transient, until a crack "
                                  "starts under the stress of this record, without wear",
             format=".4g"),
    _fatigue("wear_margin", "1", "smallest ratio across the track of the wear to the wear that "
                                 "balances fatigue; below 1, cracks start; nan without wear",
             format=".3g"),
    _volume("stressed_volume", "1", "integral of the stress over the volume, in N and mm with "
                                    "the exponents of fatigue.volume; for a flat body, over 1 "
                                    "mm of track", format=".4g"),
    _of_bodies("volume_life", "1", "revolutions that the complete volume survives under the "
                                   "stress of this record, with the probability "
                                   "fatigue.volume.survival", format=".4g",
               needs=("fatigue.volume.constant",)),
    _volume("volume_at_top", "1", "integrand at a depth of one element divided by its largest "
                                  "value; near 1, the volume grows as the mesh is refined",
            format=".2g"),
    Quantity("balancing_wear_A", "mm", "wear of body A per revolution that balances fatigue",
             dims=("y",), needs=("fatigue.limit",), when=partial(_has_fatigue, "A")),
    Quantity("balancing_wear_B", "mm", "wear of body B per revolution that balances fatigue",
             dims=("y",), needs=("fatigue.limit",), when=partial(_has_fatigue, "B")),
)
# fmt: on

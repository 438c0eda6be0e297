"""Worn profiles of a wheel and a rail."""

from os import PathLike
from typing import Any

from tractive_sam.results import WornProfiles
from tractive_sam.run.pipeline import roll
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError


def wear_profiles(
    scene: Scene, path: str | PathLike[str] | None = None, **options: Any
) -> WornProfiles:
    """Roll a wheel on a rail with wear; return the worn profiles, raise if the roll failed.

    Material is removed along the normals of both profiles, without any smoothing. Each block of
    [[duty]] is a position of the wheelset with its share in the revolutions.

    Parameters
    ----------
    scene : Scene
        Scene with [wheel], [rail], [wheelset] and [wear].
    path : path-like, optional
        Results file, as for `roll`.
    **options
        Other arguments of `roll`.

    Raises
    ------
    SceneError
        If the scene has no wheel or no wear, or worn profiles have no contact.
    RuntimeError
        If a contact is not solved; the message of the history.

    Examples
    --------
    >>> scene = ts.Scene.builtin("wheel-wear").with_set(["wear.revolutions=1000"])
    >>> worn = ts.wear_profiles(scene)
    >>> round(float(worn.revolutions[-1]))
    1000
    """
    require_wear(scene)
    history = roll(scene, path, **options)
    if not history.finished:
        raise RuntimeError(history.message)
    return WornProfiles.from_history(history)


def require_wear(scene: Scene) -> None:
    """Raise a SceneError unless a scene has [wheelset] and [wear]."""
    for name in ("wheelset", "wear"):
        if getattr(scene, name) is None:
            raise SceneError([Fault(name, "nothing", f"a [{name}] table, to wear profiles")])

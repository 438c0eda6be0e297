"""Keys of a scene that exclude each other."""

_ALTERNATIVES: tuple[tuple[tuple[str, ...], ...], ...] = (
    (("body.A.young",), ("body.A.shear",)),
    (("body.B.young",), ("body.B.shear",)),
    (("load.normal",), ("load.approach",), ("load.pressure",)),
    (("load.force_x",), ("creepage.longitudinal",)),
    (("load.force_y",), ("creepage.lateral",)),
    (("friction.mu",), ("friction.static",)),
    (("friction.kinetic", "friction.half_speed"), ("friction.A", "friction.B")),
    (("gap.file",), ("gap.x", "gap.y", "gap.separation")),
    (("fatigue.shear_yield",), ("fatigue.yield_strength",)),
    (("wear.intensity",), ("wear.coefficient", "wear.coefficient.A", "wear.coefficient.B")),
    (
        ("accuracy", "accuracy.tolerance", "accuracy.elements"),
        ("grid", "grid.half_length", "grid.elements"),
    ),
)
"""Groups of keys: a key of one group of a line excludes all keys of the other groups."""


def excluded_keys(key: str) -> tuple[str, ...]:
    """Return the keys that a scene cannot have beside a key, as they are alternatives to it."""
    excluded = tuple(
        alternative
        for groups in _ALTERNATIVES
        if any(key in group for group in groups)
        for group in groups
        if key not in group
        for alternative in group
    )
    if key in ("wear.coefficient.A", "wear.coefficient.B"):  # they give the shares in the wear
        return (*excluded, "body.A.hardness", "body.B.hardness")
    return excluded

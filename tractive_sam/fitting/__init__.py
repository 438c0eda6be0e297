"""Fits of coefficients to measurements: friction, layer, wear, or any number of a scene.

    [fit]
    scene = "rig.toml"
    free = ["friction.mu", "friction.layer"]

    [[fit.data]]
    file = "creep.csv"                   # columns creepage.longitudinal and Qx_over_P
    vary = "creepage.longitudinal"
    observe = "Qx_over_P"
    noise = 0.05                         # relative

Weighted nonlinear least squares, on meshes and steps that are fixed while parameters vary.
Derivatives of contacts are exact if `State.jacobian` has them, others are forward differences.
"""

from tractive_sam.lazy_names import attach_names

# Names, listed in __init__.pyi, are looked up when first used: reading a result computes nothing.
__getattr__, __dir__, __all__ = attach_names(__name__, __file__)

"""Free rolling of cylinders of unlike materials, in the limit of little friction."""

from tractive_sam.mechanics import CombinedMaterial


# Slip changes sign at the pressure p0 cos t; half of the load lies between these two points if 2t +
# sin 2t = pi/2. This is cos(t) / 2 at its root, 0.457 in the literature.
def bentall_johnson_creepage(material: CombinedMaterial, a: float, radius: float) -> float:
    """Return the creepage of free rolling dissimilar cylinders, mu -> 0: -0.457 kappa a / R.

    With kappa = 2 K / (1 - nu). Source: Bentall & Johnson, Int. J. Mech. Sci. 9 (1967) 389, in
    the closed form that the limit allows: with vanishing tractions the slip is
    s_x/V = xi_x + (2 K / G) p_n, and the friction forces of the forward- and backward-slipping
    parts cancel. Negative if the upper body A is the more compliant one, K > 0.

    Parameters
    ----------
    material : CombinedMaterial
        The pair of bodies.
    a : float
        Half-width of the contact, mm.
    radius : float
        Combined radius R, 1/R = 1/R_A + 1/R_B, mm.

    Examples
    --------
    >>> steel, aluminium = Material(82e3, 0.28), Material(23e3, 0.31)
    >>> round(bentall_johnson_creepage(combine(aluminium, steel), a=0.1, radius=25.0), 7)
    -0.0005263
    """
    share = 0.45738550878651788
    kappa = 2 * material.coupling / (1 - material.poisson)
    return -share * kappa * a / radius

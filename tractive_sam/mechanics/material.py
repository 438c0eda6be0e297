"""Elastic constants of one body, and of two bodies seen as one half-space."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Material:
    """Linear elastic, isotropic material of one body.

    Parameters
    ----------
    shear : float
        Shear modulus G, MPa; positive.
    poisson : float
        Poisson's ratio, above -1 and at most 0.5.

    Raises
    ------
    ValueError
        If a constant lies outside its range.

    Examples
    --------
    >>> ts.Material.from_young(208e3, 0.3).shear
    80000.0
    """

    shear: float
    poisson: float

    def __post_init__(self) -> None:
        if not self.shear > 0:
            raise ValueError(f"the shear modulus must be above 0, not {self.shear}")
        if not -1 < self.poisson <= 0.5:
            raise ValueError(f"Poisson's ratio must lie in (-1, 0.5], not {self.poisson}")

    @classmethod
    def from_young(cls, young: float, poisson: float) -> Material:
        """Return a material from Young's modulus, MPa, and Poisson's ratio.

        Parameters
        ----------
        young : float
            Young's modulus, MPa.
        poisson : float
            Poisson's ratio.
        """
        return cls(young / (2 * (1 + poisson)), poisson)

    @property
    def young(self) -> float:
        """Young's modulus E = 2 G (1 + nu), MPa."""
        return 2 * self.shear * (1 + self.poisson)


@dataclass(frozen=True)
class CombinedMaterial:
    """Elastic constants of one half-space that is equivalent to the pair of bodies (eq. 45).

    Parameters
    ----------
    shear : float
        Combined shear modulus G, MPa.
    poisson : float
        Combined Poisson's ratio nu.
    coupling : float
        K, which couples the normal to the tangential problem; 0 for equal materials, positive if
        the upper body A is the more compliant one.

    Examples
    --------
    >>> steel, aluminium = Material.from_young(208e3, 0.3), Material.from_young(70e3, 0.33)
    >>> combine(aluminium, steel).coupling > 0.0
    True
    """

    shear: float
    poisson: float
    coupling: float

    @property
    def plane_strain_modulus(self) -> float:
        """Contact modulus E* = G / (1 - nu), MPa."""
        return self.shear / (1 - self.poisson)

    @property
    def E_star(self) -> float:
        """Contact modulus E* = G / (1 - nu), MPa, as `plane_strain_modulus`."""
        return self.plane_strain_modulus


def combine(A: Material, B: Material) -> CombinedMaterial:
    """Return the elastic constants of the pair of the upper body A and the lower body B.

    Source: Juliá & Rodríguez-Tembleque, Int. J. Mech. Sci. 294 (2025) 110195, eq. (45). One of
    the two bodies may be rigid, ``shear=math.inf``.

    Raises
    ------
    ValueError
        If both bodies are rigid.

    Examples
    --------
    >>> steel = Material.from_young(208e3, 0.3)
    >>> round(combine(steel, steel).E_star)
    114286
    """
    compliance = (1 / A.shear + 1 / B.shear) / 2
    if compliance == 0:
        raise ValueError("at least one of the two bodies must be elastic")
    lateral = (A.poisson / A.shear + B.poisson / B.shear) / 2
    mismatch = ((1 - 2 * A.poisson) / A.shear - (1 - 2 * B.poisson) / B.shear) / 4
    return CombinedMaterial(1 / compliance, lateral / compliance, mismatch / compliance)

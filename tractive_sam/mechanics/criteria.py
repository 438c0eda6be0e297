"""Criteria: one number for a state of stress, or for a stress cycle."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tractive_sam.mechanics.law import Law


def von_mises(stress: ArrayLike) -> NDArray[np.float64]:
    """Return the equivalent stress of von Mises, in the unit of the stress.

    Parameters
    ----------
    stress : array_like, shape (6, ...)
        Components xx, yy, zz, xy, xz, yz.

    Examples
    --------
    >>> float(von_mises([100.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    100.0
    """
    xx, yy, zz, xy, xz, yz = np.asarray(stress, float)
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.sqrt(0.5 * normal + 3.0 * (xy**2 + xz**2 + yz**2))


def principal_stresses(stress: ArrayLike) -> NDArray[np.float64]:
    """Return the principal stresses, the largest (most tensile) first, shape (3, ...).

    Parameters
    ----------
    stress : array_like, shape (6, ...)
        Components xx, yy, zz, xy, xz, yz.

    Examples
    --------
    >>> principal_stresses([100.0, 0.0, -50.0, 0.0, 0.0, 0.0])
    array([100.,   0., -50.])
    """
    tensor = np.moveaxis(
        np.asarray(stress, float)[[[0, 3, 4], [3, 1, 5], [4, 5, 2]]], (0, 1), (-2, -1)
    )
    return np.moveaxis(np.linalg.eigvalsh(tensor), -1, 0)[::-1]


def max_shear(stress: ArrayLike) -> NDArray[np.float64]:
    """Return the largest shear stress (Tresca), half the difference of the extreme principal ones.

    Parameters
    ----------
    stress : array_like, shape (6, ...)
        Components xx, yy, zz, xy, xz, yz.

    Examples
    --------
    >>> float(max_shear([100.0, 0.0, -50.0, 0.0, 0.0, 0.0]))
    75.0
    """
    largest, _, smallest = principal_stresses(stress)
    return 0.5 * (largest - smallest)


class Criterion(Law, ABC):
    """Base class of criteria for stresses or cycles; a subclass adds name, symbol, long name."""

    name: str
    symbol: str
    long_name: str


class StressCriterion(Criterion):
    r"""Base class of equivalent stresses: a number from stresses xx, yy, zz, xy, xz, yz.

    Attributes
    ----------
    name : str
        Name in columns: the largest value in a body is ``<name>_max``.
    symbol : str
        Symbol for math text in figures.
    long_name : str
        Description for people.
    unit : str
        Unit.

    Examples
    --------
    >>> class Tresca(ts.StressCriterion):
    ...     name, symbol = "tresca", r"\sigma_\mathrm{T}"
    ...     long_name = "equivalent stress of Tresca"
    ...
    ...     def __call__(self, stress):
    ...         return 2.0 * reference.max_shear(stress)
    >>> laws = ts.Laws.of(scene).replace(criterion=Tresca())
    >>> worse = ts.stress_maximum(contact, "A", laws)
    >>> 1.0 <= worse.interior / ts.stress_maximum(contact, "A").interior <= 2.0 / 3.0**0.5
    True
    """

    unit: str = "MPa"

    @abstractmethod
    def __call__(self, stress: np.ndarray) -> np.ndarray:
        """Return the equivalent stress of stresses (6, ...), MPa.

        Parameters
        ----------
        stress : ndarray, shape (6, ...)
            Components xx, yy, zz, xy, xz, yz, MPa.

        Returns
        -------
        ndarray, shape (...)
            At least 0.
        """

    def at(
        self, stress: np.ndarray, body: np.ndarray, y: np.ndarray, depth: ArrayLike
    ) -> np.ndarray:
        """Return the equivalent stress of stresses (6, ...) at places in bodies, MPa.

        It does not depend on the place, unless residual stress does
        (`subsurface.sources.StressWithResidual`).

        Parameters
        ----------
        stress : ndarray, shape (6, ...)
            As in `__call__`.
        body : ndarray of int
            Numbers of the bodies; it broadcasts with the stresses, as do the next two.
        y, depth : ndarray
            Position, mm.
        """
        return self(stress)


class CycleCriterion(Criterion):
    """Base class of criteria of a cycle: an equivalent amplitude, compared with a fatigue limit.

    Attributes
    ----------
    name : str
        Name in ``fatigue.criterion`` of a scene.
    symbol : str
        Symbol for math text in figures.
    long_name : str
        Description for people.
    path_error : float
        Largest relative error from the finite number of points of a path; part of the error bars
        of utilisation, life and damage, without influence on jumps. Longer and denser paths change
        a maximum by up to 1e-3.

    Examples
    --------
    >>> class Range(ts.CycleCriterion):
    ...     name, long_name = "range", "half the range of xx"
    ...
    ...     def __call__(self, cycle):
    ...         return 0.5 * np.ptp(cycle[0], axis=0)
    >>> tired = scene.replace(fatigue={"limit": 200.0, "sensitivity": 0.3, "bodies": ["A"]})
    >>> laws = ts.Laws.of(tired).replace(fatigue=Range())
    >>> ts.fatigue(ts.solve(tired), laws=laws)["A"].utilisation_max > 0.0
    True
    """

    symbol = r"\tau_\mathrm{eq}"
    path_error = 1e-3

    @abstractmethod
    def __call__(self, cycle: np.ndarray) -> np.ndarray:
        """Return the value of the criterion for stress paths, MPa.

        Parameters
        ----------
        cycle : ndarray, shape (6, n, ...)
            Components xx, yy, zz, xy, xz, yz at n points along the cycle, MPa; the last of them is
            the unloaded material.

        Returns
        -------
        ndarray, shape (...)
            MPa; no damage up to zero; nan if a stress is nan.

        Raises
        ------
        ValueError
            If the cycles have another shape.
        """


@dataclass(frozen=True)
class VonMises(StressCriterion):
    """Criterion: the equivalent stress of von Mises, from six stress components."""

    name = "von_mises"
    symbol = r"\sigma_\mathrm{vM}"
    long_name = "equivalent stress of von Mises"

    def __call__(self, stress: np.ndarray) -> np.ndarray:
        """Return the equivalent stress of stresses (6, ...), MPa.

        Parameters as in `StressCriterion.__call__`.
        """
        # Reading and drawing results needs no compiler, which takes long to load.
        from tractive_sam.kernels.stress import compute_von_mises  # noqa: PLC0415

        out = np.empty(stress.shape[1:])
        compute_von_mises(out.reshape(-1), stress.reshape(6, -1))
        return out


@dataclass(frozen=True)
class MaxShear(StressCriterion):
    """Criterion: the largest shear stress, half the difference of extreme principal stresses."""

    name = "max_shear"
    symbol = r"\tau_\mathrm{max}"
    long_name = "largest shear stress"

    def __call__(self, stress: np.ndarray) -> np.ndarray:
        """Return the equivalent stress of stresses (6, ...), MPa (`StressCriterion.__call__`)."""
        return max_shear(stress)


VON_MISES = VonMises()
"""Default criterion of a scene."""

CRITERIA = {criterion.name: criterion for criterion in (VON_MISES, MaxShear())}
"""Criteria of this package by their names."""

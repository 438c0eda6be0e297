"""The global incremental wear model of a twin-disc rolling system."""

from dataclasses import dataclass

import numpy as np

from tractive_sam.description import ShortArrays


@dataclass(frozen=True, eq=False, repr=False)
class GlobalWear(ShortArrays):
    """Wear depth, half widths and pressure at revolutions 0 to n: global incremental wear model.

    Attributes
    ----------
    depth : ndarray, shape (n + 1,)
        Largest wear depth, mm.
    a, b : ndarray, shape (n + 1,)
        Half widths of the contact in x and y, mm.
    pressure : ndarray, shape (n + 1,)
        Mean pressure, MPa.

    Examples
    --------
    >>> course = giwm(300.0, 114e3, (32.5, 32.3), 125.0, (0.217, 0.827), -0.005, 2e-6, 100)
    >>> course.depth.shape, bool(course.b[-1] > course.b[0])
    ((101,), True)
    """

    depth: np.ndarray
    a: np.ndarray
    b: np.ndarray
    pressure: np.ndarray


def giwm(
    load: float,
    e_star: float,
    radii_x: tuple[float, float],
    radius_y: float,
    semi_axes: tuple[float, float],
    creepage: float,
    intensity: float,
    revolutions: int,
) -> GlobalWear:
    """Return the wear of twin discs by the global incremental wear model; only disc A wears.

    Juliá & Rodríguez-Tembleque (2025), Table 1, after Hegadekatte, Kurzenhäuser, Huber & Kraft,
    Tribol. Int. 41 (2008) 1020-1031. Disc A wears; its radius shrinks with the depth.

    Parameters
    ----------
    load : float
        P, N.
    e_star : float
        E*, MPa.
    radii_x : tuple of float
        Radii of discs A and B in the rolling direction, mm.
    radius_y : float
        Combined radius in the lateral direction, mm.
    semi_axes : tuple of float
        Half widths (a, b) of the unworn contact, mm.
    creepage : float
        xi_x.
    intensity : float
        Wear intensity, 1/MPa.
    revolutions : int
        Revolutions to compute.

    Raises
    ------
    ValueError
        If a size is not above zero, or the number of revolutions below zero.

    Examples
    --------
    >>> course = giwm(300.0, 114e3, (32.5, 32.3), 125.0, (0.217, 0.827), -0.005, 2e-6, 100)
    >>> float(course.depth[100].round(6))
    0.000123
    """
    sizes = (load, e_star, *radii_x, radius_y, *semi_axes, intensity)
    if not all(size > 0.0 for size in sizes) or revolutions < 0:
        raise ValueError("load, modulus, radii, half widths and intensity must be above 0")
    course = np.empty((4, revolutions + 1))
    radius, (a, b), depth = radii_x[0], semi_axes, 0.0
    pressure = load / (np.pi * a * b)
    pressed = load / (2.0 * e_star * np.sqrt(a * b))
    course[:, 0] = depth, a, b, pressure
    sliding = abs(creepage) / (1.0 + 0.5 * creepage)  # over the mean speed of the discs
    for revolution in range(1, revolutions + 1):
        total = depth + pressed
        worn = intensity * pressure * 2.0 * a * sliding
        depth += worn
        radius -= worn
        b = np.sqrt(2.0 * radius_y * total - total**2)
        radius_x = 1.0 / (1.0 / radius + 1.0 / radii_x[1])
        a = 0.25 * np.pi * np.sqrt(4.0 * load * radius_x / (2.0 * np.pi * b * e_star))
        pressure = 0.25 * np.pi * np.sqrt(load * e_star / (2.0 * np.pi * b * radius_x))
        pressed = load / (2.0 * e_star * np.sqrt(a * b))
        course[:, revolution] = depth, a, b, pressure
    return GlobalWear(*course)

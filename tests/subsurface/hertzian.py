"""Hertz pressure averaged over the elements of a mesh, cut by the contact's edge or not."""

import numpy as np

from tractive_sam.results.grid import Grid

SLICES = 32


def cell_averages(grid: Grid, a: float, b: float) -> np.ndarray:
    """sqrt(1 - x²/a² - y²/b²) averaged over every element: exactly in y, by 32 slices in x."""
    within = (np.arange(SLICES) + 0.5) / SLICES - 0.5
    x = (grid.x[:, None] + grid.dx * within) / a
    edges = np.append(grid.y - 0.5 * grid.dy, grid.y[-1] + 0.5 * grid.dy) / b
    chord = np.sqrt(np.maximum(0.0, 1.0 - x**2))[..., None]
    reach = np.clip(edges, -chord, chord)
    angle = np.arcsin(np.divide(reach, chord, out=np.zeros_like(reach), where=chord > 0.0))
    integral = 0.5 * (reach * np.sqrt(np.maximum(0.0, chord**2 - reach**2)) + chord**2 * angle)
    return np.diff(integral, axis=-1).mean(axis=1) * (b / grid.dy)


def tractions(pressure: np.ndarray, mu: float = 0.0) -> np.ndarray:
    """(3, n_x, n_y): the pressure, and mu times it along x."""
    return np.stack([mu * pressure, np.zeros_like(pressure), pressure])

"""The regular mesh of the potential contact."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class Grid:
    """Rectangle divided into equal elements, the mesh of a contact.

    The grid of a line contact is a row of elements (n_x, 1) that are 1 mm long in y, so that sums
    over it are per length.

    Parameters
    ----------
    half_length : tuple of float
        Half lengths (L_x, L_y) of the domain, mm (the paper's L_x, L_y).
    elements : tuple of int
        Number of elements (n_x, n_y).
    shift : float
        Lateral position, on the elements, of the origin of `y`, mm.
    centre : tuple of float
        Centre of the rectangle, mm.
    """

    half_length: tuple[float, float]
    elements: tuple[int, int]
    shift: float = 0.0
    centre: tuple[float, float] = (0.0, 0.0)

    @classmethod
    def from_half_lengths(cls, half_length: tuple[float, ...], elements: tuple[int, ...]) -> "Grid":
        """Return the grid of two directions, or of x alone for a line contact."""
        (half_x, half_y), (nx, ny) = (*half_length, 0.5)[:2], (*elements, 1)[:2]
        return cls((half_x, half_y), (nx, ny))

    def lengthened(self, elements: int) -> "Grid":
        """Return the grid with a number of further elements at both ends in x."""
        (half_x, half_y), (nx, ny) = self.half_length, self.elements
        longer = half_x + elements * self.dx, half_y
        return replace(self, half_length=longer, elements=(nx + 2 * elements, ny))

    def shifted(self, shift: float) -> "Grid":
        """Return the grid with another lateral offset, mm, from which y is measured."""
        return self if shift == self.shift else replace(self, shift=shift)

    @property
    def line(self) -> bool:
        """Whether the grid belongs to a line contact."""
        return self.directions == 1

    @property
    def directions(self) -> int:
        """Number of directions in which fields vary: 1, x alone, in a line contact, else 2."""
        return 2 if self.elements[1] > 1 else 1

    @property
    def sides(self) -> tuple[float, ...]:
        """Sides of an element in the directions in which fields vary, mm."""
        return (self.dx, self.dy)[: self.directions]

    def describe_size(self) -> str:
        """Return the numbers of elements as text, like "41 x 121 elements"."""
        return " x ".join(map(str, self.elements[: self.directions])) + " elements"

    @property
    def dx(self) -> float:
        """Side of an element in the rolling direction, mm."""
        return 2.0 * self.half_length[0] / self.elements[0]

    @property
    def dy(self) -> float:
        """Side of an element in the lateral direction, mm."""
        return 2.0 * self.half_length[1] / self.elements[1]

    @property
    def element_area(self) -> float:
        """Area of an element, mm²."""
        return self.dx * self.dy

    @cached_property
    def x(self) -> np.ndarray:
        """Centres in the rolling direction, ascending, shape (n_x,), mm."""
        x = _centres(self.half_length[0], self.elements[0])
        return x + self.centre[0] if self.centre[0] else x

    @cached_property
    def y(self) -> np.ndarray:
        """Centres in the lateral direction, ascending, shape (n_y,), mm."""
        y, away = _centres(self.half_length[1], self.elements[1]), self.centre[1] - self.shift
        return y + away if away else y


def _centres(half_length: float, elements: int) -> np.ndarray:
    """Return the centres of `elements` equal elements between -half_length and half_length."""
    # Mirrored exactly about zero, so that symmetric scenes stay symmetric to the last bit.
    return (np.arange(elements) - 0.5 * (elements - 1)) * (2.0 * half_length / elements)


def widen_field(values: np.ndarray, shape: tuple[int, ...], outside: float = 0.0) -> np.ndarray:
    """Embed a field in the middle of a wider mesh; its other elements get the value `outside`.

    Parameters
    ----------
    values : ndarray
        The last axes are the axes of the mesh.
    shape : tuple of int
        Elements of the wider mesh along these axes.
    outside : float
        Value outside the present mesh.

    Raises
    ------
    ValueError
        If the wider mesh does not add equal numbers of elements on both sides.
    """
    before = values.shape[values.ndim - len(shape) :]
    if before == tuple(shape):
        return values
    extra = np.subtract(shape, before)
    if (extra < 0).any() or (extra % 2).any():
        raise ValueError(f"a mesh of {before} elements is not the middle of a mesh of {shape}")
    sides = [(0, 0)] * (values.ndim - len(shape)) + [(n // 2, n // 2) for n in extra]
    return np.pad(values, sides, constant_values=outside)

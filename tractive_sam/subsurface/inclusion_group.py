"""Inclusions that disturb each other, in the cells of a box, by the equivalent inclusion method.

An inclusion with the stiffness C_i and the misfit e_p acts as the material of the body with an
eigenstrain e: C_i (eps - e_p) = C (eps - e), where the strain eps is that of the body without
inclusions plus that of all eigenstrains (Eshelby 1957; Mura, Micromechanics of Defects in Solids,
1987, section 22). The eigenstrain is constant in each cell of a box (`EigenstrainBox`). In an
ellipsoid it is a polynomial of second order of the place: so it is exactly in stress that varies
with at most the second power of the place, and in a whole space (Eshelby 1961).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product
from typing import ClassVar

import numpy as np

from tractive_sam.operators import EigenstrainBox, isotropic_stiffness
from tractive_sam.scene import Inclusion
from tractive_sam.solvers import gmres


def inclusion_groups(inclusions: Sequence[Inclusion]) -> Iterator[list[int]]:
    """Yield the places in [[inclusion]] of those that disturb each other, by group.

    Examples
    --------
    >>> from tractive_sam.subsurface import inclusion_groups
    >>> holes = [ts.Inclusion(at=[x, 0.0, 1.0], radii=0.1, young=0.0) for x in (0.0, 0.5, 3.0)]
    >>> list(inclusion_groups(holes))
    [[0, 1], [2]]
    """
    left = list(range(len(inclusions)))
    while left:
        group = [left.pop(0)]
        for k in group:  # it grows
            for n in [*left]:
                one, other = inclusions[k], inclusions[n]
                reach = 3.0 * (max(one.half) + max(other.half))
                if one.body == other.body and math.dist(one.at, other.at) < reach:
                    group.append(n)
                    left.remove(n)
        yield sorted(group)


@dataclass(frozen=True, eq=False)
class InclusionGroup:
    """Inclusions of a body that disturb each other, in the cells of one box.

    Parameters
    ----------
    inclusions : sequence of Inclusion
        The inclusions.
    shear, poisson : float
        Shear modulus, MPa, and Poisson's ratio of the body.
    worn : float
        Depth worn off the body above them, mm.
    margin : float
        Width of the box beyond the inclusions, over their extent.

    Examples
    --------
    >>> from tractive_sam.subsurface import InclusionGroup
    >>> hole = ts.Inclusion(at=[0.0, 0.0, 5.0], radii=0.1, young=0.0, cells=15)
    >>> group = InclusionGroup([hole], shear=80e3, poisson=0.3)
    >>> tension = np.zeros((6, 15, 15, 15))
    >>> tension[2] = 1.0
    >>> strain = np.tensordot(np.linalg.inv(group.stiffness), tension, 1)
    >>> inside, eigenstrain = group.solve(strain)
    >>> stress = group.at_surface(0, inside, eigenstrain)
    >>> round(float(stress[2].max()), 1)  # (27 - 15 nu)/(14 - 10 nu) = 2.05
    2.0
    """

    inclusions: Sequence[Inclusion]
    shear: float
    poisson: float
    worn: float = 0.0
    margin: float = 0.0

    widest: ClassVar[float] = 0.5
    """Margin of the box in which the stress around inclusions is computed."""

    @cached_property
    def places(self) -> np.ndarray:
        """Places x, y and depth of the inclusions, mm, shape (inclusions, 3)."""
        return np.array([inclusion.at for inclusion in self.inclusions]) - [0.0, 0.0, self.worn]

    @cached_property
    def cells(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Depths, x and y of the centres of cells, mm; a single inclusion is in their middle."""
        half = np.array([inclusion.half for inclusion in self.inclusions])
        low, high = (self.places - half).min(axis=0), (self.places + half).max(axis=0)
        sides = 2.0 * half.min(axis=0) / max(inclusion.cells for inclusion in self.inclusions)
        count = np.maximum(np.ceil((high - low) / sides - 1e-6).astype(int), 1)
        more = np.ceil(self.margin * count).astype(int)
        x, y, depth = (
            0.5 * (a + b) + side * (np.arange(n + 2 * m) - 0.5 * (n + 2 * m - 1))
            for a, b, side, n, m in zip(low, high, sides, count, more, strict=True)
        )
        return depth[depth > 0.5 * sides[2] * (1.0 - 1e-6)], x, y

    @cached_property
    def box(self) -> EigenstrainBox:
        """The map from eigenstrain in these cells to the strain in them."""
        sides = tuple(float(at[1] - at[0]) for at in self.cells)
        shape = tuple(at.size for at in self.cells)
        return eigenstrain_box(shape, sides, float(self.cells[0][0] - 0.5 * sides[0]), self.poisson)

    @classmethod
    def transformed_cells(cls, inclusions: Sequence[Inclusion]) -> list[int]:
        """Return the cells in the transforms of each box in which inclusions are computed."""
        boxes = (
            cls([inclusions[k] for k in group], 1.0, 0.3, margin=cls.widest)
            for group in inclusion_groups(inclusions)
        )
        return [math.prod(2 * at.size for at in box.cells) for box in boxes]

    @cached_property
    def shares(self) -> np.ndarray:
        """Share of each inclusion in the volume of each cell, shape (inclusions, n_z, n_x, n_y)."""
        points = (np.arange(6) - 2.5) / 6.0
        z, x, y = (
            (at[:, None] + side * points).ravel()
            for at, side in zip(self.cells, self.box.sides, strict=True)
        )
        shares = []
        for inclusion, at in zip(self.inclusions, self.places, strict=True):
            a, b, c = (
                np.abs(place - middle) / half
                for place, middle, half in zip((x, y, z), at, inclusion.half, strict=True)
            )
            if inclusion.is_ellipsoid:
                inside = (c**2)[:, None, None] + (a**2)[:, None] + b**2 < 1.0
            else:
                inside = (c < 1.0)[:, None, None] & (a < 1.0)[:, None] & (b < 1.0)
            nz, nx, ny = self.box.shape
            share = inside.reshape(nz, 6, nx, 6, ny, 6).mean(axis=(1, 3, 5))
            # The volume is exact, so that the far field is.
            share *= inclusion.volume / (share.sum() * np.prod(self.box.sides))
            shares.append(share)
        return np.array(shares)

    @cached_property
    def share(self) -> np.ndarray:
        """Share of all inclusions in the volume of each cell, shape (n_z, n_x, n_y)."""
        return self.shares.sum(axis=0)

    @cached_property
    def owner(self) -> np.ndarray:
        """Index of the inclusion with the largest share in each cell; -1 in the matrix."""
        return np.where(self.shares.any(axis=0), self.shares.argmax(axis=0), -1)

    @cached_property
    def stiffness(self) -> np.ndarray:
        """Stiffness (6, 6) of the body, from the strain of tensors to the stress, MPa."""
        return isotropic_stiffness(self.shear, self.poisson)

    def contrast(self, k: int) -> np.ndarray:
        """Return C_i/C - 1 of an inclusion, (6, 6)."""
        return np.linalg.solve(self.stiffness, self.inclusions[k].matrix - self.stiffness)

    @cached_property
    def _fits(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """For each inclusion: mask of its cells, 1, x, y, z over its extent there, and their fit.

        The fit leaves out cells near the surface of an ellipsoid, which it divides.
        """
        z, x, y = self.cells
        places = np.stack(np.broadcast_arrays(x[:, None], y, z[:, None, None]))
        fits = []
        for k, inclusion in enumerate(self.inclusions):
            mask = self.owner == k
            linear = self._linear(k, places[:, mask])
            inner = (linear[1:] ** 2).sum(axis=0) < self.part_of_fit**2
            fit = np.zeros_like(linear)
            if inclusion.is_ellipsoid:
                fit[:, inner] = np.linalg.pinv(linear[:, inner]).T
            fits.append((mask, linear, fit))
        return fits

    part_of_fit: ClassVar[float] = 0.7
    """Radius of the cells whose strain is fitted, over the semi-axes."""

    def _linear(self, k: int, points: np.ndarray) -> np.ndarray:
        """Return 1 and the coordinates over the extent of an inclusion, at points (3, n)."""
        scaled = (points - self.places[k][:, None]) / np.reshape(self.inclusions[k].half, (3, 1))
        return np.concatenate((np.ones_like(scaled[:1]), scaled))

    def inside(self, k: int, field: np.ndarray, points: np.ndarray | None = None) -> np.ndarray:
        """Return a field (..., n_z, n_x, n_y) in an inclusion, at points (3, n) or in its cells.

        In an ellipsoid it is the linear field that it has near the centre.
        """
        mask, linear, fit = self._fits[k]
        if not self.inclusions[k].is_ellipsoid:
            return field[..., mask]
        return field[..., mask] @ fit.T @ (linear if points is None else self._linear(k, points))

    def at_surface(
        self,
        k: int,
        strain: np.ndarray,
        eigenstrain: np.ndarray,
        directions: np.ndarray | None = None,
    ) -> np.ndarray:
        """Return the stress of the matrix at the surface of an ellipsoid, (6, ..., n), MPa.

        Tractions, and the strain in the surface, are continuous (Hill 1961).

        Parameters
        ----------
        k : int
            The inclusion.
        strain, eigenstrain : ndarray, shape (6, ..., n_z, n_x, n_y)
            Strain, and eigenstrain of the inclusions, in the cells.
        directions : ndarray, shape (3, n), optional
            Points of the unit sphere whose images are the points; by default `sphere_points`.
        """
        points, normals = surface_points(self.inclusions[k], directions)
        places = points + self.places[k][:, None]
        inside, own = (self.inside(k, values, places) for values in (strain, eigenstrain))
        missing = np.tensordot(self.stiffness, own, 1)
        traction = np.zeros((3, *inside.shape[1:]))
        for c, (i, j) in enumerate(EigenstrainBox.axes):
            traction[i] -= missing[c] * normals[j]
            if i != j:
                traction[j] -= missing[c] * normals[i]
        # The strain jumps by (b n + n b)/2 with mu b + (lambda + mu) n (n.b) = the traction.
        along = 0.5 / (1.0 - self.poisson) * sum(traction * _like(normals, traction))
        step = (traction - along * _like(normals, traction)) / self.shear
        for c, (i, j) in enumerate(EigenstrainBox.axes):
            inside[c] += 0.5 * (step[i] * normals[j] + step[j] * normals[i])
        return np.tensordot(self.stiffness, inside, 1)

    def _respond(self, field: np.ndarray) -> np.ndarray:
        """Return C_i/C - 1 times a strain in each inclusion, where in an ellipsoid it is linear."""
        result = np.zeros_like(field)
        for k in range(len(self.inclusions)):
            result[:, self._fits[k][0]] = self.contrast(k) @ self.inside(k, field)
        return result

    def solve(
        self, strain: np.ndarray, misfit: bool = False, tolerance: float = 1e-5, steps: int = 80
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return strain and eigenstrain, (6, n_z, n_x, n_y), in a strain without inclusions.

        The eigenstrain counts by the share of the inclusions in a cell.

        Parameters
        ----------
        strain : ndarray, shape (6, n_z, n_x, n_y)
            Strain of tensors.
        misfit : bool
            Whether the inclusions have their misfit.
        tolerance : float
            Relative residual.
        steps : int
            Most iterations.
        """
        # Between those of a void and of a rigid inclusion, so that no contrast is too large.
        scales = [np.eye(6) + 0.5 * self.contrast(k) for k in range(len(self.inclusions))]

        def scaled(field: np.ndarray) -> np.ndarray:
            for k, scale in enumerate(scales):
                mask = self._fits[k][0]
                field[:, mask] = np.linalg.solve(scale, field[:, mask])
            return field.ravel()

        def operator(values: np.ndarray) -> np.ndarray:
            field = values.reshape(strain.shape)
            return scaled(field + self._respond(self.box(self.share * field)))

        right = -self._respond(strain)
        for k, inclusion in enumerate(self.inclusions) if misfit else ():
            own = np.array(inclusion.misfit)
            right[:, self._fits[k][0]] += (own + self.contrast(k) @ own)[:, None]
        found, _ = gmres(operator, lambda values: values, scaled(right), tolerance, steps)
        eigenstrain = found.reshape(strain.shape)
        return strain + self.box(self.share * eigenstrain), eigenstrain


eigenstrain_box = lru_cache(4)(EigenstrainBox)
"""The box of its arguments, with its spectra after its first use."""


def _like(normals: np.ndarray, field: np.ndarray) -> np.ndarray:
    """Return normals (3, n) in the dimensions of a field (3, ..., n)."""
    return normals.reshape(3, *(1,) * (field.ndim - 2), -1)


def surface_points(
    inclusion: Inclusion, directions: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return points of an ellipsoid about its centre, mm, and unit normals, both of shape (3, n).

    `directions` are points of the unit sphere whose images they are; by default `sphere_points`.
    """
    sphere = sphere_points() if directions is None else directions
    half = np.reshape(inclusion.half, (3, 1))
    return half * sphere, sphere / half / np.linalg.norm(sphere / half, axis=0)


@lru_cache(2)
def sphere_points(parts: int = 12) -> np.ndarray:
    """Return points of the unit sphere, (3, 4 parts^2 + 2), among which are all mirror images.

    The edges of an octahedron have `parts` equal parts on the sphere; the points of each face lie
    between those of its edges.
    """
    i, j, k = np.indices((parts + 1,) * 3).reshape(3, -1)
    octant = np.sin(0.5 * math.pi / parts * np.stack((i, j, k))[:, i + j + k == parts])
    octant /= np.linalg.norm(octant, axis=0)
    signs = np.array([*product((1.0, -1.0), repeat=3)]).T
    images = (octant[:, :, None] * signs[:, None]).reshape(3, -1)
    # Points in the planes of the axes are their own images; -0.0 + 0.0 is 0.0.
    return np.unique(images + 0.0, axis=1)


def points_around(direction: np.ndarray, width: float) -> np.ndarray:
    """Return 5 x 5 points (3, 25) of the unit sphere up to `width` aside from one of them (3,)."""
    first = np.cross(direction, np.eye(3)[np.abs(direction).argmin()])
    first /= np.linalg.norm(first)
    aside = np.stack((first, np.cross(direction, first)), axis=1)
    steps = np.meshgrid(*2 * [width * np.linspace(-1.0, 1.0, 5)])
    points = direction[:, None] + aside @ np.reshape(steps, (2, -1))
    return points / np.linalg.norm(points, axis=0)

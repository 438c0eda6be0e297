"""Strain and lift of the surface of a half-space z >= 0 by eigenstrain in the cells of a box.

The strain is that of the whole space, in closed form for a cuboid of constant eigenstrain (Mura,
Micromechanics of Defects in Solids, 1987, section 11), and that of an image that leaves the surface
free. The whole space depends on z - z', the image on z + z': both are convolutions in x and y, and
in the depth a convolution and a correlation.

The image is a superposition of waves exp(i k.x - k (z + z')) whose amplitudes are polynomials in
k z and k z'. Their integral over the lengths of waves is a Legendre function of zeta = z + z', and
their dependence on the direction ends with the fourth harmonic. It is smooth: Gauss' rule
integrates it over a cell.

The lift of the surface follows by reciprocity (Betti): the work of a normal force on it is that of
the stress of the force on the eigenstrain.
"""

import math
from collections.abc import Iterator
from functools import cached_property, lru_cache
from itertools import product
from typing import ClassVar

import numpy as np

from tractive_sam.compute import box_transform, fast_length


def isotropic_stiffness(shear: float, poisson: float) -> np.ndarray:
    """Return the matrix (6, 6) from strain xx, yy, zz, xy, xz, yz (of tensors) to stress, MPa.

    Examples
    --------
    >>> isotropic_stiffness(1.0, 0.25)[0]
    array([3., 1., 1., 0., 0., 0.])
    """
    stiffness = 2.0 * shear * np.eye(6)
    stiffness[:3, :3] += 2.0 * shear * poisson / (1.0 - 2.0 * poisson)
    return stiffness


def _image_wave(poisson: float, angle: float, z: float, source: float) -> np.ndarray:
    """Return the strain (6, 6) of the image of a wave of length 2 pi, times exp(z + source).

    It is per eigenstrain at the depth `source`. The shear modulus is 1.
    """
    along = 1j * np.array([math.cos(angle), math.sin(angle)])
    stiffness = isotropic_stiffness(1.0, poisson)

    # Functions of depth are coefficients of polynomials, times exp(z) above the source, or exp(-z).
    def gradient(values: np.ndarray, sign: float) -> np.ndarray:
        down = sign * values
        down[..., :-1] += values[..., 1:] * np.arange(1, values.shape[-1])
        return np.stack([along[0] * values, along[1] * values, down])

    def at(values: np.ndarray, z: float) -> np.ndarray:
        return values @ z ** np.arange(values.shape[-1])

    def strain(displacement: np.ndarray, sign: float) -> np.ndarray:
        slopes = gradient(displacement, sign)
        return np.stack([0.5 * (slopes[i, j] + slopes[j, i]) for i, j in EigenstrainBox.axes])

    # Kelvin's tensor: 1/r becomes 2 pi exp(-k|z|)/k, and r becomes -2 pi (1 + k|z|) exp(-k|z|)/k^3.
    distance = np.array([-1.0, 1.0, 0.0], complex)
    kelvin = -gradient(gradient(distance, 1.0), 1.0) / (8.0 * (1.0 - poisson))
    kelvin[range(3), range(3), 0] += 0.5
    slopes = gradient(kelvin, 1.0)
    tensors = np.zeros((6, 3, 3))
    for column, (i, j) in zip(
        stiffness.T, EigenstrainBox.axes, strict=True
    ):  # the matrix is symmetric
        tensors[:, i, j] = tensors[:, j, i] = column
    whole = -np.einsum("kijd,bjk->ibd", slopes, tensors)
    # Waves that decay downwards: gradient and rotation of psi, and (3 - 4 nu) psi e_z - z grad psi.
    psi = np.array([1.0, 0.0, 0.0], complex)
    potential = gradient(psi, -1.0)
    turning = np.stack([1j * along[1] * psi, -1j * along[0] * psi, 0.0 * psi])
    weighted = -np.roll(potential, 1, axis=1)
    weighted[2] += (3.0 - 4.0 * poisson) * psi
    waves = np.stack([potential, turning, weighted], axis=1)
    on_surface = [4, 5, 2]
    tractions, loads = (
        at(np.tensordot(stiffness, strain(values, sign), 1)[on_surface], z)
        for values, sign, z in ((whole, 1.0, -source), (waves, -1.0, 0.0))
    )
    shares = -np.linalg.solve(loads, tractions)
    return at(strain(waves, -1.0), z) @ shares


@lru_cache(16)
def _image_harmonics(poisson: float, angles: int = 16) -> tuple[np.ndarray, ...]:
    """Return the amplitudes of the image over the direction, for harmonics 0 to 4.

    Returns
    -------
    four ndarray of complex, shape (5, 6, 6)
        Factors of 1, k z, k z', and k z k z' in the strain.
    """
    corners = [
        [_image_wave(poisson, 2.0 * math.pi * k / angles, *at) for k in range(angles)]
        for at in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0))
    ]
    one, first, second, both = (np.fft.fft(waves, axis=0)[:5] / angles for waves in corners)
    return one, first - one, second - one, both - first - second + one


def _waves(x: np.ndarray, y: np.ndarray, zeta: np.ndarray, m: int) -> list[np.ndarray]:
    """Return the waves exp(i m angle - k zeta) of all k, by k^s / (2 pi), for s = 0 to 4.

    The integral of k^s J_m(k rho) exp(-k zeta) over k is a Legendre function of zeta/R over
    R^(s + 1); negative harmonics are conjugate, so that the real part has all.
    """
    R = np.sqrt(x * x + y * y + zeta * zeta)
    turned = (2.0 - (m == 0)) / (2.0 * math.pi) * (1j * (x + 1j * y) / (R + zeta)) ** m
    values = [1.0 / R, (m * R + zeta) / R**3]
    for s in range(1, 4):
        next_one = (2 * s + 1) * zeta * values[s] - (s * s - m * m) * values[s - 1]
        values.append(next_one / R**2)
    return [turned * value for value in values]


def _corners(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> dict[tuple[int, ...], np.ndarray]:
    """Return the derivatives of phi and psi at a corner, by their axes, two or four of them.

    The integrals phi of 1/R and psi of R over a cuboid, differentiated, are sums over its corners
    with alternating signs. Functions that such sums do not contain are left out.
    """
    at, R, terms = (x, y, z), np.sqrt(x * x + y * y + z * z), dict[tuple[int, ...], np.ndarray]()
    square = [v * v for v in at]
    for i in range(3):
        j, k = sorted({0, 1, 2} - {i})
        terms[i, i] = -np.arctan(at[j] * at[k] / (at[i] * R))
        terms[j, k] = np.arcsinh(at[i] / np.sqrt(square[j] + square[k]))
        terms[tuple(sorted((i, i, j, k)))] = at[i] / R
        terms[j, j, k, k] = -x * y * z / (R * (square[j] + square[k]))
        for one in (j, k):
            change = square[one] * at[i] / (R * (square[j] + square[k]))
            terms[tuple(sorted((j, k, one, one)))] = terms[j, k] - change
    for i in range(3):
        j, k = {0, 1, 2} - {i}
        others = (terms[tuple(sorted((i, i, n, n)))] for n in (j, k))
        terms[i, i, i, i] = 2.0 * terms[i, i] - sum(others)
    return terms


class EigenstrainBox:
    """Linear map from the eigenstrain in the cells of a box to the strain at their centres.

    Parameters
    ----------
    shape : tuple of int
        Cells along depth, x and y.
    sides : tuple of float
        Sides of a cell along depth, x and y, mm.
    top : float
        Depth of the upper face of the box, mm.
    poisson : float
        Poisson's ratio of the half-space.

    Examples
    --------
    >>> box = EigenstrainBox((1, 1, 1), (0.1, 0.1, 0.1), top=1e3, poisson=0.25)
    >>> dilatation = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]).reshape(6, 1, 1, 1)
    >>> (box(dilatation).ravel() * 9.0).round(6)  # (1 + nu)/(1 - nu) = 5/3, a third along each axis
    array([5., 5., 5., 0., 0., 0.])
    """

    axes: ClassVar = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    """Axes of the components xx, yy, zz, xy, xz, yz."""

    def __init__(
        self,
        shape: tuple[int, int, int],
        sides: tuple[float, float, float],
        top: float,
        poisson: float,
    ) -> None:
        self.shape, self.sides, self.top, self.poisson = shape, sides, top, poisson
        nz, nx, ny = (fast_length(2 * n) for n in shape)
        self._padded = nz, nx, ny

    @property
    def depth(self) -> np.ndarray:
        """Depths of the centres of cells, mm, shape (cells along the depth,)."""
        return self.top + self.sides[0] * (np.arange(self.shape[0]) + 0.5)

    def __call__(self, eigenstrain: np.ndarray) -> np.ndarray:
        """Return the strain, shape (6, depths, n_x, n_y), of an eigenstrain of this shape."""
        transform = box_transform(6, self._padded)
        spectra = transform.forward(eigenstrain).copy()
        strain = np.zeros_like(spectra)
        for kernels, source in zip(self._whole, spectra, strict=True):
            strain += kernels * source
        upwards = np.roll(spectra[:, ::-1], 1, axis=1)
        inside = (slice(None), *map(slice, self.shape))
        total = np.zeros((6, *self.shape))
        for power in range(3):
            if power:
                strain = np.zeros_like(upwards)
            for kernels, source in zip(self._image[power], upwards, strict=True):
                strain += kernels * source
            factor = self.depth.reshape(-1, 1, 1) ** power
            total += factor * transform.backward(strain)[inside]
        return total

    @cached_property
    def _whole(self) -> np.ndarray:
        """Spectra of the strain in a whole space, by components of eigenstrain and of strain.

        They are real: sums of derivatives of phi and psi.
        """
        edges = (
            side * (np.arange(n + 1) - 0.5) for n, side in zip(self.shape, self.sides, strict=True)
        )
        z, x, y = np.meshgrid(*edges, indexing="ij")
        scale = 1.0 / (8.0 * math.pi * (1.0 - self.poisson))
        spectra = {}
        for axes, values in _corners(x, y, z).items():
            cells = np.diff(np.diff(np.diff(values, axis=0), axis=1), axis=2)
            odd = [axes.count(axis) % 2 for axis in (2, 0, 1)]
            spectra[axes] = self._transform(scale * cells[None], odd)[0].real.copy()
        nu, whole = self.poisson, np.zeros((6, 6, *next(iter(spectra.values())).shape))
        at = {pair: b for b, pair in enumerate(EigenstrainBox.axes)} | {
            (j, i): b for b, (i, j) in enumerate(EigenstrainBox.axes)
        }
        for a, (i, j) in enumerate(EigenstrainBox.axes):
            for b, (k, m) in enumerate(EigenstrainBox.axes):
                whole[b, a] += (1.0 + (k != m)) * spectra[tuple(sorted((i, j, k, m)))]
            whole[:3, a] -= 2.0 * nu * spectra[i, j]
            for n, (one, two) in product(range(3), ((i, j), (j, i))):
                whole[at[one, n], a] -= 2.0 * (1.0 - nu) * spectra[tuple(sorted((n, two)))]
        return whole

    @cached_property
    def _image(self) -> list[list[np.ndarray]]:
        """Spectra of the image by power of the depth and component of the eigenstrain."""
        one, first, second, both = _image_harmonics(self.poisson)
        # Factors of k, zeta k^2 | z k^2, z zeta k^3 | z^2 k^3, as z' = zeta - z.
        factors = ((one, second), (first - second, both), (-both,))
        waves = self._integrate_waves()
        spectra = []
        for power, parts in enumerate(factors):
            row = []
            for b, source in enumerate(EigenstrainBox.axes):
                table = np.zeros((6, *waves[0][0].shape))
                for m, a in product(range(5), range(6)):
                    for k, part in enumerate(parts):
                        factor, values = part[m, a, b], waves[m][2 * power + k]
                        if abs(factor.real) > 1e-12:
                            table[a] += factor.real * values.real
                        if abs(factor.imag) > 1e-12:
                            table[a] -= factor.imag * values.imag
                odd = [
                    [0, *((*pair, *source).count(axis) % 2 for axis in (0, 1))]
                    for pair in EigenstrainBox.axes
                ]
                row.append(self._transform(table, *odd).astype(np.complex64))
            spectra.append(row)
        return spectra

    def _integrate_waves(self) -> list[list[np.ndarray]]:
        """Return k, zeta k^2, k^2, zeta k^3 and k^3, integrated over a cell, by harmonic.

        They are at x, y >= 0. Gauss' rule has two points in each direction, and four if the box is
        close to the surface.
        """
        (dz, dx, dy), (nz, nx, ny) = self.sides, self.shape
        close = 2.0 * self.top < 3.0 * max(self.sides)
        centres = 2.0 * self.top + dz * np.arange(1, 2 * nz), dx * np.arange(nx), dy * np.arange(ny)
        zeta, x, y = np.meshgrid(*centres, indexing="ij")
        sums: list[list[np.ndarray]] = [[] for _ in range(5)]
        for point, weight in _gauss_points(4 if close else 2):
            u, v, w = point * self.sides
            for m in range(5):
                waves = _waves(x + v, y + w, zeta + u, m)[2:]
                terms = waves[0], (zeta + u) * waves[1], waves[1], (zeta + u) * waves[2], waves[2]
                parts = [weight * dz * dx * dy * term for term in terms]
                sums[m] = [a + b for a, b in zip(sums[m], parts, strict=True)] if sums[m] else parts
        return sums

    def _transform(self, table: np.ndarray, *odd: list[int]) -> np.ndarray:
        """Return the spectra, over their number, of fields given at x, y >= 0 (and z >= 0).

        `odd` lists the axes (depth, x, y) along which each field is odd; depths that are as many as
        those of a correlation are complete.
        """
        transform = box_transform(len(table), self._padded)
        padded = np.zeros((len(table), *self._padded))
        padded[tuple(map(slice, table.shape))] = table
        for field, axes in zip(padded, odd, strict=True):
            for axis, is_odd in enumerate(axes):
                n = self.shape[axis]
                if n == 1 or n < table.shape[1 + axis]:
                    continue
                mirrored = np.moveaxis(field, axis, 0)
                mirrored[1 - n :] = (1.0 - 2.0 * is_odd) * mirrored[n - 1 : 0 : -1]
        return transform.forward(padded) / math.prod(self._padded)

    def lift(self, eigenstrain: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the displacement (..., n) of the surface out of the body at x, y (n,), mm.

        Parameters
        ----------
        eigenstrain : ndarray, shape (6, ..., n_z, n_x, n_y)
            Eigenstrain in the cells.
        x, y : ndarray, shape (n,)
            Places from the middle of the box, mm.
        """
        shape = eigenstrain.shape[1:-3]
        filled = np.nonzero(eigenstrain.reshape(-1, *self.shape).any(axis=0))
        sources = eigenstrain.reshape(6, math.prod(shape), *self.shape)
        sources = sources[:, :, filled[0], filled[1], filled[2]]
        weights = math.prod(self.sides) * np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
        depth, across = self.depth[filled[0]], list[np.ndarray]()
        for side, k, n in zip(self.sides[1:], filled[1:], self.shape[1:], strict=True):
            across.append(side * (k - 0.5 * (n - 1)))
        lift, points = np.empty((sources.shape[1], x.size)), [*_gauss_points(2)]
        for part in np.array_split(np.arange(x.size), math.ceil(x.size * depth.size / 1.6e4) or 1):
            stress = sum(
                weight
                * _stress_of_force(
                    across[0] + u - x[part, None],
                    across[1] + v - y[part, None],
                    depth + w,
                    self.poisson,
                )
                for (w, u, v), weight in ((point * self.sides, weight) for point, weight in points)
            )
            lift[:, part] = -np.einsum("c,cpk,cnk->np", weights, stress, sources, optimize=True)
        return lift.reshape(*shape, x.size)


def _stress_of_force(x: np.ndarray, y: np.ndarray, z: np.ndarray, poisson: float) -> np.ndarray:
    """Return the stress (6, ...) by a unit force into the surface at the origin (Boussinesq)."""
    square = x * x + y * y + z * z
    r = np.sqrt(square)  # no power of 3, which takes as long as all the rest
    share, down = 0.5 / math.pi / (square * r), 3.0 * z / square
    first = (1.0 - 2.0 * poisson) * (z - square / (r + z))
    across = (1.0 - 2.0 * poisson) * (2.0 * r + z) / (r + z) ** 2 - down
    stress = [first + across * x * x, first + across * y * y, -down * z * z, across * x * y]
    return share * np.stack([*stress, -down * x * z, -down * y * z])


def _gauss_points(count: int) -> Iterator[tuple[np.ndarray, float]]:
    """Yield points (3,) of a cell of length 1 about its centre, and their weights."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    for places in product(range(count), repeat=3):
        yield 0.5 * nodes[[*places]], float(np.prod(0.5 * weights[[*places]]))

"""The contacts behind a table: forces, gradient and error bar at scaled creepages.

At rest all of the contact sticks. Its tractions are singular at the trailing edge, and their
resultants depend on how the elements cover the contact: by 1 % to 2 % with fifteen elements across
it, irregularly from mesh to mesh. Most of this error depends on the second moments of the covered
area, which are known for an ellipse. A fit over many meshes

    slope = limit + c_1 / n + c_2 (moment of x² - exact) + c_3 (moment of y² - exact)

over n elements across the contact yields the limit, and its scatter yields the error bar.
"""

import warnings
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.compute import numeric_settings
from tractive_sam.contact import Model, jacobian_of, solve_on_fitted_mesh
from tractive_sam.mechanics import HertzContact, HertzLine
from tractive_sam.results import State
from tractive_sam.run import read_measured_gap, solve_from_nearby, warn_of_gap, with_creepages
from tractive_sam.scene import Friction, Scene
from tractive_sam.schema import Fault, SceneError, required


def rest_meshes(
    elements: int, finest: int, wanted: float, *, number: int = 16, spread: float = 3.2
) -> np.ndarray:
    """Return the numbers of elements across the contact on which slopes at rest are solved.

    Parameters
    ----------
    elements, finest : int
        First and largest number of elements of the table.
    wanted : float
        Error bar of forces over mu P; slopes at rest must have a tenth of this error, or less.
    number : int
        Meshes: four times the unknowns of the fit.
    spread : float
        Elements of the finest over elements of the coarsest mesh.
    """
    # From 101 elements slopes are within 0.3 % if forces are wanted within 0.8 % of mu P.
    largest = min(finest, max(2 * elements, 0.8 / wanted))
    across = np.geomspace(largest / spread, largest, number)
    return np.unique(2 * np.rint(0.5 * (across - 1.0)).astype(int) + 1)


def extrapolate_slopes(
    meshes: np.ndarray, slopes: np.ndarray, moments: np.ndarray, *, confidence: float = 0.95
) -> tuple[np.ndarray, np.ndarray]:
    """Extrapolate slopes at rest to an infinitely fine mesh; return (limit, error bar).

    Parameters
    ----------
    meshes : ndarray, shape (M,)
        Elements across the contact.
    slopes : ndarray, shape (M, ...)
        Slopes on each mesh.
    moments : ndarray, shape (M, K)
        Excess moments of the area, on which the slopes depend; zero in the limit.
    confidence : float
        Probability that a slope is within its error bar if scatter is normal.

    Returns
    -------
    limit, bar : ndarray, shape (...)
        Slopes of the limit and half widths of their intervals.
    """
    # The scatter decreases faster than 1/n, as the number of elements at the edge increases.
    weights = meshes[:, None] ** 1.5
    basis = weights * np.column_stack([np.ones(len(meshes)), 1.0 / meshes, moments])
    values = weights * slopes.reshape(len(meshes), -1)
    # Both moments of a circle are equal: the rest of a singular value is rounding.
    inverse = np.linalg.pinv(basis, rcond=1e-6)
    fitted = inverse @ values
    free = max(len(meshes) - np.linalg.matrix_rank(basis, tol=1e-6 * np.abs(basis).max()), 1)
    scatter = np.sqrt(np.sum((values - basis @ fitted) ** 2, axis=0) / free)
    bar = scipy.special.stdtrit(free, 0.5 + 0.5 * confidence) * np.linalg.norm(inverse[0]) * scatter
    return fitted[0].reshape(slopes.shape[1:]), bar.reshape(slopes.shape[1:])


YOUNG, MU, PRESSURE, RADIUS = 2e5, 0.3, 1e3, 1e3
"""Parameters of the scenes that are solved; no scaled result depends on them."""


@dataclass(frozen=True, eq=False)
class Solved:
    """Solution at scaled creepages: scaled forces, their gradient, and error bars.

    Attributes
    ----------
    force : ndarray, shape (3,)
        Q_x, Q_y, M_z.
    bar : ndarray, shape (3,)
        Error bars of the forces.
    gradient : ndarray, shape (3, 3)
        Derivatives of the three by scaled creepages.
    gradient_bar : ndarray, shape (3, 3)
        Error bars of the derivatives at rest; zero elsewhere, since checks of the table find them.
    """

    force: np.ndarray
    bar: np.ndarray
    gradient: np.ndarray
    gradient_bar: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))


def required_hertz(scene: Scene) -> HertzContact | HertzLine:
    """Return the Hertz contact of a scene; raise a SceneError if its radii form none."""
    if scene.hertz is None:
        raise SceneError(
            [Fault("body", "radii without a closed contact", "radii that close in x and y")]
        )
    return scene.hertz


def required_friction(scene: Scene) -> Friction:
    """Return the friction of a scene; raise a SceneError without [friction], as tables need it."""
    return required(scene.friction, "friction")


class Contacts:
    """Solver of one scene at any scaled creepages, which stores models and last solutions.

    Parameters
    ----------
    scene : Scene
        Scene without a mesh and creepages.
    contact : tuple of float, optional
        a, b, load, mu and shear that scale creepages and forces; by default the scene's.
    """

    keys = ("creepage.longitudinal", "creepage.lateral", "creepage.spin")

    def __init__(self, scene: Scene, contact: tuple[float, ...] | None = None):
        self.scene = scene
        if contact is None:
            hertz, mu = required_hertz(scene), required_friction(scene).mu[0]
            load = required(scene.normal_load, "load.normal")
            contact = hertz.a, hertz.b, load, mu, scene.material.shear
        a, b, load, mu, shear = contact
        c, bound = (a * b) ** 0.5, mu * load
        self._unit = bound * np.array([1.0, 1.0, c])
        self._creepage = bound / (shear * c**2) * np.array([1.0, 1.0, 1.0 / c])
        self._models: dict[int, Model] = {}
        self._last: dict[int, State] = {}
        self.solved = 0

    @numeric_settings()
    def solve(
        self, w: np.ndarray, elements: int, finest: int, wanted: float, gradient: bool = True
    ) -> Solved:
        """Return forces, bars and gradient at w, on meshes refined until bars <= `wanted`.

        At rest there are no forces; the gradient is extrapolated there.

        Raises
        ------
        RuntimeError
            If a contact is not solved.
        """
        meshes = [odd(elements / 2.0), odd(elements / 2.0**0.5), elements]
        states = [self.solve_on_mesh(w, n) for n in meshes]
        forces = [self._scaled(state) for state in states]
        while (bar := _error_bar(*forces[-3:])).max() > wanted and odd(
            meshes[-1] * 2.0**0.5
        ) <= finest:
            meshes.append(odd(meshes[-1] * 2.0**0.5))
            states.append(self.solve_on_mesh(w, meshes[-1]))
            forces.append(self._scaled(states[-1]))
        if not gradient:
            return Solved(forces[-1], bar, np.zeros((3, 3)))
        if np.any(w):
            return Solved(forces[-1], bar, self._gradient(states[-1], meshes[-1]))
        return Solved(forces[-1], bar, *self.slopes_at_rest(rest_meshes(elements, finest, wanted)))

    def slopes_at_rest(self, meshes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the gradient at zero creepage, extrapolated over meshes, and its error bars.

        Parameters
        ----------
        meshes : ndarray, shape (M,)
            Elements across the contact of the meshes to extrapolate from.
        """
        slopes, moments = [], []
        for n in map(int, meshes):
            is_used = n in self._models
            contact = self.solve_on_mesh(np.zeros(3), n)
            slopes.append(self._gradient(contact, n))
            moments.append(self._excess_moments(contact, n))
            if not is_used:  # fine meshes are used once, and their operators are large
                del self._models[n], self._last[n]
        return extrapolate_slopes(meshes, np.array(slopes), np.array(moments))

    def forces(self, w: np.ndarray, elements: int) -> np.ndarray:
        """Return the scaled forces at scaled creepages w, solved on one mesh, shape (3,)."""
        return self._scaled(self.solve_on_mesh(w, elements))

    def _model(self, elements: int) -> Model:
        """Return the model with a number of elements across the contact, cached."""
        if elements not in self._models:
            scene = with_mesh(self.scene, elements, self._reach)
            self._models[elements] = Model(scene, read_measured_gap(scene))
        return self._models[elements]

    @cached_property
    def _reach(self) -> tuple[float, float]:
        """Largest distances in x and y of the contact from the centre, mm."""
        if not self.scene.has_gap:
            hertz = required_hertz(self.scene)
            return float(hertz.a), float(hertz.b)
        smooth = self.scene.replace(friction=None, creepage=None)
        model, contact = solve_on_fitted_mesh(Model(smooth, read_measured_gap(smooth)))
        if not contact.converged:
            raise RuntimeError(f"a contact without friction was not solved: {contact.message}")
        warn_of_gap(model)
        grid, touches = model.grid, contact.pressure > 0.0
        x, y = np.abs(grid.x)[touches.any(axis=1)], np.abs(grid.y)[touches.any(axis=0)]
        return float(x.max() + 0.5 * grid.dx), float(y.max() + 0.5 * grid.dy)

    def _scaled(self, contact: State) -> np.ndarray:
        """Return Q_x/(mu P), Q_y/(mu P) and M_z/(mu P c) of a contact, shape (3,)."""
        # The load of the mesh equals the prescribed one, within the tolerance of the solver.
        return np.array([contact.Qx, contact.Qy, contact.Mz]) / self._unit

    def _excess_moments(self, contact: State, elements: int) -> np.ndarray:
        """Return the relative error of the second moments of the meshed contact area, (2,).

        Shape (2,), x² first, or (0,) for contacts that are no ellipses.
        """
        if self.scene.has_gap:
            return np.empty(0)
        grid, touches = self._model(elements).grid, contact.pressure > 0.0
        a, b = self._reach
        moments = np.array([touches.sum(axis=1) @ grid.x**2, touches.sum(axis=0) @ grid.y**2])
        exact = 0.25 * np.pi * a * b * np.array([a**2, b**2])
        return moments * grid.dx * grid.dy / exact - 1.0

    def solve_on_mesh(self, w: np.ndarray, elements: int) -> State:
        """Return the solved contact at scaled creepages w on one mesh; RuntimeError if it fails.

        Parameters
        ----------
        w : ndarray, shape (3,)
            Longitudinal and lateral creepage and spin, scaled.
        elements : int
            Elements across the contact.

        Raises
        ------
        RuntimeError
            If the contact is not solved.
        """
        model = self._model(elements)
        creepages = dict(zip(self.keys, w * self._creepage, strict=True))
        _, contact = solve_from_nearby(with_creepages(model, creepages), self._last.get(elements))
        self.solved += 1
        if not contact.converged:
            raise RuntimeError(
                f"a contact was not solved: {self.scene.title}, w = {w}: {contact.message}"
            )
        self._last[elements] = contact
        return contact

    def _gradient(self, contact: State, elements: int) -> np.ndarray:
        """Return the derivatives of scaled forces by scaled creepages, shape (3, 3)."""
        creepages = (contact.xi_x, contact.xi_y, contact.spin)
        model = with_creepages(self._model(elements), dict(zip(self.keys, creepages, strict=True)))
        jacobian = jacobian_of(model, contact, only=("xi_x", "xi_y", "spin"))
        slopes = jacobian.loc[["Qx", "Qy", "Mz"], ["xi_x", "xi_y", "spin"]].values
        return slopes / self._unit[:, None] * self._creepage


def _error_bar(
    coarse: np.ndarray,
    middle: np.ndarray,
    fine: np.ndarray,
    *,
    safety: float = 3.0,
    previous: float = 0.7,
    shared: float = 0.4,
) -> np.ndarray:
    """Return error bars of forces solved on three meshes, as with [accuracy], shape (3,).

    Parameters
    ----------
    coarse, middle, fine : ndarray, shape (3,)
        Forces on the meshes.
    safety : float
        Bar over the difference of the last two meshes.
    previous : float
        Weight of the difference of the first two.
    shared : float
        Smallest bar over the largest of the three.
    """
    bars = safety * np.maximum(np.abs(fine - middle), previous * np.abs(middle - coarse))
    return np.maximum(bars, shared * bars.max())


def odd(number: float) -> int:
    """Return the nearest odd integer."""
    return 2 * round(0.5 * (number - 1.0)) + 1


@lru_cache(maxsize=64)
def unit_scene(ratio: float, poisson: float) -> Scene:
    """Return the scene of a Hertz contact with a given a/b and Poisson's ratio, without mesh."""
    # 1/R_x over 1/R_y of an ellipse, see `mechanics.hertz_contact`.
    integral = scipy.special.elliprd
    curvatures = integral(0.0, 1.0 / ratio, ratio) / integral(0.0, ratio, 1.0 / ratio)
    body = {"young": YOUNG, "poisson": poisson}
    flat = {"radius_x": np.inf, "radius_y": np.inf}
    curved = {"radius_x": RADIUS / curvatures**0.5, "radius_y": RADIUS * curvatures**0.5}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its numbers need not be plausible
        return Scene(
            title=f"Contact of a/b = {ratio:g}",
            body={"A": body | curved, "B": body | flat},
            load={"pressure": PRESSURE},
            creepage=dict.fromkeys(("longitudinal", "lateral", "spin"), 0.0),
            friction={"mu": MU},
        )


def with_mesh(
    scene: Scene,
    elements: int,
    reach: tuple[float, float],
    *,
    margin: int = 2,
    longest: float = 2.0,
) -> Scene:
    """Return the scene with a mesh of `elements` across the shorter of the contact's two sides.

    Parameters
    ----------
    scene : Scene
        The scene.
    elements : int
        Elements across the contact.
    reach : (float, float)
        Half widths of the contact in x and y, mm.
    margin : int
        Additional elements outside of the contact.
    longest : float
        Largest ratio of the sides of an element.
    """
    a, b = reach
    across = [odd(elements * max(1.0, side / cross / longest)) for side, cross in ((a, b), (b, a))]
    half = [side * (1.0 + margin / n) for side, n in zip((a, b), across, strict=True)]
    grid = {"half_length": tuple(half), "elements": tuple(n + margin for n in across)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return scene.replace(grid=grid)

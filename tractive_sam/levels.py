"""Compare levels of a model: what each costs and what it gets wrong, for the contact of a scene.

A scene needs no finer model than its question. The levels are closed forms (Hertz, Carter, the
linear theory with a limit), the simplified theory, the look-up in a table of creep forces, a line
contact, and this program on coarse and fine meshes. All of them compute the contact of the unworn
bodies, and the refined contact with its error bar is the reference.
"""

import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from time import process_time
from typing import Any

import numpy as np

from tractive_sam.description import Section, TextTable
from tractive_sam.lookup import CreepTable
from tractive_sam.mechanics import HertzContact, HertzLine
from tractive_sam.plot import Figure, error_over_time
from tractive_sam.reference import Carter, fastsim, linear_creep_forces, vermeulen_johnson
from tractive_sam.results import NotConverged, State
from tractive_sam.run import solve
from tractive_sam.safe_text import Html
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError, required
from tractive_sam.tables import open_table


@dataclass(frozen=True)
class Level:
    """A level of the model: its cost and its errors, or why it does not apply.

    Attributes
    ----------
    name : str
        What computes the contact.
    seconds : float
        CPU time of one contact, s; nan if it does not apply.
    force, pressure : float
        Error of the vector of the tangential forces over its size, and of the peak pressure over
        the peak pressure; nan if the level does not compute it.
    missing : str
        Why it does not apply; else empty.
    """

    name: str
    seconds: float = math.nan
    force: float = math.nan
    pressure: float = math.nan
    missing: str = ""

    @property
    def error(self) -> float:
        """Largest error of force and pressure; inf if the level does not apply."""
        errors = [error for error in (self.force, self.pressure) if not math.isnan(error)]
        return max(errors, default=math.inf)


@dataclass(frozen=True)
class Levels:
    """Levels of the model for one scene, in the order of their cost.

    Attributes
    ----------
    reference : State
        The refined contact, with error bars.
    uncertainty : float
        Relative error of the reference, which bounds what the errors of levels can show.
    levels : tuple of Level
        The levels.

    Examples
    --------
    >>> levels = ts.compare_levels(ts.Scene.builtin("spheres"), tolerance=2e-3)
    >>> levels.find_cheapest(0.03).name
    'closed form (Hertz, linear theory with a limit)'
    """

    reference: State
    uncertainty: float
    levels: tuple[Level, ...]

    def find_cheapest(self, error: float) -> Level | None:
        """Return the cheapest level whose error is below a stated one; None if none is.

        Parameters
        ----------
        error : float
            Relative error of the forces and the peak pressure.
        """
        enough = (level for level in self.levels if level.error + self.uncertainty <= error)
        return min(enough, key=lambda level: level.seconds, default=None)

    def table(self) -> TextTable:
        """Return the levels as a table of texts."""
        headings = "level", "CPU\nms", "force\n%", "p_max\n%", ""
        rows = []
        for level in self.levels:
            errors = (self._format_error(error) for error in (level.force, level.pressure))
            time = "" if math.isnan(level.seconds) else f"{1e3 * level.seconds:.3g}"
            rows.append([level.name, time, *errors, level.missing])
        caption = f"errors of the refined contact: {100.0 * self.uncertainty:.1g} %"
        return TextTable(rows, headings, frozenset({1, 2, 3}), caption)

    def section(self, error: float | None = None) -> Section:
        """Return the levels as a section of a description, with the cheapest one below an error."""
        rows = [(level.name, level.missing or self._describe(level)) for level in self.levels]
        if error is not None:
            cheapest = self.find_cheapest(error)
            answer = "none of these; set [accuracy]" if cheapest is None else cheapest.name
            rows.append((f"enough for {100.0 * error:.3g} %", answer))
        return Section("Levels of the model", rows)

    def draw(self) -> Figure:
        """Draw the error of each level over its time, see `plot.error_over_time`."""
        applying = [level for level in self.levels if not level.missing]
        points = {level.name: (level.seconds, level.error) for level in applying}
        title = self.reference.scene.title
        return error_over_time(points, self.uncertainty, title=title)

    def _describe(self, level: Level) -> str:
        """Describe errors and time of a level."""
        errors = {"force": level.force, "p_max": level.pressure}
        texts = [
            f"{name} {self._format_error(error)} %"
            for name, error in errors.items()
            if not math.isnan(error)
        ]
        return f"error of {', '.join(texts)}; {1e3 * level.seconds:.2g} ms"

    def _format_error(self, error: float) -> str:
        """Format an error in per cent; below the error of the reference, as that bound."""
        if math.isnan(error):
            return ""
        if error < self.uncertainty:
            return f"< {100.0 * self.uncertainty:.1g}"
        return f"{100.0 * error:.2g}"

    def __repr__(self) -> str:
        return self.table().to_text()

    def _repr_html_(self) -> Html:
        """Return the table as HTML, for notebooks."""
        return self.table().to_html()


@dataclass(frozen=True)
class _Comparison:
    """Comparison of simple and of numerical levels with the refined contact of a scene.

    Attributes
    ----------
    scene : Scene
        The scene, without what follows from the contact.
    reference, usual : State
        The refined contact, and the contact on the mesh that the program chooses.
    """

    scene: Scene
    reference: State
    usual: State

    @property
    def uncertainty(self) -> float:
        """Largest relative error bar of the tangential force and the peak pressure."""
        bars, contact = self.reference.error_bars, self.reference
        force = math.hypot(bars.get("Qx", 0.0), bars.get("Qy", 0.0))
        size = math.hypot(contact.Qx, contact.Qy)
        return max(bars.get("p_max", 0.0) / contact.p_max, force / size if size else 0.0)

    def levels(self, meshes: tuple[int, ...] = (11, 15, 21, 31, 45, 63, 91)) -> Iterator[Level]:
        """Yield the levels that apply, and those that do not with the reason.

        Parameters
        ----------
        meshes : tuple of int
            Elements across the shorter axis of the contact.
        """
        scene, creepage = self.scene, self.scene.creepage
        missing = self._why_no_theory()
        of_point = missing or ("it needs a point contact" if scene.line else "")
        poisson, along = scene.material.poisson, not (creepage.lateral or creepage.spin)
        is_steel = math.isclose(poisson, 0.3, abs_tol=5e-3)
        of_table = "" if is_steel else f"the table has a Poisson's ratio of 0.3, not {poisson:.3g}"
        need = "it needs a {} contact with longitudinal creepage alone"
        of_line = "" if scene.line and along else need.format("line")
        of_wide = "" if along and not scene.line else need.format("point")
        for name, reason, compute in (
            ("closed form (Hertz, Carter)", missing or of_line, self._solve_carter),
            ("closed form (Hertz, linear theory with a limit)", of_point, self._solve_linear),
            ("simplified theory (FASTSIM, 50 x 50)", of_point, self._solve_fastsim),
            ("table look-up (steel)", of_point or of_table, self._look_up),
            ("line contact of equal peak pressure", missing or of_wide, self._solve_line),
        ):
            if reason:
                yield Level(name, missing=reason)
                continue
            try:
                yield self._measure(name, compute)
            except ValueError as error:  # outside of a table
                yield Level(name, missing=str(error))
        usual = self.usual.grid
        directions = usual.directions
        for across in meshes:
            elements = [round(n * across / 64) | 1 for n in usual.elements[:directions]]
            if math.prod(elements) <= math.prod(self.reference.grid.elements):
                mesh = {"elements": elements, "half_length": usual.half_length[:directions]}
                name = f"mesh of {' x '.join(map(str, elements))} elements"
                on_mesh = scene.replace(grid=mesh)
                yield self._measure(name, partial(self._solve, on_mesh))

    def _measure(self, name: str, compute: Callable[[], tuple[float, float, float]]) -> Level:
        """Return the level with its errors and the least CPU time of some calls, s."""
        Qx, Qy, p_max = compute()  # the first call also loads kernels, plans and tables
        times: list[float] = []
        while not times or (sum(times) < 1.0 and (len(times) < 3 or sum(times) < 0.01)):
            began = process_time()
            compute()
            times.append(process_time() - began)
        exact = self.reference
        size = math.hypot(exact.Qx, exact.Qy)
        force = math.hypot(Qx - exact.Qx, Qy - exact.Qy) / size if size else math.nan
        return Level(name, min(times), force, abs(p_max / exact.p_max - 1.0))

    def _why_no_theory(self) -> str:
        """Return why no theory of creep forces applies; empty if one may."""
        scene = self.scene
        friction = scene.friction
        if scene.hertz is None:
            return "the radii give no Hertz contact"
        if friction is None or friction.varies or len({*np.ravel(friction.mu)}) > 1:
            return "it needs one constant friction coefficient"
        if scene.load.force_x is not None or scene.load.force_y is not None:
            return "it needs creepages, and the scene prescribes forces"
        return ""

    @property
    def _contact(self) -> dict[str, float]:
        """Semi-axes and combined shear modulus of the Hertz contact of a point, and its load."""
        hertz, material = self.scene.hertz, self.scene.material
        assert isinstance(hertz, HertzContact)  # as the theory applies
        return {"a": hertz.a, "b": hertz.b, "shear": material.shear, "load": hertz.load}

    @property
    def _creepages(self) -> dict[str, float]:
        """Creepages of the scene."""
        creepage = self.scene.creepage
        return {"xi_x": creepage.longitudinal, "xi_y": creepage.lateral, "spin": creepage.spin}

    @property
    def _mu(self) -> float:
        """Coefficient of friction."""
        return float(np.ravel(required(self.scene.friction, "friction").mu)[0])

    @property
    def _p0(self) -> float:
        """Peak pressure of Hertz, MPa."""
        assert self.scene.hertz is not None  # as the theory applies
        return self.scene.hertz.p0

    def _solve_carter(self) -> tuple[float, float, float]:
        """Return Q_x, Q_y and p_max of Carter's solution."""
        hertz = self.scene.hertz
        assert isinstance(hertz, HertzLine)  # as the theory applies
        carter = Carter(hertz, self._mu, self.scene.creepage.longitudinal)
        return carter.force_ratio * self._mu * hertz.load_per_length, 0.0, hertz.p0

    def _solve_linear(self) -> tuple[float, float, float]:
        """Return Q_x, Q_y and p_max of the linear theory with Vermeulen and Johnson's limit.

        Source: Shen, Hedrick & Elkins, 8th IAVSD Symposium (1983) 591-605.
        """
        contact, limit = self._contact, self._mu * self._contact["load"]
        axes = {name: contact[name] for name in ("a", "b", "shear")}
        forces = linear_creep_forces(**axes, poisson=self.scene.material.poisson, **self._creepages)
        size = math.hypot(forces.Fx, forces.Fy)
        factor = limit * float(vermeulen_johnson(size / (3.0 * limit))) / size if size else 0.0
        return factor * forces.Fx, factor * forces.Fy, self._p0

    def _solve_fastsim(self) -> tuple[float, float, float]:
        """Return Q_x, Q_y and p_max of the simplified theory."""
        numbers: dict[str, Any] = {**self._contact, **self._creepages, "mu": self._mu}
        forces = fastsim(poisson=self.scene.material.poisson, **numbers)
        return forces.Fx, forces.Fy, self._p0

    def _look_up(self) -> tuple[float, float, float]:
        """Return Q_x, Q_y and p_max by the table of creep forces."""
        forces = self._table(**self._creepages, **self._contact, mu=self._mu)
        return float(forces.Qx), float(forces.Qy), self._p0

    @cached_property
    def _table(self) -> CreepTable:
        """The built-in table."""
        return open_table("steel")

    def _solve_line(self) -> tuple[float, float, float]:
        """Return Q_x, Q_y and p_max of a line contact of equal peak pressure and Q over P."""
        flat = {"body.A.radius_y": math.inf, "body.B.radius_y": math.inf, "grid": None}
        return self._solve(self.scene.replace(**flat, load={"pressure": self._p0}))

    def _solve(self, scene: Scene) -> tuple[float, float, float]:
        """Return Q_x, Q_y and p_max of a scene under the load of the contact."""
        contact = solve(scene, throw=False)
        share = self.reference.P / contact.P
        return share * contact.Qx, share * contact.Qy, contact.p_max


def compare_levels(scene: Scene, tolerance: float = 1e-3) -> Levels:
    """Compute the unworn contact of a scene on every level of the model, and compare them.

    Parameters
    ----------
    scene : Scene
        A scene of steady rolling with one contact.
    tolerance : float
        Relative error of the refined contact with which the levels are compared; if it is not
        reached, they are compared with the contact whose error is the smallest.

    Raises
    ------
    SceneError
        If the scene has a [transient], a [[duty]], a [wheelset] or [conformal].
    NotConverged
        If the refined contact does not converge.

    Examples
    --------
    >>> levels = ts.compare_levels(ts.Scene.builtin("cylinders"), tolerance=2e-3)
    >>> [level.name for level in levels.levels if not level.missing][0]
    'closed form (Hertz, Carter)'
    """
    steady = "levels are compared for a scene of steady rolling with one contact"
    reasons = {key: steady for key in ("transient", "duty", "wheelset") if scene.has(key)}
    if reasons := reasons | scene.find_exclusions("levels"):
        raise SceneError(Fault(key, "a table", f"none: {why}") for key, why in reasons.items())
    plain = scene.replace(wear=None, fatigue=None, subsurface=None, heat=None, accuracy=None)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        refined = plain.replace(grid=None, accuracy={"tolerance": tolerance})
        reference = solve(refined, throw=False)
        usual = solve(plain.replace(grid=None), throw=False)
    if not (reference.converged or reference.error_bars):
        raise NotConverged(reference)
    comparison = _Comparison(plain, reference, usual)
    levels = sorted(comparison.levels(), key=lambda level: (bool(level.missing), level.seconds))
    return Levels(reference, comparison.uncertainty, tuple(levels))

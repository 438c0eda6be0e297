"""A solved contact: fields, resultants, the quality and cost of the solution, and its columns."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property, partial
from operator import add, attrgetter
from typing import Any, ClassVar

import numpy as np

from tractive_sam.description import html_table, text_table
from tractive_sam.extra_packages import xarray
from tractive_sam.kernels.contact_edge import edge_place
from tractive_sam.mechanics import Frame
from tractive_sam.results.grid import Grid, widen_field
from tractive_sam.results.heat import FlashTemperature
from tractive_sam.results.quantity import (
    Quantity,
    index_by_name,
    read_component,
    read_number,
    vectors,
)
from tractive_sam.safe_text import Html
from tractive_sam.scene import Scene


def html_with_figure(
    rows: Mapping[str, str], name: str, source: Any, wide: int = 380, narrow: int = 230
) -> Html:
    """Return HTML with rows (label, text) as a table next to a named figure of `plot`.

    Parameters
    ----------
    rows : mapping of str to str
        Rows of the table.
    name : str
        Name of a figure of `plot`; omitted if it has nothing to draw.
    source : State or History
        Argument of the figure.
    wide, narrow : int
        Width of a landscape and of a portrait figure, pixels.
    """
    # Figures are in a higher package; they are taken from the public package, as a user does.
    import tractive_sam  # noqa: PLC0415

    try:
        figure = getattr(tractive_sam.plot, name)(source)
    except (LookupError, ValueError):  # no fields, or nothing to draw
        return html_table(rows, Html())
    landscape = figure.get_figwidth() > figure.get_figheight()
    return html_table(rows, figure.to_html(wide if landscape else narrow))


class Status(StrEnum):
    """How a solve ended: converged, or the reason for its failure."""

    CONVERGED = "converged"
    OUT_OF_ITERATIONS = "out of iterations"
    DIVERGED = "diverged"
    OFF_GRID = "off grid"
    NOT_RESOLVED = "not resolved"
    INACCURATE = "inaccurate"


@dataclass(frozen=True)
class Cost:
    """Computational cost of a solve, in counts that do not depend on the machine, and its time.

    Attributes
    ----------
    applications : float
        Applications of the displacement, slip or coupled operator; on coarser meshes weighted by
        their share of the elements.
    preconditioner : float
        Applications of circulant inverses and, within a step of a transient, of the operators on a
        shorter period; each has as many transforms, of a quarter to half the size.
    convolutions : float
        All padded transforms of the solve, of operators and preconditioners, over the number in one
        application of the tangential operator on the mesh (`compute.fft`).
    over_application : float
        CPU time of the solve over the time of such an application, measured in the solve. The first
        solve on a mesh also plans its transforms. It is not compared.
    """

    applications: float = 0.0
    preconditioner: float = 0.0
    convolutions: float = 0.0
    over_application: float = field(default=0.0, compare=False)

    def __add__(self, other: "Cost") -> "Cost":
        return Cost(*map(add, vars(self).values(), vars(other).values()))

    def scaled(self, share: float) -> "Cost":
        """Return the cost multiplied by a share, for work on a coarser mesh."""
        return Cost(*(share * part for part in vars(self).values()))


class NotConverged(RuntimeError):  # noqa: N818 - the name says what happened
    """Raised for a contact without solution; `contact` is the last iterate.

    Examples
    --------
    >>> settings = ["load.approach=0.036", "load.force_x=0.4", "grid.elements=[15, 15]"]
    >>> try:
    ...     ts.solve(scene.with_set(settings))  # more than friction carries
    ... except ts.NotConverged as error:
    ...     print(error.contact.converged)
    False
    """

    def __init__(self, contact: "State"):
        super().__init__(contact.message)
        self.contact = contact

    def __reduce__(self):
        """Pickle the error by its contact, so that it can be sent between processes."""
        return NotConverged, (self.contact,)


@dataclass(frozen=True, eq=False)
class State:
    """One solved steady state of rolling contact: fields on the mesh, forces and other results.

    Fields have the shape (n_x, n_y) of the grid, vectors (2, n_x, n_y) with the x-component first.
    Tractions act on body A; slip is the velocity of A relative to B over the rolling speed.

    In a line contact n_y is 1, and forces, moment and dissipation are per length: N/mm, and N for
    the moment.

    Attributes
    ----------
    scene : Scene
        The solved scene.
    grid : Grid
        The mesh.
    pressure : ndarray
        p_n >= 0, MPa.
    traction : ndarray
        (p_x, p_y) on body A, MPa.
    slip : ndarray
        (s_x, s_y)/V at the centres of the elements, dimensionless; zero outside the contact. It is
        the mean slip of the leading and the trailing face of an element, which determines wear and
        dissipation. An element sticks if its leading face does. So a sticking element ahead of a
        slipping one shows half its slip, and a leading one half the slip of the surfaces ahead of
        the contact. If slip reverses from one face to the next, the mean of a sliding element may
        point along its traction; its share of the power falls with the element size. ``slip =
        "upwind"`` gives the slip of the leading face.
    gap : ndarray
        Separation of the deformed surfaces, mm.
    wear : ndarray
        Depth worn off both bodies together, mm.
    approach : float
        Rigid-body approach from the first touch of the unworn bodies, mm. In a line contact it is
        relative to the points of the surface one combined radius R_x away, or two lengths of the
        mesh if that is more: relative to distant points it is infinite.
    xi_x, xi_y, spin : float
        Longitudinal and lateral creepage; spin in 1/mm.
    rolling_resistance : float
        Work of the pressure per distance rolled, the integral of p_n dh/dx over the gap h of the
        undeformed, worn bodies, N; zero for elastic bodies of equal material. Its differences make
        `work_supplied` equal to the dissipation on any mesh (`contact.steady`).
    sliding : ndarray of bool
        Elements in contact with tractions that have reached the friction bound.
    status : Status
        CONVERGED, or the reason of the failure.
    note : str
        Remark on a solution, or what to try without one. See `message`.
    residual : float
        Relative natural residual of all contact conditions.
    cost : Cost
        Applications of operators and preconditioners.
    trace : tuple of str
        Steps of the solution method.
    error_bars : mapping of str to float or mapping
        For scenes with [accuracy]: estimated distance of numbers from their values on an infinitely
        fine mesh, by their recorded names and in their units, for "von_mises_max" by body; and
        "relative", the widest relative error bar that the tolerance bounds.
    revolution : int
        Revolutions rolled.
    volumes : mapping of str to float, optional
        `worn_volume` of the history; by default it follows from `wear`.
    jacobian : xarray.DataArray or None
        From ``solve(scene, jacobian=True)``: derivatives of Qx, Qy, Mz and approach (rows,
        "result") by xi_x, xi_y, spin, P, mu1 and mu2 (columns, "parameter"), with everything else
        constant, including the mesh. A prescribed force is a column and its creepage a row; a
        prescribed approach is a column and P a row. A line contact has no column for spin, and a
        user-defined friction law none for mu. For isotropic friction the derivative by mu is the
        sum of both; for a law that falls with speed mu is the static coefficient, with the kinetic
        one in proportion. Attributes: `units` of rows and columns (an entry has the unit of its row
        over that of its column), and `operator_applications`. On a given mesh it is exact to 1e-6
        while no element changes between stick, slip and no contact (`contact.jacobian`). Pickles
        and results files do not contain it.
    heat : FlashTemperature or None
        For scenes with [heat]: temperatures of both surfaces, and the heat flux into them.
    tilt : float
        Angle between the axes of rollers with a profile, mrad, prescribed or found for a moment.
    frame : Frame or None
        Scaled tribological frame of the friction law; None without friction.
    traction_bound : ndarray or None
        Largest ||p_t||_mu that friction allows in each element under its slip, MPa; None if it is
        the pressure, as for Coulomb's law.
    bulk_dissipation : mapping of str to float
        Work per distance rolled that each body dissipates inside, N; empty if none relaxes.
    laws : Laws or mapping of str to LawRecord
        Laws of the solution; for a contact read from a file the laws that replaced laws of its
        scene (`History.law_records`).

    Examples
    --------
    >>> contact.converged, contact.pressure.shape
    (True, (91, 91))
    >>> round(contact.p_max / scene.hertz.p0, 3)
    1.0
    >>> jacobian = ts.solve(scene, jacobian=True).jacobian
    >>> jacobian.attrs["units"]["Qx"]
    'N'
    >>> jacobian.loc["Qx", "xi_x"].item() < 0.0
    True
    """

    _bound_tolerance = 1e-5
    """Distance from the friction bound, over the peak pressure, below which an element slips: well
    above the residual of any useful solution."""

    scene: Scene
    grid: Grid
    pressure: np.ndarray
    traction: np.ndarray
    slip: np.ndarray
    gap: np.ndarray
    wear: np.ndarray
    approach: float
    xi_x: float
    xi_y: float
    spin: float
    rolling_resistance: float
    sliding: np.ndarray
    status: Status
    note: str
    residual: float
    cost: Cost
    trace: tuple[str, ...] = ()
    error_bars: Mapping[str, Any] = field(default_factory=dict)
    revolution: int = 0
    volumes: Mapping[str, float] | None = field(default=None, repr=False)
    jacobian: "xarray.DataArray | None" = field(default=None, repr=False)
    heat: FlashTemperature | None = field(default=None, repr=False)
    tilt: float = 0.0
    frame: Frame | None = None
    traction_bound: np.ndarray | None = field(default=None, repr=False)
    bulk_dissipation: Mapping[str, float] = field(default_factory=dict)
    laws: Any = field(default_factory=dict, repr=False)

    def __repr__(self) -> str:
        return text_table("Contact", self._summary())

    def _repr_html_(self) -> str:
        """Return the summary of the contact and a pressure figure as HTML, for notebooks."""
        return html_with_figure(self._summary(), "pressure", self)

    def _summary(self) -> dict[str, str]:
        """Return the summary of the contact as text by label: status, forces, creepages, mesh."""
        unit = self.scene.contact_type.unit
        wide = {"a": self.half_width_x, "b": self.half_width_y}
        widths = [f"{name} = {half:.4g} mm" for name, half in wide.items() if math.isfinite(half)]
        at = f", revolution {self.revolution}" if self.revolution else ""
        return {
            "scene": (self.scene.title or "no title") + at,
            "status": f"{self.status}: {self.message}",
            "forces": f"P = {self.P:.4g}, Qx = {self.Qx:.4g}, Qy = {self.Qy:.4g} "
            f"{unit('N')}, Mz = {self.Mz:.3g} {unit('N mm')}",
            "creepages": f"xi_x = {self.xi_x:.4g}, xi_y = {self.xi_y:.4g}, "
            f"spin = {self.spin:.4g} /mm",
            "contact": f"{', '.join(widths)}, p_max = {self.p_max:.4g} MPa, "
            f"{self.stick_fraction:.0%} sticks",
            "mesh": self.grid.describe_size(),
        }

    def __getstate__(self) -> dict[str, Any]:
        """Pickle without the Jacobian: the reader may not have xarray."""
        return self.__dict__ | {"jacobian": None}

    @property
    def message(self) -> str:
        """Meaning of the status and, without convergence, what to try."""
        if self.converged:
            return f"contact conditions hold to {self.residual:.1e}{self.note}"
        return self.note

    @property
    def converged(self) -> bool:
        """Whether the contact conditions hold to the tolerance of the scene."""
        return self.status is Status.CONVERGED

    @property
    def at_edge(self) -> tuple[bool, bool]:
        """Whether the contact reaches the edge of the mesh in x and in y (a line: not in y)."""
        touching, is_line = self.touching, self.touching.shape[1] == 1
        ends, sides = touching[0] | touching[-1], touching[:, 0] | touching[:, -1]
        return bool(ends.any()), bool(sides.any()) and not is_line

    @property
    def elements_across(self) -> tuple[int, ...]:
        """Elements of the contact in x, and in y; of a line contact in x alone."""
        return tuple(int(self.touching.any(axis=1 - k).sum()) for k in range(self.grid.directions))

    def on(self, grid: Grid) -> "State":
        """Return the contact on a wider mesh of equal elements: gap inf, else 0 outside, no heat.

        Raises
        ------
        ValueError
            If the wider mesh does not add equal numbers of elements on both sides.
        """
        same_sides = np.allclose((grid.dx, grid.dy), (self.grid.dx, self.grid.dy), rtol=1e-9)
        if not same_sides or grid.centre != self.grid.centre:
            raise ValueError(f"{self.grid} is not the middle of {grid}")
        changes: dict[str, Any] = {
            name: widen_field(
                getattr(self, name), grid.elements, math.inf if name == "gap" else 0.0
            )
            for name in ("pressure", "traction", "slip", "gap", "wear", "sliding")
        }
        if self.traction_bound is not None:
            changes["traction_bound"] = widen_field(self.traction_bound, grid.elements)
        # The temperatures on the wider mesh are not computed.
        return replace(self, grid=grid, heat=None, **changes)

    @cached_property
    def touching(self) -> np.ndarray:
        """Elements in contact, bool."""
        return self.pressure > 0.0

    @cached_property
    def sticking(self) -> np.ndarray:
        """Elements in contact that do not slip, bool."""
        return self.touching & ~self.sliding

    @cached_property
    def utilisation(self) -> np.ndarray:
        """Tangential traction in the norm of the friction law, ||p_t||_mu, MPa; 0 if none."""
        if self.frame is None:
            return np.zeros_like(self.pressure)
        first, second = self.frame.to_scaled(self.traction)
        return np.sqrt(first**2 + second**2)

    @property
    def bound(self) -> np.ndarray:
        """Largest `utilisation` that friction allows in each element, MPa: the traction bound."""
        return self.pressure if self.traction_bound is None else self.traction_bound

    def with_cost(self, cost: Cost) -> "State":
        """Return a copy of the contact with another computational cost."""
        return replace(self, cost=cost)

    def reuse_values(self, earlier: "State") -> None:
        """Store values that an earlier contact has computed, if both have the same pressure.

        A step under a constant load changes the tractions only.
        """
        if not np.array_equal(self.pressure, earlier.pressure):
            return
        for value in self._of_pressure:
            if value.attrname in earlier.__dict__:
                self.__dict__[value.attrname] = earlier.__dict__[value.attrname]

    @property
    def friction_varies(self) -> bool:
        """Whether the bound of the traction differs from the pressure in some elements.

        For files written before the bound was stored it follows from the scene.
        """
        friction = self.scene.friction
        return self.traction_bound is not None or (friction is not None and friction.varies)

    def with_sliding_by_traction(self) -> "State":
        """Return a copy with `sliding` elements wherever tractions reach their bound."""
        margin = self._bound_tolerance * self.pressure.max()
        return replace(self, sliding=self.touching & (self.utilisation >= self.bound - margin))

    def _integral(self, field: np.ndarray) -> float:
        """Return the integral of a field over the mesh (per length for a line contact)."""
        return float(field.sum() * self.grid.element_area)

    @cached_property
    def P(self) -> float:
        """Normal load, N."""
        return self._integral(self.pressure)

    @cached_property
    def Qx(self) -> float:
        """Longitudinal force on A, N."""
        return self._integral(self.traction[0])

    @cached_property
    def Qy(self) -> float:
        """Lateral force on A, N."""
        return self._integral(self.traction[1])

    @cached_property
    def Mz(self) -> float:
        """Spin moment on A, N mm."""
        along_x, along_y = self.traction[1].sum(axis=1), self.traction[0].sum(axis=0)
        return self._integral(self.grid.x @ along_x - self.grid.y @ along_y)

    @cached_property
    def Mx(self) -> float:
        """Moment of the pressure about the x axis, the integral of p y, N mm."""
        return self._integral(self.pressure.sum(axis=0) @ self.grid.y)

    @cached_property
    def My(self) -> float:
        """Rolling resistance moment: of the pressure about y, the integral of p x, N mm."""
        return self._integral(self.grid.x @ self.pressure.sum(axis=1))

    @cached_property
    def resultant(self) -> tuple[float, float]:
        """Lateral and normal force on A, N, in the frame of the middle of the patch.

        On a curved patch both have parts of the pressure and of the traction.
        """
        x, y = self.grid.x[:, None], self.grid.y[None, :]
        lateral, normal = self.scene.patch.force(x, y, self.pressure, self.traction)
        return lateral * self.grid.element_area, normal * self.grid.element_area

    @cached_property
    def end_load(self) -> float:
        """Load within a twentieth of the width of the free ends of the narrower body, N."""
        width = min(body.width or math.inf for body in self.scene.body.rollers.values())
        rows = (np.abs(self.grid.y) - 0.45 * width) / self.grid.dy + 0.5
        return self._integral(self.pressure.sum(axis=0) @ np.clip(rows, 0.0, 1.0))

    @property
    def p_max(self) -> float:
        """Peak contact pressure of an element, MPa."""
        return float(self.pressure.max())

    @cached_property
    def p_95(self) -> float:
        """Pressure that 5 % of the load exceeds, MPa: a peak that depends on no single element.

        In Hertz contacts it is 0.95^(1/3) = 0.983 of the peak contact pressure, in line contacts
        0.999. At the rim of a worn contact the pressure may have a spike as wide as an element;
        then the peak contact pressure jumps with each element that comes into contact, and this
        pressure does not.
        """
        total, peak = self.pressure.sum(), self.p_max
        if not total:
            return 0.0
        # Few elements are sorted, unless the load is on many pressures that are much smaller.
        for fraction in (0.9, 0.5, 0.0):
            pressures = self.pressure[self.pressure > fraction * peak]
            if pressures.sum() > 0.05 * total:
                break
        pressures = np.sort(pressures)[::-1]
        return float(np.interp(0.05, np.cumsum(pressures) / total, pressures))

    @cached_property
    def p_max_at(self) -> tuple[float, float]:
        """Place of the largest pressure, (x, y) in mm; nan without contact."""
        if not self.pressure.any():
            return math.nan, math.nan
        i, j = np.unravel_index(np.argmax(self.pressure), self.pressure.shape)
        return float(self.grid.x[i]), float(self.grid.y[j])

    @cached_property
    def half_width_x(self) -> float:
        """Half the extent of the contact in x, mm.

        The extent is from edge to edge over all rows of elements. At an edge the squared pressure
        extrapolates to zero (`distance_to_edge`).
        """
        return 0.5 * self.grid.dx * contact_extent(self.pressure)

    @cached_property
    def half_width_y(self) -> float:
        """Half the extent of the contact in y, mm; inf for a line contact."""
        if self.grid.directions == 1:
            return math.inf
        return 0.5 * self.grid.dy * contact_extent(self.pressure.T)

    @cached_property
    def area(self) -> float:
        """Contact area within its edges, mm²; for a line contact its width, mm."""
        return self.grid.element_area * covered_elements(self.pressure)

    @cached_property
    def stick_fraction(self) -> float:
        """Share of the contact area that sticks; 0 without contact.

        At the end of stick the distance of the traction from its bound falls to zero, as the
        pressure does at the edge of the contact. So both areas end between the centres of elements.
        If the bound is not the pressure, the distance may jump; then elements are counted.
        """
        from tractive_sam.kernels.contact_area import bound_reserve  # noqa: PLC0415

        reserve, scaling = np.empty(self.pressure.shape), np.zeros((2, 2))
        if self.frame is not None:
            scaling = np.ascontiguousarray(self.frame.inverse.T)
        fields = self.pressure, self.traction, self.sliding
        stuck, slid, lacks = bound_reserve(*fields, scaling, reserve)
        if not stuck:
            return 0.0
        if not slid or lacks > self._bound_tolerance * self.p_max:
            return stuck / (stuck + slid)
        return min(1.0, self.grid.element_area * covered_elements(reserve) / self.area)

    _of_pressure: ClassVar[Any] = (touching, P, p_95, p_max_at, half_width_x, half_width_y, area)
    """Stored values that depend on the pressure alone."""

    @property
    def dissipation(self) -> float:
        """Frictional work per unit distance rolled, the integral of -p_t . s/V, N."""
        return 0.0 - self._integral((self.traction * self.slip).sum(axis=0))

    @property
    def work_supplied(self) -> float:
        """Work per unit distance rolled that drives the bodies, N; it equals the dissipation.

        -(Q_x xi_x + Q_y xi_y + M_z phi) and, for dissimilar bodies, the rolling resistance. The
        elastic displacements do no work in a cycle: their operators are antisymmetric. Bodies that
        relax dissipate a part inside, `bulk_dissipation`.
        """
        return self.rolling_resistance + self.t_gamma

    @property
    def t_gamma(self) -> float:
        """T-gamma, the work of the tangential forces per distance rolled, N.

        -(Q_x xi_x + Q_y xi_y + M_z phi).
        """
        return 0.0 - (self.Qx * self.xi_x + self.Qy * self.xi_y + self.Mz * self.spin)

    @property
    def t_gamma_over_area(self) -> float:
        """T-gamma over the contact area, MPa; 0 without contact."""
        return self.t_gamma / self.area if self.area else 0.0

    @property
    def creepage_found(self) -> tuple[float, float]:
        """Longitudinal and lateral creepage for prescribed forces; nan for prescribed creepages."""
        forced_x, forced_y = self.scene.has_prescribed_force
        return self.xi_x if forced_x else math.nan, self.xi_y if forced_y else math.nan

    @cached_property
    def worn_volume(self) -> dict[str, float]:
        """Volume worn off the bodies "A" and "B" since they were new, mm³; nan for a flat body.

        Worn cross section times the circumference 2 pi R_x; for a line contact per length, mm².
        """
        if self.volumes is not None:
            return dict(self.volumes)
        turns, (entering, leaving) = self.scene.turns, (self.wear[-1], self.wear[0])
        return self.volumes_of({body: turns.mean_depth(body, entering, leaving) for body in "AB"})

    def volumes_of(self, around: Mapping[str, np.ndarray]) -> dict[str, float]:
        """Return volumes, mm³, worn off bodies from the mean depth around each; nan if flat."""
        volumes = {}
        for body, depth in around.items():
            length = 2.0 * math.pi * abs(getattr(self.scene.body, body).radius_x)
            section = depth.sum() * self.grid.dy
            volumes[body] = float(length * section) if math.isfinite(length) else math.nan
        return volumes

    @property
    def worn_mass(self) -> dict[str, float]:
        """Mass worn off the bodies "A" and "B", their `worn_volume` times density, mg."""
        bodies = self.scene.body
        density = {"A": bodies.A.density, "B": bodies.B.density}
        return {name: 1e-3 * density[name] * volume for name, volume in self.worn_volume.items()}

    @property
    def worn_area(self) -> float:
        """Cross section worn off both bodies in this revolution, mm²."""
        return float((self.wear[0] - self.wear[-1]).sum() * self.grid.dy)


def _over_load(force: str, contact: State) -> float:
    """Return a force of a contact over its load; 0 without load."""
    return getattr(contact, force) / contact.P if contact.P else 0.0


def _deepest(contact: State) -> float:
    """Return the largest wear depth of both bodies together, mm."""
    return float(contact.wear.max())


FIELDS = index_by_name(
    (
        Quantity("pressure", "MPa", "contact pressure", attrgetter("pressure")),
        *vectors("traction", "MPa", "traction on body A"),
        *vectors("slip", "1", "slip of A relative to B, divided by the rolling speed"),
        Quantity("wear", "mm", "wear depth, both bodies together", attrgetter("wear")),
        Quantity(
            "gap",
            "mm",
            "separation of the deformed surfaces",
            attrgetter("gap"),
            outside=math.inf,
        ),
        Quantity(
            "sliding",
            "1",
            "1 if the traction has reached the friction bound",
            partial(read_number, "sliding"),
        ),
    )
)
"""Functions of x and y, stored at chosen revolutions; resuming needs all of them."""

BOUND = Quantity(
    "traction_bound",
    "MPa",
    "largest traction that friction allows, in the norm of its law",
    attrgetter("traction_bound"),
)
"""Stored with `FIELDS` if it differs from the pressure, which it does not for Coulomb's law."""

BEFORE = ("before_pressure", "before_x", "before_y")
"""Names of the pressure and the tractions of the step before, which resuming a transient needs."""

# fmt: off
CONTACT_COLUMNS = (
    Quantity("P", "N", "normal load", attrgetter("P"), symbol="P", per_length=True),
    Quantity("Qx", "N", "longitudinal force on body A", attrgetter("Qx"),
             symbol="Q_x", per_length=True),
    Quantity("Qy", "N", "lateral force on body A", attrgetter("Qy"),
             symbol="Q_y", per_length=True),
    Quantity("Fy", "N", "lateral force on A of pressure and traction, at the middle of the patch",
             partial(read_component, "resultant", 0), symbol="F_y", needs=("conformal",),
             per_length=True),
    Quantity("Fz", "N", "normal force on A of pressure and traction, at the middle of the patch",
             partial(read_component, "resultant", 1), symbol="F_z", needs=("conformal",),
             per_length=True),
    Quantity("Mz", "N mm", "spin moment on body A", attrgetter("Mz"),
             symbol="M_z", per_length=True),
    Quantity("Mx", "N mm", "moment of the pressure about x, the integral of p y",
             attrgetter("Mx"), symbol="M_x", needs=("body.has_roller",)),
    Quantity("My", "N mm", "rolling resistance moment, the integral of p x",
             attrgetter("My"), symbol="M_y", needs=("body.relaxes",), per_length=True),
    Quantity("tilt", "mrad", "angle between the axes of the rollers; their distance grows with y",
             attrgetter("tilt"), symbol=r"\theta", needs=("body.has_roller",)),
    Quantity("end_load", "N", "load within a twentieth of the width of the free ends",
             attrgetter("end_load"), symbol="P_e", needs=("body.has_ends",)),
    Quantity("Qx_over_P", "1", "longitudinal force over normal load",
             partial(_over_load, "Qx"), symbol="Q_x/P", format=".4f"),
    Quantity("Qy_over_P", "1", "lateral force over normal load",
             partial(_over_load, "Qy"), symbol="Q_y/P", format=".4f"),
    Quantity("approach", "mm", "approach; in a line contact, relative to surface points at the "
                               "distance R_x",
             attrgetter("approach"), symbol=r"\delta"),
    Quantity("p_max", "MPa", "peak contact pressure", attrgetter("p_max"),
             symbol=r"p_\mathrm{max}", over_blocks="largest"),
    Quantity("p_95", "MPa", "pressure above which 5 % of the load is carried",
             attrgetter("p_95"), symbol="p_{95}", over_blocks="largest"),
    Quantity("half_width_x", "mm", "half-width of the contact in the rolling direction; its "
                                   "edge may lie between elements",
             attrgetter("half_width_x"), symbol="a", over_blocks="largest"),
    Quantity("half_width_y", "mm", "half-width of the contact in the lateral direction; its "
                                   "edge may lie between elements",
             attrgetter("half_width_y"), symbol="b", over_blocks="largest"),
    Quantity("area", "mm2", "contact area", attrgetter("area"), symbol="A",
             per_length=True),
    Quantity("wear_max", "mm", "largest wear depth, both bodies together",
             _deepest, symbol=r"w_\mathrm{max}", over_blocks="largest"),
    Quantity("stick_fraction", "1", "fraction of the contact area that sticks",
             attrgetter("stick_fraction"), format=".3f"),
    Quantity("xi_x", "1", "longitudinal creepage", attrgetter("xi_x"), symbol=r"\xi_x"),
    Quantity("xi_y", "1", "lateral creepage", attrgetter("xi_y"), symbol=r"\xi_y"),
    Quantity("spin", "1/mm", "spin creepage", attrgetter("spin"), symbol=r"\varphi"),
    Quantity("residual", "1", "relative residual of the contact conditions",
             attrgetter("residual"), format=".0e", over_blocks="largest"),
    Quantity("dissipation", "N", "frictional work per unit rolling distance, by traction and slip",
             attrgetter("dissipation"), per_length=True),
    Quantity("work_supplied", "N", "work of the driving forces per unit rolling distance",
             attrgetter("work_supplied"), per_length=True),
    Quantity("t_gamma", "N", "T-gamma, -(Q_x xi_x + Q_y xi_y + M_z phi)", attrgetter("t_gamma"),
             symbol=r"T\gamma", per_length=True),
    Quantity("t_gamma_over_area", "MPa", "T-gamma over the contact area",
             attrgetter("t_gamma_over_area"), symbol=r"T\gamma/A"),
    Quantity("bulk_dissipation", "N", "work per unit rolling distance that a body loses inside",
             attrgetter("bulk_dissipation"), dims=("body",), needs=("body.relaxes",),
             per_length=True),
    Quantity("worn_area", "mm2", "cross-section worn off both bodies in a pass",
             attrgetter("worn_area"), per_length=True),
    Quantity("operator_applications", "1", "applications of elastic operators",
             attrgetter("cost.applications"), over_blocks="sum"),
    Quantity("convolutions", "1", "convolutions, in units of one tangential application",
             attrgetter("cost.convolutions"), over_blocks="sum"),
    Quantity("over_application", "1", "CPU time of a solution over one tangential application",
             attrgetter("cost.over_application"), over_blocks="sum"),
    Quantity("converged", "1", "1 if the contact conditions hold to the tolerance",
             partial(read_number, "converged"), format="d", over_blocks="smallest"),
    Quantity("p_max_at", "mm", "position (x, y) of the peak contact pressure",
             attrgetter("p_max_at"), ("axis",), place_of="p_max"),
    Quantity("wear_profile", "mm", "wear depth behind the contact, both bodies together; for "
                                   "shifts, the largest along x",
             partial(read_component, "wear", 0), ("y",)),
    Quantity("creepage_found", "1", "creepages (x, y) that the prescribed forces require",
             attrgetter("creepage_found"), ("axis",), needs=("finds_creepage",)),
    Quantity("worn_volume", "mm3", "volume worn off each body since it was new; for a flat "
                                   "body, only in a transient",
             attrgetter("worn_volume"), ("body",), symbol="V", per_length=True, needs=("wear",)),
    Quantity("worn_mass", "mg", "mass worn off each body since it was new, from its density",
             attrgetter("worn_mass"), ("body",), symbol="m", per_length=True, needs=("wear",)),
)
# fmt: on
"""Columns that a contact provides."""

Contact = State
"""Former name of `State`."""


# Positions of the edges of a contact between the centres of elements. Towards the edge the square
# of the pressure falls in proportion to the distance. The outermost element in contact and its
# neighbour determine the place at which it extrapolates to zero. If the pressures were samples at
# points, the edge would lie r²/(1 - r²) elements beyond the centre of the outermost one, with r the
# quotient of both pressures. For elements of constant pressure the distance is a cubic in r. One
# cubic serves all bodies and meshes, since any edge is straight on the scale of an element, and any
# contact is in plane strain along it. Its coefficients are fitted to line contacts with edges in
# all positions within an element of size a/728; `tests/results/test_edges.py` checks them. When an
# element comes into contact r is zero, so the edge does not jump.


def distance_to_edge(pressure: np.ndarray) -> np.ndarray:
    """Return where the edge lies ahead (+x) of outermost centres, in elements; nan elsewhere.

    Parameters
    ----------
    pressure : ndarray, shape (n, m)
        p_n, MPa; zero outside the contact.

    Returns
    -------
    ndarray, shape (n, m)
        Distance towards larger indices, in elements; nan for elements without an edge ahead.
    """
    distances = np.full(pressure.shape, np.nan)
    i, j, place = _edges_ahead(pressure)
    distances[i, j] = place
    return distances


def _edges_ahead(pressure: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return indices i, j of elements with an edge ahead (+x), and its distances, in elements."""
    touching = pressure > 0.0
    last = touching.copy()
    last[:-1] &= ~touching[1:]
    i, j = np.nonzero(last)
    before = np.where(i > 0, pressure[i - 1, j], 0.0)
    return i, j, edge_place(pressure[i, j], before)


def distances_to_edges(pressure: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return where edges lie ahead (+x) and behind outermost centres, elements; nan elsewhere."""
    return distance_to_edge(pressure), distance_to_edge(pressure[::-1])[::-1]


def contact_extent(pressure: np.ndarray) -> float:
    """Return the length along x from first to last edge, in elements; 0 without contact."""
    rows = np.flatnonzero(pressure.any(axis=1))
    if not rows.size:
        return 0.0
    first, last = rows[0], rows[-1]
    ahead, behind = pressure[max(last - 2, 0) : last + 1], pressure[first : first + 3][::-1]
    return float(last - first + _last_edge(ahead) + _last_edge(behind))


def _last_edge(pressure: np.ndarray) -> float:
    """Return where the last edge ahead lies, in elements beyond the centres of the last row.

    It belongs to an element of the last two rows.
    """
    i, _, place = _edges_ahead(pressure)
    return (i + place).max() - (len(pressure) - 1)


def covered_elements(pressure: np.ndarray) -> float:
    """Return the contact area in elements, bounded by straight lines between its edge points.

    The edges lie on the lines between the centres of elements; on a mesh one element wide along
    the first axis alone.
    """
    if pressure.shape[1] == 1:
        beyond = np.array(distances_to_edges(pressure)) - 0.5
        return np.count_nonzero(pressure > 0.0) + float(np.nansum(beyond))
    # Reading and drawing results needs no compiler, which takes long to load.
    from tractive_sam.kernels.contact_area import covered_area  # noqa: PLC0415

    wide: np.ndarray = np.zeros((pressure.shape[0] + 4, pressure.shape[1] + 4))
    wide[2:-2, 2:-2] = pressure
    return covered_area(wide)

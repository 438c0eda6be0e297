"""Memory of bodies that relax, in the steps of a transient, in mm, N and MPa.

With a term of ratio f and time tau, a particle is displaced by the memory q, tau dq/dt + q = f A p,
along its way. The state of a term is what q differs by from the memory of steady rolling under the
tractions of the moment, q = f M p + rest. In a step of the distance d and the time t

    rest_1(x) = exp(-t/tau) rest_0(x + d) + f C (p_0 - p_1),

see `mechanics.relaxation`. In a step at rest, d = 0, with y = t/tau, b_1 = (y - 1 + exp(-y))/y and
b_0 + b_1 = 1 - exp(-y),

    rest_1 = exp(-y) rest_0 + f (exp(-y) M p_0 - M p_1 + A (b_0 p_0 + b_1 p_1)),

and a shift takes no time: q stays.

**Places.** The rest is needed where material comes from, up to where its memory ends. Ahead of the
nodes of the mesh and of two dozen elements more lie nodes at 2, 4, 8 ... lengths of an element, a
dozen each; loads act there like those of elements of these lengths. Between nodes the rest is a
cubic. In a line contact the nodes also reach to the datum on both sides, relative to which surfaces
are displaced.

**Energy.** The springs of a term store E, half the work of the tractions that its dashpot passes
on: tau dE/dt = q . p - 2 E, however these are distributed. What the work on q adds to E beyond that
is dissipated.
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from tractive_sam.contact.model import Model
from tractive_sam.mechanics import Elasticity, FadingMemory, LinearHalfSpaces, RelaxingHalfSpaces
from tractive_sam.operators import Lattice, Operators
from tractive_sam.results import BODIES, Grid, State

StepSize = tuple[float, float]
"""Distance in elements, and time, s, of a step."""


@dataclass(frozen=True, eq=False)
class Remembered:
    """What bodies remember after a step.

    Attributes
    ----------
    places : ndarray, shape (nodes,)
        `Memory.places`.
    rest : ndarray, shape (terms, 3, nodes, n_y)
        Displacement by the memory (z, x, y) of each term less that of steady rolling, mm.
    datum : ndarray, shape (terms, 3, 1, 1)
        The part of `rest` at the datum of a line contact, mm; zero of other contacts.
    stored : ndarray, shape (terms,)
        Energy of the springs of each term, N mm.
    moved : ndarray, shape (terms, 3, n_x + reach, n_y)
        Displacement by the memory, at the mesh and at some nodes ahead, mm.
    response : tuple of (StepSize, ndarray), optional
        What steps of a size leave at their end of the steady memory of the tractions.
    """

    places: np.ndarray
    rest: np.ndarray
    datum: np.ndarray
    stored: np.ndarray
    moved: np.ndarray = field(default_factory=lambda: np.zeros((1, 3, 0, 0)), repr=False)
    response: tuple[StepSize, np.ndarray] | None = field(default=None, repr=False)

    def on(self, before: Grid, after: Grid) -> "Remembered":
        """Return the memory on a wider mesh, with the values at the edges beyond them.

        Nodes stay where they were.
        """
        further, across = (
            (wide - narrow) // 2
            for wide, narrow in zip(after.elements, before.elements, strict=True)
        )
        rest = np.pad(self.rest, ((0, 0), (0, 0), (0, 0), (across, across)), mode="edge")
        return Remembered(self.places + further, rest, self.datum, self.stored)


class Recalling(NamedTuple):
    """What bodies remember at the end of a step of the time before it.

    Attributes
    ----------
    size : StepSize
        Elements rolled and time of the step.
    carried : Remembered
        The memory without what the tractions at its end add.
    """

    size: StepSize
    carried: Remembered


class Term(NamedTuple):
    """Term of the creep compliance of one body, or of both alike.

    Attributes
    ----------
    bodies : str
        "A", "B" or "AB".
    elastic : LinearHalfSpaces
        Elasticity of these bodies at once after loading.
    ratio, time : float
        f and tau, s.
    """

    bodies: str
    elastic: LinearHalfSpaces
    ratio: float
    time: float


class Memory:
    """Memory of the bodies of a model that relax.

    Parameters
    ----------
    model : Model
        Model of a scene whose bodies relax.
    """

    longest = 14.0
    """Length over V tau after which a memory has ended."""
    near = 24
    """Elements ahead of the mesh with nodes; farther away half as many lie at each length."""

    def __init__(self, model: Model):
        self.model, self.grid = model, model.grid
        law: Any = model.elasticity
        self.law: RelaxingHalfSpaces = law
        self.terms = tuple(
            Term(bodies, elastic, ratio, time)
            for bodies, elastic in law.groups.items()
            for ratio, time in getattr(getattr(law, bodies[0]), "terms", ())
        )
        self._operators_of = lru_cache(8)(self._make_operators)
        kept = 4 * len(self.terms) * (2 + 2 * self.zones)
        self._unit_operators = lru_cache(kept)(  # from MPa to mm
            lambda law, lattice: Operators(lattice, law, 1.0, 1.0 / lattice.dx)
        )

    def size(self, elements: float, time: float) -> StepSize:
        """Return the size of a step that rolls a number of elements, or that takes a time at rest.

        Equal steps differ by rounding; their operators are made once.
        """
        if elements:
            time = elements * self.grid.dx / self.law.speed
        return float(f"{elements:.10g}"), float(f"{time:.10g}")

    def operators(self, size: StepSize = (0.0, 0.0)) -> Operators:
        """Return the operators of tractions that have grown linearly over a step."""
        return self._operators_of(size)

    def _make_operators(self, size: StepSize) -> Operators:
        """Return new operators of a step."""
        step = size[0] * self.grid.dx, size[1]
        law = replace(self.law, step=step) if any(size) else self.law.glassy
        whole, units = self.model.operators, self.model.units
        gap, slip = units.gap / units.pressure, units.slip / units.pressure
        return Operators(whole.lattice, law, gap, slip, self.model.frame)

    def scaled(self, moved: np.ndarray) -> np.ndarray:
        """Return dimensionless displacements (..., 3, n_x, n_y) from those in mm."""
        units, frame = self.model.units, self.model.frame
        along = np.moveaxis(moved[..., 1:, :, :], -3, 0)
        along = np.moveaxis(frame.slip_to_scaled(along), 0, -3) / (units.slip * self.grid.dx)
        return np.concatenate((moved[..., :1, :, :] / units.gap, along), axis=-3)

    @cached_property
    def zones(self) -> int:
        """Number of zones ahead of the mesh; in each the distance between nodes is doubled.

        They reach as far as material remembers, but not beyond that which rolls to the contact.
        """
        schedule = self.model.scene.schedule
        rolled = np.ptp(schedule.rolled(np.array((0.0, schedule.end)))) + self.grid.half_length[0]
        reach = self.longest * self.law.speed * max(term.time for term in self.terms)
        reach = min(reach, float(rolled)) + 1.1 * (self.law.datum or 0.0)
        return max(0, math.ceil(math.log2(max(reach / self.grid.dx, 1.0) / self.near)))

    @cached_property
    def places(self) -> np.ndarray:
        """Places of the nodes, in elements from the first one of the mesh, ascending."""
        nx, far = self.grid.elements[0], np.arange(self.near // 2, self.near) + 0.5
        zones = [np.arange(self.near) + 0.5, *(far * 2.0**k for k in range(1, self.zones + 1))]
        beyond = np.concatenate(zones)
        behind = beyond if self.law.datum is not None else beyond[:0]
        return np.concatenate((-0.5 - behind[::-1], np.arange(nx), nx - 0.5 + beyond))

    @property
    def work_of_steps(self) -> tuple[float, float]:
        """Work of making the operators of a step, and of a step with them, in elastic responses.

        Measured on `benchmarks/relaxation.py steps`. An operator takes as long as ten responses to
        make; it is applied to the pressure and to both tractions. Those of rows take equal times.
        """
        nx, sides = self.grid.elements[0], 1 if self.law.datum is None else 2
        ahead = [max(2, math.ceil(nx / 2**k)) + self.near for k in range(1, self.zones + 1)]
        lengths = [nx, nx + sides * self.near, *(sides * ahead)]
        shares = len(lengths) if self.law.datum is not None else sum(lengths) / nx
        return 20.0 * len(self.terms) * len(lengths), 1.5 * len(self.terms) * shares

    @property
    def at_datum(self) -> np.ndarray:
        """Places at the datum of a line contact, in elements; empty for other contacts."""
        if self.law.datum is None:
            return np.zeros(0)
        sides = np.array((-1.0, 1.0)) * self.law.datum / self.grid.dx
        return np.asarray(0.5 * (self.grid.elements[0] - 1) + sides)

    def _move(self, law: Elasticity, dx: float, loads: np.ndarray) -> np.ndarray:
        """Return the displacement (z, x, y), mm, by tractions (3, n_x, n_y) in MPa."""
        lattice = Lattice(loads.shape[1:], dx, self.grid.dy)
        return displace(self._unit_operators(law, lattice), loads)

    def _at_nodes(self, law: LinearHalfSpaces, loads: np.ndarray) -> np.ndarray:
        """Return the displacement by loads at all nodes, mm, (3, nodes, n_y)."""
        dx, half = self.grid.dx, self.near // 2
        both = self.law.datum is not None
        around = self.near if both else 0, self.near
        pieces = [self._move(law, dx, np.pad(loads, ((0, 0), around, (0, 0))))]
        if isinstance(law, FadingMemory) and not both:
            law = replace(law, far=True)
        for length in (2**k for k in range(1, self.zones + 1)):
            merged = merge_loads(loads, length)
            moved = self._move(law, length * dx, np.pad(merged, ((0, 0), (0, self.near), (0, 0))))
            pieces.append(moved[:, -half:])
            if both:
                merged = merge_loads(loads[:, ::-1], length)[:, ::-1]
                moved = self._move(
                    law, length * dx, np.pad(merged, ((0, 0), (self.near, 0), (0, 0)))
                )
                pieces.insert(0, moved[:, :half])
        return np.concatenate(pieces, axis=1)

    def _law(self, term: Term, distance: float = 0.0) -> FadingMemory:
        """Return the law M of a term, or C of a step."""
        A, B, datum = term.elastic.A, term.elastic.B, term.elastic.datum
        length = self.law.speed * term.time
        return FadingMemory(A, B, datum, term.ratio, length, distance * self.grid.dx)

    def _response(self, size: StepSize, loads: np.ndarray) -> np.ndarray:
        """Return what a step leaves at its end of the steady memory of loads, at all nodes."""
        return np.stack([self._at_nodes(self._law(term, size[0]), loads) for term in self.terms])

    def begin(self, loads: np.ndarray, steady: bool) -> Remembered:
        """Return the memory of bodies that roll steadily, or that were just pressed together.

        Parameters
        ----------
        loads : ndarray, shape (3, n_x, n_y)
            Pressure and tractions, MPa.
        steady : bool
            Whether the bodies roll steadily.
        """
        count, ny = len(self.terms), self.grid.elements[1]
        none = np.zeros((count, 3, len(self.places), ny))
        start = Remembered(self.places, none, np.zeros((count, 3, 1, 1)), np.zeros(count))
        if not steady:
            start = replace(start, rest=-self._response((0.0, 0.0), loads))
            return self.moved(start, loads, 1)
        start = self.moved(start, loads, 1)
        return replace(start, stored=0.5 * self.work(loads, start.moved))

    def recall(
        self, past: Remembered, loads: np.ndarray, elements: float, time: float
    ) -> "Recalling":
        """Return what bodies remember at the end of a step of the time before it.

        Parameters
        ----------
        past : Remembered
            Memory before the step.
        loads : ndarray, shape (3, n_x, n_y)
            Pressure and tractions before it, MPa.
        elements, time : float
            Elements rolled; time, s, of a step at rest.
        """
        size = distance, time = self.size(elements, time)
        last = past.response
        kept = last[1] if last and last[0] == size else self._response(size, loads)
        fall = np.exp([-time / term.time for term in self.terms])[:, None, None, None]
        rest = interpolate(past.rest, past.places, self.places + distance)
        if not distance:
            rest = fall * (rest + kept)
            rest += self._at_rest(time, loads, ended=False) if time else 0.0
            carried = Remembered(self.places, rest, fall * past.datum, past.stored)
            return Recalling(size, carried)
        # Relative to the datum, what the loads add is zero there.
        datum = np.zeros_like(past.datum)
        if self.at_datum.size:
            before = interpolate(past.rest, past.places, self.at_datum + distance)
            datum = fall * before.mean(axis=2, keepdims=True)
        return Recalling(size, Remembered(self.places, fall * rest + kept, datum, past.stored))

    def after(
        self,
        past: Remembered,
        before: np.ndarray,
        recalling: "Recalling",
        loads: np.ndarray,
        ahead: int,
    ) -> Remembered:
        """Return the memory after a step, with the energy of its springs.

        Parameters
        ----------
        past : Remembered
            Memory before the step.
        before, loads : ndarray, shape (3, n_x, n_y)
            Pressure and tractions before the step and at its end, MPa.
        recalling : Recalling
            See `recall`.
        ahead : int
            Elements ahead of the mesh at which the displacement is needed.
        """
        size = distance, time = recalling.size
        response = self._response(size, loads)
        rest = recalling.carried.rest - response
        if time and not distance:
            rest += self._at_rest(time, loads, ended=True)
        last = replace(recalling.carried, rest=rest, response=(size, response))
        last, past = self.moved(last, loads, ahead), self.moved(past, before, ahead)
        works = self.work(before, past.moved), self.work(loads, last.moved)
        stored = last.stored.copy()
        for k, term in enumerate(self.terms):
            start, end = linear_shares(2.0 * time / term.time)
            stored[k] = math.exp(-2.0 * time / term.time) * stored[k]
            stored[k] += 0.5 * (start * works[0][k] + end * works[1][k])
        return replace(last, stored=stored)

    def _at_rest(self, time: float, loads: np.ndarray, ended: bool) -> np.ndarray:
        """Return the memory that loads at the end, or the start, of a step at rest add."""
        added = []
        for term in self.terms:
            start, end = linear_shares(time / term.time)
            elastic = self._at_nodes(term.elastic, loads)
            added.append(term.ratio * (end if ended else start) * elastic)
        return np.stack(added)

    def displacement(self, memory: Remembered, ahead: int = 0) -> np.ndarray:
        """Return the displacement of the mesh, and ahead of it, by the rest of each term, mm."""
        places = np.arange(self.grid.elements[0] + ahead)
        return interpolate(memory.rest, memory.places, places) - memory.datum

    def moved(self, memory: Remembered, loads: np.ndarray, ahead: int) -> Remembered:
        """Return the memory with its displacement at the mesh and some elements ahead."""
        if memory.moved.shape[2] >= self.grid.elements[0] + ahead:
            return memory
        wide = np.pad(loads, ((0, 0), (0, ahead), (0, 0)))
        steady = [self._move(self._law(term), self.grid.dx, wide) for term in self.terms]
        return replace(memory, moved=np.stack(steady) + self.displacement(memory, ahead))

    def work(self, loads: np.ndarray, moved: np.ndarray) -> np.ndarray:
        """Return the work, N mm, of loads, MPa, on the displacements of each term, mm."""
        moved = moved[:, :, : loads.shape[1]]
        return self.grid.element_area * np.einsum("cij,tcij->t", loads, moved)

    def by_body(self, lost: np.ndarray) -> np.ndarray:
        """Return the sums over the terms of A and of B; bodies alike have a half each."""
        total = np.zeros(2)
        for term, value in zip(self.terms, lost, strict=True):
            for body in term.bodies:
                total[BODIES.index(body)] += value / len(term.bodies)
        return total


def displace(operators: Operators, fields: np.ndarray) -> np.ndarray:
    """Return the displacement by tractions, or by pressure and tractions."""
    if len(fields) == 2:
        return operators.tangential(fields)
    if operators.elasticity.coupled:
        return operators.coupled_displacement(fields)
    moved = np.zeros_like(fields)
    moved[:1] = operators.normal(fields[:1])
    if fields[1:].any():
        moved[1:] = operators.tangential(fields[1:])
    return moved


def loads_of(contact: State) -> np.ndarray:
    """Return pressure and tractions of a contact, MPa, shape (3, n_x, n_y)."""
    return np.concatenate((contact.pressure[None], contact.traction))


def linear_shares(rate: float) -> tuple[float, float]:
    """Return the shares of the start and the end of a linear course in its fading mean.

    The mean at the end of a time t, with the weights exp(-s/tau)/tau of a time s before, has these
    of the values at its start and at its end; `rate` is t/tau.
    """
    end = (rate + math.expm1(-rate)) / rate if rate > 1e-4 else 0.5 * rate - rate**2 / 6.0
    return -math.expm1(-rate) - end, end


def interpolate(values: np.ndarray, nodes: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return values (..., nodes, n_y) at places, by cubics; beyond the nodes those at the end."""
    places = np.clip(places, nodes[0], nodes[-1])
    first = np.clip(np.searchsorted(nodes, places, side="right") - 2, 0, len(nodes) - 4)
    at = nodes[first[:, None] + np.arange(4)]
    out = np.zeros((*values.shape[:-2], len(places), values.shape[-1]))
    for k in range(4):
        others = np.delete(at, k, axis=1)
        weight = np.prod((places[:, None] - others) / (at[:, k : k + 1] - others), axis=1)
        out += weight[:, None] * values[..., first + k, :]
    return out


def merge_loads(loads: np.ndarray, length: int) -> np.ndarray:
    """Return loads on elements of a length from the front of the mesh, with equal moments."""
    nx = loads.shape[1]
    count = max(2, -(-nx // length))
    place = count - 0.5 - (nx - 0.5 - np.arange(nx)) / length
    index = np.clip(np.floor(place).astype(int), 0, count - 2)
    share, spread = place - index, np.zeros((count, nx))
    spread[index, np.arange(nx)] = 1.0 - share
    spread[index + 1, np.arange(nx)] = share
    return np.einsum("ij,cjk->cik", spread / length, loads)

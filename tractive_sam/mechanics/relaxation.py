"""Half-spaces that relax while they roll: linear viscoelastic bodies with Prony terms.

The creep compliance of a body is that of its elastic constants times

    1 + sum_j f_j (1 - exp(-t/tau_j)),

for all components, so that Poisson's ratio does not depend on the time. In steady rolling material
comes from ahead, +x, with the speed V: a particle at x was at x + V t before. With the displacement
K(x) of the elastic body by the traction on an element, that of the relaxing one is therefore

    K(x) + sum_j f_j M_j(x),    M(x) = integral of exp(-s/T) K(x + s) ds/T over s > 0, T = V tau,

and M is the solution of M - T dM/dx = K that is bounded ahead. The integral is taken once, of the
influence coefficients: the convolutions are those of elastic bodies, of as many elements, for any
number of terms and any length of the memory. An equation for the displacement in place of it, as in
finite differences, has a further error for the place, and needs the displacement far ahead.

M is integrated from far ahead to the element and beyond, step by step, with the exponential exact
and K by polynomials of fifth degree: near the element at ninths of its length, since K has bends at
its edges; farther away at elements; and beyond the mesh at steps that double in length.

**Steps.** In a step of a transient tractions are linear in time, in the frame of the contact, and
the exponential is exact. The displacement by the memory is that of the steady memory of the
tractions at the end of the step, and a rest that fades: exp(-t/tau) times what the material brings
from where it was before, and C times the decrease of the tractions, with

    C(x) = 1/d integral of exp(-s/T) M(x + s) ds over 0 < s < d,

for a distance d. The response to tractions at the end is K + sum f (M - C). So constant tractions
end in the steady state, and no d and tau make it unstable: the sequence of responses of a wave to
its unit tractions, 1, 2, ... steps later, is of positive type.

M is neither even nor odd in x. Its part with the parity of K stores energy, the other one
dissipates: of equal tractions it gives the work p . dM/dx.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np

from tractive_sam.mechanics.elasticity import Elasticity, Material, SurfaceResponse
from tractive_sam.mechanics.layers import LinearHalfSpaces


@dataclass(frozen=True)
class RelaxingBody(SurfaceResponse):
    """Body whose deformation under a constant load grows with the time.

    Parameters
    ----------
    body : Material, LayeredBody or TransverseMaterial
        The body at once after loading, in glassy state.
    terms : tuple of (float, float)
        Ratio f and retardation time tau, s, of each term of the creep compliance, which is the
        elastic one times 1 + sum f (1 - exp(-t/tau)).

    Examples
    --------
    >>> rubber = ts.RelaxingBody(ts.Material(2.0, 0.5), ((1.0, 0.01), (3.0, 0.1)))
    >>> float(rubber.factor(0.0, 100.0).real)  # long after loading
    5.0
    """

    body: SurfaceResponse
    terms: tuple[tuple[float, float], ...]
    relaxes = True

    @property
    def compliances(self) -> np.ndarray:
        """Response of the glassy body to short waves, see `SurfaceResponse`."""
        return self.body.compliances

    @property
    def images(self) -> tuple[np.ndarray, np.ndarray]:
        """Response of the glassy body to other waves, see `SurfaceResponse`."""
        return self.body.images

    @property
    def laws(self) -> frozenset[type[LinearHalfSpaces]]:
        """Laws that a pair with this body needs: `RelaxingHalfSpaces`."""
        return self.body.laws | {RelaxingHalfSpaces}

    def reach(self, speed: float) -> float:
        """Return the length of the body's layers and of its memory, mm; above 0."""
        memory = sum(speed * time for _, time in self.terms)
        return (self.body.reach(speed) + memory) or 1.0

    def worn(self, depth: float, step: float) -> "RelaxingBody":
        """Return the body without a worn depth, mm, see `SurfaceResponse.worn`."""
        return replace(self, body=self.body.worn(depth, step))

    def factor(
        self, k: np.ndarray | float, speed: float, step: tuple[float, float] | None = None
    ) -> np.ndarray:
        """Return the complex compliance in rolling over the elastic one, for waves exp(i k x).

        Parameters as in `SurfaceResponse.factor`.
        """
        if step is None:
            each = [ratio / (1.0 - 1j * np.asarray(k) * speed * tau) for ratio, tau in self.terms]
            return np.asarray(1.0 + sum(each))
        distance, time = step
        total = np.ones(np.shape(k), complex)
        for ratio, tau in self.terms:
            z = time / tau - 1j * np.asarray(k) * distance
            small = np.abs(z) < 1e-3
            z = np.where(small, 1.0, z)
            exact = (z - 1.0 + np.exp(-z)) / z**2
            total = total + ratio * time / tau * np.where(small, 0.5, exact)
        return total


def creep_terms(terms: Sequence[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Return the terms of the creep compliance of a modulus that relaxes.

    The modulus is G (1 - sum g (1 - exp(-t/tau))). Both are related by J(s) G(s) = 1 of their
    Laplace transforms times s. With 1/tau on the diagonal of D and v² = g/tau, G(s)/G is 1 - v^T (D
    + s)^-1 v, and the inverse is 1 + v^T (D - v v^T + s)^-1 v: the terms follow from eigenvalues.

    Parameters
    ----------
    terms : sequence of (float, float)
        g and relaxation time tau, s, of each term; the sum of g is below 1.

    Returns
    -------
    tuple of (float, float)
        Ratio f and retardation time, s, of as many terms.

    Examples
    --------
    >>> ((ratio, time),) = ts.creep_terms([(0.5, 0.01)])
    >>> round(ratio, 12), round(time, 12)
    (1.0, 0.02)
    """
    g, tau = np.array(terms, float).T
    v = np.sqrt(g / tau)
    rates, modes = np.linalg.eigh(np.diag(1.0 / tau) - np.outer(v, v))
    return tuple(zip(((v @ modes) ** 2 / rates).tolist(), (1.0 / rates).tolist(), strict=True))


@dataclass(frozen=True)
class RelaxingHalfSpaces(LinearHalfSpaces):
    """Elasticity of two half-spaces in steady rolling; at least one of them relaxes.

    Its normal and tangential operators are not symmetric, and dissipate.

    Parameters
    ----------
    A, B : Material, LayeredBody, TransverseMaterial or RelaxingBody
        The upper and the lower body.
    datum : float, optional
        For line contacts, see `Strips`; None for contacts of finite width.
    speed : float
        Rolling speed V, mm/s; 0: the bodies have relaxed.
    step : (float, float), optional
        Distance, mm, and time, s, of a step in which the tractions have grown linearly from zero; a
        time without distance is a step at rest. By default the tractions have always been there.

    Examples
    --------
    >>> bodies = ts.Laws.of(scene).elasticity
    >>> tyre = ts.RelaxingBody(bodies.A, ((0.5, 0.01),))
    >>> rolling = ts.RelaxingHalfSpaces(tyre, bodies.B, speed=100.0)
    >>> table = rolling.coefficients("zz", (9, 9), 0.1, 0.1)
    >>> bool((table > bodies.coefficients("zz", (9, 9), 0.1, 0.1)).all())
    True
    """

    speed: float = 0.0
    step: tuple[float, float] | None = None
    shared = True

    @property
    def symmetric(self) -> bool:
        """Whether the operators of pressure and of tractions are symmetric: only at rest."""
        return not (self.speed if self.step is None else self.step[0])

    @property
    def coupled(self) -> bool:
        """Whether pressure causes tangential displacement: unless the bodies are alike."""
        slips = (body.compliances[3] or body.images[1][3].any() for body in (self.A, self.B))
        return self.A != self.B and any(slips)

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return the part of the influence coefficients with the parity of elastic bodies.

        Parameters as in `Elasticity.coefficients`.
        """
        nx, ny = offsets
        return _coefficients(self, component, dx, dy).at(nx, ny)[0]

    def lag(self, component: str, offsets: tuple[int, int], dx: float, dy: float) -> np.ndarray:
        """Return the other part of the influence coefficients, of the other parity in x.

        Parameters as in `Elasticity.coefficients`.
        """
        nx, ny = offsets
        return _coefficients(self, component, dx, dy).at(nx, ny)[1]

    def periodic(
        self, component: str, period: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray | None:
        """Return the spectrum of displacements that repeat with a period, from the response.

        Parameters as in `Elasticity.periodic`.
        """
        k = 2.0 * np.pi * np.fft.fftfreq(period[0])[:, None] / dx
        total: np.ndarray | None = None
        for law, body in _parts(self):
            spectrum = law.periodic(component, period, dx, dy)
            if spectrum is None:
                return None
            factor = body.factor(k, self.speed, self.step)
            spectrum = spectrum * (factor.real if self.symmetric else factor)
            total = spectrum + (0.0 if total is None else total)
        return total

    def at_speed(self, speed: float | None) -> "RelaxingHalfSpaces":
        """Return the law at a rolling speed, mm/s; without one at rest, long after loading."""
        return replace(self, speed=speed or 0.0)

    def single_body(self, body: str) -> Elasticity:
        """Return the half-spaces for the stress in a body, which tractions give at any time.

        The stress in a homogeneous half-space under given tractions depends on Poisson's ratio
        alone, which does not change with the time.
        """
        A, B = (getattr(each, "body", each) for each in (self.A, self.B))
        return LinearHalfSpaces(A, B, self.datum).single_body(body)

    @property
    def glassy(self) -> LinearHalfSpaces:
        """Elasticity at once after loading."""
        A, B = (getattr(body, "body", body) for body in (self.A, self.B))
        return LinearHalfSpaces(A, B, self.datum)

    @property
    def groups(self) -> dict[str, LinearHalfSpaces]:
        """Elastic laws of bodies that relax alike: of "AB", or of "A" and of "B"."""
        if getattr(self.A, "terms", ()) == getattr(self.B, "terms", ()):
            return {"AB": self.glassy}
        rigid, glassy = Material(np.inf, 0.5), self.glassy
        return {"A": replace(glassy, B=rigid), "B": replace(glassy, A=rigid)}


def _parts(law: RelaxingHalfSpaces) -> list[tuple[LinearHalfSpaces, SurfaceResponse]]:
    """Return elastic laws of groups of bodies that relax alike, and one body of each."""
    return [(elastic, getattr(law, names[0])) for names, elastic in law.groups.items()]


@dataclass(frozen=True)
class FadingMemory(LinearHalfSpaces):
    """Displacement by the memory of a term, or the part of it that a step forgets.

    It is C of the text of this module, or without a distance M.

    Parameters
    ----------
    A, B, datum
        Of the elastic bodies, see `LinearHalfSpaces`.
    ratio : float
        f.
    length : float
        V tau, mm.
    distance : float
        Distance of the step, mm; 0: at once.
    far : bool
        Whether only elements far ahead are displaced, more than half a dozen from the load.
    """

    ratio: float = 1.0
    length: float = 0.0
    distance: float = 0.0
    far: bool = False

    @property
    def symmetric(self) -> bool:
        """Whether its operators are symmetric: not with memory."""
        return not self.length

    def coefficients(
        self, component: str, offsets: tuple[int, int], dx: float, dy: float
    ) -> np.ndarray:
        """Return the part with the parity of elastic bodies; see `RelaxingHalfSpaces`."""
        return self._table(component, offsets, dx, dy)[0]

    def lag(self, component: str, offsets: tuple[int, int], dx: float, dy: float) -> np.ndarray:
        """Return the other part of the influence coefficients, of the other parity in x."""
        return self._table(component, offsets, dx, dy)[1]

    def periodic(self, component: str, period: tuple[int, int], dx: float, dy: float) -> None:
        """Return None: it needs no preconditioner."""

    def _table(self, component: str, offsets: tuple[int, int], dx: float, dy: float) -> np.ndarray:
        """Return both parts of the influence coefficients, (2, n_x, n_y)."""
        elastic, terms = LinearHalfSpaces(self.A, self.B, self.datum), ((self.ratio, self.length),)
        return _remember(elastic, component, offsets, (dx, dy), terms, self.distance, far=self.far)


class _Coefficients:
    """Influence coefficients of both parities of a component, stored and extended on demand."""

    def __init__(self, law: RelaxingHalfSpaces, component: str, dx: float, dy: float) -> None:
        self._law, self._component, self._sides = law, component, (dx, dy)
        self._tables: dict[int, np.ndarray] = {}

    def at(self, nx: int, ny: int) -> np.ndarray:
        """Return those at offsets below (nx, ny) elements, mm/MPa, (2, nx, ny).

        The lengths of `_memory_along` change their last digits. So that results do not depend on
        what was computed before, meshes with the same lengths have a table.
        """
        further = _beyond(self._law.step[0], self._sides[0]) if self._law.step else 0
        rows = _rounded_up(nx + further) - further
        table = self._tables.get(rows)
        if table is None or ny > table.shape[2]:
            table = self._tables[rows] = np.zeros((2, rows, ny))
            for elastic, body in _parts(self._law):
                table[0] += elastic.coefficients(self._component, (rows, ny), *self._sides)
                self._add_memory(table, elastic, body)
        return table[:, :nx, :ny]

    def _add_memory(
        self, table: np.ndarray, elastic: LinearHalfSpaces, body: SurfaceResponse
    ) -> None:
        """Add the displacement by the memory of a body, or what of it a step renews."""
        speed, step, offsets = self._law.speed, self._law.step, table.shape[1:]
        if not isinstance(body, RelaxingBody):
            return
        if step is not None and not step[0]:
            renewed = body.factor(0.0, 0.0, step).real - 1.0
            table[0] += renewed * elastic.coefficients(self._component, offsets, *self._sides)
            return
        terms = tuple((ratio, speed * time) for ratio, time in body.terms)
        distance = step[0] if step else 0.0
        table += _remember(elastic, self._component, offsets, self._sides, terms, distance, True)


_coefficients = lru_cache(32)(_Coefficients)
"""The coefficients of a law by component and sides of the elements."""


@lru_cache(64)
def _remember(
    law: LinearHalfSpaces,
    component: str,
    offsets: tuple[int, int],
    sides: tuple[float, float],
    terms: tuple[tuple[float, float], ...],
    distance: float = 0.0,
    renews: bool = False,
    far: bool = False,
) -> np.ndarray:
    """Return the memory f M of elastic influence coefficients, summed over terms, in two parts.

    Parameters
    ----------
    law : LinearHalfSpaces
        Elastic bodies, K.
    component, offsets, sides
        See `Elasticity.coefficients`.
    terms : tuple of (float, float)
        f and T = V tau, mm, of each term.
    distance : float
        d, mm: C in place of M, see the text of this module.
    renews : bool
        Whether to return M - C in place of C.
    far : bool
        Whether only elements ahead, at a distance, are needed; elsewhere the table is zero.

    Returns
    -------
    ndarray, shape (2, n_x, n_y)
        Parts with the parity of K and without, mm/MPa.
    """
    (dx, _), (nx, ny) = sides, offsets
    parity = -1.0 if component in ("xz", "xy") else 1.0
    if not terms[0][1]:
        table = sum(ratio for ratio, _ in terms) * law.coefficients(component, offsets, *sides)
        return np.stack((table, np.zeros_like(table)))
    ratios, lengths = np.array(terms).T
    memory = _memory_along(law, component, (nx + _beyond(distance, dx), ny), sides, lengths, far)
    lines, start = memory.lines, memory.start
    if distance:
        lines, start = _mean_over_step(memory, dx / lengths, distance / dx)
        if renews:
            before = memory.start - start
            lines = memory.lines[:, before : before + lines.shape[1]] - lines
    line = np.tensordot(ratios, lines, 1)
    if law.datum is not None:
        for ratio, length in terms:
            at_datum = _at_datum(law.datum, length, distance, parity)
            if renews and distance:
                at_datum = _at_datum(law.datum, length, 0.0, parity) - at_datum
            line -= ratio * at_datum * memory.unit
    front, rear = line[start:][:nx], np.zeros((nx, ny))
    if not far:
        rear = line[start::-1][:nx]
    return 0.5 * np.stack((front + parity * rear, front - parity * rear))


def _beyond(distance: float, dx: float) -> int:
    """Return the elements that a step needs beyond a mesh, of it and of the polynomials."""
    return int(distance / dx) + 6 if distance else 0


def _rounded_up(nx: int) -> int:
    """Return the length that meshes of similar size share, 24 elements times a power of two."""
    return 24 * 2 ** max(0, int(np.ceil(np.log2(nx / 24))))


class _Along(NamedTuple):
    """M of a loaded element along x, of each term.

    Attributes
    ----------
    lines : ndarray, shape (terms, n, n_y)
        At elements before and after it, mm/MPa.
    start : int
        Index of the loaded element.
    unit : ndarray, shape (n_y,)
        Factor of -ln|x|, or of the sign of x, far from the load in a line contact.
    middles : ndarray, shape (terms, m, n_y)
        Near it, at parts of elements.
    near, parts : int
        Elements on both sides in `middles`, and parts of each.
    """

    lines: np.ndarray
    start: int
    unit: np.ndarray
    middles: np.ndarray
    near: int
    parts: int


def _memory_along(
    law: LinearHalfSpaces,
    component: str,
    offsets: tuple[int, int],
    sides: tuple[float, float],
    lengths: np.ndarray,
    far: bool,
    near: int = 6,
    parts: int = 9,
) -> _Along:
    """Return M at elements before and after a loaded one.

    Parameters
    ----------
    law, component, sides, far
        See `_remember`.
    offsets : (int, int)
        Elements on both sides in x, and in y.
    lengths : ndarray, shape (terms,)
        T of each term, mm.
    near : int
        Elements from the loaded one up to which K is taken at parts of elements.
    parts : int
        These parts, odd.
    """
    (dx, dy), (nx, ny) = sides, offsets
    nx = _rounded_up(nx)
    parity = -1.0 if component in ("xz", "xy") else 1.0
    first, doublings = 12, int(np.log2(nx / 12))  # of the doubled length up to the mesh's end

    # Beyond the mesh, from the farthest steps to the nearest, of at least twelve steps each.
    steps = [dx * 2**doublings]
    while 2 * first * steps[-1] < 40.0 * lengths.max():
        steps.append(2.0 * steps[-1])
    nodes = np.outer(steps, np.arange(first - 2, 2 * first + 4))
    beyond = law.distant_coefficients(component, tuple(nodes.ravel().tolist()), ny, dx, dy)
    beyond = beyond.reshape(*nodes.shape, ny)
    end = beyond[-1, first + 2]
    unit = (beyond[-1, 2] - end) / np.log(2.0) if parity > 0.0 else end
    end = np.broadcast_to(end, (lengths.size, ny))
    for step, values in zip(reversed(steps), beyond[::-1], strict=True):
        end = _sweep(end, values[None], step / lengths)[:, 0]
    whole = law.coefficients(component, (first * 2**doublings + 4, ny), dx, dy)
    ahead = _sweep(end, whole[None, near - 2 :], dx / lengths)
    if far:
        lines = np.concatenate((np.zeros((lengths.size, near, ny)), ahead), axis=1)
        return _Along(lines, 0, unit, lines[:, :0], near + 2, parts)
    # Sums of parts of elements: K at parts.
    count = (near + 1) * parts + 4 + parts // 2
    fine = law.coefficients(component, (count, ny), dx / parts, dy)
    fine = np.concatenate((parity * fine[:0:-1], fine)).cumsum(axis=0)
    fine = np.concatenate((np.zeros((1, ny)), fine))
    fine = fine[parts:] - fine[:-parts]
    middles = _sweep(ahead[:, 1], fine[None, 1:], dx / parts / lengths)
    inner = middles[:, parts:-parts:parts]
    behind = _sweep(inner[:, 0], parity * whole[None, nx + 1 : near - 4 : -1], dx / lengths)
    lines = np.concatenate((behind[:, :-1], inner[:, :-1], ahead), axis=1)  # from -(nx - 1) on
    return _Along(lines, nx - 1, unit, middles, near, parts)


def _mean_over_step(memory: _Along, rates: np.ndarray, elements: float) -> tuple[np.ndarray, int]:
    """Return C of each term at elements, and the index of the loaded one.

    With the bounded solution of N - T dN/dx = M, C(x) is T/d (N(x) - exp(-d/T) N(x + d)). What N is
    at the end does not matter.

    Parameters
    ----------
    memory : _Along
        M; without `middles` it is zero up to `near`, and C as well.
    rates : ndarray, shape (terms,)
        Element over T.
    elements : float
        d over the element.
    """
    lines, start, _, middles, near, parts = memory
    whole, part = int(elements), elements - int(elements)
    at, between = _solve_at(lines[:, start + near - 2 :], rates, 0.0 * lines[:, -1], part)
    if middles.size:
        finer = int(part * parts)
        inner = middles[:, parts - 2 : 3 - parts]
        inner, shifted = _solve_at(inner, rates / parts, at[:, 0], part * parts - finer)
        behind = _solve_at(lines[:, : start - near + 4], rates, inner[:, 0], part)
        at = np.concatenate((behind[0][:, :-1], inner[:, :-1:parts], at), axis=1)
        shifted = shifted[:, finer::parts][:, : 2 * near]
        between = np.concatenate((behind[1], shifted, between), axis=1)
    count, fall = between.shape[1] - whole, np.exp(-rates * elements)[:, None, None]
    mean = (at[:, :count] - fall * between[:, whole:]) / (rates * elements)[:, None, None]
    if middles.size:
        return mean, start - 2
    return np.concatenate((np.zeros((len(mean), near, mean.shape[2])), mean), axis=1), 0


def _solve_at(
    values: np.ndarray, rates: np.ndarray, end: np.ndarray, part: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the solution of `_sweep` at nodes, and at a part of the step after each but the last.

    Parameters as in `_sweep`; `end` is the solution at the last node.
    """
    at, count = _sweep(end, values, rates), values.shape[1] - 6
    weights = np.array([_step_weights(rate, part) for rate in rates.tolist()])
    added = sum(weights[:, i, None, None] * values[:, i : i + count] for i in range(6))
    return at, added + np.exp(-rates * (1.0 - part))[:, None, None] * at[:, 1:]


def _at_datum(datum: float, reach: float, distance: float, parity: float) -> float:
    """Return the mean at both points at the distance of the datum of M or C, of -ln|x/datum|.

    Of the sign of x if the parity is negative. Parameters as in `_remember`. What M lacks of it is
    that of `_memory_along`: M is relative to a load's own datum.
    """
    # Scenes and results are read without these functions.
    from scipy.integrate import quad  # noqa: PLC0415
    from scipy.special import exp1, expi  # noqa: PLC0415

    r = datum / reach
    if parity < 0.0:
        if distance <= datum:
            return float(np.exp(-r))
        d = distance / reach
        return float(((r + 1.0) * np.exp(-r) - np.exp(-d)) / d)
    if distance:

        def remembered(s: float) -> float:
            left = min(s * reach / distance, 1.0) * np.exp(-s)
            return float(-0.5 * left * np.log(max(abs(1.0 - (s / r) ** 2), 1e-300)))

        places = [k for k in (distance / reach, r) if k < 45.0]
        return float(quad(remembered, 0.0, 45.0, points=places or None, limit=200)[0])
    if r > 50.0:  # asymptotic
        return 1.0 / r**2
    return float(0.5 * (np.exp(-r) * expi(r) - np.exp(r) * exp1(r)))


def _sweep(end: np.ndarray, values: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """Return M of each term at equal steps from M at the last node, for values K at the nodes.

    Parameters
    ----------
    end : ndarray, shape (terms, n_y)
        M at the last node.
    values : ndarray, shape (terms or 1, n + 6, n_y)
        K at the nodes 0 ... n, with two more before and three after.
    rates : ndarray, shape (terms,)
        Step over T.

    Returns
    -------
    ndarray, shape (terms, n + 1, n_y)
    """
    # Scenes and results are read without compiled kernels.
    from tractive_sam.kernels.linear_algebra import sum_from_end  # noqa: PLC0415

    weights = np.array([_step_weights(rate) for rate in rates.tolist()])
    out = np.empty((len(end), values.shape[1] - 5, end.shape[1]))
    out[:, -1] = end
    sum_from_end(np.ascontiguousarray(values), weights, np.exp(-rates), out)
    return out


@lru_cache(256)
def _step_weights(rate: float, start: float = 0.0) -> np.ndarray:
    """Return the weights of K at six nodes in the integral of its polynomial over a step.

    It begins at a part of the step, where the exponential is 1.
    """
    points, shares, polynomials = _step_polynomials()
    # Of the step only the part within reach of the exponential counts.
    end = min(1.0 - start, 40.0 / rate)
    points = 0.5 * end * (1.0 + points)
    shares = 0.5 * end * shares * rate * np.exp(-rate * points)
    return shares @ np.vander(start + points, 6, increasing=True) @ polynomials


@cache
def _step_polynomials() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return Gauss points (24,), their weights, and powers of polynomials that are 1 at a node."""
    points, weights = np.polynomial.legendre.leggauss(24)
    return points, weights, np.linalg.inv(np.vander(np.arange(-2.0, 4.0), increasing=True))

"""Displacement at and below the surface of both bodies, and their elastic energy."""

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.kernels import half_space as formula
from tractive_sam.mechanics import HalfSpaces, Strips
from tractive_sam.operators import Lattice, transform_quadrant
from tractive_sam.results import State
from tractive_sam.subsurface.loaded_bodies import check_depths
from tractive_sam.subsurface.sources import SIGNS, tractions_on_bodies


def displacement(
    contact: State, body: str = "A", depth: float = 0.0, laws: Laws | None = None
) -> np.ndarray:
    """Return the elastic displacement (3, n_x, n_y) of one body at a depth, mm.

    It is relative to distant points of the body, in the axes of the contact, for both bodies: z
    points into body A. Rigid motion by approach and creepage is not part of it.

    Parameters
    ----------
    contact : State
        The solved contact.
    body : "A" or "B"
        The body.
    depth : float
        Depth below the surface, mm.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.

    Returns
    -------
    ndarray, shape (3, n_x, n_y)
        (u_x, u_y, u_z), mm.

    Raises
    ------
    ValueError
        If the body is not "A" or "B", the depth is negative or not finite, the bodies are not
        homogeneous half-spaces, or the contact is a line contact: its displacement relative to
        distant points is infinite.

    Examples
    --------
    >>> from tractive_sam.subsurface import displacement
    >>> contact.grid.elements, displacement(contact, "B", depth=0.1).shape
    ((91, 91), (3, 91, 91))
    """
    (depth,) = check_depths([depth])
    material = _half_spaces(contact, body, laws)
    grid, modulus = contact.grid, getattr(material, body).shear
    lattice = Lattice(grid.elements, grid.dx, grid.dy)
    tractions = np.concatenate((contact.traction, contact.pressure[None]))
    (on_body,) = tractions_on_bodies(tractions, (SIGNS[body],))
    px, py = lattice.padded
    table = formula.displacement_quadrant(
        (px // 2 + 1, py // 2 + 1), grid.dx, grid.dy, depth, getattr(material, body).poisson
    )
    kernels = {
        name: transform_quadrant(values, formula.PARITY[name], lattice.padded)
        for name, values in table.items()
    }
    kernels["yx"] = kernels["xy"]
    spectra = np.fft.rfft2(on_body, lattice.padded)
    moved = [sum(kernels[a + b] * spectra[k] for k, b in enumerate("xyz")) for a in "xyz"]
    nx, ny = grid.elements
    field = np.fft.irfft2(np.stack(moved), lattice.padded)[:, :nx, :ny] / modulus
    field[2] *= SIGNS[body]
    return field


def elastic_energy(contact: State, laws: Laws | None = None) -> float:
    """Return the elastic energy of both bodies and of an interfacial layer, N mm.

    It is half the work of the tractions on the displacements of the surfaces, which is the mean
    over the elements.

    Parameters
    ----------
    contact : State
        The solved contact.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.

    Raises
    ------
    ValueError
        See `displacement`.

    Examples
    --------
    >>> from tractive_sam.subsurface import elastic_energy
    >>> frictionless = ts.solve(scene.replace(friction=None, creepage=None))
    >>> hertz = scene.hertz  # its energy is 2/5 of the load times the approach
    >>> round(elastic_energy(frictionless) / (0.4 * hertz.load * hertz.approach), 3)
    1.0
    """
    work = 0.0
    for body, sign in SIGNS.items():
        moved = displacement(contact, body, 0.0, laws)
        tangential = (contact.traction * moved[:2]).sum()
        work += sign * float(tangential + (contact.pressure * moved[2]).sum())
    layer = (laws or Laws.of_contact(contact)).elasticity.layer
    work += layer * float((contact.traction**2).sum())
    return 0.5 * work * contact.grid.element_area


def _half_spaces(contact: State, body: str, laws: Laws | None) -> HalfSpaces:
    """Return the bodies of a contact as HalfSpaces; ValueError for strips and other laws."""
    if body not in SIGNS:
        raise ValueError(f'a body is "A" or "B", not {body!r}')
    elasticity = (laws or Laws.of_contact(contact)).elasticity
    elasticity.single_body(body)  # raises for a law that does not give the stress
    bodies = getattr(elasticity, "bodies", elasticity)
    if isinstance(bodies, Strips):
        raise ValueError(
            "the displacement of a line contact relative to distant points is infinite: give a "
            "body a finite radius_y"
        )
    if not isinstance(bodies, HalfSpaces):
        raise ValueError(f"the law {bodies!r} gives no displacement inside bodies; use HalfSpaces")
    return bodies

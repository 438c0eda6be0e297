"""Linear response of the wear of a revolution to the profile worn so far."""

import numpy as np

from tractive_sam.contact import Model, wear_law_at
from tractive_sam.operators import row_compliance
from tractive_sam.results import State
from tractive_sam.rolling.passage import Passage
from tractive_sam.schema import required


def mean_wear_response(model: Model, passage: Passage, closing: float = 0.0) -> np.ndarray:
    """Return the Jacobian of wear per revolution by the profile, mean of blocks, (n_y, n_y).

    Its weights are the shares of the blocks, with sum 1 (`Passage.weights`).

    Parameters
    ----------
    model : Model
        The scene in numbers.
    passage : Passage
        The contacts at the profile.
    closing : float
        See `wear_response`.
    """
    each = zip(passage.weights, block_responses(model, passage, closing), strict=True)
    return np.sum([weight * response for weight, response in each], axis=0)


def block_responses(model: Model, passage: Passage, closing: float = 0.0) -> list[np.ndarray]:
    """Return, for each block, the Jacobian of wear per revolution by the profile, (n_y, n_y).

    Returns
    -------
    list of ndarray, shape (n_y, n_y)
        1/revolution.
    """
    each = zip(model.blocks, passage.turns, passage.contacts, strict=True)
    return [
        np.reshape(turns.gain, (-1, 1)) * wear_response(block, contact, closing)
        for block, turns, contact in each
    ]


def wear_response(model: Model, contact: State, closing: float = 0.0) -> np.ndarray:
    """Return the approximate Jacobian of the wear of a pass by the entering profile, (n_y, n_y).

    Material that is worn deeper carries less pressure, by the compliance between rows at constant
    load, and wears less: waves of the profile decay at a rate proportional to their wave number, up
    to i |s| a E* q per revolution. That makes rolling stiff. Slip, contact area and the ratio of
    traction to pressure are assumed constant; the method that uses the response is of second order
    for any approximation.

    Parameters
    ----------
    model : Model
        The scene in numbers.
    contact : State
        The contact at the profile.
    closing : float
        Elements with a gap up to this count as in contact, mm: they will soon be. A row that comes
        into contact during a jump is as stiff as its neighbours.

    Returns
    -------
    ndarray, shape (n_y, n_y)
        1/revolution; zero for rows that are not in contact.
    """
    response = np.zeros((model.grid.elements[1],) * 2)
    if not contact.touching.any():
        return response
    touching = contact.touching | (contact.gap <= closing)
    rows = np.flatnonzero(touching.any(axis=0))
    compliance = row_compliance(model.operators, touching)
    stiffness = np.linalg.inv(compliance)
    if model.load is not None:
        # A uniform depth only moves the bodies closer.
        uniform = stiffness.sum(axis=1)
        stiffness = stiffness - np.outer(uniform, stiffness.sum(axis=0)) / uniform.sum()
    per_load = _wear_per_load(model, contact)[rows]
    response[np.ix_(rows, rows)] = -per_load[:, None] * stiffness
    return response


def _wear_per_load(model: Model, contact: State) -> np.ndarray:
    """Return the wear depth of each row per MPa summed over it, mm; constant beyond the contact."""
    count = contact.touching.sum(axis=0)
    law = required(wear_law_at(model, contact), "wear")
    rate = law.per_load(contact.pressure, contact.traction, contact.slip)
    per_pressure = rate.sum(axis=0)
    inside = np.flatnonzero(count)
    values = model.grid.dx * per_pressure[inside] / count[inside]
    return np.interp(np.arange(count.size), inside, values)

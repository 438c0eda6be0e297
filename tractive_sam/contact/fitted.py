"""New bodies on a mesh that holds their contact."""

from tractive_sam.contact.equilibrium import equilibrium
from tractive_sam.contact.mesh import grown
from tractive_sam.contact.model import Model
from tractive_sam.results import State, Status

GROWTHS = 8
"""Most enlargements of a mesh that the scene left to us."""


def fitted(model: Model) -> tuple[Model, State]:
    """Solve unworn bodies, enlarging a mesh that the scene left to us until it holds the contact.

    Returns
    -------
    Model, State
        The model on the mesh of the contact.
    """
    contact = equilibrium(model)
    for _ in range(GROWTHS):
        # Beyond a measured gap from which the mesh was chosen there is nothing to grow into.
        chosen = model.scene.grid is None and model.scene.hertz is not None
        if contact.status is not Status.OFF_GRID or not chosen:
            break
        model = model.on(grown(model.grid))
        contact = equilibrium(model)
    return model, contact

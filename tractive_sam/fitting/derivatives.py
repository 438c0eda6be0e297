"""Derivatives of the columns of a record, from the Jacobian of a contact."""

from collections.abc import Callable, Mapping, Sequence
from operator import itemgetter
from typing import Any

import numpy as np

from tractive_sam.fitting.entries import base_of
from tractive_sam.results import State
from tractive_sam.scene import Scene

RESULTS = ("Qx", "Qy", "Mz", "approach", "P", "xi_x", "xi_y", "spin")
"""Rows and columns of the Jacobian, see `State.jacobian`."""

FORMULAS: Mapping[str, Callable[[Mapping[str, complex]], complex]] = {
    **{name: itemgetter(name) for name in RESULTS},
    "Qx_over_P": lambda of: of["Qx"] / of["P"],
    "Qy_over_P": lambda of: of["Qy"] / of["P"],
    "t_gamma": lambda of: -(of["Qx"] * of["xi_x"] + of["Qy"] * of["xi_y"] + of["Mz"] * of["spin"]),
}
"""Columns of a record with derivatives that follow from the Jacobian."""


def derivatives_of(
    columns: Sequence[str], wanted: Sequence[str], contact: State, jacobian: Any
) -> dict[str, np.ndarray]:
    """Return derivatives of columns by Jacobian parameters, "column/parameter", by complex steps.

    Parameters
    ----------
    columns : sequence of str
        Columns; those without a formula are left out.
    wanted : sequence of str
        Columns of the Jacobian.
    contact : State
        The contact.
    jacobian : "xarray.DataArray"
        Jacobian of the contact.

    Returns
    -------
    dict of str to ndarray, shape (1,)
        "Qx/P" is the derivative of Qx with respect to P.
    """
    tiny = 1e-30
    rows = [str(name) for name in jacobian.coords["result"].values]
    values = {name: float(getattr(contact, name)) for name in RESULTS}
    derivatives = {}
    for parameter in wanted:
        change = dict.fromkeys(RESULTS, 0.0)
        if parameter in change:
            change[parameter] = 1.0
        column = jacobian.loc[:, parameter].values
        change |= {row: float(value) for row, value in zip(rows, column, strict=True)}
        moved = {name: values[name] + 1j * tiny * change[name] for name in RESULTS}
        for name in filter(FORMULAS.__contains__, columns):
            slope = complex(FORMULAS[name](moved)).imag / tiny
            derivatives[f"{name}/{parameter}"] = np.array([slope])
    return derivatives


def exact_columns(scene: Scene, columns: tuple[str, ...], keys: tuple[str, ...]) -> dict[str, str]:
    """Return the Jacobian column of keys with exact derivatives; {} if a column has no formula."""
    # Columns of the Jacobian by the keys of their parameters.
    columns_of = {
        "creepage.longitudinal": "xi_x",
        "creepage.lateral": "xi_y",
        "creepage.spin": "spin",
        "load.normal": "P",
        "friction.mu": "mu",
        "friction.mu[0]": "mu1",
        "friction.mu[1]": "mu2",
    }
    law = scene.friction
    if law is None or any(name not in FORMULAS for name in columns):
        return {}
    coulomb = law.law == "constant" and law.strength is None and law.temperature is None
    load = scene.load
    sought = {name for name, force in (("xi_x", load.force_x), ("xi_y", load.force_y))
              if force is not None}  # fmt: skip
    exact = {}
    for key in keys:
        column = columns_of.get(key, "")
        is_exact = column not in sought and (coulomb or base_of(key) != "friction.mu")
        if column and is_exact and (column != "P" or load.normal is not None):
            exact[key] = column
    return exact

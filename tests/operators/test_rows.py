"""Compliance between rows against the dense normal operator."""

import numpy as np

from tests.operators.test_elastic import dense
from tractive_sam.mechanics.elasticity import HalfSpaces, Material
from tractive_sam.operators import Lattice, Operators
from tractive_sam.operators.elastic import row_compliance


def test_row_compliance_is_a_galerkin_projection():
    mesh = Lattice((7, 6), 0.3, 0.2)
    bodies = HalfSpaces(Material(2.0, 0.1), Material(5.0, 0.4))
    rng = np.random.default_rng(0)
    contact = rng.random(mesh.shape) < 0.6
    contact[:, 2] = False
    share = contact / np.maximum(contact.sum(axis=0), 1)
    A = dense(mesh, bodies.material)[2, :, 2].reshape(*mesh.shape, *mesh.shape)
    truth = np.einsum("ij,ijkl,kl->jl", share, A, share)
    rows = [0, 1, 3, 4, 5]
    result = row_compliance(Operators(mesh, bodies, 1.0, 1.0), contact)
    np.testing.assert_allclose(result, truth[np.ix_(rows, rows)], rtol=1e-12)
    assert np.linalg.eigvalsh(result).min() > 0

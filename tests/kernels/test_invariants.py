"""Scalars of stresses in one pass against their definitions."""

import numpy as np

from tractive_sam.mechanics.criteria import VON_MISES, von_mises


def test_the_criterion_is_the_stress_of_von_mises():
    stress = np.random.default_rng(0).normal(size=(6, 3, 5))
    np.testing.assert_allclose(VON_MISES(stress), von_mises(stress), rtol=1e-14)  # rounding
    np.testing.assert_array_equal(VON_MISES(stress.swapaxes(1, 2)), VON_MISES(stress).T)

"""Laws keep working under their former names, also in results files."""

import numpy as np
import pytest

import tractive_sam as ts

STEEL = ts.Material(8e4, 0.3)


@pytest.mark.parametrize(
    ("law", "stored"),
    [
        (ts.PerBody(A=ts.Energy((1e-6, 1e-6))), "80ede2e968842670"),
        (ts.InterfacialLayer(ts.HalfSpaces(STEEL, STEEL), 1e-5), "dce8fe5070adb537"),
        (ts.FallingCoulomb(mu=(0.3, 0.3)), "8d1213d91409af79"),
    ],
)
def test_fingerprints_equal_those_in_files_of_earlier_versions(law, stored):
    assert law.fingerprint().startswith(stored)


@pytest.mark.parametrize(
    ("former", "name"), [("EachBody", "PerBody"), ("Layered", "InterfacialLayer")]
)
def test_earlier_names_of_laws_warn(former, name):
    with pytest.warns(DeprecationWarning, match=name):
        law = getattr(ts, former)
    assert law is getattr(ts, name)


def test_methods_may_be_defined_and_called_under_their_earlier_names():
    with pytest.warns(DeprecationWarning, match="single_body"):

        class Coated(ts.HalfSpaces):
            def coefficients(self, component, offsets, dx, dy):
                return super().coefficients(component, offsets, dx, dy)

            def alone(self, body):
                return ts.HalfSpaces(self.A, self.B).single_body(body)

    assert Coated(STEEL, STEEL).single_body("A").A.poisson == STEEL.poisson
    with pytest.warns(DeprecationWarning, match="at_speed_ratio"):
        law = ts.Coulomb(mu=(0.3, 0.2)).eased(0.0)
    assert law.bound(np.ones((1, 1)), 0.0, 0.0).radius == 1.0

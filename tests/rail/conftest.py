"""A wheel S1002 on rails of UIC 60."""

import pytest

from tractive_sam.rail import Wheel, builtin_profile, place_rail


@pytest.fixture(scope="session")
def rail():
    return place_rail(builtin_profile("UIC60-manchester"), 40.0, 1435.0)


@pytest.fixture(scope="session")
def wheel():
    return Wheel(builtin_profile("S1002"), 460.0, 1360.0)

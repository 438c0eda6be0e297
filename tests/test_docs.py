"""Examples in docstrings run."""

import doctest

import tractive_sam


def test_package_docstring():
    result = doctest.testmod(tractive_sam)
    assert result.attempted > 0
    assert result.failed == 0

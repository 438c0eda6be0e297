"""Descriptions that Python prints."""

from dataclasses import dataclass

import numpy as np

from tractive_sam.description import ShortArrays


@dataclass(frozen=True, repr=False)
class Measured(ShortArrays):
    name: str
    by_body: dict[str, np.ndarray]
    bars: np.ndarray
    labels: np.ndarray


def test_records_print_shapes_and_ranges_of_their_arrays():
    some = np.array([[1.0, np.nan, -2.5], [0.0, np.inf, 3.0]])
    record = Measured("rig", {"A": some}, np.full(4, np.nan), np.array(["a", "b"]))
    assert repr(record) == (
        "Measured(name='rig', by_body={'A': <2 x 3: -2.5 to 3>}, bars=<4>,"
        " labels=array(['a', 'b'], dtype='<U1'))"
    )

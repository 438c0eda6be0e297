import numpy as np
import pytest

from tractive_sam.schema import SceneError
from tractive_sam.studies import SAMPLE, Axis, Latin, Values

MU = {"key": "friction.mu", "start": 0.1, "stop": 0.9}
LOADS = {"key": "load.normal", "values": [1.0, 2.0]}


def test_range_has_its_ends_and_equal_steps():
    column = Values(**MU, number=5).column()
    assert column == (0.1, 0.3, 0.5, 0.7, 0.9)  # without what rounding leaves


def test_logarithmic_range_has_equal_ratios():
    column = Values(
        key="load.normal", start=-1.0, stop=-1000.0, number=4, spacing="logarithmic"
    ).column()
    np.testing.assert_allclose(np.divide(column[1:], column[:-1]), 10.0, rtol=1e-11)  # 12 digits


def test_whole_entries_stay_whole():
    values = Values(key="wear.revolutions", start=1, stop=1000, number=4, spacing="logarithmic")
    assert values.column() == (1, 10, 100, 1000)
    assert all(type(value) is int for value in values.column())


def test_zipped_entries_go_in_step():
    axis = Axis(
        key="load.normal",
        values=[1.0, 2.0, 3.0],
        zip=[{"key": "friction.mu", "values": [0.1, 0.1, 0.2]}],  # may repeat, the axis may not
    )
    assert axis.dimension().name == "load.normal"
    assert axis.dimension().at(2) == {"load.normal": 3.0, "friction.mu": 0.2}


def test_latin_hypercube_has_one_sample_in_each_part():
    count = 16
    latin = Latin(
        number=count,
        variable=[MU, {"key": "load.normal", "start": 1, "stop": 100, "spacing": "logarithmic"}],
    )
    dimension = latin.dimension()
    assert (dimension.name, len(dimension)) == (SAMPLE, count)
    linear = (np.array(dimension.columns["friction.mu"]) - 0.1) / 0.8
    logarithmic = np.log10(dimension.columns["load.normal"]) / 2.0
    for shares in (linear, logarithmic):
        assert sorted((shares * count).astype(int)) == list(range(count))


def test_samples_are_those_of_the_seed():
    def column(seed):
        return Latin(number=4, variable=[MU], seed=seed).dimension().columns["friction.mu"]

    assert column(1) == column(1)
    assert column(1) != column(2)


@pytest.mark.parametrize(
    ("given", "reported"),
    [
        ({"key": "friction.angel", "values": [1]}, "key: given 'friction.angel'.*angle"),
        ({"key": "load.normal"}, "values: given nothing.*start.*stop.*number"),
        ({"key": "load.normal", "start": 1}, "values: given.*start"),
        ({**MU, "number": 2, "values": [1]}, "values: given.*start, stop, number"),
        ({"key": "load.normal", "values": [1, 1]}, "values: "),
        ({"key": "load.normal", "values": []}, "values: "),
        ({**MU, "number": 1}, "number: given 1"),
        ({**MU, "stop": 0.1, "number": 2}, "stop: given 0.1"),
        ({**MU, "start": 0, "number": 2, "spacing": "logarithmic"}, "spacing: "),
        ({**MU, "number": 2, "spacing": "cubic"}, "spacing: given 'cubic'"),
        ({**MU, "number": 2, "zip": [{**MU, "number": 3}]}, r"zip\[0\].values: given 3 values"),
        ({**MU, "number": 2, "zip": [{**MU, "number": 2}]}, r"zip\[0\].key: given friction.mu"),
        ({**LOADS, "zip": [{**MU, "number": 2}] * 2}, r"zip\[1\].key: given friction.mu again"),
    ],
)
def test_bad_axes(given, reported):
    with pytest.raises(SceneError, match=reported):
        Axis(**given)


@pytest.mark.parametrize(
    ("variable", "reported"),
    [
        ([], "variable: given .*"),
        ([MU, MU], r"variable\[1\].key: given friction.mu again"),
        ([MU, {**MU, "key": "x"}], r"variable\[1\].key: given 'x'"),
    ],
)
def test_bad_samples(variable, reported):
    with pytest.raises(SceneError, match=reported):
        Latin(number=2, variable=variable)


@pytest.mark.parametrize(
    "values",
    [[1, 2, 1], [1, 1.0], [[1, 2], [1, 2]], ["a", "a"], [{"mu": 0.3}, {"mu": 0.3}]],
)
def test_values_are_distinct(values):
    with pytest.raises(SceneError, match="values: "):
        Axis(key="friction.mu", values=values)


def test_many_values_are_compared_at_once():
    """Each with each, 20,000 would take a minute."""

    class Counted(float):
        compared = 0

        def __eq__(self, other):
            Counted.compared += 1
            return float(self) == float(other)

        __hash__ = float.__hash__

    values = [Counted(k) for k in range(20_000)]
    assert len(Axis(key="load.normal", values=values).column()) == len(values)
    assert Counted.compared <= len(values)

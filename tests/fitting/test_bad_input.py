"""Each fault of a fit file or of its data is reported by its key, before anything is computed."""

import pytest

import tractive_sam as ts
from tests.fitting.conftest import creep_data
from tractive_sam.fitting import FitDesign, FitError
from tractive_sam.fitting.run import make_problem, read_design

CREEP = {
    "values": {"creepage.longitudinal": [-1e-3, -2e-3], "Qx_over_P": [0.17, 0.26]},
    "vary": "creepage.longitudinal",
    "observe": "Qx_over_P",
    "noise": 0.05,
}


def fitted(data=None, **fit):
    """Return the table of a fit of the friction of two spheres, with changes."""
    sets = [CREEP | (data or {})]
    return {"scene": "spheres", "free": ["friction.mu"], "data": sets} | fit


def columns(**values):
    return {"values": {"creepage.longitudinal": [-1e-3, -2e-3], "Qx_over_P": [0.1, 0.2]} | values}


def parameter(**entries):
    return {"parameter": [{"key": "friction.mu"} | entries]}


TESTS = {
    "no free key": (fitted(free=[]), "fit.free"),
    "a free key twice": (fitted(free=["friction.mu", "friction.mu"]), "fit.free"),
    "an unknown key": (fitted(free=["friction.mew"]), "fit.free"),
    "a key with a text": (fitted(free=["solver.method"]), "fit.free"),
    "a table": (fitted(free=["friction"]), "fit.free"),
    "a key without a value": (fitted(free=["creepage.speed"]), "fit.free"),
    "a pair as one number": (
        fitted(scene="spheres-orthotropic", free=["friction.mu"]), "fit.free"),
    "a pair and one of its numbers": (
        fitted(free=["friction.mu", "friction.mu[0]"]), "fit.free"),
    "a list for the scene": (fitted(scene=[1]), "fit.scene"),
    "a number for the scene": (fitted(scene=5), "fit.scene"),
    "no scene of this name": (fitted(scene="sphere"), "fit.scene"),
    "a scene with [accuracy]": (
        fitted(scene={"body": {"A": {"young": 2e5, "poisson": 0.3, "radius_x": 10.0,
                                     "radius_y": 10.0},
                               "B": {"young": 2e5, "poisson": 0.3, "radius_x": 10.0,
                                     "radius_y": 10.0}},
                      "load": {"normal": 10.0}, "friction": {"mu": 0.3},
                      "accuracy": {"tolerance": 0.01}}), "fit.scene.accuracy"),
    "no data": (fitted() | {"data": []}, "fit.data"),
    "an unknown entry": (fitted(method="trf"), "fit.method"),
    "an unknown loss": (fitted(loss="huge"), "fit.loss"),
    "no start": (fitted(starts=0), "fit.starts"),
    "a level of certainty": (fitted(level=1.0), "fit.level"),
    "a step of zero": (fitted(step=0.0), "fit.step"),
    "a target that is not free": (fitted(target="load.normal"), "fit.target"),
    "a parameter that is not free": (fitted(**parameter(key="load.normal")),
                                     "fit.parameter[0].key"),
    "a parameter twice": (
        fitted(parameter=[{"key": "friction.mu"}, {"key": "friction.mu"}]), "fit.parameter"),
    "bounds the wrong way round": (fitted(**parameter(lower=0.5, upper=0.4)),
                                   "fit.parameter[0].upper"),
    "a start below its bound": (fitted(**parameter(start=0.1, lower=0.2)),
                                "fit.parameter[0].start"),
    "a start above its bound": (fitted(**parameter(start=0.9, upper=0.5)),
                                "fit.parameter[0].start"),
    "a logarithm of a negative start": (fitted(**parameter(start=-0.3, scale="log")),
                                        "fit.parameter[0].start"),
    "a prior without width": (fitted(**parameter(prior=[0.4, 0.0])),
                              "fit.parameter[0].prior"),
    "a prior of one number": (fitted(**parameter(prior=[0.4])), "fit.parameter[0].prior"),
    "no noise": (fitted() | {"data": [{k: v for k, v in CREEP.items() if k != "noise"}]},
                 "fit.data[0].noise"),
    "noise of zero": (fitted({"noise": 0.0}), "fit.data[0].noise"),
    "an empty table of noise": (fitted({"noise": {}}), "fit.data[0].noise.noise"),
    "noise by a column and a number": (fitted({"noise": {"column": "sd", "absolute": 1.0}}),
                                       "fit.data[0].noise.column"),
    "a factor of at most 1": (fitted({"noise": {"factor": 1.0}}), "fit.data[0].noise"),
    "a factor and a number": (fitted({"noise": {"factor": 1.2, "absolute": 1.0}}),
                              "fit.data[0].noise.factor"),
    "a factor of a profile": (
        fitted({"observe": "wear_profile", "body": "A", "vary": [], "noise": {"factor": 1.2}}),
        "fit.data[0].noise.factor"),
    "an unknown observation": (fitted({"observe": "Qx_over_Q"}), "fit.data[0].observe"),
    "a vector": (fitted({"observe": "p_max_at"}), "fit.data[0].observe"),
    "a mass of no body": (fitted({"observe": "worn_mass"}), "fit.data[0].body"),
    "a body C": (fitted({"observe": "worn_mass", "body": "C"}), "fit.data[0].body"),
    "file and values": (fitted({"file": "creep.csv"}), "fit.data[0].file"),
    "a varied key that is free": (fitted({"vary": "friction.mu"}), "fit.data[0].vary"),
    "an unknown varied key": (fitted({"vary": "creepage.longitudnal"}), "fit.data[0].vary"),
    "a free key that a data set sets": (fitted({"set": {"friction.mu": 0.3}}),
                                        "fit.data[0].set"),
    "an unknown key that a data set sets": (fitted({"set": {"load.nrmal": 0.3}}),
                                            "fit.data[0].set"),
    "a record before the first": (fitted({"at": -1.0}), "fit.data[0].at"),
    "an unknown nuisance": (fitted({"nuisance": ["shear"]}), "fit.data[0].nuisance"),
    "a position of no profile": (fitted({"nuisance": ["tilt"]}), "fit.data[0].nuisance"),
    "a profile over a varied key": (
        fitted({"observe": "wear_profile", "body": "A"}), "fit.data[0].vary"),
    "a candidate without noise": (fitted(test=[{"observe": "Qx"}]), "fit.test[0].noise"),
    "a candidate of values alone": (
        fitted(test=[{"observe": "Qx", "noise": 0.1, "values": [1.0]}]), "fit.test[0].values"),
}  # fmt: skip


@pytest.mark.parametrize("case", TESTS)
def test_a_fault_of_the_file_is_reported_by_its_key(case):
    table, key = TESTS[case]
    with pytest.raises(FitError) as caught:
        FitDesign(fit=table)
    keys = [fault.key for fault in caught.value.faults]
    assert any(one.startswith(key) for one in keys), keys
    assert all(fault.allowed for fault in caught.value.faults)


DATA = {
    "no such column": (fitted({"observe": "Qx"}), "fit.data[0].values"),
    "not a number": (fitted(columns(Qx_over_P=[0.1, "high"])), "fit.data[0].values"),
    "nan": (fitted(columns(Qx_over_P=[0.1, float("nan")])), "fit.data[0].values"),
    "infinite": (fitted(columns(Qx_over_P=[0.1, float("inf")])), "fit.data[0].values"),
    "columns of different lengths": (fitted(columns(Qx_over_P=[0.1])), "fit.data[0].values"),
    "no rows": (
        fitted({"values": {"creepage.longitudinal": [], "Qx_over_P": []}}), "fit.data[0].values"),
    "relative noise of zero": (fitted(columns(Qx_over_P=[0.0, 0.2])), "fit.data[0].noise"),
    "no column of noise": (fitted({"noise": {"column": "sd"}}), "fit.data[0].values"),
    "negative noise": (
        fitted(columns(sd=[0.1, -0.1]) | {"noise": {"column": "sd"}}), "fit.data[0].noise"),
    "fewer points than parameters": (
        fitted(free=["friction.mu", "load.normal", "body.A.poisson"]), "fit.data"),
    "wear of a scene without": (
        fitted({"values": {"worn_mass": [0.1]}, "vary": [], "observe": "worn_mass", "body": "A"}),
        "fit.data[0].observe"),
    "a creepage beyond the scene": (
        fitted(columns() | {"vary": ["creepage.longitudinal"], "set": {"load.normal": -1.0}}),
        "fit.data[0].load.normal"),
    "no such file": (
        fitted() | {"data": [{"file": "none.csv", "observe": "Qx", "noise": 0.1}]},
        "fit.data[0].file"),
}  # fmt: skip


@pytest.mark.parametrize("case", DATA)
def test_a_fault_of_the_data_is_reported_before_anything_is_computed(case, monkeypatch):
    monkeypatch.setattr("tractive_sam.fitting.case.compute", None)
    table, key = DATA[case]
    with pytest.raises(FitError) as caught:
        make_problem(read_design(table).fit)
    keys = [fault.key for fault in caught.value.faults]
    assert any(one.startswith(key) for one in keys), keys


FILES = {
    "an empty file": "",
    "a header alone": "creepage.longitudinal,Qx_over_P\n",
    "a row that is too short": "creepage.longitudinal,Qx_over_P\n-1e-3,0.1\n-2e-3\n",
    "a blank cell": "creepage.longitudinal,Qx_over_P\n-1e-3,0.1\n-2e-3,\n",
    "a column twice": "Qx_over_P,Qx_over_P\n0.1,0.1\n",
    "another column": "creepage.longitudinal,Qx/P\n-1e-3,0.1\n",
    "bytes": "\xff\xfe\x00".encode("latin-1"),
}


@pytest.mark.parametrize("case", FILES)
def test_a_fault_of_a_data_file_is_reported(case, tmp_path):
    file, content = tmp_path / "creep.csv", FILES[case]
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    data = {"file": str(file), "vary": "creepage.longitudinal", "observe": "Qx_over_P"}
    with pytest.raises(FitError, match=r"fit.data\[0\].file"):
        make_problem(read_design(fitted() | {"data": [data | {"noise": 0.05}]}).fit)


def test_files_of_spreadsheets_are_read(tmp_path):
    text = "# rig\ncreepage.longitudinal;slip;Qx_over_P\n-0,001;0,1;0,17\n\n-0,002;0,2;0,26\n"
    (tmp_path / "creep.csv").write_text(text)
    data = {"file": str(tmp_path / "creep.csv"), "observe": "Qx_over_P", "noise": 0.05}
    table = data | {"vary": "creepage.longitudinal"}
    with pytest.warns(ts.SceneWarning, match="creep.csv: columns that are not read: slip"):
        problem = make_problem(read_design(fitted() | {"data": [table]}).fit)
    assert problem.observed.tolist() == [0.17, 0.26]
    assert problem.series[0].measured.settings[1] == {"creepage.longitudinal": -0.002}


def test_a_column_that_another_data_set_reads_is_not_named(tmp_path):
    text = "creepage.longitudinal;Qx_over_P;p_max\n-0.001;0.17;1000\n-0.002;0.26;1000\n"
    (tmp_path / "creep.csv").write_text(text)
    data = {"file": str(tmp_path / "creep.csv"), "vary": "creepage.longitudinal", "noise": 0.05}
    tables = [data | {"observe": name} for name in ("Qx_over_P", "p_max")]
    make_problem(read_design(fitted() | {"data": tables}).fit)


@pytest.mark.parametrize(
    ("heading", "label"),
    [
        ("# slip in per cent", "slip"),
        ("# percent", "slip"),
        ("# creepage x 1000", "slip"),
        ("# creepage in 10^-3", "slip"),
        *(("#", label) for label in ("Slip %", "Slip_pct", "Slip in %", "slip in per cent")),
    ],
)
def test_per_cent_is_used_refused_or_named(tmp_path, heading, label):
    (tmp_path / "creep.csv").write_text(f"{heading}\n{label};Qx_over_P\n-0.1;0.17\n-0.2;0.26\n")
    data = {"file": str(tmp_path / "creep.csv"), "observe": "Qx_over_P", "noise": 0.05}
    data |= {"vary": "creepage.longitudinal", "columns": {"creepage.longitudinal": label}}
    if heading != "#":
        with pytest.raises((FitError, ts.SceneWarning), match="line 1"):
            make_problem(read_design(fitted() | {"data": [data]}).fit)
        return
    problem = make_problem(read_design(fitted() | {"data": [data]}).fit)
    assert problem.series[0].measured.settings[1]["creepage.longitudinal"] == pytest.approx(-0.002)


def test_all_faults_are_reported_at_once():
    table = fitted({"observe": "force", "noise": -1.0}, loss="huge", free=["friction.mew"])
    with pytest.raises(FitError) as caught:
        FitDesign(fit=table)
    assert len(caught.value.faults) >= 4


@pytest.mark.slow
def test_a_parameter_without_influence_has_a_note(spheres):
    data = creep_data(spheres, {"friction.mu": 0.35})
    free = ["friction.mu", "body.A.density"]
    found = ts.fit(
        {"scene": spheres, "free": free, "data": [data], "mesh_check": False, "curve": 0}
    )
    (text,) = found.undetermined
    assert text.startswith("body.A.density is not determined")


def test_a_noise_out_of_range_is_reported(spheres):
    """The square of a residual over its noise would exceed the range of numbers."""
    precise = creep_data(spheres, {"friction.mu": 0.35}) | {"noise": {"column": "sd"}}
    precise["values"]["sd"] = [1e-300] * len(precise["values"]["Qx_over_P"])
    with pytest.raises(FitError) as caught:
        ts.fit({"scene": spheres, "free": ["friction.mu"], "data": [precise]})
    (fault,) = caught.value.faults
    assert "noise" in fault.key


@pytest.mark.slow
def test_a_value_near_zero_with_relative_noise_does_not_end_a_fit(spheres):
    tiny = creep_data(spheres, {"friction.mu": 0.35})
    tiny["values"]["Qx_over_P"][0] = 1e-300
    found = ts.fit({"scene": spheres, "free": ["friction.mu"], "data": [tiny]})
    assert found.values["friction.mu"] > 0.0

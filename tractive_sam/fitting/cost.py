"""Describe fits, spreads and designs before they are computed: keys, outcomes, and time."""

import numpy as np

from tractive_sam.description import Description, Section, format_duration, format_with_unit
from tractive_sam.fitting.case import Evaluations, FitCase, exact_columns, is_steady
from tractive_sam.fitting.data import Measured
from tractive_sam.fitting.design import FitDesign, Parameters
from tractive_sam.fitting.distributions import SpreadDesign
from tractive_sam.fitting.optimum import OptimumDesign, prepare_search
from tractive_sam.fitting.problem import Series, groups_of
from tractive_sam.fitting.response import Response, quantity_of
from tractive_sam.fitting.run import read_all
from tractive_sam.results import COLUMNS, index_by_name
from tractive_sam.schema import PlausibilityWarning, warn
from tractive_sam.studies import estimate_times


def explain_fit(design: FitDesign) -> Description:
    """Return sections that describe the parameters, data sets and computations of a fit.

    Times are those of the scenes at the first values, estimated as for one scene; nothing is
    solved.

    Raises
    ------
    FitError
        With every fault of the data, or of a scene at the first values.

    Examples
    --------
    >>> from tractive_sam.fitting import explain_fit
    >>> design = ts.FitDesign(fit={"scene": coarse, "free": ["friction.mu"], "data": [data]})
    >>> free, data_sets, work = explain_fit(design)
    >>> free.rows
    [('friction.mu', 'from 0.3; its logarithm is fitted')]
    """
    fit = design.fit
    parameters, cases, data_sets = Parameters.of(fit), dict[str, FitCase](), []
    values = parameters.values_by_key(np.ones(len(parameters)))
    for k, (name, measured) in enumerate(zip(fit.names, read_all(fit), strict=True)):
        series = Series.of(f"fit.data[{k}]", name, measured, fit.scene, parameters, None)
        for note in series.notes:
            warn(note, PlausibilityWarning)
        scenes = [series.scene_at(values, settings) for _, settings in groups_of(measured)]
        cases |= {scene.fingerprint(): FitCase(scene, series.columns) for scene in scenes}
        kind = "contacts" if is_steady(scenes[0]) else "runs"
        data_sets.append((name, _describe_data(measured, kind)))
    exact = (
        exact_columns(case.scene, case.columns, fit.free) if case.is_steady else {}
        for case in cases.values()
    )
    changed = [len(fit.free) - len(keys) for keys in exact]
    times = estimate_times((case.scene for case in cases.values()), with_files=False)
    seconds = float(np.dot(times, np.add(changed, 1)))
    runs = sum(not case.is_steady for case in cases.values())
    counts = f"{len(cases) - runs} contacts and {runs} runs, and {sum(changed)} with a changed"
    points = fit.curve * sum(bool(data_set.vary) for data_set in fit.data)
    once = format_duration(1.5**2 * sum(times))  # `on_finer_mesh`
    finer = f"; all data once on a finer mesh (fit.mesh_check), about {once}" * fit.mesh_check
    work = [
        ("an iteration", f"{counts} parameter; about {format_duration(seconds)} of one core"),
        ("iterations", f"at most {fit.iterations * fit.starts}"),
        ("afterwards", f"intervals, and up to {points} contacts for figures (fit.curve){finer}"),
    ]
    rows = [(key, _describe_parameter(parameters, k)) for k, key in enumerate(fit.free)]
    return Description(
        (Section("Parameters", rows), Section("Data", data_sets), Section("Work", work))
    )


def _describe_parameter(parameters: Parameters, k: int) -> str:
    """Describe start, bounds, prior and scale of a parameter."""
    lower, upper = (float(limit[k]) for limit in (parameters.lower, parameters.upper))
    text = f"from {parameters.start[k]:.4g}"
    text += f", at least {lower:g}" if np.isfinite(lower) else ""
    text += f", at most {upper:g}" if np.isfinite(upper) else ""
    mean, deviation = parameters.prior[k]
    text += f", prior {mean:g} ± {deviation:g}" if np.isfinite(mean) else ""
    return text + ("; its logarithm is fitted" if parameters.logarithmic[k] else "")


def _describe_data(measured: Measured, kind: str) -> str:
    """Describe the values of a data set, what varies, and whether they need contacts or runs."""
    data = measured.data
    body = f" of body {data.body}" if data.body else ""
    along = f" over {', '.join(data.vary)}" if data.vary else ""
    ranges = ", ".join(map(_describe_range, data.observe, measured.observed.T))
    return f"{measured.points} values of {ranges}{body}{along}, from {kind}"


def _describe_range(name: str, values: np.ndarray) -> str:
    """Describe a measured column by its range in the unit of the package."""
    unit = index_by_name(COLUMNS)[name].unit
    unit = "" if unit == "1" else f" {unit}"
    return f"{name} from {values.min():.4g} to {values.max():.4g}{unit}"


def explain_spread(design: SpreadDesign) -> Description:
    """Return sections that describe the uncertain keys, the outcomes and the runs of a spread.

    Raises
    ------
    SpreadError
        With every fault of the scene at the medians.
    """
    done = Evaluations(lambda cases: iter(()))
    inputs, table = design.inputs()[0], design.spread
    point = np.array([one.values(np.zeros(1))[0] for one in inputs])
    keys = [one.key for one in inputs]
    response = Response((table.scene,), tuple(keys), table.outcomes, done)
    (seconds,) = estimate_times([response.scene_at(point)], with_files=False)
    wanted = table.samples if table.indices is None else table.indices
    runs = table.samples + wanted * (1 + len(inputs))
    quantities = {str(one): quantity_of(str(one), table.scene) for one in table.outcomes}
    outcomes = [
        (name, format_with_unit(one.long_name, one.unit)) for name, one in quantities.items()
    ]
    each = f"about {format_duration(seconds)} each and {format_duration(seconds * runs)} in all"
    work = [
        ("linear estimate", f"at most {2 * len(inputs) + 2} runs"),
        ("samples", f"{table.samples} runs, at most {table.most}"),
        ("Sobol indices", f"about {wanted * (1 + len(inputs))} runs"),
        (
            "time",
            f"{each}, of one core" + (", less on the coarse mesh" * (table.coarse is not None)),
        ),
    ]
    rows = [(one.key, one.text) for one in inputs]
    return Description(
        (Section("Uncertain keys", rows), Section("Outcomes", outcomes), Section("Work", work))
    )


def explain_design(design: OptimumDesign) -> Description:
    """Return sections that describe the free keys, aims, limits and runs of a design.

    Raises
    ------
    SceneError
        With every fault of the scene at the start.
    """
    table = design.design
    search, aims, _, start = prepare_search(table, Evaluations(lambda cases: iter(())))
    rows = [("minimise" if one.sign > 0.0 else "maximise", one.name) for one in aims]
    if table.target is not None:
        rows = [("target", f"{aims[0].name} = {table.target.value:g}")]
    point, number = search.point(start), len(design.scenes)
    scenes = [search.response.scene_at(point, n) for n in range(number)]
    runs = (len(table.free) + 1) * number
    seconds = sum(estimate_times(scenes, with_files=False)) / number
    work = [
        ("an iteration", f"{runs} runs, about {format_duration(seconds * runs)} of one core"),
        ("iterations", f"at most {table.iterations} for each of {table.starts} starts"),
    ]
    keys = [(one.key, f"{one.lower:g} to {one.upper:g}") for one in table.free]
    units = (quantity_of(one.observe, table.scene).unit for one in table.limit)
    limits = [
        ("limit", format_with_unit(str(one), unit) + ", in the last record" * (one.at is None))
        for one, unit in zip(table.limit, units, strict=True)
    ]
    return Description(
        (Section("Free keys", keys), Section("Aims", rows + limits), Section("Work", work))
    )

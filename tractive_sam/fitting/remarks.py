"""What a fit leaves open, in words: undetermined parameters, and wide intervals."""

import math
import warnings
from collections.abc import Iterator, Sequence

import numpy as np

from tractive_sam.fitting.design import Fit, base_of, changes_of
from tractive_sam.fitting.estimate import Estimate
from tractive_sam.fitting.results import Intervals
from tractive_sam.scene import scene_notes


def describe_undetermined(best: Estimate, intervals: Intervals) -> list[str]:
    """Return a sentence for each direction in which the data do not determine parameters.

    Parameters that the data bound on one side are left out, see `list_notes`.

    Parameters
    ----------
    best : Estimate
        The minimum.
    intervals : Intervals
        Intervals of the estimate.
    """
    parameters = best.problem.parameters
    rows = _undetermined_rows(best)
    decided = "; the priors decide" if len(best.directions.null.T) < len(rows) else ""
    texts = []
    for row, involved in rows:
        keys = [parameters.keys[k] for k in involved]
        if len(keys) == 1 and not decided and np.isfinite(intervals.high[involved]).all():
            continue
        if len(keys) == 1 and not decided and np.isfinite(intervals.low[involved]).all():
            continue
        if not keys:
            texts.append("the position of a profile is not determined")
        elif len(keys) == 1:
            cure = _suggest_data(keys)
            texts.append(f"{keys[0]} is not determined at the estimate: {cure}")
        elif len(keys) == 2 and parameters.logarithmic[involved].all():
            texts.append(f"only {_product(keys, row[involved])} is determined")
        else:
            texts.append(f"only combinations of {', '.join(keys)} are determined")
    return [text + decided for text in texts]


def find_undetermined(best: Estimate) -> list[int]:
    """Return the parameters, by index, that data and priors do not determine at all."""
    if len(best.directions.null.T) < len(best.data_directions.null.T):
        return []
    return [int(involved[0]) for _, involved in _undetermined_rows(best) if len(involved) == 1]


def _undetermined_rows(best: Estimate) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return (direction, parameters by index) of each direction that the data do not determine."""
    directions = best.data_directions
    rows = _sparse_rows(directions.null.T, directions.involved)
    n = len(best.problem.parameters)
    return [(row, np.flatnonzero(np.abs(row[:n]) > directions.involved)) for row in rows]


def _product(keys: Sequence[str], direction: np.ndarray) -> str:
    """Return the product of powers of two parameters that the data determine, as "k1 * k2^3"."""
    # Difference from a simple number below which an exponent is written as that number.
    simple_within = 0.03
    power = -direction[0] / direction[1]
    for simple in (1.0, -1.0, 2.0, -2.0, 0.5, -0.5, 3.0, -3.0):
        if abs(power - simple) < simple_within * abs(simple):
            power = simple
    sign = "*" if power > 0.0 else "/"
    exponent = "" if abs(power) == 1.0 else f"^{abs(power):.3g}"
    return f"{keys[0]} {sign} {keys[1]}{exponent}"


def _sparse_rows(rows: np.ndarray, small: float) -> list[np.ndarray]:
    """Return a basis of the row space with few non-zero entries, by elimination."""
    rows = np.array(rows, float)
    done = 0
    for column in range(rows.shape[1] if rows.size else 0):
        if done == len(rows):
            break
        pivot = done + int(np.abs(rows[done:, column]).argmax())
        if abs(rows[pivot, column]) < small:
            continue
        rows[[done, pivot]] = rows[[pivot, done]]
        rows[done] /= rows[done, column]
        for row in range(len(rows)):
            if row != done:
                rows[row] -= rows[row, column] * rows[done]
        done += 1
    return [row / np.linalg.norm(row) for row in rows]


def _opposite_signs(best: Estimate) -> Iterator[str]:
    """Yield a note for each data set whose model has the opposite sign in nearly all rows."""
    first = 0
    for series in best.problem.series:
        rows = slice(first, first + series.measured.points)
        first = rows.stop
        if series.measured.data.profile:
            continue
        signs = np.sign(best.problem.observed[rows] * best.predicted[rows])
        opposite = int((signs < 0.0).sum())
        if opposite and opposite >= 0.8 * np.count_nonzero(signs):
            text = f"model and data have opposite signs in {opposite} of {signs.size} values"
            columns = " or of ".join([*series.columns, *series.measured.data.vary])
            cure = f"reverse the sign of {columns} in the data: creepage.longitudinal < 0 drives A"
            yield f"{series.name}: {text}; {cure}"


def _describe_bounds(best: Estimate, intervals: Intervals, level: float) -> Iterator[str]:
    """Yield a note for each parameter at a bound, or bounded by the data on one side only."""
    parameters = best.problem.parameters
    values = parameters.values(best.u)
    lower, upper = parameters.limits(values)
    for k, key in enumerate(parameters.keys):
        low, high, value = intervals.low[k], intervals.high[k], values[k]
        data = []
        if low <= lower[k] and np.isfinite(high):
            data.append(f"bounded above by {high:.3g} ({level:.0%}), and by no data from below")
        elif high >= upper[k] and np.isfinite(low):
            data.append(f"bounded below by {low:.3g} ({level:.0%}), and by no data from above")
        for bound, name in ((parameters.lower[k], "lower"), (parameters.upper[k], "upper")):
            if np.isclose(value, bound, rtol=1e-6, atol=0.0):
                data.append(f"at its {name} bound, {bound:g}; widen it unless it is a limit")
        if data:
            yield f"{key} is {'; '.join(reversed(data))}"


def _describe_spans(best: Estimate, intervals: Intervals, level: float) -> Iterator[str]:
    """Yield a note for each parameter, or pair of similar effect, with a wide interval."""
    keys, correlation = best.problem.parameters.keys, np.nan_to_num(best.correlation)
    np.fill_diagonal(correlation, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        spans = np.where(intervals.low > 0.0, intervals.high / intervals.low, math.nan)
    is_wide = (spans > 3.0) & np.isfinite(spans)
    noted: set[int] = set()
    for k in np.flatnonzero(is_wide).tolist():
        other = int(np.abs(correlation[k]).argmax())
        similar = abs(correlation[k, other]) >= 0.9
        if k in noted or not (similar or spans[k] > 10.0):
            continue
        pair = [k, other] if similar and is_wide[other] else [k]
        noted.update(pair)
        names = " and ".join(keys[one] for one in pair)
        factors = " and ".join(f"{spans[one]:.2g}" for one in pair)
        text = f"{names} hardly determined: {level:.0%} interval spans a factor of {factors}"
        cure = _suggest_data([keys[one] for one in pair])
        if similar:
            text += f"; {keys[k]} and {keys[other]} have similar effects"
            text += f" (correlation {correlation[k, other]:.2f})"
            cure = f"fix one of them, give it a prior, or {cure}"
        yield f"{text}: {cure}"


def _suggest_data(keys: Sequence[str]) -> str:
    """Return what would determine parameters that the data hardly determine, as text."""
    fast, full_slip = "sliding speeds above friction.half_speed", "creepages of full slip"
    data_for = {
        "friction.kinetic": fast, "friction.half_speed": fast, "friction.layer": "small creepages",
        "friction.mu": full_slip, "friction.static": full_slip,
    }  # fmt: skip
    at = " and ".join(dict.fromkeys(data_for[key] for key in map(base_of, keys) if key in data_for))
    where = f"at {at}" if at else "that depend more on it" if len(keys) == 1 else "that differ"
    return f"add measurements {where}; [[fit.test]] with --design ranks such tests"


def list_notes(best: Estimate, table: Fit, intervals: Intervals) -> list[str]:
    """Return the caveats of a fit, as sentences."""
    notes = [note for series in best.problem.series for note in series.notes]
    notes += _opposite_signs(best)
    if best.iterations >= table.iterations:
        notes.append(f"the search ended at {table.iterations} iterations: raise fit.iterations")
    low, high = best.chi2_range(table.level)
    if best.chi2 > high:
        cure = "the noise is larger than stated, or the model does not describe the data"
        notes.append(f"chi-square {best.chi2:.3g} is above its expected range: {cure}")
    if best.chi2 < low:
        notes.append(f"chi-square {best.chi2:.3g} is below its expected range: overstated noise")
    if best.degrees < best.fewest_degrees:
        text = "as many parameters as points: chi-square says nothing about the model"
        notes.append(text + (", and the scatter nothing about the noise" * table.scatter))
    notes += _describe_bounds(best, intervals, table.level)
    notes += _describe_spans(best, intervals, table.level)
    if failures := [*best.problem.failures.values()]:
        text = f"{len(failures)} computations failed during the fit, which turned back"
        notes.append(f"{text}; the last one: {failures[-1]}")
    notes += _describe_several_solutions(best)
    notes += _describe_implausible(best, table)
    return notes


def _describe_several_solutions(best: Estimate) -> Iterator[str]:
    """Yield a note if contacts of the fit may have other solutions than those that it used."""
    count, rows = best.problem.find_several_solutions(best.u)
    if not count:
        return
    total = len(best.problem.evaluations.stored)
    text = f"{count} of {total} computations have no unique solution"
    text += f", at the estimate {len(rows)}" + (f", as {rows[0]}" if rows else "")
    text += ": friction falls too fast with sliding; the fit follows friction.start"
    yield text + (", and its intervals hold for these solutions" if rows else "")


def _describe_implausible(best: Estimate, table: Fit) -> Iterator[str]:
    """Yield notes on fitted values that are improbable, or far from those of the scene."""
    parameters = best.problem.parameters
    values = parameters.values_by_key(best.u)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        fitted = table.scene.replace(**changes_of(table.scene, values))
    known = {*scene_notes(table.scene)}
    notes = [note for note in scene_notes(fitted) if note not in known]
    yield from (f"the fitted scene: {note}" for note in notes)
    for key, start in zip(parameters.keys, parameters.start.tolist(), strict=True):
        wears = base_of(key).startswith(("wear.coefficient", "wear.intensity"))
        factor = values[key] / start if wears and start > 0.0 else 1.0
        if not 0.01 < factor < 100.0 and not any(note.startswith("wear") for note in notes):
            text = f"{key} = {values[key]:.3g} is {factor:.2g} times its first value, {start:.3g}"
            yield f"{text}: check the unit of the data (worn_mass is in mg, depths are in mm)"

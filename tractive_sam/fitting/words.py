"""Sentences on undetermined parameters and caveats of a fit."""

from collections.abc import Iterator, Sequence

import numpy as np

from tractive_sam.fitting.design import Fit
from tractive_sam.fitting.estimate import Directions, Estimate


def describe_undetermined(best: Estimate) -> list[str]:
    """Return a sentence for each direction in which the data do not determine parameters."""
    parameters = best.problem.parameters
    directions = Directions.of(best.weighted)
    rows = _sparse_rows(directions.null.T, directions.involved)
    decided = "; the priors decide" if len(best.directions.null.T) < len(rows) else ""
    texts = []
    for row in rows:
        involved = np.flatnonzero(np.abs(row[: len(parameters)]) > directions.involved)
        keys = [parameters.keys[k] for k in involved]
        if not keys:
            texts.append("the position of a profile is not determined")
        elif len(keys) == 1:
            texts.append(f"{keys[0]} is not determined: no data depend on it at the estimate")
        elif len(keys) == 2 and parameters.logarithmic[involved].all():
            texts.append(f"only {_product(keys, row[involved])} is determined")
        else:
            texts.append(f"only combinations of {', '.join(keys)} are determined")
    return [text + decided for text in texts]


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
        signs = np.sign(best.problem.observed[rows] * best.predicted[rows])
        opposite = int((signs < 0.0).sum())
        if opposite and opposite >= 0.8 * np.count_nonzero(signs):
            text = f"model and data have opposite signs in {opposite} of {signs.size} values"
            columns = " or of ".join([*series.columns, *series.measured.data.vary])
            cure = f"reverse the sign of {columns} in the data: creepage.longitudinal < 0 drives A"
            yield f"{series.key}: {text}; {cure}"


def list_notes(best: Estimate, table: Fit) -> list[str]:
    """Return the caveats of a fit, as sentences."""
    parameters = best.problem.parameters
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
    if best.degrees <= 0:
        notes.append("as many parameters as points: chi-square says nothing about the model")
    for key, value, low_end, high_end in zip(
        parameters.keys, parameters.values(best.u), parameters.lower, parameters.upper, strict=True
    ):
        for bound, name in ((low_end, "lower"), (high_end, "upper")):
            if np.isclose(value, bound, rtol=1e-6, atol=0.0):
                notes.append(
                    f"{key} is at its {name} bound, {bound:g}: no valid interval; widen the bounds"
                )
    if messages := best.problem.failures:
        notes.append(f"{len(messages)} computations failed during the fit: {messages[-1]}")
    return notes

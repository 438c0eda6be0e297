"""Answers of computations in the file of a fit: an interrupted fit resumes from them."""

import json
import math
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from tractive_sam.fitting.case import Answer
from tractive_sam.fitting.design import FitDesign
from tractive_sam.fitting.fit_file import open_fit
from tractive_sam.scene import describe_changes, hashes_of
from tractive_sam.store import DamagedError, ResultsError, versions


def read_answers(
    document: FitDesign, path: str | PathLike[str] | None, overwrite: bool
) -> dict[str, Answer]:
    """Return stored answers of an earlier run by digest, {} if none fit; raise for another scene.

    Raises
    ------
    ResultsError
        If it is no fit, or one of another scene.
    """
    if path is None or not Path(path).exists():
        return {}
    before = open_fit(path)
    data = before.dataset
    stored = json.loads(str(data.attrs.get("files", "{}")))
    changed = describe_changes(hashes_of([document.fit.scene]), stored)
    if changed or before.design.fit.scene != document.fit.scene:
        if overwrite:
            return {}
        cure = "-o FILE.nc gives this fit another file, --overwrite replaces it"
        reason = (
            f"the fit of another scene: {changed} has changed"
            if changed
            else "the fit of another scene"
        )
        raise ResultsError(f"{path} holds {reason}; {cure}")
    if "answer" not in data or data.attrs.get("version") != versions()["tractive-sam"]:
        return {}  # another version may compute other numbers
    try:
        return _restore(data)
    except Exception as error:  # of numbers and texts that were changed
        cure = "remove it, and fit again"
        raise DamagedError(f"{path} is damaged ({error}): {cure}") from error


def _restore(data: Any) -> dict[str, Answer]:
    """Return the answers by digest from the variables of a dataset."""
    flat, answers, first = data["answer_numbers"].values, {}, 0
    names = ("answer", "answer_layout", "answer_message", "answer_cost")
    for digest, layout, message, cost in zip(*(data[name].values for name in names), strict=True):
        numbers = arrays_of(str(layout), flat[first:])
        first += sum(array.size for array in numbers.values())
        contacts, rolls, convolutions = cost.tolist()
        answers[str(digest)] = Answer(
            numbers, int(contacts), int(rolls), convolutions, str(message)
        )
    return answers


def answer_variables(answers: Mapping[str, Answer]) -> dict[str, tuple]:
    """Return the variables that store the answers of all computations; {} without any."""
    if not answers:
        return {}
    numbers = [np.ravel(array) for answer in answers.values() for array in answer.numbers.values()]
    layouts = [layout_of(answer.numbers) for answer in answers.values()]
    messages = [answer.message for answer in answers.values()]
    costs = [(answer.contacts, answer.rolls, answer.convolutions) for answer in answers.values()]
    flat = np.concatenate([np.zeros(0), *numbers, np.zeros(1)])
    return {
        "answer": (("answers",), [*answers], "1", "hash of a computation"),
        "answer_layout": (("answers",), layouts, "1", "names and shapes of its numbers"),
        "answer_message": (("answers",), messages, "1", "why it failed"),
        "answer_cost": (("answers", "cost"), costs, "1", "contacts, rolls, transforms"),
        "answer_numbers": (("numbers",), flat, "1", "numbers of all computations"),
    }


def layout_of(numbers: Mapping[str, np.ndarray]) -> str:
    """Return the names and shapes of arrays as JSON text."""
    return json.dumps([[name, list(np.shape(array))] for name, array in numbers.items()])


def arrays_of(layout: str, flat: np.ndarray) -> dict[str, np.ndarray]:
    """Return arrays by name from their layout and all their numbers in one flat array."""
    arrays, first = {}, 0
    for name, shape in json.loads(layout):
        count = math.prod(shape)
        arrays[name] = flat[first : first + count].reshape(shape)
        first += count
    return arrays

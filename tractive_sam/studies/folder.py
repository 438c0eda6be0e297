"""The folder of a study: what was asked, one results file a case, and what went wrong.

    study.toml                  the study, with its scene
    00012-0123456789abcdef.h5   results of a case: its number when it was first run, and the hash of
                                its scene
    0123456789abcdef.txt        why a case failed
    complete.jsonl              last records of the cases that are complete, to be read at once

Results files are written by workers, everything else by the one client that runs the study. There
is no other state: what is complete is what these files say.
"""

import json
import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from tractive_sam.store import ResultsError
from tractive_sam.studies.case import Case
from tractive_sam.studies.design import Study
from tractive_sam.studies.lock import HeldError, locked


class Folder:
    """The folder of a study.

    Parameters
    ----------
    path : path-like
        Where it is.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path).absolute()
        self._study, self._complete = self.path / "study.toml", self.path / "complete.jsonl"

    @contextmanager
    def taken(self, study: Study) -> Iterator[None]:
        """Make the folder that of a study, for one client alone.

        Raises
        ------
        ResultsError
            If it cannot be written, is used for something else, or another client runs it.
        """
        with ExitStack() as held:
            try:
                self.path.mkdir(parents=True, exist_ok=True)
                if not self._study.exists() and any(self.path.glob("[!.]*")):
                    raise ResultsError(
                        f"{self.path} holds other files; a study needs a folder of its own"
                    )
                held.enter_context(locked(self.path / ".client.lock"))
                _replace(self._study, study.to_toml())
            except HeldError:
                raise ResultsError(
                    f"{self.path} is being run by another client; wait for it, stop it, or choose "
                    "another folder"
                ) from None
            except FileExistsError:
                raise ResultsError(f"{self.path} is not a folder; choose another") from None
            except OSError as error:
                raise ResultsError(
                    f"{self.path} cannot be written: {error}; choose another folder"
                ) from error
            yield

    def study(self) -> Study:
        """The study that is run here.

        Raises
        ------
        ResultsError
            If there is none.
        StudyError
            If its file is not valid any more.
        """
        if not self._study.is_file():
            raise ResultsError(
                f"{self.path} is not the folder of a study; tractive-sam study STUDY.toml -o "
                f"{self.path} makes it"
            )
        return Study.from_toml(self._study)

    def results(self) -> dict[str, Path]:
        """Results files by the hash of their scenes."""
        with os.scandir(self.path) as files:
            names = [file.name for file in files if file.name.endswith(".h5")]
        return {
            name[:-3].partition("-")[2]: self.path / name
            for name in sorted(names)
            if not name.startswith(".")
        }

    def file_of(self, case: Case, results: dict[str, Path]) -> Path:
        """The results file of a case, be it there already or not."""
        return results.get(case.digest, self.path / f"{case.name}.h5")

    def complete(self) -> dict[str, dict[str, Any]]:
        """What `keep` was told, by the hash of the scene; the results files have the last word."""
        if not self._complete.exists():
            return {}
        kept = {}
        for line in self._complete.read_text(encoding="utf-8").splitlines():
            try:
                one = json.loads(line)
            except ValueError:  # a line that a killed client wrote half
                continue
            kept[one["digest"]] = one
        return kept

    def keep(self, case: Case, message: str, row: dict[str, Any]) -> None:
        """Remember the last record of a complete case."""
        line = json.dumps({"digest": case.digest, "message": message, "row": row})
        with self._complete.open("a", encoding="utf-8") as file:
            file.write(f"\n{line}")
        self._fault(case).unlink(missing_ok=True)

    def fail(self, case: Case, message: str) -> None:
        """Say why a case failed."""
        _replace(self._fault(case), message)

    def failures(self) -> dict[str, str]:
        """Why cases failed, by the hash of their scenes."""
        return {file.stem: file.read_text(encoding="utf-8") for file in self.path.glob("*.txt")}

    def _fault(self, case: Case) -> Path:
        return self.path / f"{case.digest}.txt"


def _replace(path: Path, text: str) -> None:
    """Write a text file whole or not at all."""
    scratch = path.with_name(f".{path.name}.new")
    scratch.write_text(text, encoding="utf-8")
    os.replace(scratch, path)

"""The folder of a study: its design, a results file for each case, and the failures.

    study.toml                  the study, with its scene
    00012-0123456789abcdef.h5   results of a case: its number when it was first run, and the hash of
                                its scene
    00012-0123456789abcdef.damaged    a results file that could not be read
    0123456789abcdef.txt        why a case failed: the message, and after an empty line the version
                                of this package, the worker and its traceback
    complete.jsonl              last records of complete cases, to be read at once, each
                                with a checksum (see `case_log`)

Workers write the results files; the client that runs the study writes all others. There is no other
state: these files determine which cases are complete. Other files are not changed.

A study that keeps scalars has no results files: complete.jsonl has a line for each complete case. A
line is written before the case is reported as complete, and counts only if it agrees with its
checksum.
"""

import os
import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from tractive_sam.output_file import OutputError, describe_os_error, is_disk_failure, write_file
from tractive_sam.scene import hashes_of
from tractive_sam.store import FileInUseError, ResultsError, StorageError, hold_lock
from tractive_sam.studies.case import DIGEST, Case
from tractive_sam.studies.case_log import CaseLog
from tractive_sam.studies.design import Study
from tractive_sam.studies.task import CaseOutcome, Task


class Folder:
    """Folder of a study: the study, results files, log of cases, and failures.

    Parameters
    ----------
    path : path-like
        The folder.
    """

    digest_pattern = re.compile(rf"[0-9a-f]{{{DIGEST}}}")

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path).absolute()
        self._study, self.log = self.path / "study.toml", CaseLog(self.path / "complete.jsonl")

    @contextmanager
    def lock(self, study: Study) -> Iterator[None]:
        """Within the block, lock the folder for one client; create it, and store the study in it.

        Raises
        ------
        ResultsError
            If it cannot be written, has other files, or another client runs it.
        """
        with ExitStack() as locks:
            try:
                self.path.mkdir(parents=True, exist_ok=True)
                if not self._study.exists() and any(self.path.glob("[!.]*")):
                    message = f"{self.path} contains other files; choose an empty folder"
                    raise ResultsError(message)
                locks.enter_context(hold_lock(self.path / ".client.lock"))
                write_file(self._study, study.to_toml())
            except FileInUseError:
                raise ResultsError(
                    f"{self.path} is being run by another client; wait for it, stop it, or choose "
                    "another folder"
                ) from None
            except FileExistsError:
                raise ResultsError(f"{self.path} is not a folder; choose another") from None
            except OutputError:
                raise
            except OSError as error:
                if is_disk_failure(error):
                    message = f"{self.path} cannot be written: {describe_os_error(error)}"
                    raise StorageError(message) from error
                raise ResultsError(
                    f"{self.path} cannot be written: {error}; choose another folder"
                ) from error
            yield

    def study(self) -> Study:
        """Return the study that is stored in the folder; ResultsError if there is none.

        Raises
        ------
        ResultsError
            If the folder has no study.
        StudyError
            If its file is no longer valid.
        """
        if not self._study.is_file():
            raise ResultsError(
                f"{self.path} is not the folder of a study; tractive-sam study STUDY.toml -o "
                f"{self.path} creates it"
            )
        return Study.from_toml(self._study)

    def results(self) -> dict[str, Path]:
        """Return the results files in the folder, by the hash of their scenes."""
        with os.scandir(self.path) as files:
            names = [file.name for file in files if file.name.endswith(".h5")]
        return {
            name[:-3].partition("-")[2]: self.path / name
            for name in sorted(names)
            if not name.startswith(".")
        }

    def file_of(self, case: Case, results: dict[str, Path]) -> Path:
        """Return the path of the results file of a case, existing or not."""
        return results.get(case.digest, self.path / f"{case.name}.h5")

    def log_complete(self, task: Task, outcome: CaseOutcome) -> None:
        """Log a complete case with its last record, and remove its earlier failure."""
        entry = {
            "digest": task.case.digest,
            "size": 0 if task.file is None else task.file.stat().st_size,
            "version": outcome.version,
            "message": outcome.message,
            "row": outcome.row,
        }
        if files := hashes_of([task.case.scene]):
            entry["files"] = files
        self.log.append(entry)
        self._failure_file(task.case).unlink(missing_ok=True)

    def log_failure(self, case: Case, outcome: CaseOutcome) -> None:
        """Write message, version, worker and traceback of a failed case to its failure file."""
        by = f"tractive-sam {outcome.version or 'of unknown version'} on {outcome.worker or '?'}"
        write_file(self._failure_file(case), f"{outcome.message}\n\n{by}\n{outcome.traceback}")

    def failures(self) -> dict[str, str]:
        """Return the reasons of failed cases, by the hash of their scenes."""
        return {
            file.stem: file.read_text(encoding="utf-8", errors="replace").partition("\n\n")[0]
            for file in self.path.glob("*.txt")
            if self.digest_pattern.fullmatch(file.stem) and file.is_file()
        }

    def _failure_file(self, case: Case) -> Path:
        """Return the path of the file with the reason of a case's failure."""
        return self.path / f"{case.digest}.txt"

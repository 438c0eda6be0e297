import subprocess
import sys

import pytest

from tractive_sam.store import ResultsError
from tractive_sam.store.write_access import FileInUseError, hold_lock, is_locked


def test_one_holder_at_a_time(tmp_path):
    path = tmp_path / "lock"
    with hold_lock(path):
        assert is_locked(path)
        with pytest.raises(FileInUseError), hold_lock(path):
            pass
    assert not path.exists()
    assert not is_locked(path)


def test_a_link_is_no_lock(tmp_path):
    path, target = tmp_path / "lock", tmp_path / "target"
    target.write_text("unharmed")
    path.symlink_to(target)
    with pytest.raises(ResultsError, match="is a link; remove it"), hold_lock(path):
        pass
    assert target.read_text() == "unharmed"


def test_lock_ends_with_its_process(tmp_path):
    """However that ends; the file may stay and is taken over."""
    path = tmp_path / "lock"
    holds = (
        "import sys, time, pathlib; from tractive_sam.store.write_access import hold_lock\n"
        "with hold_lock(pathlib.Path(sys.argv[1])): print('held', flush=True); time.sleep(60)"
    )
    with subprocess.Popen([sys.executable, "-c", holds, path], stdout=subprocess.PIPE) as holder:
        assert holder.stdout.readline().strip() == b"held"
        assert is_locked(path)
        holder.kill()
        holder.wait()
    assert path.exists()
    assert not is_locked(path)
    with hold_lock(path):
        pass

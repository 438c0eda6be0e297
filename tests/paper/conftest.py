"""The paper, reproduced once at its reduced size."""

from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

from tractive_sam.cli import app


@pytest.fixture(scope="session")
def reproduced(tmp_path_factory):
    """What the command leaves behind, and what it prints."""
    folder = tmp_path_factory.mktemp("paper") / "reproduced"
    arguments = ["reproduce", "-o", str(folder), "--reduced", "--format", "svg"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    html = (folder / "index.html").read_text("utf-8")
    return SimpleNamespace(folder=folder, html=html, printed=result.stdout)

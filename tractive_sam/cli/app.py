"""The program `tractive-sam` and its commands."""

import sys
from typing import Annotated

import typer

from tractive_sam.cli.explain import explain
from tractive_sam.cli.export import export
from tractive_sam.cli.output import Status, silence, stop, tell
from tractive_sam.cli.plot import plot
from tractive_sam.cli.reproduce import reproduce
from tractive_sam.cli.run import run
from tractive_sam.cli.scenes import scenes
from tractive_sam.cli.show import show
from tractive_sam.cli.study import study
from tractive_sam.cli.study_show import study_show

app = typer.Typer(
    name="tractive-sam",
    help="Tractive rolling contact: forces, stick and slip, wear.",
    epilog="Exit status: 0 done; 2 the input is not valid; 3 not converged or stopped early.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for command in (run, show, plot, export, explain, scenes, reproduce, study, study_show):
    app.command()(command)


def main() -> None:
    """Run the program."""
    try:
        app()
    except OSError as error:  # of the output itself: commands tell of all others
        silence(sys.stdout)
        raise SystemExit(
            stop(Status.INCOMPLETE, f"the output is lost: {error}").exit_code
        ) from None


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        tell(f"tractive-sam {version('tractive-sam')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Print the version.", callback=_print_version, is_eager=True
        ),
    ] = False,
) -> None:
    pass

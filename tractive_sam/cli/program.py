"""The program `tractive-sam` and its commands."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

import typer
from typer.core import TyperGroup

from tractive_sam import interrupt
from tractive_sam.cli.explain import explain
from tractive_sam.cli.export import export
from tractive_sam.cli.keys import keys
from tractive_sam.cli.output import (
    Status,
    running_command,
    silence,
    spell_what_has_no_sign,
    stop,
    tell,
)
from tractive_sam.cli.plot import plot
from tractive_sam.cli.report import report
from tractive_sam.cli.reproduce import reproduce
from tractive_sam.cli.run import run
from tractive_sam.cli.scenes import scenes
from tractive_sam.cli.show import show
from tractive_sam.cli.study import study
from tractive_sam.cli.study_show import study_show
from tractive_sam.cli.table import table
from tractive_sam.safe_text import printable_text


@contextmanager
def _ended_well() -> Iterator[None]:
    """What may end any command: that it is asked to stop, or that its reader leaves."""
    try:
        interrupt.raise_if_interrupted()
        yield
    except KeyboardInterrupt:
        raise stop(Status.INCOMPLETE, "interrupted") from None
    except (BrokenPipeError, SystemExit):  # which rich makes of it while it prints help
        silence(sys.stdout)
        raise typer.Exit(Status.DONE) from None
    except Exception as error:
        # What the library of commands has to say, it says with arguments as they were given.
        message = getattr(error, "message", None)
        if isinstance(message, str):
            vars(error)["message"] = printable_text(message)
        raise


class _Program(TyperGroup):
    """All commands, ended well; help is printed while the context is made."""

    def make_context(self, *arguments, **options):
        with _ended_well():
            return super().make_context(*arguments, **options)

    def invoke(self, ctx):
        with running_command(), _ended_well():
            return super().invoke(ctx)


app = typer.Typer(
    cls=_Program,
    name="tractive-sam",
    help="Tractive rolling contact: forces, stick and slip, wear.",
    epilog="Exit status: 0 done; 2 the input is not valid; 3 not converged or stopped early.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for command in (
    run,
    show,
    plot,
    report,
    export,
    explain,
    keys,
    scenes,
    reproduce,
    study,
    study_show,
    table,
):
    app.command()(command)


def run_program() -> None:
    """Run the program on the arguments of the process."""
    spell_what_has_no_sign()
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
            "--version", "-V", help="Print the version.", callback=_print_version, is_eager=True
        ),
    ] = False,
) -> None:
    pass

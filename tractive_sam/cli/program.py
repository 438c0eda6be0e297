"""The program `tractive-sam` and its commands."""

import inspect
import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from tractive_sam import interrupt
from tractive_sam.cli.explain import explain, keys, scenes
from tractive_sam.cli.fit import design, fit, spread
from tractive_sam.cli.output import (
    ExitStatus,
    discard_output,
    exit_after,
    incomplete_exit,
    print_line,
    replace_missing_signs,
    running_command,
)
from tractive_sam.cli.run import locus, reproduce, run, validate, wear
from tractive_sam.cli.show import export, plot, report, show, study_show
from tractive_sam.cli.study import study, table
from tractive_sam.safe_text import printable_text


@contextmanager
def _handle_end() -> Iterator[None]:
    """End the command with its exit status after an error, a signal, or a closed output."""
    try:
        interrupt.raise_if_interrupted()
        yield
    except KeyboardInterrupt:
        raise incomplete_exit("interrupted") from None
    except (BrokenPipeError, SystemExit):  # rich raises the latter while it prints help
        discard_output(sys.stdout)
        raise typer.Exit(ExitStatus.DONE) from None
    except typer.Exit:
        raise
    except Exception as error:
        message = getattr(error, "message", None)
        if isinstance(message, str):  # of typer, and contains arguments as they were given
            vars(error)["message"] = printable_text(message)
        elif leave := exit_after(error):
            raise leave from None
        raise


class _CommandGroup(TyperGroup):
    """Group of all commands, which turns failures and signals into a message and an exit status."""

    def make_context(self, *arguments: Any, **options: Any) -> Any:
        """Parse the arguments; end with a message and an exit status if they are invalid."""
        with _handle_end():
            return super().make_context(*arguments, **options)

    def invoke(self, ctx: Any) -> Any:
        """Run the command; end with a message and an exit status if it fails."""
        with running_command(), _handle_end():
            return super().invoke(ctx)


app = typer.Typer(
    cls=_CommandGroup,
    name="tractive-sam",
    help="Compute tractive rolling contact: forces, stick and slip, wear.",
    epilog="Exit status: 0 done; 2 the input is not valid; 3 not converged or stopped early.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _add_command(command: Callable[..., None]) -> None:
    """Add a command whose docstring describes it and those of its parameters that have no help.

    Raises KeyError if the docstring describes a parameter that the command lacks.
    """
    text = inspect.cleandoc(command.__doc__ or "")
    summary, _, parameters = text.partition("\n\nParameters\n----------\n")
    for name, described in re.findall(r"^(\w+)\n((?: .*\n?)+)", parameters, re.MULTILINE):
        kind = command.__annotations__[name]
        if not hasattr(kind, "__metadata__"):
            kind = command.__annotations__[name] = Annotated[kind, typer.Option()]
        kind.__metadata__[0].help = " ".join(described.split()).replace("[", r"\[")  # no markup
    app.command(help=summary.replace("[", r"\["))(command)


# fmt: off
for command in (
    run, show, plot, report, export, explain, keys, scenes, reproduce, study, study_show, table,
    fit, spread, design, locus, wear, validate,
):
    _add_command(command)
# fmt: on


def run_program() -> None:
    """Run the command that the arguments of the process name."""
    replace_missing_signs()
    os.environ["MPLBACKEND"] = "agg"  # figures need no window; matplotlib refuses unknown names
    try:
        app()
    except OSError as error:  # of the output itself: commands report all others
        discard_output(sys.stdout)
        leave = incomplete_exit(f"the output is lost: {error}")
        raise SystemExit(leave.exit_code) from None


def _print_version(wanted: bool) -> None:
    """Print the version and exit, if `wanted` (callback of --version)."""
    if wanted:
        from importlib.metadata import version

        print_line(f"tractive-sam {version('tractive-sam')}")
        raise typer.Exit


_Version = typer.Option(
    "--version", "-V", help="Print the version.", callback=_print_version, is_eager=True
)


@app.callback()
def _options(version: Annotated[bool, _Version] = False) -> None:
    """Accept options of the program before a command (--version); do nothing else."""
    pass

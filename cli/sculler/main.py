"""Entry point: the verbs, and what becomes of their errors.

Exit status: 0 done, 1 a comparison or requirement failed, 2 bad usage or bad input with exactly one
line on stderr, 130 interrupted, 141 nobody reads the output.  Verbs import what they need when they
run, so that `--help` is quick.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

import click

from sculler.verbs import VerbGroup

VERBS = (
    "coefficients",
    "generate",
    "model",
    "simulate",
    "compare",
    "convert",
    "motion",
    "navigate",
    "analyze",
    "advise",
    "place",
    "demo",
)
"""In the order of the work; verb V is the click command `command` of `sculler.commands.V`."""

FAILED, BAD_INPUT, INTERRUPTED, UNREAD = 1, 2, 130, 141


@click.group(
    cls=VerbGroup,
    package="sculler.commands",
    verbs=VERBS,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Every verb has --help with an example.  DESIGN is a design file (TOML) or a preset's"
    " name.",
)
@click.version_option(package_name="sculler", prog_name="sculler", message="%(prog)s %(version)s")
def cli() -> None:
    """Exact coning and sculling for FPGA navigation computers.

    Design the algorithm, generate its Verilog, model it bit by bit, simulate the one against the
    other on real IMU logs, and navigate.
    """


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status.

    Args:
        arguments: the words after `sculler`; left out, those of the process.
    """
    return run_command(cli, arguments, "sculler")


def run_command(command: click.Command, arguments: Sequence[str] | None, name: str) -> int:
    """Run a command, turning its errors into one line on stderr and an exit status."""
    try:
        status = command.main(args=arguments, prog_name=name, standalone_mode=False)
        sys.stdout.flush()
    except click.exceptions.Exit as done:
        return done.exit_code
    except click.UsageError as error:
        verb = error.ctx.command_path if error.ctx else name
        return _complain(f"{error.format_message().rstrip('.')}; see '{verb} --help'")
    except click.ClickException as error:
        return _complain(error.format_message())
    except (KeyboardInterrupt, click.Abort):
        return INTERRUPTED
    except (BrokenPipeError, SystemExit):
        # the reader of our output has gone (`sculler ... | head`), which click and rich tell by
        # SystemExit: nothing more to say, not even when the interpreter flushes stdout at its end
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return UNREAD
    except OSError as error:
        where = error.filename if error.filename is not None else "a file"
        return _complain(f"{where}: {error.strerror or error}; check the path and its permissions")
    except Exception as error:
        known = _known(error)
        if known is None:
            raise
        return _complain(str(error), known)
    return status if isinstance(status, int) else 0


def _known(error: Exception) -> int | None:
    """Exit status of the packages' own errors, None for any other.

    It asks without importing them, which would be slow: what raised the error has.
    """
    for module, name, status in (
        ("sculler_model.errors", "InputError", BAD_INPUT),
        ("sculler_sim.run", "SimulationError", FAILED),
    ):
        if module in sys.modules and isinstance(error, getattr(sys.modules[module], name)):
            return status
    return None


def _complain(message: str, status: int = BAD_INPUT) -> int:
    """One line on stderr; gives the exit status back."""
    click.echo("sculler: " + " ".join(message.split()), err=True)
    return status

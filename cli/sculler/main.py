"""Entry point: the verbs, and what becomes of their errors.

Exit status: 0 done, 1 a comparison or requirement failed, 2 bad usage or bad input with exactly one
line on stderr, 130 interrupted, 129 hung up, 143 terminated, 141 nobody reads the output.  Verbs
import what they need when they run, so that `--help` is quick.
"""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Sequence
from contextlib import suppress

import click

from sculler.process import Ended, any_encoding, signals_raise
from sculler.verbs import VerbGroup
from sculler_model import inputs, machine_code

VERBS = (
    "coefficients",
    "generate",
    "model",
    "simulate",
    "compare",
    "convert",
    "motion",
    "navigate",
    "campaign",
    "analyze",
    "advise",
    "place",
    "soc",
    "demo",
)
"""In the order of the work; verb V is the click command `command` of `sculler.commands.V`."""

FAILED, BAD_INPUT, INTERRUPTED, UNREAD = 1, 2, 130, 141

_LONGEST = 2000  # characters of a message, which may cite the input


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
    if arguments is None:
        machine_code.alone()
    return run_command(cli, arguments, "sculler")


def run_command(command: click.Command, arguments: Sequence[str] | None, name: str) -> int:
    """Run a command, turning its errors into one line on stderr and an exit status."""
    any_encoding()
    try:
        with inputs.remembered(), signals_raise(last_words=arguments is None):
            status = command.main(args=arguments, prog_name=name, standalone_mode=False)
            sys.stdout.flush()
    except click.exceptions.Exit as done:
        return done.exit_code
    except click.UsageError as error:
        verb = error.ctx.command_path if error.ctx else name
        return _complain(f"{error.format_message().rstrip('.')}; see '{verb} --help'")
    except click.ClickException as error:
        return _complain(error.format_message())
    except Ended as signal:
        return signal.status
    except (KeyboardInterrupt, click.Abort):
        return INTERRUPTED
    except (BrokenPipeError, SystemExit):
        # the reader of our output has gone (`sculler ... | head`), which click and rich tell by
        # SystemExit: nothing more to say
        _forget_stdout()
        return UNREAD
    except OSError as error:
        return _complain(_os_error(error))
    except MemoryError:
        return _complain("the input asks for more memory than there is, give a smaller one")
    except Exception as error:
        known = _known(error)
        if known is None:
            raise
        return _complain(str(error) + _see_help(error, arguments, name), known)
    return status if isinstance(status, int) else 0


def _os_error(error: OSError) -> str:
    """An error of the system in a line: of a file, or of our own output."""
    full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
    # files that we write are named where they are full (`files.replacing`)
    where = error.filename or ("standard output" if full else "a file")
    try:
        sys.stdout.flush()
    except OSError:
        _forget_stdout()
    cure = "free some space" if full else "check the path and its permissions"
    return f"{where}: {error.strerror or error}; {cure}"


def _forget_stdout() -> None:
    """Let what stdout still holds go nowhere, not even when the interpreter flushes it."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _known(error: Exception) -> int | None:
    """Exit status of the packages' own errors, None for any other.

    It asks without importing them, which would be slow: what raised the error has.
    """
    for module, name, status in (
        ("sculler_model.errors", "InputError", BAD_INPUT),
        ("sculler_model.errors", "ToolError", BAD_INPUT),
        ("sculler_sim.run", "SimulationError", FAILED),
    ):
        if module in sys.modules and isinstance(error, getattr(sys.modules[module], name)):
            return status
    return None


def _see_help(error: Exception, arguments: Sequence[str] | None, name: str) -> str:
    """Where to read which arguments go together, if it is that."""
    errors = sys.modules.get("sculler_model.errors")
    if errors is None or not isinstance(error, errors.ContradictionError):
        return ""
    words = sys.argv[1:] if arguments is None else arguments
    verb = next((word for word in words if word in VERBS), None)
    if verb is None:
        return ""
    below = getattr(sys.modules.get(f"sculler.commands.{verb}"), "VERBS", ())
    called = " ".join([verb, *[word for word in words if word in below][:1]])
    return f"; see '{name} {called} --help'"


def _complain(message: str, status: int = BAD_INPUT) -> int:
    """One line on stderr; gives the exit status back."""
    line = " ".join(message.split())
    if len(line) > _LONGEST:
        line = f"{line[: _LONGEST // 2]} ... {line[-_LONGEST // 2 :]}"
    with suppress(OSError, ValueError):  # nobody hears it
        print(f"sculler: {line}", file=sys.stderr, flush=True)
    return status

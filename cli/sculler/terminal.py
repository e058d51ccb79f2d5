"""What the verbs share: arguments, progress on a terminal, and the report at the end."""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from sculler.words import Advance, silent
from sculler_model import inputs

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from rich.progress import Progress, TaskID

    from sculler_model.design import Design

Command = TypeVar("Command", bound=Callable[..., Any])

PROGRESS_AFTER = 1.0
"""Seconds of work before a progress bar appears."""


class OutputFile(click.Path):
    """An option's type: a file to write, claimed at once (`inputs.claim`)."""

    name = "file"

    def __init__(self) -> None:
        super().__init__(dir_okay=False, path_type=Path)

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """The path, or what is wrong with it."""
        path = Path(str(super().convert(value, param, ctx)))
        inputs.claim(path)
        return path


class InputFile(click.Path):
    """An argument's type: a file to read, which no output may replace; `-` is stdin.

    Args:
        path_type: str or Path.
    """

    name = "file"

    def __init__(self, path_type: type[str] | type[Path] = str) -> None:
        super().__init__(path_type=path_type, allow_dash=path_type is str)

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """The path, noted."""
        path = super().convert(value, param, ctx)
        inputs.note(_STDIN if str(path) == "-" else str(path))
        return path


_STDIN = 0


def number_type(
    least: float = -math.inf, most: float = math.inf, above: bool = False
) -> Callable[[str], float]:
    """An option's type: a finite number, at least `least` (or above it), at most `most`."""
    limits = [f"{'>' if above else '>='} {least:g}"] * (least > -math.inf)
    limits += [f"<= {most:g}"] * (most < math.inf)
    allowed = " ".join(["a finite number", " and ".join(limits)]).strip()

    def number(text: str | float) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        inside = least <= value <= most and not (above and value == least)
        if not (inside and math.isfinite(value)):
            raise click.BadParameter(f"{str(text)[:40]!r} is not allowed, give {allowed}")
        return value

    return number


def examples(*commands: str) -> str:
    """The end of a verb's help: commands to copy, each on lines of its own."""
    title = "Example:" if len(commands) == 1 else "Examples:"
    return "\n\n".join([title, *(f"\b\n  {command}" for command in commands)])


def json_option(command: Command) -> Command:
    """`--json`: one JSON object on stdout and nothing else."""
    return click.option("--json", "as_json", is_flag=True, help="One JSON object on stdout.")(
        command
    )


def design_argument(command: Command) -> Command:
    """DESIGN: a design file or a preset's name; the verb gets the text, see `load_design`."""
    return click.argument("design_name", metavar="DESIGN")(command)


def log_argument(command: Command) -> Command:
    """LOG: a core log, or `-`."""
    return click.argument("log", metavar="LOG", type=InputFile())(command)


def output_option(command: Command) -> Command:
    """`-o FILE`, required: a table, whose kind the ending of its name says."""
    return click.option(
        "-o",
        "--output",
        type=OutputFile(),
        required=True,
        metavar="FILE",
        help="Where to write: .parquet, .npz, or CSV.",
    )(command)


def breaks_option(meaning: str) -> Callable[[Command], Command]:
    """`--breaks`: what to do where something is missing; `meaning` is its help."""
    return click.option(
        "--breaks",
        type=click.Choice(["refuse", "split"]),
        default="refuse",
        show_default=True,
        help=meaning,
    )


BREAKS_IN_LOG = (
    "Where the log's time_s or sequence shows missing samples: refuse; or begin anew, major from 0"
    " and no history."
)
"""Help of `--breaks` for the verbs that read a log."""


def load_design(name: str) -> Design:
    """The design of a TOML file, or of a preset if there is no such file.

    Raises:
        InputError: neither, or the file has faults.
    """
    from sculler_model.design import PRESETS, Design
    from sculler_model.errors import InputError

    if Path(name).exists():
        return Design.load(name)
    if name in PRESETS:
        return Design.preset(name)
    raise InputError(
        f"{name}: no such design file, give a path, or a preset: {', '.join(sorted(PRESETS))}"
    )


def load_bare_design(name: str) -> Design:
    """`load_design`, for studies of what is behind the compensation.

    Raises:
        InputError: as `load_design`, or the design has one.
    """
    from sculler_model.errors import InputError

    design = load_design(name)
    if design.compensation is not None:
        raise InputError(
            f"{name}: compensation: this verb studies what is behind it, leave the table out"
        )
    return design


def report(data: Mapping[str, Any], as_json: bool, *renderables: RenderableType) -> None:
    """Tell the result on stdout: as JSON, or as the given rich renderables."""
    if as_json:
        click.echo(json.dumps(data))
        return
    console = stdout_console()
    for renderable in renderables:
        console.print(renderable, soft_wrap=isinstance(renderable, str))


def stdout_console() -> Console:
    """Stdout through rich; what is not a terminal gets 120 columns and no colour."""
    from rich.console import Console

    return Console(file=sys.stdout, highlight=False, width=None if sys.stdout.isatty() else 120)


def facts(rows: Mapping[str, str], title: str | None = None) -> RenderableType:
    """A table of two columns, name and value, as they stand."""
    from rich.table import Table
    from rich.text import Text

    table = Table(
        title=None if title is None else Text(title),
        title_justify="left",
        title_style="bold",
        show_header=False,
        box=None,
    )
    table.add_column(style="cyan", no_wrap=True)
    table.add_column(overflow="fold")
    for name, value in rows.items():
        table.add_row(Text(name), Text(value))
    return table


def verbatim(text: object) -> str:
    """What `report` is to show as it stands: brackets in a file's name are no markup."""
    from rich.markup import escape

    return escape(str(text))


def file_size(path: str | Path) -> int | None:
    """Bytes of a file, for progress; None for `-` or where it cannot be told."""
    try:
        return Path(path).stat().st_size
    except OSError:
        return None


@contextmanager
def progress(description: str, total: int | None) -> Iterator[Advance]:
    """A progress bar on stderr: only on a terminal, and only once the work has lasted a second.

    Args:
        description: what is going on.
        total: the amount of work in the unit of `Advance`; None if unknown.
    """
    if not sys.stderr.isatty():
        yield silent
        return
    bar = _LateBar(description, total)
    try:
        yield bar.advance
    finally:
        bar.stop()


@contextmanager
def staged_progress(total: int) -> Iterator[tuple[Advance, Callable[[str], None]]]:
    """A progress bar like `progress`, and what tells it in words which stage is under way."""
    if not sys.stderr.isatty():
        yield silent, lambda _: None
        return
    bar = _LateBar("starting", total)
    try:
        yield bar.advance, bar.describe
    finally:
        bar.stop()


class _LateBar:
    """A rich progress bar that shows itself after `PROGRESS_AFTER` seconds."""

    def __init__(self, description: str, total: int | None) -> None:
        self._description, self._total = description, total
        self._start, self._done = time.monotonic(), 0
        self._bar: Progress | None = None
        self._task: TaskID | None = None

    def advance(self, amount: int) -> None:
        self._done += amount
        if self._bar is None and time.monotonic() - self._start > PROGRESS_AFTER:
            from rich.console import Console
            from rich.progress import Progress

            self._bar = Progress(console=Console(stderr=True), transient=True)
            self._task = self._bar.add_task(self._description, total=self._total)
            self._bar.start()
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, completed=self._done)

    def describe(self, stage: str) -> None:
        self._description = stage
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, description=stage)

    def stop(self) -> None:
        if self._bar is not None:
            self._bar.stop()

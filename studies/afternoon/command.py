"""The command line of `python -m studies.afternoon`."""

from __future__ import annotations

import os
import re
import sys
import sysconfig
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter

import click

from sculler import terminal
from sculler_model.errors import ToolError
from sculler_model.outputs import replacing
from sculler_sim import processes
from studies import documents

PAGE = Path("docs/tutorials/stranger.md")

_BLOCK = re.compile(r"^```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)^```$", re.M | re.S)
_TIMES = re.compile(r"(<!-- times: begin -->\n).*?(<!-- times: end -->)", re.S)


@click.command(
    epilog=terminal.examples("python -m studies.afternoon", "python -m studies.afternoon --write")
)
@click.option("--write", is_flag=True, help=f"Write the table into {PAGE}.")
def command(write: bool) -> None:
    """Run the commands of the tutorial in an empty folder, and show how long each takes.

    Needs the extras sim, package and place, a C++ compiler and make.  It takes some minutes.
    """
    text = PAGE.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder, terminal.progress("running", None):
        found = list(timed(text, Path(folder)))
    rows = table(found)
    terminal.report({}, False, "\n".join(rows))
    if write:
        made = _TIMES.sub(lambda old: old[1] + "\n".join([*rows, ""]) + old[2], text)
        with replacing(PAGE) as temporary:
            temporary.write_text(made, encoding="utf-8")


def timed(page: str, folder: Path) -> Iterator[tuple[str, float]]:
    """Each command of a page and the seconds that it took; its titled blocks are files.

    Args:
        page: text in Markdown.
        folder: where the commands are run.

    Raises:
        ToolError: a command failed.
    """
    # the commands of this Python's environment, and what it imports
    path = os.pathsep.join([sysconfig.get_path("scripts"), os.environ.get("PATH", "")])
    modules = os.pathsep.join(filter(None, sys.path))
    surroundings = {**os.environ, "PATH": path, "PYTHONPATH": modules}
    for language, title, text in _BLOCK.findall(page):
        if title:
            (folder / title).write_text(text, encoding="utf-8")
        for line in text.splitlines() if language == "sh" else ():
            began = perf_counter()
            (ended,) = processes.run(["bash", "-c", line], folder=folder, environment=surroundings)
            if ended.status:
                last = ended.said.strip().splitlines()[-1:]
                raise ToolError(f"{line}: {ended.how}: {' '.join(last)}")
            yield line, perf_counter() - began


def table(found: list[tuple[str, float]]) -> list[str]:
    """The rows, in Markdown."""
    shown = [(_short(line), f"{seconds:.0f}") for line, seconds in found if line[:2] != "ls"]
    total = sum(seconds for _, seconds in found)
    rows = [*shown, ("all", f"{total / 60:.1f} minutes")]
    return list(documents.table("lr", ("command", "seconds"), rows))


def _short(line: str) -> str:
    """A command without what makes it long."""
    words = line.split()
    return f"`{' '.join(words[:3] if words[0] == 'sculler' else words)}`"

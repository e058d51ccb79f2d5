"""Pages of docs/ as programs: what stands in fenced blocks, and how a page is run.

A page is one session in an empty folder.  Its blocks run in their order:

- ```toml title="NAME"``` (any language) is written to the file NAME;
- ```python``` is executed, in one namespace a page;
- ```sh``` is run by bash, which stops at the first command that fails;
- ```console``` has commands behind `$ ` and below each what it prints, in which `...` stands for
  anything; a command that prints nothing to check is followed by nothing; `[N]` at its end is the
  exit status.

A block that must not run has the line `<!-- not run: REASON -->` before it.  Other languages are
there to be read.
"""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path
from textwrap import dedent

RUN = ("python", "sh", "console")

_BLOCK = re.compile(
    r"(?:^ *<!-- not run: (?P<reason>.+?) -->\n)?"
    r"^(?P<indent> *)```(?P<language>\w+)?(?: title=\"(?P<title>[^\"]+)\")?[^\n]*\n"
    r"(?P<text>.*?)^(?P=indent)```$",
    re.MULTILINE | re.DOTALL,
)


@dataclass(frozen=True)
class Block:
    """A fenced block of a page.

    Attributes:
        language: the word behind the fence.
        text: what stands in it.
        line: of its fence, from 1.
        title: the file that it is, if it is one.
        reason: why it is not run, if it says so.
    """

    language: str
    text: str
    line: int
    title: str | None
    reason: str | None


def blocks(page: Path) -> list[Block]:
    """The fenced blocks of a page, in their order."""
    source = page.read_text(encoding="utf-8")
    return [
        Block(
            found["language"] or "",
            dedent(found["text"]),
            source.count("\n", 0, found.start("indent")) + 1,
            found["title"],
            found["reason"],
        )
        for found in _BLOCK.finditer(source)
    ]


def run_page(page: Path, folder: Path) -> None:
    """Run a page's blocks in a folder, which must be the working directory."""
    names: dict[str, object] = {"__name__": page.stem}
    for block in blocks(page):
        where = f"{page.name}:{block.line}"
        if block.title is not None:
            (folder / block.title).write_text(block.text, encoding="utf-8")
        if block.reason is not None or block.title is not None:
            continue
        if block.language == "python":
            exec(compile("\n" * block.line + block.text, str(page), "exec"), names)
        elif block.language == "sh":
            shell(block.text, where, 0)
        elif block.language == "console":
            for command, expected, status in commands(block.text):
                printed = shell(command, where, status)
                assert like(printed, expected), (
                    f"{where}: {command}\nthe page has\n{expected}\nit prints\n{printed}"
                )


def commands(text: str) -> list[tuple[str, str, int]]:
    """Of a console block, each command, what is below it, and its exit status."""
    found = []
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        command, _, expected = part.partition("\n")
        while command.endswith("\\"):
            more, _, expected = expected.partition("\n")
            command = command[:-1] + " " + more.strip()
        status = re.search(r"\n?^\[(\d+)\]\n?\Z", expected, re.MULTILINE)
        if status:
            expected = expected[: status.start()]
        found.append((command, expected, int(status[1]) if status else 0))
    return found


def like(printed: str, expected: str) -> bool:
    """Whether a command printed what a page has; blanks count once, `...` is anything."""
    wanted = [" ".join(part.split()) for part in expected.split("...")]
    if wanted == [""]:
        return True
    pattern = ".*".join(re.escape(part) for part in wanted)
    return re.fullmatch(pattern, " ".join(printed.split()), re.DOTALL) is not None


def shell(text: str, where: str, status: int) -> str:
    """Run lines by bash; what they print to stdout and stderr."""
    done = subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", text],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        timeout=300,
        check=False,
    )
    assert done.returncode == status, (
        f"{where}: exit status {done.returncode}\n{text}\n{done.stdout}"
    )
    return done.stdout

"""The command line of `python -m studies.host_c`."""

from __future__ import annotations

from pathlib import Path

import click

from sculler import terminal
from sculler_model.errors import InputError
from studies import documents
from studies.host_c.measure import STAGES, measured
from studies.host_c.page import document, instructions, memory
from studies.host_c.precision import MOTIONS, left
from studies.host_c.targets import TARGETS

PAGE = "host-in-c-targets.md"


@click.command(
    epilog=terminal.examples(
        f"python -m studies.host_c -o {documents.PAGES}", "python -m studies.host_c --only m7"
    )
)
@documents.folder_option(PAGE)
@click.option(
    "--only",
    "keys",
    multiple=True,
    metavar="KEY",
    help="A processor, shown and not written; several times for several: "
    + ", ".join(target.key for target in TARGETS)
    + ".",
)
def command(folder: Path, keys: tuple[str, ...]) -> None:
    """Compile the host in C for small processors, count instructions, write host-in-c-targets.md.

    Needs cross compilers and QEMU; on Debian: apt-get install gcc-arm-none-eabi
    libnewlib-arm-none-eabi gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf qemu-user.  A
    processor whose tools are missing is left out.
    """
    known = [target.key for target in TARGETS]
    for key in keys:
        if key not in known:
            raise InputError(f"--only {key}: not known, give one of {', '.join(known)}")
    chosen = [target for target in TARGETS if not keys or target.key in keys]
    there = [target for target in chosen if target.missing is None]
    if not there:
        tools = ", ".join(sorted({str(target.missing) for target in chosen}))
        raise InputError(f"no processor can be measured: {tools} not installed")
    with terminal.progress("measuring", len(there) * (1 + len(STAGES))) as advance:
        found = measured(there, advance)
    if keys:
        terminal.report({}, False, "\n".join([*instructions(found), "", *memory(found)]))
        return
    with terminal.progress("flying", len(MOTIONS)) as advance:
        precisions = left(advance=advance)
    documents.write_page(folder / PAGE, document(found, precisions))

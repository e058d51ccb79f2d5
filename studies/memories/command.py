"""The command line of `python -m studies.memories`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import fill

import click

from sculler import terminal
from sculler_hdl import BLOCK_ATTRIBUTES
from sculler_model.errors import InputError
from sculler_sim.place.tools import YOSYS
from studies import documents
from studies.memories.measure import FAMILIES, SMALL, Memory, memories, places, unit, unit_text

PAGE = "memories.md"

_ABOUT = (
    "The microprogram, the results' two banks and the queue of a unit (preset `stim300`, compact"
    " core of the target `generic`, AXI4-Lite), each synthesised alone by {tool}, words × bits. A"
    " cell is what Yosys says the memory goes to: **block** memory in bold, else memory of look-up"
    " tables; `logic`: it has found no place. `synth_sf2` knows no block memory. Left out are"
    " `synth_intel`, which stops with an error in its own brams_map_m9k.v, and the flows that are"
    " not in the table. Of NanoXplore's flow `memory_libmap` is the last command: the next takes"
    " many minutes."
)


_OTHERS = (
    "Memories of 4096 bits and more have attributes that ask for block memory, the three above"
    " among them; of what is smaller the tool chooses. Yosys heeds the first of each, so the table"
    " shows that each family's blocks can hold these memories. The other tools were not at hand:"
    " what stands here is from their manuals. In Intel devices whose blocks are not M10K, Quartus"
    " leaves the attribute out of account and chooses by size; so may Libero, which calls its"
    ' block memory `syn_ramstyle = "lsram"`.'
)

_TOOLS = {
    "`ram_style`, `rom_style`": "Vivado (UG901), Yosys",
    "`ramstyle`, `romstyle`": "Quartus",
    "`syn_ramstyle`": "Synplify Pro, Lattice's own, Gowin (SUG550)",
    "`syn_romstyle`": "Lattice's own",
}
"""Who heeds which attribute."""


@click.command(
    epilog=terminal.examples(
        f"python -m studies.memories -o {documents.PAGES}",
        "python -m studies.memories --only Gowin",
    )
)
@documents.folder_option(PAGE)
@click.option(
    "--only",
    "names",
    multiple=True,
    metavar="FAMILY",
    help="A family, shown and not written; several times for several.",
)
def command(folder: Path, names: tuple[str, ...]) -> None:
    """See which memories Yosys puts in block memory, for each family; write memories.md."""
    for name in names:
        if name not in FAMILIES:
            raise InputError(f"--only {name}: no such family, give one of {', '.join(FAMILIES)}")
    chosen = names or tuple(FAMILIES)
    text = unit_text(unit())
    found: dict[str, list[str]] = {}
    with terminal.progress("synthesising", len(chosen)) as advance:
        for name in chosen:
            found[name] = places(text, name)
            advance(1)
    rows = table(memories(text), found)
    if names:
        terminal.report({}, False, "\n".join(rows))
        return
    documents.write_page(folder / PAGE, document(rows))


def table(held: Sequence[Memory], found: Mapping[str, Sequence[str]]) -> list[str]:
    """The rows, in Markdown."""
    names = {"engine_program": "microprogram", "results": "results", "bus_store": "queue"}
    heads = [f"{names[m.module.removeprefix('unit_')]} {m.words} × {m.bits}" for m in held]
    rows = [f"| {name} | {' | '.join(map(_told, row))} |" for name, row in found.items()]
    return [f"| family | {' | '.join(heads)} |", "|---" * (1 + len(heads)) + "|", *rows]


def _told(cell: str) -> str:
    if not cell:
        return "logic"
    return f"`{cell}`" if any(word in cell for word in SMALL) else f"**`{cell}`**"


def document(rows: Sequence[str]) -> str:
    """The page."""
    about = _ABOUT.format(tool=f"Yosys {YOSYS.version()}")
    return "\n".join(
        [
            "# Memories in every family",
            "",
            "<!-- written by `python -m studies.memories` -->",
            "",
            fill(about, documents.WIDTH),
            "",
            *rows,
            "",
            "## Attributes",
            "",
            fill(_OTHERS, documents.WIDTH),
            "",
            "| memory | attributes |",
            "|---|---|",
            *(f"| {kind.upper()} | `{text}` |" for kind, text in BLOCK_ATTRIBUTES.items()),
            "",
            "| attribute | heeded by |",
            "|---|---|",
            *(f"| {attribute} | {tools} |" for attribute, tools in _TOOLS.items()),
            "",
        ]
    )

"""Changes of a core's Verilog, all in one text that makes the one it is asked for."""

from __future__ import annotations

import random
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from sculler_sim.prove.problem import run_yosys

SEED = 1

_READ = """\
read_verilog -defer core.v
{cells}hierarchy -top {name}
proc
memory_collect
opt_clean
setattr -unset src
"""

_WRITE = """\
opt_expr -mux_undef
write_verilog -noattr -norename changed.v
"""
"""While a memory is not written, address and data are x: they become what they are when it is."""

_ASKED = 'if (!$value$plusargs("mutant=%d", {0})) {0} = 0;'
_OFF = "module turning (output on);\n  assign on = 0;\nendmodule\n"
_MODULE = re.compile(r"^module \w+_engine_program *\(", re.M)
_WORD = re.compile(r"words_2\[(\d+)\] = (\d+)'h([0-9a-f]+);")


@dataclass(frozen=True)
class Mutants:
    """A core that changes itself.

    Attributes:
        verilog: the core; with `+mutant=N` a simulator runs its change N, without it none.
        changes: change N is the element N - 1: Yosys's command, or a bit of the microprogram.
    """

    verilog: str
    changes: list[str]


def mutants(name: str, texts: Mapping[str, str], folder: Path, count: int) -> Mutants:
    """So many changes of the gates, and twice as many of the microprogram, if there is one.

    The same core and count give the same.  A register's output is not changed, for it would lose
    its value at power-up; its input is, and what reads it.

    Args:
        name: of the core.
        texts: core and models of blocks, by name of file; the core is NAME.v.
        folder: to work in, a folder that is there.
        count: of the gates.

    Raises:
        InputError: Yosys is not installed.
        ToolError: Yosys failed.
    """
    read = _written(name, texts, folder)
    run_yosys(folder, f"{read}mutate -list {3 * count} -seed {SEED} -o list.txt\n")
    found = (folder / "list.txt").read_text(encoding="ascii").splitlines()
    changes = [each for each in found if " -port Q " not in each][:count]
    text = _asks(changed(name, texts, folder, changes), name)
    bits = _drawn(texts[f"{name}.v"], 2 * count)
    turned = [f"words_2[{word}][{bit}] = !words_2[{word}][{bit}];" for word, bit in bits]
    cases = [f"{number}: {line}" for number, line in enumerate(turned, len(changes) + 1)]
    lines = [_ASKED.format("flip"), "case (flip)", *cases, "endcase"]
    changes += [f"microprogram word {word} bit {bit}" for word, bit in bits]
    return Mutants(_in_program(text, lines, "flip") if bits else text, changes)


def with_unknown(core: str, changes: Sequence[str]) -> str:
    """A core in whose microprogram all bits that these changes turn over are unknown, x.

    Args:
        core: its text.
        changes: of the microprogram.
    """
    places = map(place, changes)
    return _in_program(core, [f"words_2[{word}][{bit}] = 1'bx;" for word, bit in places])


def changed(name: str, texts: Mapping[str, str], folder: Path, changes: Sequence[str]) -> str:
    """The text of a core with one of several changes: its input `mutant` says which, from 1 on.

    Args:
        name: of the core.
        texts: core and models of blocks, by name of file; the core is NAME.v.
        folder: to work in, a folder that is there.
        changes: of `Mutants.changes`; of the microprogram, what is read of a word is turned over.

    Raises:
        InputError: Yosys is not installed.
        ToolError: Yosys failed.
    """
    file = f"{name}.v"
    texts = {**texts, file: _turning(texts[file], changes)}
    commands = "\n".join([_written(name, texts, folder), *_asked(name, changes)])
    run_yosys(folder, f"{commands}\n{_WRITE}")
    return (folder / "changed.v").read_text(encoding="utf-8")


def _asked(name: str, changes: Sequence[str]) -> list[str]:
    """The commands that make changes, each where the core's input `mutant` is its number."""
    return [
        (
            f"mutate -mode const1 -module {name}_engine_program -cell turning{number}"
            " -port on -portbit 0"
            if of_program(change)
            else change
        ).replace("mutate ", f"mutate -ctrl mutant 16 {number} ", 1)
        for number, change in enumerate(changes, start=1)
    ]


def _turning(core: str, changes: Sequence[str]) -> str:
    """The text with a cell for each change of the microprogram, whose output `on` makes it."""
    cells, turned = [], ""
    start, end = _program(core)
    for number, change in enumerate(changes, start=1):
        if of_program(change):
            word, bit = place(change)
            cells.append(f"  wire on{number};\n  turning turning{number} (.on(on{number}));\n")
            turned += f" ^ ((on{number} && address == {word}) << {bit})"
    if not cells:
        return core
    declared = core.index("  initial ", start)
    program = core[start:declared] + "".join(cells) + core[declared:end]
    program = program.replace("<= words_2[address]", f"<= words_2[address]{turned}")
    return f"{core[:start]}{program}{core[end:]}\n{_OFF}"


def _written(name: str, texts: Mapping[str, str], folder: Path) -> str:
    """Write the core for Yosys; returns the commands that read it, in which names are the same."""
    cells = [file for file in texts if file != f"{name}.v"]
    (folder / "core.v").write_text(texts[f"{name}.v"], encoding="utf-8")
    for cell in cells:  # `$finish` Yosys wants in `initial` only
        (folder / cell).write_text(texts[cell].replace("$finish;", ""), encoding="utf-8")
    return _READ.format(name=name, cells="".join(f"read_verilog -lib {cell}\n" for cell in cells))


def of_program(change: str) -> bool:
    """Whether a change is one of the microprogram."""
    return change.startswith("microprogram")


def place(change: str) -> tuple[int, int]:
    """Word and bit of a change of the microprogram."""
    word, bit = map(int, re.findall(r"\d+", change))
    return word, bit


def _asks(text: str, name: str) -> str:
    """The text with a register in place of the core's input `mutant`."""
    start = text.index(f"module {name}(")
    end = text.index(");", start)
    head = text[start:end].replace(", mutant", "")
    declared = "  input [15:0] mutant;\n  wire [15:0] mutant;\n"
    register = f"  reg [15:0] mutant;\n  initial {_ASKED.format('mutant')}\n"
    return text[:start] + head + text[end:].replace(declared, register, 1)


def _program(core: str) -> tuple[int, int]:
    """Where the microprogram's module begins and ends in a core's text."""
    module = _MODULE.search(core)
    return (module.start(), core.index("endmodule", module.start())) if module else (0, 0)


def _drawn(core: str, count: int) -> list[tuple[int, int]]:
    """Words and bits of the microprogram, drawn at random."""
    words = _WORD.findall(core, *_program(core))
    bits = [(int(word), bit) for word, width, _ in words for bit in range(int(width))]
    return random.Random(SEED).sample(bits, min(count, len(bits)))


def _in_program(text: str, lines: Sequence[str], register: str = "") -> str:
    """The text with lines after those that fill the microprogram, and a register for them."""
    last = list(_WORD.finditer(text, *_program(text)))[-1].end()
    start = text.rfind("  initial begin", 0, last)
    declared = f"  reg [15:0] {register};\n" if register else ""
    more = "".join(f"\n    {line}" for line in lines)
    return text[:start] + declared + text[start:last] + more + text[last:]

"""Changes of a core's Verilog, one at a time."""

from __future__ import annotations

import random
import re
from dataclasses import dataclass
from pathlib import Path

from sculler_hdl import generate
from sculler_model.design import Design
from sculler_sim.place.tools import YOSYS, ToolError

SEED = 1

_READ = """\
read_verilog -defer core.v {cells}
hierarchy -top {top}
proc
opt_clean
setattr -unset src
"""


@dataclass(frozen=True)
class Mutant:
    """A changed core.

    Attributes:
        change: what was changed, as Yosys says it, or the word and bit of the microprogram.
        verilog: the changed text.
    """

    change: str
    verilog: str


def mutants(design: Design, folder: Path, count: int) -> list[Mutant]:
    """So many changes of the gates, and a third as many of the microprogram, if there is one.

    The same design and count give the same.  The first has no change: it must pass.

    Args:
        design: the design.
        folder: to work in, a folder that is there.
        count: of the gates.

    Raises:
        InputError: Yosys is not installed.
        ToolError: Yosys failed.
    """
    generated = generate(design)
    core = generated.verilog
    (folder / "core.v").write_text(core, encoding="utf-8")
    for cell, text in generated.cells.items():
        (folder / f"{cell}.v").write_text(text.replace("$finish;", ""), encoding="utf-8")
    read = _READ.format(
        top=design.name, cells=" ".join(f"-lib {cell}.v" for cell in generated.cells)
    ).replace("core.v -lib", "core.v\nread_verilog -lib")
    _yosys(folder, f"{read}mutate -list {count} -seed {SEED} -none -o list.txt\n")
    lines = (folder / "list.txt").read_text(encoding="ascii").splitlines()
    script = [read + "design -save whole"]
    for number, line in enumerate(lines):
        script += [
            "design -load whole",
            line,
            f"write_verilog -noattr -norename mutant{number}.v",
        ]
    _yosys(folder, "\n".join(script) + "\n")
    found = [
        Mutant(line, (folder / f"mutant{number}.v").read_text(encoding="utf-8"))
        for number, line in enumerate(lines)
    ]
    return found + _programs(core, count // 3)


def _programs(core: str, count: int) -> list[Mutant]:
    """One bit of the microprogram turned over, in each."""
    start = core.find("_engine_program (")
    if start < 0:
        return []
    end = core.index("endmodule", start)
    words = list(re.finditer(r"words_2\[(\d+)\] = (\d+)'h([0-9a-f]+);", core[start:end]))
    rng = random.Random(SEED)
    found = []
    for _ in range(count if words else 0):
        word = rng.choice(words)
        bit = rng.randrange(int(word[2]))
        changed = f"words_2[{word[1]}] = {word[2]}'h{int(word[3], 16) ^ (1 << bit):x};"
        text = core[: start + word.start()] + changed + core[start + word.end() :]
        found.append(Mutant(f"microprogram word {word[1]} bit {bit}", text))
    return found


def _yosys(folder: Path, script: str) -> None:
    (folder / "mutate.ys").write_text(script, encoding="utf-8")
    status, said = YOSYS.run(folder, "-q", "mutate.ys")
    if status:
        raise ToolError(YOSYS, said)

"""A property proved for ever, refuted, or held for so many clocks, by ABC's `pdr`."""

from __future__ import annotations

import time
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from sculler_sim.place.tools import YOSYS, ToolError


class Verdict(Enum):
    """What came out."""

    PROVED = "proved"
    REFUTED = "refuted"
    OPEN = "open"


@dataclass(frozen=True)
class Outcome:
    """What is known of a property.

    Attributes:
        verdict: what came out.
        clocks: of a refuted one, clocks to where it fails; of one left open, clocks from power-up
            for which it holds.
        seconds: it took.
    """

    verdict: Verdict
    clocks: int
    seconds: float


# Yosys runs ABC on logic that it extracts; here it is a gate, and ABC reads a file of its own
_SCRIPT = """
read_rtlil <<GATE
module \\gate
  wire input 1 \\a
  wire output 2 \\b
  cell $_NOT_ \\not
    connect \\A \\a
    connect \\Y \\b
  end
end
GATE
abc -script "+read_aiger {name}.aig; fold; scorr; {command}; write_status {name}.status"
"""

_VERDICTS = {
    "snl_UNSAT": Verdict.PROVED,
    "snl_SAT": Verdict.REFUTED,
    "snl_UNK": Verdict.OPEN,
}


def prove(folder: Path, name: str, seconds: int) -> Outcome:
    """Prove that the output of NAME.aig is never high; else find for how many clocks it is not.

    Args:
        folder: where it lies.
        name: of the file.
        seconds: after which to give up, once for ever and once for so many clocks.

    Raises:
        InputError: Yosys is not installed.
        ToolError: it failed.
    """
    begun = time.monotonic()
    verdict, clocks = _run(folder, name, f"pdr -T {seconds}")
    if verdict is Verdict.OPEN:
        verdict, longer = _run(folder, name, f"bmc3 -T {seconds}")
        clocks = longer if verdict is Verdict.REFUTED else max(clocks, longer)
    return Outcome(verdict, clocks, time.monotonic() - begun)


def _run(folder: Path, name: str, command: str) -> tuple[Verdict, int]:
    script = folder / f"{name}.ys"
    script.write_text(_SCRIPT.format(name=name, command=command), encoding="utf-8")
    status = folder / f"{name}.status"
    status.unlink(missing_ok=True)
    _, said = YOSYS.run(folder, "-q", script.name)  # ABC ends the whole process in its own way
    if not status.is_file():
        raise ToolError(YOSYS, said or "ABC said nothing")
    word, clocks, *_ = status.read_text(encoding="ascii").split()
    return _VERDICTS[word], int(clocks)

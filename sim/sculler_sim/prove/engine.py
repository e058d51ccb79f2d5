"""A property proved for ever, refuted, or held for so many clocks, by ABC."""

from __future__ import annotations

import time
from contextlib import suppress
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


_CONFLICTS = 300_000
"""After which a solver gives up an output that it neither proves nor refutes; a minute or so."""

_FEW_LATCHES = 110
"""So few that all states that can be reached may be gathered (`reach`)."""

_MERGING = 300
"""Seconds after which it is given up to look for what is always equal (`scorr`)."""

_REACH = "-B 1000000 -F 100000"
"""Nodes of a decision diagram, and clocks, after which that is given up."""

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
abc -script "+{commands}"
"""

_VERDICTS = {
    "snl_UNSAT": Verdict.PROVED,
    "snl_SAT": Verdict.REFUTED,
    "snl_UNK": Verdict.OPEN,
}


def prove(folder: Path, name: str, seconds: int, *, bounded: bool = True) -> Outcome:
    """Prove that the output of NAME.aig is never high; else find for how many clocks it is not.

    Args:
        folder: where it lies.
        name: of the file.
        seconds: after which to give up, once for ever and once for so many clocks.
        bounded: whether to try the latter.

    Raises:
        InputError: Yosys is not installed.
        ToolError: it failed.
    """
    begun = time.monotonic()
    small = _merged(folder, name)
    if _outputs(folder / f"{small}.aig") == [0]:  # `pdr` says nothing of a constant
        return Outcome(Verdict.PROVED, 0, time.monotonic() - begun)
    verdict, clocks = Verdict.OPEN, 0
    if _latches(folder / f"{small}.aig") <= _FEW_LATCHES:
        with suppress(ToolError):  # it may run out of memory
            verdict, clocks = _run(folder, small, f"reach -T {min(seconds, 10)} {_REACH}")
    if verdict is Verdict.OPEN:
        verdict, clocks = _run(folder, small, f"pdr -T {seconds}")
    if bounded and verdict is Verdict.OPEN:
        verdict, longer = _run(folder, small, f"bmc3 -T {seconds}")
        clocks = longer if verdict is Verdict.REFUTED else max(clocks, longer)
    return Outcome(verdict, clocks, time.monotonic() - begun)


def prove_inductive(folder: Path, name: str) -> bool:
    """Whether the output of NAME.aig is low at first, and low in a clock after any where it is.

    States that cannot be reached count, too: what is so proved needs no search.

    Args:
        folder: where it lies.
        name: of the file.

    Raises:
        InputError: Yosys is not installed.
        ToolError: it failed.
    """
    verdict, clocks = _run(folder, name, "fold; bmc3 -F 1")
    if verdict is Verdict.REFUTED or clocks < 0:
        return False
    return _run(folder, name, f"fold; ind -F 2 -C {_CONFLICTS}")[0] is Verdict.PROVED


def prove_unrolled(folder: Path, name: str, clocks: int) -> Verdict:
    """Prove that no output of NAME.aig is high in so many clocks from power-up.

    All clocks become one circuit without registers, in which nodes that are always the same are
    found from the inputs on and made one: that is what sums of products need.

    Args:
        folder: where it lies.
        name: of the file.
        clocks: how many.

    Raises:
        InputError: Yosys is not installed.
        ToolError: it failed.
    """
    unrolled = f"{name}_unrolled"
    _abc(folder, name, f"read_aiger {name}.aig; frames -i -F {clocks}; write_aiger {unrolled}.aig")
    left = []
    for i, literal in enumerate(_outputs(folder / f"{unrolled}.aig")):
        if literal == 1:
            return Verdict.REFUTED
        if literal:
            left.append(i)
    each = (
        f"read_aiger {unrolled}.aig; cone -O {i}; iprove -L {_CONFLICTS};"
        f" write_status {name}_{i}.status"
        for i in left
    )
    _abc(folder, name, "; ".join(each))
    found = {_status(folder, f"{name}_{i}")[0] for i in left}
    order = (Verdict.REFUTED, Verdict.OPEN)
    return next((verdict for verdict in order if verdict in found), Verdict.PROVED)


def _merged(folder: Path, name: str) -> str:
    """The name of a circuit in which what is always equal is one; as it was, if that takes long.

    Raises:
        ToolError: ABC wrote none.
    """
    small = f"{name}_small"
    for steps, seconds in (("fold; scorr", _MERGING), ("fold", None)):
        _abc(folder, name, f"read_aiger {name}.aig; {steps}; write_aiger {small}.aig", seconds)
        if (folder / f"{small}.aig").is_file():
            return small
    raise ToolError(YOSYS, "ABC wrote no circuit")


def _outputs(path: Path) -> list[int]:
    """What the outputs of a circuit are: 0 and 1 are constants, else a node."""
    with path.open("rb") as file:
        _, _, _, latches, outputs, *_ = file.readline().split()  # aig M I L O A
        for _ in range(int(latches)):
            file.readline()
        return [int(file.readline()) for _ in range(int(outputs))]


def _latches(path: Path) -> int:
    with path.open("rb") as file:
        return int(file.readline().split()[3])  # aig M I L O A


def _run(folder: Path, name: str, command: str) -> tuple[Verdict, int]:
    (folder / f"{name}.status").unlink(missing_ok=True)
    _abc(folder, name, f"read_aiger {name}.aig; {command}; write_status {name}.status")
    return _status(folder, name)


def _abc(folder: Path, name: str, commands: str, seconds: float | None = None) -> None:
    """Run commands of ABC, which have to write files: what it says is lost."""
    script = folder / f"{name}.ys"
    script.write_text(_SCRIPT.format(commands=commands), encoding="utf-8")
    YOSYS.run(
        folder, "-q", script.name, seconds=seconds
    )  # ABC ends the whole process in its own way


def _status(folder: Path, name: str) -> tuple[Verdict, int]:
    """What ABC wrote: the verdict, and clocks."""
    status = folder / f"{name}.status"
    if not status.is_file():
        raise ToolError(YOSYS, "ABC said nothing")
    word, clocks, *_ = status.read_text(encoding="ascii").split()
    return _VERDICTS[word], int(clocks)

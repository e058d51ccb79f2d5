"""The number of results from every value that its counter can have, in the pipelined core.

The counter's limbs begin with anything, and the checker's number with the same; so the carry of
every limb is looked at, which from power-up would come after 65,536 results.

Where the number that the port shows is the counter itself (results are handed over whole and none
is dropped), this is proved by induction, in two steps:

* results are taken clocks apart, and by the time that the next one is shown no carry is under way
  (`APART`): that goes by control alone, and the model checker finds it;
* given that, the limbs show the checker's number as it was 1, 2, 3 and 4 clocks ago, and what is on
  its way from limb to limb is what it has to be: if so in one clock, then in the next.
"""

from __future__ import annotations

import re
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from sculler_hdl import module_ports, properties
from sculler_model.design import Design
from sculler_sim.prove.engine import Outcome, Verdict, prove, prove_inductive
from sculler_sim.prove.problem import FLAT, TO_GATES, TOP, run_yosys, top_module, write_core

LABEL = "every_number"

APART = "taken_apart"
"""Label of what the induction goes by."""

RELATED = "limbs_follow"
"""Label of what is proved by induction: more than is claimed."""

_LIMB = 16

_WRITE = """
design -reset
read_rtlil flat.il
delete t:$assert c:{label} %d
opt_clean
aigmap
write_aiger -zinit {label}.aig
"""


def settle_counter(design: Design, folder: Path, seconds: int) -> Outcome | None:
    """What comes of the claim; None of a compact core, whose program counts its results.

    Args:
        design: the design.
        folder: to work in, a folder that is there.
        seconds: for the model checker.

    Raises:
        InputError: Yosys is not installed.
        ToolError: Yosys failed.
    """
    sources = write_core(design, folder)
    core = (folder / "core.v").read_text(encoding="utf-8")
    limbs = len(set(re.findall(r"reg \[15:0\] major_(\d+);", core)))
    if not limbs:
        return None
    shown = design.hardware.handover == "parallel" and not design.drops_results
    checker = _shown(limbs) if shown else _collected(design, limbs)
    labels = [LABEL, APART, RELATED] if shown else [LABEL]
    _write(design, folder, sources, checker, labels)
    begun = time.monotonic()
    if (
        shown
        and prove(folder, APART, seconds, bounded=False).verdict is Verdict.PROVED
        and prove_inductive(folder, RELATED)
    ):
        return Outcome(Verdict.PROVED, 0, time.monotonic() - begun)
    return prove(folder, LABEL, seconds)


@dataclass(frozen=True)
class _Checker:
    """What stands beside core and properties.

    Attributes:
        inside: wires of its own by what they are connected to, of core and properties.
        free: of these, registers that begin with anything.
        lines: its Verilog.
    """

    inside: Mapping[str, str]
    free: tuple[str, ...]
    lines: tuple[str, ...]


def _write(
    design: Design, folder: Path, sources: str, checker: _Checker, labels: list[str]
) -> None:
    """Write LABEL.aig of each label."""
    free = [checker.inside.get(name, name) for name in checker.free]
    script = [
        "cutpoint t:$mul",
        f"cd {TOP}",
        *(f"connect -nounset -set {wire} {name}" for wire, name in checker.inside.items()),
        "cd ..",
        "setattr -unset init " + " ".join(f"w:{name}" for name in free),
    ]
    top = top_module(design.name, module_ports(design), checker.lines)
    (folder / "properties.sv").write_text(properties(design), encoding="utf-8")
    (folder / "top.v").write_text(top, encoding="utf-8")
    flat = FLAT.format(sources=sources, top=TOP, cut="\n".join(script), to_gates=TO_GATES)
    run_yosys(folder, flat + "".join(_WRITE.format(label=label) for label in labels))


def _limbs(limbs: int) -> dict[str, str]:
    """The counter's limbs, and which of them are full."""
    inside = {f"limb{i}": f"core.handover.major_{i * _LIMB}" for i in range(limbs)}
    return inside | {f"full{i}": f"core.handover.major_full{i}" for i in range(limbs - 1)}


def _collected(design: Design, limbs: int) -> _Checker:
    """Of a counter whose value goes along with its result."""
    counter = _limbs(limbs)
    bits = _LIMB * limbs
    number = "checks.number" if design.drops_results else "checks.first_number"
    alike = ["counter == number", *(f"full{i} == &limb{i}" for i in range(limbs - 1))]
    lines = (
        *_declared(limbs, bits),
        f"  wire [{bits - 1}:0] counter;",
        "  assign counter = {" + ", ".join(f"limb{i}" for i in reversed(range(limbs))) + "};",
        f"  wire holds, alike = {' && '.join(alike)};",
        "  reg begun = 0, astray = 0;",
        "  always @(posedge clk) begin",
        "    begun <= 1;",
        "    astray <= astray || (!begun && !alike);",
        f"    {LABEL}: assert (holds || astray || (!begun && !alike));",
        "  end",
    )
    inside = {**counter, "number": number, "holds": "checks.holds_major_as_due"}
    return _Checker(inside, (*counter, "number", "checks.first_number"), lines)


def _shown(limbs: int) -> _Checker:
    """Of a counter that the port shows.

    `back3` is the number as it was three clocks ago, `taken3` whether a result was taken then.
    """
    counter, bits, last = _limbs(limbs), _LIMB * limbs, limbs + 1
    carries = {f"carry{i}": f"core.handover.major_carry{i}" for i in range(limbs - 1)}
    inside = {
        **counter,
        **carries,
        "number": "checks.first_number",
        "step": "core.handover.was_taken",
        "part": "checks.part",
        "taken": "checks.whole",
        "want_valid": "checks.want_valid",
        "holds": "checks.holds_major_as_due",
    }
    before = ["number", *(f"back{k}" for k in range(1, last + 1))]
    related = ["step == taken1"]
    related += [f"{before[k]} == back{k + 1} + taken{k + 1}" for k in range(last)]
    for i in range(limbs):
        here = f"[{_LIMB * i + _LIMB - 1}:{_LIMB * i}]"
        related.append(f"limb{i} == back{i + 1}{here}")
        if i + 1 < limbs:
            related.append(f"full{i} == &back{i + 2}{here}")
            below = f"back{i + 3}[{_LIMB * i + _LIMB - 1}:0]"
            related.append(f"carry{i} == (taken{i + 2} && &{below})")
    recent = " || ".join(f"taken{k}" for k in range(1, last + 1))
    apart = [f"!(taken{k} && taken{k + 1})" for k in range(1, last)]
    apart += ["!part", f"!(want_valid && ({recent}))"]
    steps = [
        f"    back{k + 1} <= rst ? 0 : {before[k]}; taken{k + 1} <= !rst && taken{k or ''};"
        for k in range(last)
    ]
    lines = (
        *_declared(limbs, bits),
        *(f"  wire {name};" for name in (*carries, "step", "part", "taken", "want_valid", "holds")),
        *(f"  reg [{bits - 1}:0] back{k}; reg taken{k} = 0;" for k in range(1, last + 1)),
        *(
            f"  wire {name} = {_all(those)};"
            for name, those in (("related", related), ("apart", apart))
        ),
        "  reg begun = 0, astray = 0, close = 0;",
        "  wire unlike = !begun && !related;",
        "  always @(posedge clk) begin",
        "    begun <= 1;",
        "    astray <= astray || unlike;",
        "    close <= close || !apart;",
        *steps,
        "  end",
        "  always @* begin",
        f"    {LABEL}: assert (holds || astray || unlike);",
        f"    {APART}: assert (apart || astray || unlike);",
        f"    {RELATED}: assert ((related && holds) || astray || unlike || close || !apart);",
        "  end",
    )
    return _Checker(inside, (*counter, "number"), lines)


def _declared(limbs: int, bits: int) -> tuple[str, ...]:
    """The wires of the limbs and of the checker's number."""
    return (
        *(f"  wire [{_LIMB - 1}:0] limb{i};" for i in range(limbs)),
        *(f"  wire full{i};" for i in range(limbs - 1)),
        f"  wire [{bits - 1}:0] number;",
    )


def _all(conditions: list[str]) -> str:
    return " && ".join(f"({condition})" for condition in conditions)

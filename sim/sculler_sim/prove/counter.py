"""The number of results from every value that its counter can have, in the pipelined core.

The counter's limbs begin with anything, and the checker's number with the same; so the carry of
every limb is looked at, which from power-up would come after 65,536 results.
"""

from __future__ import annotations

import re
from pathlib import Path

from sculler_hdl import module_ports, properties
from sculler_model.design import Design
from sculler_sim.prove.problem import FLAT, TO_GATES, TOP, run_yosys, top_module, write_core

LABEL = "every_number"

_WRITE = """
design -reset
read_rtlil flat.il
delete t:$assert c:{label} %d
opt_clean
aigmap
write_aiger -zinit {label}.aig
"""


def write_counter_problem(design: Design, folder: Path) -> bool:
    """Write every_number.aig.

    Args:
        design: the design.
        folder: where, a folder that is there.

    Returns:
        Whether the core has such a counter: the compact core has none, its program counts.

    Raises:
        InputError: Yosys is not installed.
        ToolError: Yosys failed.
    """
    sources = write_core(design, folder)
    core = (folder / "core.v").read_text(encoding="utf-8")
    limbs = sorted({int(low) for low in re.findall(r"reg \[15:0\] major_(\d+);", core)})
    if not limbs:
        return False
    number = "number" if design.drops_results else "first_number"
    inside = {f"limb{low}": f"core.handover.major_{low}" for low in limbs}
    inside |= {f"full{i}": f"core.handover.major_full{i}" for i in range(len(limbs) - 1)}
    inside |= {"number": f"checks.{number}", "holds": "checks.holds_major_as_due"}
    any_value = [name for wire, name in inside.items() if wire != "holds"]
    if design.drops_results:
        any_value.append("checks.first_number")
    script = [
        f"cd {TOP}",
        *(f"connect -nounset -set {wire} {name}" for wire, name in inside.items()),
        "cd ..",
        "setattr -unset init " + " ".join(f"w:{name}" for name in any_value),
    ]
    top = top_module(design.name, module_ports(design), _checker(limbs))
    (folder / "properties.sv").write_text(properties(design), encoding="utf-8")
    (folder / "top.v").write_text(top, encoding="utf-8")
    cut = "\n".join(["cutpoint t:$mul", *script])
    flat = FLAT.format(sources=sources, top=TOP, cut=cut, to_gates=TO_GATES)
    run_yosys(folder, flat + _WRITE.format(label=LABEL))
    return True


def _checker(limbs: list[int]) -> list[str]:
    """Lines that ask for the number where counter and checker began alike."""
    bits = 16 * len(limbs)
    alike = ["counter == number", *(f"full{i} == &limb{low}" for i, low in enumerate(limbs[:-1]))]
    return [
        *(f"  wire [15:0] limb{low};" for low in limbs),
        *(f"  wire full{i};" for i in range(len(limbs) - 1)),
        f"  wire [{bits - 1}:0] number, counter;",
        "  assign counter = {" + ", ".join(f"limb{low}" for low in reversed(limbs)) + "};",
        f"  wire holds, alike = {' && '.join(alike)};",
        "  reg begun = 0, astray = 0;",
        "  always @(posedge clk) begin",
        "    begun <= 1;",
        "    astray <= astray || (!begun && !alike);",
        f"    {LABEL}: assert (holds || astray || (!begun && !alike));",
        "  end",
    ]

"""All files of a package."""

from __future__ import annotations

from sculler_hdl import Generated
from sculler_sim.package.boards import board_texts, find_board
from sculler_sim.package.cocotb_bench import cocotb_bench
from sculler_sim.package.constraints import constraints
from sculler_sim.package.contents import CLOCK_MHZ, contents
from sculler_sim.package.fusesoc import fusesoc_core
from sculler_sim.package.ipxact import YEARS, ipxact_component
from sculler_sim.package.unit import unit_contents
from sculler_sim.package.unit_bench import unit_bench_texts
from sculler_sim.package.unit_cocotb import unit_cocotb
from sculler_sim.package.vendors import quartus_script, vivado_script


def package_texts(
    generated: Generated,
    clock_mhz: float = CLOCK_MHZ,
    board: str | None = None,
    bus_clock_mhz: float | None = None,
) -> dict[str, str]:
    """The package of a generated core, and of its unit: texts by the name of their file.

    They name the files that `generate` writes, beside which they belong.  The same core and clock
    give the same bytes.

    Args:
        generated: the core.
        clock_mhz: rate of its clock, for the constraints.
        board: name of a board to write a top level for.
        bus_clock_mhz: rate of the bus's clock, where it has one; by default that of the core's.

    Raises:
        InputError: the clock rate is none, there is no such board or the design is none for it, or
            PyYAML is not installed.
    """
    held, timing = contents(generated, clock_mhz), generated.manifest.timing
    name = held.name
    return {
        f"{name}.core": fusesoc_core(held, find_board(board) if board else None),
        **{f"{name}_ipxact_{year}.xml": ipxact_component(held, year) for year in YEARS},
        f"{name}_vivado.tcl": vivado_script(held),
        f"{name}_hw.tcl": quartus_script(held),
        **constraints(held),
        f"test_{name}.py": cocotb_bench(held, timing),
        **_unit_texts(generated, clock_mhz, bus_clock_mhz),
        **(board_texts(generated, board) if board else {}),
    }


def _unit_texts(
    generated: Generated, clock_mhz: float, bus_clock_mhz: float | None
) -> dict[str, str]:
    """The unit's; none where the design has no bus."""
    held = unit_contents(generated, clock_mhz, bus_clock_mhz)
    if held is None:
        return {}
    return {
        f"{held.name}.core": fusesoc_core(held),
        **{f"{held.name}_ipxact_{year}.xml": ipxact_component(held, year) for year in YEARS},
        f"{held.name}_vivado.tcl": vivado_script(held),
        f"{held.name}_hw.tcl": quartus_script(held),
        **constraints(held),
        **unit_bench_texts(held),
        f"test_{held.name}.py": unit_cocotb(held),
    }

"""`sculler place`: clock rate, area and worst path of the core in a real device."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sculler import terminal

if TYPE_CHECKING:
    from sculler_sim.place.placement import Placement, Placer


@click.command(
    short_help="Place and route the core in an FPGA: clock rate, area, worst path.",
    epilog=terminal.examples(
        "sculler place examples/stim300_4x5.toml --device LFE5U-85F",
        "sculler place examples/stim300_4x5.toml --device LFE5U-25F --speed 7 --check -o build/p",
    ),
)
@terminal.design_argument
@click.option(
    "--device",
    "device_name",
    required=True,
    metavar="DEVICE",
    help="LFE5U-12F, -25F, -45F or -85F, iCE40UP5K, iCE40HX8K, or xc7 (an estimate of the area in"
    " Xilinx 7 series).",
)
@click.option(
    "--speed", type=int, metavar="GRADE", help="Speed grade of an ECP5: 6 (default) to 8."
)
@click.option(
    "--seeds",
    type=click.IntRange(min=1, max=100),
    default=3,
    show_default=True,
    help="How many times to place and route; the median counts.",
)
@click.option(
    "--check",
    is_flag=True,
    help="Simulate the netlist that is placed, with models of the device's cells, against the"
    " golden model.",
)
@click.option(
    "-o",
    "--output",
    "folder",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Where to write report.json, the netlist (NAME_netlist.v) and Yosys' log; nothing is"
    " written if left out.",
)
@terminal.json_option
def command(
    design_name: str,
    device_name: str,
    speed: int | None,
    seeds: int,
    check: bool,
    folder: Path | None,
    as_json: bool,
) -> int:
    """Place and route the core of DESIGN with Yosys and nextpnr.

    Wide ports do not limit the figure: in an ECP5 the core is placed alone, out of context, in an
    iCE40 in a shift register that stands for the pins and is not counted.  Paths inside multiplier
    and memory blocks, which nextpnr does not check, are checked here: the clock rate is the smaller
    of both.  Needs the extra sculler[place].
    """
    from sculler_model.errors import InputError
    from sculler_sim.place.devices import find_device
    from sculler_sim.place.netlist import check_netlist
    from sculler_sim.place.placement import Placer, place

    design = terminal.load_design(design_name)
    device, speed = find_device(device_name, speed)
    if check and not device.routed:
        raise InputError(f"{device.name}: no models of its cells here, leave out --check")
    difference = None
    with terminal.progress("placing", seeds + 2) as advance:
        placer = Placer(design, device, speed)
        advance(1)
        placement = place(design, device, speed, range(1, seeds + 1), placer=placer, done=advance)
    if check:
        with terminal.progress("simulating the netlist", None):
            synthesis = placer.synthesis
            difference = check_netlist(design, placer.generated, synthesis.netlist, device.family)
    data = placement.as_json()
    if check:
        data["netlist"] = difference or "identical to the golden model"
    rows = describe(placement)
    if check:
        rows["netlist"] = data["netlist"]
    if folder is not None:
        write(folder, placer, json.dumps(data, indent=2) + "\n")
        rows["wrote"] = f"{folder}/: report.json, {design.name}_netlist.v, yosys.log"
    terminal.report(data, as_json, terminal.facts(rows))
    return 0 if difference is None else 1


def describe(placement: Placement) -> dict[str, str]:
    """The report's rows."""
    area = placement.area
    rows = {"design": placement.design, "device": placement.device, "how": placement.how}
    if placement.fmax_mhz is not None:
        each = ", ".join(f"{seed.mhz:.1f}" for seed in placement.seeds)
        rows["clock rate"] = f"{placement.fmax_mhz:.1f} MHz (median of {each})"
        rows["worst path"] = placement.limited_by()
        inside = [limit.describe() for limit in placement.limits]
        rows["inside blocks"] = "; ".join(inside) or "nothing that nextpnr does not check"
    rows |= {
        "LUTs": f"{area.luts:,}",
        "flip-flops": f"{area.flip_flops:,}",
        "multipliers": f"{area.multipliers:,}",
        "block RAMs": f"{area.memories:,}",
    }
    for kind, label in _LABELS.items():
        if kind in area.usage:
            used, available = area.usage[kind]
            rows[label] = f"{used:,} of {available:,}"
    rows["latency"] = f"{placement.latency_clocks} clocks" + (
        f", {placement.latency_ns:.0f} ns" if placement.latency_ns is not None else ""
    )
    rows["throughput"] = f"{placement.clocks_per_sample:g} clocks a sample" + (
        f", {placement.samples_per_second:,.0f} samples/s"
        if placement.samples_per_second is not None
        else ""
    )
    return rows


_LABELS = {
    "TRELLIS_COMB": "LUTs with what carry chains need",
    "ICESTORM_LC": "logic cells",
    "TRELLIS_FF": "flip-flops",
    "MULT18X18D": "multipliers",
    "ICESTORM_DSP": "multipliers",
    "DP16KD": "block RAMs",
    "ICESTORM_RAM": "block RAMs",
}


def write(folder: Path, placer: Placer, report: str) -> None:
    """Write report.json, the netlist and the log into a folder; they appear together.

    Raises:
        InputError: the folder cannot be made or written to.
    """
    from sculler_model.outputs import gathering

    synthesis = placer.synthesis
    texts = {
        f"{placer.design.name}_netlist.v": synthesis.netlist,
        "yosys.log": synthesis.log,
        "report.json": report,
    }
    with gathering(folder) as gathered:
        for name, text in texts.items():
            (gathered / name).write_text(text, encoding="utf-8")

"""`sculler generate`: the design as Verilog, with all that goes with it."""

from __future__ import annotations

from pathlib import Path

import click

from sculler import terminal
from sculler_model.errors import InputError


@click.command(
    short_help="Write the core as plain Verilog with manifest and test bench.",
    epilog=terminal.examples(
        "sculler generate examples/stim300_4x5.toml -o build/stim300_4x5",
        "sculler generate examples/stim300_4x5.toml --package --clock-mhz 100",
        "sculler generate examples/stim300_4x5.toml --data-sheet --placed build/placed",
    ),
)
@terminal.design_argument
@click.option(
    "-o",
    "--output",
    "folder",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Where to write; build/NAME if left out.",
)
@click.option(
    "--host",
    type=click.Choice(["c"]),
    help="Write the host too: freestanding C99 that makes attitude, velocity and position of the"
    " core's results.",
)
@click.option(
    "--hdl",
    type=click.Choice(["verilog", "amaranth"]),
    default="verilog",
    show_default=True,
    help="amaranth: write NAME.py alone, the core as a component for Amaranth designs.",
)
@click.option(
    "--package",
    "packaged",
    is_flag=True,
    help="Write what FPGA tools need to take the core in, too; needs the extra sculler[package].",
)
@click.option(
    "--clock-mhz",
    type=terminal.number_type(1e-3, 1e4),
    metavar="MHZ",
    help="With --package: the core's clock rate in the constraints; 50 if left out.",
)
@click.option(
    "--bus-clock-mhz",
    type=terminal.number_type(1e-3, 1e4),
    metavar="MHZ",
    help="With --package and a bus that has a clock of its own: its rate; the core's if left out.",
)
@click.option(
    "--board",
    metavar="BOARD",
    help="With --package: write a top level too, with pins and Makefile; ulx3s or icebreaker.",
)
@click.option(
    "--data-sheet",
    "data_sheet",
    is_flag=True,
    help="Write NAME_datasheet.html too: figures, ports, registers, timing diagrams of a run.",
)
@click.option(
    "--placed",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="With --data-sheet: where `place -o` has left its report; area and clock rate are its.",
)
@terminal.json_option
def command(
    design_name: str,
    folder: Path | None,
    host: str | None,
    hdl: str,
    packaged: bool,
    clock_mhz: float | None,
    bus_clock_mhz: float | None,
    board: str | None,
    data_sheet: bool,
    placed: Path | None,
    as_json: bool,
) -> None:
    """Write the core of DESIGN as plain Verilog-2001.

    FOLDER gets NAME.v, its manifest NAME.json (ports, word lengths, scales, latency), and a
    self-checking test bench NAME_tb.v with its golden vectors; its README.md has the command that
    runs it in any simulator.  With a hardware.target that has multiplier or memory blocks of its
    own come their models for simulators; with core = "compact" comes the schedule to read,
    NAME_schedule.txt.  With --host c come NAME_host.h and NAME_host.c, which read a result's words
    and scale them, and the library sculler_*.h and sculler_*.c beside them.  With --package
    come NAME.core for FuseSoC, IP-XACT descriptions, scripts for Vivado and Platform Designer,
    constraints (SDC, XDC, PDC, LPF) and test_NAME.py for cocotb, with a bus files of its unit too
    (NAME_unit.core and so on, registers as a memory map), with --board a top level with its
    pins and a Makefile that makes the bitstream.  With --data-sheet comes NAME_datasheet.html,
    whose timing diagrams NAME_timing.json has for WaveDrom.  With --hdl amaranth comes NAME.py
    alone.  The same design gives the same bytes.
    """
    from sculler.runs.hardware import Outcome, Source, write_amaranth, write_hardware

    design = terminal.load_design(design_name)
    folder = folder or Path("build") / design.name
    outcome: Outcome | Source
    if hdl == "amaranth":
        options = {
            "--host": host,
            "--package": packaged,
            "--clock-mhz": clock_mhz,
            "--bus-clock-mhz": bus_clock_mhz,
            "--board": board,
            "--data-sheet": data_sheet,
            "--placed": placed,
        }
        for option, given in options.items():
            if given:
                raise InputError(
                    f"{option} goes with the Verilog, leave out --hdl amaranth or {option}"
                )
        outcome = write_amaranth(design, folder)
    else:
        with terminal.progress("generating", None):
            outcome = write_hardware(
                design,
                folder,
                host == "c",
                packaged,
                clock_mhz,
                board,
                bus_clock_mhz,
                data_sheet,
                placed,
            )
    terminal.report(outcome.as_json(), as_json, terminal.facts(outcome.told()))

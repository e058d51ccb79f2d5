"""`sculler soc`: the whole navigation computer on one chip."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from sculler import terminal
from sculler.commands.options import navigation as options


@click.command(
    short_help="Write a whole navigation computer: sensor, core, RISC-V, firmware.",
    epilog=terminal.examples(
        "sculler soc chip.toml -o chip --lat 48 --lon 11 --height 500 --ve 30",
        "sculler soc chip.toml -o chip --truth truth.csv --fly imu.csv",
        "sculler soc chip.toml -o chip --lat 48 --lon 11 --height 500 --align 60 --gyro-noise 0.15"
        " --accel-noise 0.07",
    ),
)
@terminal.design_argument
@click.option(
    "-o",
    "--output",
    "folder",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Where to write; build/NAME_soc if left out.",
)
@options.initial_state_options
@click.option(
    "--truth",
    type=terminal.InputFile(Path),
    metavar="FILE",
    help="A truth (of `motion`), whose time 0 is the first sample: what of the initial state is"
    " left out comes from it.",
)
@click.option(
    "--position-every",
    type=click.IntRange(1, 1000),
    default=1,
    show_default=True,
    metavar="J",
    help="Major intervals from one position update to the next.",
)
@options.alignment_options
@options.noise_options
@click.option(
    "--memory",
    "memory_kib",
    type=int,
    metavar="KIB",
    help="Block memory of the processor, a power of two from 32 to 1024; 64 if left out, 128 with"
    " --align or algorithm.order = 3 or 4.",
)
@click.option(
    "--fly",
    "log",
    type=terminal.InputFile(Path),
    metavar="LOG",
    help="Simulate the chip in Verilator with this log's samples as datagrams on the sensor's line,"
    " and hold what it sends against the model.",
)
@terminal.json_option
def command(
    design_name: str,
    folder: Path | None,
    truth: Path | None,
    position_every: int,
    memory_kib: int | None,
    log: Path | None,
    as_json: bool,
    **asked: Any,
) -> int:
    """Write the navigation computer of DESIGN: Verilog of a whole chip, and its firmware.

    DESIGN has a sensor front end ([hardware.front]) and Wishbone ([hardware.bus]).  FOLDER gets the
    top level NAME_soc.v (front end, core and registers in NAME_unit, a RISC-V, memory, serial
    port), all modules below it, the processor VexRiscv.v with its licence, the firmware's sources
    and the compiled NAME_firmware.elf and .hex, which the memory is filled with.  The firmware
    navigates from the initial state, at the end of the core's first result of full history, or,
    with --align, from the attitude that it finds itself at rest.  It sends two frames of telemetry
    a result: the core's integers with their times, and the state.

    With --fly come NAME_flight.frames (the states, a truth for `navigate --truth`) and
    NAME_flight.csv (the core's results, for `compare`).  The exit status is 1 if an integer differs
    from the model's.  A second of flight takes about a minute.

    Needs the extra sculler[soc] and riscv64-unknown-elf-gcc with picolibc; --fly sculler[sim] too.
    """
    from sculler.commands.options.navigation import given_state
    from sculler.runs.chip import start_of
    from sculler.runs.soc import write_soc
    from sculler.soc import SocPlan, chip_alignment

    design = terminal.load_design(design_name)
    options.refuse_contradictions(asked)
    if truth is None:
        options.require_place(asked)
    start = start_of(design, given_state(asked), truth)
    seconds, fine, align = asked["align"], asked["fine"], None
    if seconds is not None:
        align = chip_alignment(design, seconds, fine, options.sensor_noise(asked), start.lat)
    plan = SocPlan(design, start, position_every, memory_kib, align)
    folder = folder or Path("build") / f"{design.name}_soc"
    with terminal.progress("making the chip", None):
        outcome = write_soc(plan, folder, log)
    terminal.report(outcome.as_json(), as_json, terminal.facts(outcome.told()))
    return 0 if outcome.same else 1

"""`sculler simulate`: a log through the generated hardware."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from sculler import terminal
from sculler.words import warning_rows

if TYPE_CHECKING:
    from sculler.checks.breaks import Policy
    from sculler.runs.engines import SimulationEngine


@click.command(
    short_help="Run an IMU log through the hardware, in Verilator or in Amaranth's simulator.",
    epilog=terminal.examples(
        "sculler simulate examples/stim300_4x5.toml imu.csv -o rtl.csv --stall 1"
    ),
)
@terminal.design_argument
@terminal.log_argument
@terminal.output_option
@click.option(
    "--engine",
    type=click.Choice(["auto", "verilator", "amaranth"]),
    default="auto",
    show_default=True,
    help="The emitted Verilog compiled by Verilator, or the Amaranth design in its own simulator;"
    " auto is Verilator where it is installed.",
)
@click.option(
    "--stall",
    type=click.IntRange(min=0),
    metavar="SEED",
    help="Random stalls on both handshakes, reproducible from the seed.",
)
@click.option(
    "--wave",
    type=terminal.OutputFile(),
    metavar="FILE",
    help="Write a waveform: .vcd, or with Verilator also .fst.",
)
@terminal.breaks_option(terminal.BREAKS_IN_LOG)
@terminal.json_option
def command(
    design_name: str,
    log: str,
    output: Path,
    engine: Literal["auto"] | SimulationEngine,
    stall: int | None,
    wave: Path | None,
    breaks: Policy,
    as_json: bool,
) -> None:
    """Run the IMU log LOG through the register-transfer level.

    LOG has counts, as CSV, .npz or .parquet; - is CSV from stdin.
    Writes the vectors that the core hands over, for `sculler compare` with those of `sculler
    model`.
    """
    from sculler.commands.origin import write_origin
    from sculler.runs.counts import simulate_log
    from sculler.runs.engines import choose_engine
    from sculler_sim.stimulus import Stimulus

    design = terminal.load_design(design_name)
    warnings: list[str] = []
    if engine == "auto":
        engine, no_verilator = choose_engine()
        if no_verilator is not None:
            warnings.append(f"simulated by Amaranth, slowly: {no_verilator}")
    # stalls long enough that the host misses a major end now and then
    longest = max(256, 4 * design.samples_per_major)
    stimulus = Stimulus.always() if stall is None else Stimulus.stalls(stall, longest)
    with terminal.progress("simulating", terminal.file_size(log)) as advance:
        summary = simulate_log(design, log, output, engine, stimulus, wave, advance, breaks)
    waveform = None if wave is None else str(wave)
    data = {"engine": engine, "log": log, "output": str(output), "stall": stall, "wave": waveform}
    warnings += summary.warnings
    rows = summary.facts() | warning_rows(warnings) | {"wrote": str(output)}
    if waveform is not None:
        rows["waveform"] = waveform
    data |= summary.as_json() | {"warnings": warnings}
    write_origin(output, {"log": log, "design": design_name}, data)
    terminal.report(data, as_json, terminal.facts(rows))

"""`sculler generate`: the design as Verilog, with all that goes with it."""

from __future__ import annotations

import json
from pathlib import Path

import click

from sculler import terminal


@click.command(
    short_help="Write the core as plain Verilog with manifest and test bench.",
    epilog=terminal.examples("sculler generate examples/stim300_4x5.toml -o build/stim300_4x5"),
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
@terminal.json_option
def command(design_name: str, folder: Path | None, as_json: bool) -> None:
    """Write the core of DESIGN as plain Verilog-2001.

    FOLDER gets NAME.v, its manifest NAME.json (ports, word lengths, scales, latency), and a
    self-checking test bench NAME_tb.v with its golden vectors; its README.md has the command that
    runs it in any simulator.  With a hardware.target that has multiplier or memory blocks of its
    own come their models for simulators; with core = "compact" comes the schedule to read,
    NAME_schedule.txt.  The same design gives the same bytes.
    """
    from sculler.runs.hardware import write_hardware

    design = terminal.load_design(design_name)
    folder = folder or Path("build") / design.name
    with terminal.progress("generating", None):
        files = write_hardware(design, folder)
    manifest = json.loads((folder / f"{design.name}.json").read_text(encoding="utf-8"))
    words = design.words
    data = {
        "design": design.name,
        "folder": str(folder),
        "files": [str(file) for file in files],
        "latency_clocks": manifest["latency_clocks"],
        "clocks_per_minor": manifest["clocks_per_minor"],
        "samples_per_major": design.samples_per_major,
        "resources": manifest["resources"],
        "verilog_sha256": manifest["verilog_sha256"],
    }
    rows = {
        "module": f"{design.name}: {design.algorithm.family}, n = {design.algorithm.samples},"
        f" M = {design.algorithm.minors}",
        "core": f"{design.hardware.core}, target {design.hardware.target}",
        "clocks": f"{manifest['clocks_per_minor']} a minor interval of"
        f" {design.algorithm.samples} samples; {manifest['latency_clocks']} from a major"
        " interval's last sample to its result",
        "widths": ", ".join(f"{vector} {getattr(words, vector).bits}" for vector in design.vectors)
        + " bits",
        "wrote": f"{folder}/: {', '.join(file.name for file in files)}",
    }
    terminal.report(data, as_json, terminal.facts(rows))

"""`sculler place`: clock rate, area and worst path of the core in a real device."""

from __future__ import annotations

from pathlib import Path

import click

from sculler import terminal


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
    help="LFE5U-12F, -25F, -45F or -85F, iCE40UP5K, iCE40HX8K, LIFCL-40, GW2A-18, GW1NR-9,"
    " CCGM1A1; or, for an estimate of the area, xc7, xcup (UltraScale+), cyclonev.",
)
@click.option(
    "--speed",
    type=int,
    metavar="GRADE",
    help="Speed grade: ECP5 6 (default) to 8, LIFCL-40 7 (default) to 9.",
)
@click.option(
    "--seeds",
    type=click.IntRange(min=1, max=100),
    default=3,
    show_default=True,
    help="How many times to place and route, as many at once as there are processors; the median"
    " counts.",
)
@click.option(
    "--check",
    is_flag=True,
    help="Simulate the netlist that is placed, with models of the device's cells, against the"
    " golden model.",
)
@click.option(
    "--time-limit",
    "time_limit_s",
    type=click.FloatRange(min=0, min_open=True),
    metavar="SECONDS",
    help="Give up after so long; what is done by then is kept for the next run.  No limit if left"
    " out.",
)
@click.option(
    "-o",
    "--output",
    "folder",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Where to write report.json, the netlist (NAME_netlist.v), Yosys' log, constraints with"
    " the clock rate found (NAME.sdc, .xdc, .pdc, .lpf) and a picture of the floor plan"
    " (floorplan.png); nothing is written if left out.",
)
@terminal.json_option
def command(
    design_name: str,
    device_name: str,
    speed: int | None,
    seeds: int,
    check: bool,
    time_limit_s: float | None,
    folder: Path | None,
    as_json: bool,
) -> int:
    """Place and route the core of DESIGN with Yosys and nextpnr.

    Wide ports do not limit the figure: in an ECP5 the core is placed alone, out of context, in
    others in a shift register that stands for the pins and is not counted.  Paths inside multiplier
    and memory blocks, which nextpnr does not check, are checked here: the clock rate is the smaller
    of both.  Needs the extra sculler[place].
    """
    from sculler.runs.placing import Plan, place_core

    plan = Plan(terminal.load_design(design_name), device_name, speed, seeds, check, time_limit_s)
    with terminal.staged_progress(plan.steps) as (advance, tell):
        outcome = place_core(plan, advance=advance, tell=tell)
    rows = outcome.told()
    if folder is not None:
        rows["wrote"] = outcome.write(folder)
    terminal.report(outcome.as_json(), as_json, terminal.facts(rows))
    return 0 if outcome.difference is None else 1

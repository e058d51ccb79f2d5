"""The command line of `python -m studies.bench`."""

from __future__ import annotations

import os
import platform
import statistics
import tempfile
from pathlib import Path
from typing import Any

import click
import numpy as np
from rich.table import Table

from sculler import terminal
from sculler.words import three_digits
from sculler_model.design import Design
from sculler_model.errors import InputError
from studies.bench import navigators
from studies.bench.tasks import measure, tasks


@click.command(epilog=terminal.examples("python -m studies.bench --runs 9 --json"))
@click.option(
    "--runs", type=click.IntRange(min=5), default=5, show_default=True, help="Runs of each."
)
@terminal.json_option
def command(runs: int, as_json: bool) -> None:
    """Measure model, simulators, log reading and navigation, the latter beside python-ins."""
    design = Design.preset("stim300")
    with tempfile.TemporaryDirectory() as folder:
        all_tasks = tasks(design, Path(folder))
        seconds = measure(all_tasks, runs)
    rows = {}
    for task in all_tasks:
        speeds = [task.samples / s for s in seconds[task.name]]
        rows[task.name] = {
            "samples": task.samples,
            "samples_per_s": statistics.median(speeds),
            "majors_per_s": statistics.median(speeds) / design.samples_per_major,
            "slowest": min(speeds),
            "fastest": max(speeds),
            "clocks_per_s": statistics.median(speeds) / task.samples * task.clocks
            if task.clocks
            else None,
        }
    machine = f"{platform.machine()}, {os.cpu_count()} processors, Python"
    machine += f" {platform.python_version()}, numpy {np.__version__}"
    data = {"design": design.name, "runs": runs, "machine": machine, "speeds": rows}
    compared = _compare_navigators(runs)
    terminal.report(
        {**data, "navigators": compared}, as_json, _table(data), "", _navigators(compared)
    )


def _compare_navigators(runs: int) -> dict[str, Any]:
    """`navigators.compare`, or which package it misses."""
    try:
        return navigators.compare(runs=runs)
    except InputError as missing:
        return {"missing": str(missing)}


def _table(data: dict[str, Any]) -> Table:
    table = Table(
        title=f"samples/s, design {data['design']}, medians of {data['runs']} runs",
        title_justify="left",
        caption=data["machine"],
        caption_justify="left",
    )
    table.add_column("")
    for column in ("samples/s", "slowest", "fastest", "results/s", "clocks/s", "samples a run"):
        table.add_column(column, justify="right")
    for name, row in data["speeds"].items():
        speeds = [row["samples_per_s"], row["slowest"], row["fastest"], row["majors_per_s"]]
        clocks = row["clocks_per_s"]
        table.add_row(
            name,
            *(three_digits(speed) for speed in speeds),
            three_digits(clocks) if clocks else "",
            f"{row['samples']:,}",
        )
    return table


def _navigators(data: dict[str, Any]) -> Table | str:
    """Of `_compare_navigators`."""
    if "missing" in data:
        return f"navigators not compared: {data['missing']}"
    table = Table(
        title=f"navigators, {data['seconds']:g} s of a {data['motion']},"
        f" {data['rate_hz']:g} increments a second",
        title_justify="left",
        caption=f"compiled, {data['speed_ratio']:.3g} times the updates of python-ins a second,"
        f" {1 / data['error_ratio']:.2g} of its horizontal error",
        caption_justify="left",
    )
    table.add_column("")
    for column in ("updates/s", "us an update", "horizontal error, m", "velocity error, m/s"):
        table.add_column(column, justify="right")
    for name, row in data["navigators"].items():
        keys = ("updates_per_s", "us_per_update", "horizontal_m", "velocity_m_per_s")
        table.add_row(name, *(three_digits(row[key]) if key in row else "" for key in keys))
    return table

"""The command line of `python -m studies.bench`."""

from __future__ import annotations

import os
import platform
import statistics
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np
from rich.table import Table

from sculler import terminal
from sculler.words import three_digits
from sculler_model.design import Design
from sculler_model.errors import InputError
from studies.bench import analyses, files, kernels, navigators, rtl, runs
from studies.bench.contest import Contest, hold
from studies.bench.tasks import measure, tasks

SUBJECTS: dict[str, Callable[[Path], list[Contest]]] = {
    "analyses": analyses.contests,
    "files": files.contests,
    "kernels": kernels.contests,
    "navigators": navigators.contests,
    "rtl": rtl.contests,
    "runs": runs.contests,
}
"""Contests by subject, each made from a folder for its files."""


@click.command(epilog=terminal.examples("python -m studies.bench --runs 9 --json"))
@click.option(
    "--runs", type=click.IntRange(min=5), default=5, show_default=True, help="Runs of each."
)
@click.option(
    "--only",
    type=click.Choice(sorted(SUBJECTS)),
    multiple=True,
    help="Hold the contests of this subject and nothing else; may be given more than once.",
)
@terminal.json_option
def command(runs: int, only: Sequence[str], as_json: bool) -> None:
    """Measure model, simulators, files, navigation and studies, beside others that do the same."""
    data: dict[str, Any] = {"runs": runs, "machine": _machine()}
    shown: list[Table | str] = [data["machine"]]
    if not only:
        data |= _speeds(runs)
        data["navigators"] = _compare_navigators(runs)
        shown += [_table(data), "", _navigators(data["navigators"])]
    data["contests"] = {}
    with tempfile.TemporaryDirectory() as folder:
        for subject in only or SUBJECTS:
            rows = hold(SUBJECTS[subject](Path(folder)), runs)
            data["contests"][subject] = rows
            shown += ["", _contests(subject, rows, runs)]
    terminal.report(data, as_json, *shown)


def _machine() -> str:
    machine = f"{platform.machine()}, {os.cpu_count()} processors, Python"
    return f"{machine} {platform.python_version()}, numpy {np.__version__}"


def _speeds(runs: int) -> dict[str, Any]:
    """What each task does in a second, of the default design."""
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
    return {"design": design.name, "speeds": rows}


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


def _contests(subject: str, rows: list[dict[str, Any]], runs: int) -> Table:
    """A subject's rows of `hold`; the worst ratio against its goal comes first."""

    def margin(row: dict[str, Any]) -> float:
        return float("inf") if row["ratio"] is None else row["ratio"] / (row["goal"] or 1)

    table = Table(
        title=f"{subject}: ratio of the other side's time to ours, medians of {runs} runs",
        title_justify="left",
    )
    for column in ("", "against"):
        table.add_column(column)
    for column in ("ratio", "goal", "a second", "ours, s", "theirs, s"):
        table.add_column(column, justify="right")
    for row in sorted(rows, key=margin):
        theirs = row["theirs_s"]
        table.add_row(
            row["name"],
            row["missing"] or row["against"],
            "" if row["ratio"] is None else f"{row['ratio']:.2f}",
            "" if row["goal"] is None else f"{row['goal']:g}",
            f"{three_digits(row['per_second'])} {row['unit']}",
            three_digits(row["ours_s"][1]),
            "" if theirs is None else three_digits(theirs[1]),
        )
    return table

"""A campaign from its file to results, statistics and pictures; what is done stays done."""

from __future__ import annotations

import json
import os
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.formats.tables import Column, open_table, writing_table
from sculler.plots.campaign import campaign_picture
from sculler.plots.pictures import left_out
from sculler.runs.campaign import hardware
from sculler.runs.campaign.engine import (
    Batch,
    Job,
    by_scheduler,
    in_processes,
    in_this_process,
    runs_together,
)
from sculler.runs.campaign.flights import COLUMNS
from sculler.runs.campaign.hardware import Held
from sculler.runs.campaign.plan import Campaign
from sculler.runs.campaign.statistics import Statistics, require_scipy
from sculler.words import Advance, silent, three_digits
from sculler_model.errors import InputError
from sculler_model.outputs import replacing

Rows = Mapping[str, NDArray[Any]]

_NOTE = "campaign.json"
_KINDS = [Column(name, "int64" if name in ("design", "seed") else "float64") for name in COLUMNS]


@dataclass(frozen=True)
class Outcome:
    """What a campaign found.

    Attributes:
        campaign: the campaign.
        folder: where everything is.
        statistics: by label.
        flown: runs done now; the others were there.
        picture: file, or None where there is none, `why_none`.
        held: runs that went through the hardware too.
    """

    campaign: Campaign
    folder: Path
    statistics: Mapping[str, Statistics]
    flown: int
    picture: Path | None
    why_none: str | None
    held: list[Held] = field(default_factory=list)

    @property
    def identical(self) -> bool:
        """The hardware gave the twin's integers, as far as it was asked."""
        return all(held.different is None for held in self.held)

    @property
    def warnings(self) -> list[str]:
        """What one should know."""
        return [] if self.why_none is None else [self.why_none]

    @property
    def files(self) -> list[str]:
        """What was written, by name."""
        drawn = [] if self.picture is None else [self.picture.name]
        return ["results.parquet", "summary.json", *drawn]

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "runs": self.campaign.tables.runs,
            "flown_now": self.flown,
            "seconds": self.campaign.tables.seconds,
            "designs": {label: found.as_json() for label, found in self.statistics.items()},
            "results": str(self.folder / "results.parquet"),
            "summary": str(self.folder / "summary.json"),
            **({"plots": [str(self.picture)]} if self.picture else {}),
            **({"rtl": hardware.as_json(self.held)} if self.held else {}),
        }

    def table(self) -> tuple[list[str], list[list[str]]]:
        """Titles and rows: a design each."""
        titles = ["design", "runs", "horizontal 50 %", "95 %", "growth 50 %", "heading 50 %"]
        rows = []
        for label, found in self.statistics.items():
            rows.append(
                [
                    label,
                    f"{found.runs:,}",
                    _told(found.horizontal[0.5], "m"),
                    _told(found.horizontal[0.95], "m"),
                    _told(found.growth[0.5], "nmi/h"),
                    _told(found.heading[0.5], "arcsec"),
                ]
            )
        return titles, rows


def _told(values: tuple[float, float, float], unit: str) -> str:
    value, low, high = map(three_digits, values)
    return f"{value} {unit} ({low} to {high})"


def run_campaign(
    campaign: Campaign,
    source: Path,
    folder: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    advance: Advance = silent,
) -> Outcome:
    """Fly what is not flown yet, and write results, statistics and a picture.

    Results are the same to the last bit whatever the number of workers, and whoever they are.

    Args:
        campaign: what to fly.
        source: its file; names in it start from its folder.
        folder: where to write `results.parquet`, `summary.json`, `growth.png`, and `parts/`, from
            which a campaign that was interrupted goes on.
        workers: processes of this machine; as many as it has cores if left out.
        scheduler: address of a Dask scheduler whose workers do it.
        advance: told the runs that are done.

    Raises:
        InputError: the folder is of another campaign, a library or a simulator is absent, or a run
            fails.
        SimulationError: a core hangs.
    """
    require_scipy()
    parts = folder / "parts"
    _refuse_another(campaign, folder)
    there = _done(campaign, parts)
    advance(sum(len(seeds) for seeds in there))
    workers = workers or os.cpu_count() or 1
    batches = list(_missing(campaign, there, workers))
    tables = campaign.tables.model_dump_json(exclude_none=True)
    jobs = [Job(tables, str(source.parent.resolve()), batch) for batch in batches]
    if scheduler is not None:
        results: Generator[tuple[Batch, Rows], None, None] = by_scheduler(jobs, scheduler)
    elif workers == 1 or len(jobs) == 1:
        results = in_this_process(jobs)
    else:
        results = in_processes(jobs, workers)
    with closing(results):
        for batch, rows in results:
            _claim(campaign, folder)
            name = f"{batch.design}-{batch.first_seed}-{batch.many}.parquet"
            _write(parts / name, rows)
            advance(batch.many)
    held = hardware.held_against_hardware(campaign, parts)
    return _summed_up(campaign, folder, sum(batch.many for batch in batches), held)


def _refuse_another(campaign: Campaign, folder: Path) -> None:
    """See that what lies in the folder is of this campaign."""
    note = folder / _NOTE
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is no folder, give the name of one")
    if note.exists() and json.loads(note.read_text(encoding="utf-8")) != _claimed(campaign):
        raise InputError(f"{folder}: has results of another campaign, give another folder")


def _claim(campaign: Campaign, folder: Path) -> None:
    """Write in the folder whose it is."""
    (folder / "parts").mkdir(parents=True, exist_ok=True)
    if not (folder / _NOTE).exists():
        with replacing(folder / _NOTE) as temporary:
            temporary.write_text(json.dumps(_claimed(campaign)) + "\n", encoding="utf-8")


def _claimed(campaign: Campaign) -> dict[str, str]:
    return {"digest": campaign.digest}


def _done(campaign: Campaign, parts: Path) -> list[set[int]]:
    """Seeds of each design that are done."""
    there: list[set[int]] = [set() for _ in campaign.designs]
    for part in parts.glob("*-*-*.parquet"):
        words = part.stem.split("-")
        if all(word.isdecimal() for word in words) and len(words) == 3:
            design, first, many = map(int, words)
            if design < len(there):
                there[design] |= set(range(first, first + many))
    wanted = set(campaign.seeds)
    return [seeds & wanted for seeds in there]


def _missing(campaign: Campaign, there: Sequence[set[int]], workers: int) -> Iterator[Batch]:
    """The runs that are not done, in batches that keep all workers busy to the end."""
    together = runs_together(campaign.tables.runs, workers)
    for design, done in enumerate(there):
        first, many = 0, 0
        for seed in campaign.seeds:
            if seed in done:
                if many:
                    yield Batch(design, first, many)
                many = 0
                continue
            first = seed if not many else first
            many += 1
            if many == together:
                yield Batch(design, first, many)
                many = 0
        if many:
            yield Batch(design, first, many)


def _write(path: Path, rows: Rows) -> None:
    with replacing(path) as temporary, writing_table(temporary, _KINDS) as table:
        table.write(rows)


def _read(path: Path) -> dict[str, NDArray[Any]]:
    with open_table(path, "results") as table:
        blocks = list(table.blocks(COLUMNS))
    return {name: np.concatenate([block[name] for block in blocks]) for name in COLUMNS}


def _summed_up(campaign: Campaign, folder: Path, flown: int, held: list[Held]) -> Outcome:
    """Results in order, statistics and the picture."""
    found = [_read(path) for path in sorted((folder / "parts").glob("*-*-*.parquet"))]
    rows = {name: np.concatenate([part[name] for part in found]) for name in COLUMNS}
    seeds = campaign.seeds
    wanted = (rows["seed"] >= seeds.start) & (rows["seed"] < seeds.stop)
    order = np.lexsort((rows["time_s"], rows["seed"], rows["design"]))
    order = order[wanted[order]]
    rows = {name: column[order] for name, column in rows.items()}
    _write(folder / "results.parquet", rows)
    statistics = {
        label: Statistics.of({name: part[rows["design"] == number] for name, part in rows.items()})
        for number, label in enumerate(campaign.labels)
    }
    why_none, picture = left_out(), None
    if why_none is None:
        picture = campaign_picture(statistics, folder / "growth.png")
    outcome = Outcome(campaign, folder, statistics, flown, picture, why_none, held)
    with replacing(folder / "summary.json") as temporary:
        text = json.dumps(outcome.as_json(), indent=2, ensure_ascii=False)
        temporary.write_text(text + "\n", encoding="utf-8")
    return outcome

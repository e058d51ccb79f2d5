"""A navigation computer on one chip: its files, and a log flown by it in Verilator."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from sculler.formats import comparison
from sculler.formats.log import read_log
from sculler.formats.telemetry import FRAME, frames_of
from sculler.formats.vectors import VectorsWriter
from sculler.runs.hardware import texts_of
from sculler.runs.navigation import AgainstTruth, Given
from sculler.soc import (
    ChipRecord,
    Firmware,
    Flight,
    SocPlan,
    check_soc,
    compile_firmware,
    firmware_texts,
    fly_log,
    makefile,
    require_compiler,
    soc_texts,
)
from sculler_hdl import Generated, generate
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock
from sculler_model.frames import SEMI_MAJOR_AXIS
from sculler_model.host import major_increments
from sculler_model.navigation import NavHistory, Navigator, NavState, navigate
from sculler_model.outputs import gathering

QUANTITIES = ("attitude", "velocity", "position")


def short_results(design: Design) -> int:
    """Results of short history at a core's beginning: the firmware begins at their end."""
    spans = design.table.history // design.samples_per_major + 2
    zeros = np.zeros((spans * design.samples_per_major, 6), np.int64)
    return int((np.asarray(FastModel(design).feed(zeros).status) & 1).sum())


def start_of(design: Design, given: Given, truth: Path | None) -> NavState:
    """Where a chip begins to navigate, at the end of its first results of short history.

    Args:
        design: of the chip.
        given: what the user says of it.
        truth: tells what is left out; its time 0 is the first sample's beginning.

    Raises:
        InputError: nobody tells the position, or the truth has no state at that instant.
    """
    check_soc(design)
    time = short_results(design) * design.major_interval
    if truth is None:
        return given.state(time, None)
    found = AgainstTruth(truth, design.major_interval).start(np.array([time]))
    if found is None:
        raise InputError(
            f"{truth}: the truth has no state at {time:.15g} s, where the chip begins to navigate"
        )
    return given.state(time, found.state)


@dataclass(frozen=True)
class Chip:
    """A chip made.

    Attributes:
        plan: what was asked for.
        generated: core, front end, bus.
        firmware: its program.
    """

    plan: SocPlan
    generated: Generated
    firmware: Firmware

    def texts(self) -> dict[str, str]:
        """All files but the program: texts by name."""
        name = self.plan.design.name
        texts = {
            file: text
            for file, text in texts_of(self.generated).items()
            if file.endswith((".v", ".json", "_regs.h", ".rdl"))
        }
        return (
            texts
            | soc_texts(self.plan)
            | firmware_texts(self.plan)
            | {f"{name}_firmware.hex": self.firmware.hex, f"{name}_soc.mk": makefile(self.plan)}
        )


def make_chip(plan: SocPlan) -> Chip:
    """Generate a chip's hardware and compile its firmware.

    Raises:
        InputError: the processor's package or the cross compiler is not installed, or the firmware
            does not fit the memory.
    """
    require_compiler()
    soc_texts(plan)  # the processor is there
    generated = generate(plan.design)
    registers = generated.further[f"{plan.design.name}_regs.h"]
    return Chip(plan, generated, compile_firmware(plan, registers))


@dataclass(frozen=True)
class Flown:
    """A log that a chip flew, held against the models.

    Attributes:
        flight: what the chip sent.
        model: the core's results by the golden model's twin.
        lead: results of short history, with each of which the chip tells its initial state.
        expected: (R + 1,) states that Python's navigator has with the others, the initial one
            first.
    """

    flight: Flight
    model: VectorBlock
    lead: int
    expected: NavHistory

    @property
    def record(self) -> ChipRecord:
        """What the telemetry tells, as far as the log went."""
        return self.flight.record

    @property
    def equal_results(self) -> int:
        """Results that are the model's, integer for integer, from the first one on."""
        found = comparison.difference(self.model, self.record.results)
        return len(self.model) if found is None else found.row

    def differences(self) -> dict[str, float]:
        """The largest difference of the states from Python's: rad, m/s, m."""
        status = np.zeros(len(self.expected), np.int64)
        expected = np.frombuffer(frames_of(self.expected, status, 0), FRAME)[1:]
        told = self.record.states[self.lead :]
        count = min(len(told), len(expected))

        def away(name: str, scale: float | list[float] = 1.0) -> float:
            one, other = told[name][:count], expected[name][:count]
            return float(np.abs((one - other) * scale).max(initial=0.0))

        on_earth = [SEMI_MAJOR_AXIS, SEMI_MAJOR_AXIS, 1.0]  # latitude and longitude as m
        return dict(
            zip(QUANTITIES, (away("q", 2.0), away("v"), away("place", on_earth)), strict=True)
        )

    @property
    def same(self) -> bool:
        """Whether all results are the model's."""
        return self.equal_results == len(self.model) == len(self.record.results)


def fly(chip: Chip, log: Path) -> Flown:
    """Fly a log: its samples on the sensor's line, in Verilator.

    Raises:
        InputError: the log has a fault or less than a result, the sensor is not on an asynchronous
            line, or Verilator fails.
    """
    chunks = list(read_log(log, chip.plan.design))
    counts = np.concatenate([chunk.counts for chunk in chunks])
    marks = [c.faults if c.faults is not None else np.zeros(len(c.counts), int) for c in chunks]
    return flown(chip, counts.tolist(), np.concatenate(marks).tolist())


def flown(chip: Chip, counts: list[list[int]], faults: list[int]) -> Flown:
    """The same of samples in memory: (N, 6) counts and (N,) fault marks."""
    plan, design = chip.plan, chip.plan.design
    model = FastModel(design).feed(np.array(counts, np.int64), np.array(faults, np.uint8))
    increments = major_increments(design, model)
    lead = increments.leading_short
    if len(model) <= lead:
        raise InputError(
            f"the log has {len(counts)} samples, less than a result to navigate with; give a"
            " longer one"
        )
    flight = fly_log(plan, chip.generated, chip.firmware, counts, faults)
    kept = flight.record.first(len(model))
    start = plan.start._replace(time=lead * design.major_interval)
    expected = navigate(
        start,
        design.major_interval,
        increments[lead:],
        lambda state, interval: Navigator(state, interval, position_every=plan.position_every),
    )
    return Flown(replace(flight, record=kept), model, lead, expected)


@dataclass(frozen=True)
class Outcome:
    """What was written, and how the flight went.

    Attributes:
        chip: what was made.
        folder: where the files are.
        files: their names.
        flown: the flight; None without one.
    """

    chip: Chip
    folder: Path
    files: tuple[str, ...]
    flown: Flown | None

    @property
    def same(self) -> bool:
        """Whether the chip flew as the models did, or did not fly."""
        return self.flown is None or self.flown.same

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        plan, firmware = self.chip.plan, self.chip.firmware
        data: dict[str, Any] = {
            "design": plan.design.name,
            "folder": str(self.folder),
            "files": [str(self.folder / name) for name in self.files],
            "memory_bytes": plan.memory_kib * 1024,
            "code_bytes": firmware.code,
            "variable_bytes": firmware.variables,
            "compiler": firmware.compiler,
        }
        if self.flown is not None:
            data["flight"] = figures(plan.design, self.flown)
        return data

    def told(self) -> dict[str, str]:
        """In words, row by row."""
        plan, firmware = self.chip.plan, self.chip.firmware
        rows = {
            "chip": f"{plan.design.name}_soc: {plan.design.name}_unit, VexRiscv,"
            f" {plan.memory_kib} KiB",
            "firmware": f"{firmware.code:,} bytes of code, {firmware.variables:,} of variables;"
            f" {firmware.compiler}",
        }
        if self.flown is not None:
            rows |= _told(figures(plan.design, self.flown))
        return rows | {"wrote": f"{self.folder}/: {', '.join(self.files)}"}


def figures(design: Design, flown: Flown) -> dict[str, Any]:
    """Of a flight, as plain data."""
    record, front = flown.record, design.hardware.front
    assert front is not None
    clock = front.clock_hz
    steady = slice(flown.lead + 1, None)  # the first update is worked out twice
    update = (record.ended - record.begun)[steady]
    busy = record.free[steady][1:] - record.begun[steady][:-1]
    told = [last for number, last in _last_bytes(flown.flight, len(record.results))]
    after = [end - int(begin) for end, begin in zip(told, record.sample_clock, strict=False)]
    return {
        "clock_hz": clock,
        "clocks": flown.flight.clocks,
        "results": len(record.results),
        "results_of_the_model": len(flown.model),
        "identical_results": flown.equal_results,
        "states": len(record.states),
        "largest_difference": flown.differences(),
        "update_clocks": int(np.median(update)) if len(update) else None,
        "busy_clocks": int(np.median(busy)) if len(busy) else None,
        "updates_per_second": float(clock / np.median(busy)) if len(busy) else None,
        "core_clocks": int(np.median(record.result_clock - record.sample_clock)),
        "wait_clocks": int(np.median(record.begun - record.result_clock)),
        "telemetry_clocks": int(np.median(after)) if after else None,
        "counters": dict(
            zip(
                ("taken", "bad", "missed", "late", "lost"),
                record.counters[-1].tolist() if len(record.counters) else (),
                strict=False,
            )
        ),
    }


def _last_bytes(flight: Flight, results: int) -> Iterable[tuple[int, int]]:
    """Of each result with a state, its number and the clock in which its last byte began."""
    for number, place in flight.record.state_ends[:results]:
        yield number, flight.sent.clocks[place]


def _told(found: dict[str, Any]) -> dict[str, str]:
    away = found["largest_difference"]
    units = dict(zip(QUANTITIES, ("rad", "m/s", "m"), strict=True))
    states = ", ".join(f"{name} {away[name]:.1e} {units[name]}" for name in QUANTITIES)
    rows = {
        "results": f"{found['identical_results']} of {found['results_of_the_model']} are the"
        " model's, integer for integer",
        "states": f"{found['states']}: Python's to the last bit"
        if not any(away.values())
        else f"{found['states']}; off from Python's by at most {states}",
    }
    if found["busy_clocks"]:
        rows["update"] = (
            f"{found['update_clocks']:,} clocks, {found['busy_clocks']:,} with telemetry:"
            f" {found['updates_per_second']:.0f} a second at {found['clock_hz'] / 1e6:g} MHz"
        )
    return rows


def write_soc(plan: SocPlan, folder: Path, log: Path | None = None) -> Outcome:
    """Write a chip's files, and fly a log; the files appear together.

    With a flight come NAME_flight.frames, its telemetry's states, and NAME_flight.csv, the core's
    results as vectors.

    Args:
        plan: of the chip.
        folder: where; it is made if need be.
        log: of the design's counts; None for no flight.

    Raises:
        InputError: as `make_chip` and `fly`; or the folder cannot be made or written to.
    """
    chip = make_chip(plan)
    found = None if log is None else fly(chip, log)
    name = plan.design.name
    texts = chip.texts()
    with gathering(folder) as gathered:
        for file, text in texts.items():
            (gathered / file).write_text(text, encoding="utf-8", newline="\n")
        (gathered / f"{name}_firmware.elf").write_bytes(chip.firmware.elf)
        files = [*texts, f"{name}_firmware.elf"]
        if found is not None:
            files += _write_flight(gathered, plan.design, found.record)
    return Outcome(chip, folder, tuple(files), found)


def _write_flight(folder: Path, design: Design, record: ChipRecord) -> list[str]:
    frames, vectors = f"{design.name}_flight.frames", f"{design.name}_flight.csv"
    assert record.states.dtype == FRAME
    (folder / frames).write_bytes(record.states.tobytes())
    with VectorsWriter(folder / vectors, design.columns, design=design) as writer:
        writer.write(record.results)
    return [frames, vectors]

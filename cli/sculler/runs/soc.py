"""`sculler soc`: a chip's files, and a log flown by it in Verilator."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sculler.formats.telemetry import FRAME
from sculler.formats.vectors import VectorsWriter
from sculler.runs.chip import Chip, make_chip
from sculler.runs.chip_flight import Flown, figures, fly, told
from sculler.soc import ChipRecord, SocPlan
from sculler_model.design import Design
from sculler_model.outputs import gathering


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
            "memory_bytes": plan.memory * 1024,
            "code_bytes": firmware.code,
            "variable_bytes": firmware.variables,
            "compiler": firmware.compiler,
        }
        if self.flown is not None:
            data["flight"] = figures(self.chip, self.flown)
        return data

    def told(self) -> dict[str, str]:
        """In words, row by row."""
        plan, firmware = self.chip.plan, self.chip.firmware
        rows = {
            "chip": f"{plan.design.name}_soc: {plan.design.name}_unit, VexRiscv, {plan.memory} KiB",
            "firmware": f"{firmware.code:,} bytes of code, {firmware.variables:,} of variables;"
            f" {firmware.compiler}",
        }
        if self.flown is not None:
            rows |= told(figures(self.chip, self.flown))
        return rows | {"wrote": f"{self.folder}/: {', '.join(self.files)}"}


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

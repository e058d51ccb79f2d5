"""A design's hardware as files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sculler.host_c import host_texts, library_texts
from sculler_hdl import Generated, Manifest, amaranth_source, generate, timing
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.outputs import gathering, make_folder, replacing
from sculler_sim.package.contents import CLOCK_MHZ
from sculler_sim.package.datasheet import data_sheet_texts, read_report
from sculler_sim.package.files import package_texts
from sculler_sim.testbench import write_testbench


@dataclass(frozen=True)
class Outcome:
    """What was written.

    Attributes:
        manifest: of the core.
        folder: where the files are.
        files: all of them.
    """

    manifest: Manifest
    folder: Path
    files: tuple[Path, ...]

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        manifest, design = self.manifest.as_json(), self.manifest.design
        return {
            "design": design.name,
            "folder": str(self.folder),
            "files": [str(file) for file in self.files],
            "latency_clocks": manifest["latency_clocks"],
            "clocks_per_minor": manifest["clocks_per_minor"],
            "samples_per_major": design.samples_per_major,
            "resources": manifest["resources"],
            "verilog_sha256": manifest["verilog_sha256"],
        }

    def told(self) -> dict[str, str]:
        """In words, row by row."""
        manifest, design = self.manifest, self.manifest.design
        algorithm = design.algorithm
        widths = (f"{vector} {getattr(design.words, vector).bits}" for vector in design.vectors)
        return {
            "module": f"{design.name}: {algorithm.family}, n = {algorithm.samples},"
            f" M = {algorithm.minors}",
            "core": f"{design.hardware.core}, target {design.hardware.target}",
            "clocks": f"{manifest.clocks_per_minor} a minor interval of"
            f" {algorithm.samples} samples; {manifest.latency_clocks} from a major"
            " interval's last sample to its result",
            "widths": f"{', '.join(widths)} bits",
            "wrote": f"{self.folder}/: {', '.join(file.name for file in self.files)}",
        }


def texts_of(generated: Generated) -> dict[str, str]:
    """The files of a generated core, but for its test bench: texts by name."""
    name = generated.manifest.design.name
    texts = {
        f"{name}.v": generated.verilog,
        f"{name}.vhd": generated.vhdl,
        f"{name}.json": json.dumps(generated.manifest.as_json(), indent=2) + "\n",
        **{f"{cell}.v": text for cell, text in generated.cells.items()},
        **generated.further,
    }
    if generated.listing is not None:
        texts[f"{name}_schedule.txt"] = generated.listing
    return texts


@dataclass(frozen=True)
class Source:
    """A core written as a Python file.

    Attributes:
        design: whose core.
        file: where it is.
    """

    design: Design
    file: Path

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "design": self.design.name,
            "folder": str(self.file.parent),
            "files": [str(self.file)],
        }

    def told(self) -> dict[str, str]:
        """In words, row by row."""
        return {"component": f"{self.design.name}.Core", "wrote": str(self.file)}


def write_amaranth(design: Design, folder: Path) -> Source:
    """Write a design's core as a Python file for Amaranth designs, NAME.py.

    Args:
        design: the design.
        folder: where; it is made if need be.

    Raises:
        InputError: the folder cannot be made or written to, or `hardware.multipliers` are too few.
    """
    timing(design)  # it can be built
    file = make_folder(folder) / f"{design.name}.py"
    with replacing(file) as temporary:
        temporary.write_text(amaranth_source(design), encoding="ascii", newline="\n")
    return Source(design, file)


def write_hardware(
    design: Design,
    folder: Path,
    host_in_c: bool = False,
    packaged: bool = False,
    clock_mhz: float | None = None,
    board: str | None = None,
    bus_clock_mhz: float | None = None,
    data_sheet: bool = False,
    placed: Path | None = None,
) -> Outcome:
    """Write Verilog, manifest and test bench of a design; they appear together.

    Args:
        design: the design.
        folder: where; it is made if need be.
        host_in_c: write the host in C, too.
        packaged: write what FPGA tools need to take the core in, too.
        clock_mhz: the core's clock rate in the package's constraints; if left out, that of the
            design's front end, or 50.
        board: name of a board to write a top level for, with the package.
        bus_clock_mhz: clock rate of the bus in the package's constraints, where it has a clock of
            its own; if left out, the core's.
        data_sheet: write a page that says what the core is, with timing diagrams of a run.
        placed: where `sculler place -o` has left its report, for area and clock rate in that page.

    Raises:
        InputError: the folder cannot be made or written to; a package or a page is asked for of a
            design with channels; a clock rate that is none, is not the front end's; that or a
            board is given without a package; no such board, or the design is none for it; the extra
            `package` is not installed; no report of this design.
        ToolError: the core, simulated for the page, is not as the cycle model says.
    """
    given = {"--clock-mhz": clock_mhz, "--board": board, "--bus-clock-mhz": bus_clock_mhz}
    _refuse(design, given, packaged, data_sheet, placed)
    report = None if placed is None else read_report(placed, design)
    generated = generate(design)
    texts = texts_of(generated)
    if data_sheet:
        texts |= data_sheet_texts(generated, report)
    if host_in_c:
        texts |= host_texts(design) | library_texts()
    if packaged:
        texts |= package_texts(generated, _clock_mhz(design, clock_mhz), board, bus_clock_mhz)
    with gathering(folder) as gathered:
        for name, text in texts.items():
            (gathered / name).write_text(text, encoding="utf-8", newline="\n")
        bench = write_testbench(design, gathered, timing(design), generated.cells)
        names = [*texts, *(file.name for file in bench)]
    return Outcome(generated.manifest, folder, tuple(folder / name for name in names))


def _refuse(
    design: Design,
    given: Mapping[str, object],
    packaged: bool,
    data_sheet: bool,
    placed: Path | None,
) -> None:
    """Refuse options that do not belong together, or not to the design.

    Args:
        given: value of each option that belongs to a package, None where it is left out.
    """
    for option, value in given.items():
        if value is not None and not packaged:
            raise InputError(f"{option} belongs to --package, give both or neither")
    if placed is not None and not data_sheet:
        raise InputError("--placed belongs to --data-sheet, give both or neither")
    bus = design.hardware.bus
    if given["--bus-clock-mhz"] is not None and (bus is None or bus.clock == "same"):
        raise InputError(
            "--bus-clock-mhz: the design's bus has no clock of its own, leave the option out or"
            ' give hardware.bus.clock = "separate"'
        )
    if design.channels > 1 and (packaged or data_sheet):
        option = "--package" if packaged else "--data-sheet"
        raise InputError(
            f"{option}: not built for a core with channels, leave it or hardware.channels out"
        )


def _clock_mhz(design: Design, given: float | None) -> float:
    """The clock rate of a package."""
    front = design.hardware.front
    if front is None:
        return CLOCK_MHZ if given is None else given
    mhz = front.clock_hz / 1e6
    if given is not None and given != mhz:
        raise InputError(
            f"--clock-mhz {given:g}: the design's hardware.front.clock_hz says {mhz:g} MHz,"
            " leave the option out"
        )
    return mhz

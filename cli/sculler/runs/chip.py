"""A navigation computer on one chip, made: where it begins, its hardware, its firmware."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sculler.runs.hardware import texts_of
from sculler.runs.navigation import AgainstTruth, Given
from sculler.soc import (
    Firmware,
    SocPlan,
    check_soc,
    compile_firmware,
    firmware_texts,
    makefile,
    require_compiler,
    soc_texts,
)
from sculler_hdl import Generated, generate
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel
from sculler_model.navigation import NavState


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

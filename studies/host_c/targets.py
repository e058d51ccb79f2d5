"""Processors: how to compile for each, and what runs it."""

from __future__ import annotations

import shutil
from dataclasses import dataclass

FLAGS = "-std=gnu99 -ffp-contract=off -ffreestanding -ffunction-sections -fdata-sections".split()
LINKING = "-static -nostdlib -Wl,--gc-sections -Wl,--no-relax".split()
LIBRARIES = ("-Wl,--start-group", "-lm", "-lc", "-lgcc", "-Wl,--end-group")
_PICOLIBC = "/usr/lib/picolibc/riscv64-unknown-elf"


@dataclass(frozen=True)
class Target:
    """A processor.

    Attributes:
        name: for readers.
        key: for the command line.
        double: whether it has instructions for doubles.
        compiler: the command.
        flags: of the processor.
        linking: more flags of the linker.
        emulator: runs a program.
        clock_mhz: at which a part of this kind runs, for an idea of times.
        hosted: whether its mathematical library is an operating system's, which brings much along.
    """

    name: str
    key: str
    double: bool
    compiler: str
    flags: tuple[str, ...]
    linking: tuple[str, ...]
    emulator: tuple[str, ...]
    clock_mhz: float
    hosted: bool = False

    @property
    def optimised(self) -> tuple[str, ...]:
        """Without hardware for doubles an operation is a call: small code is what counts."""
        return ("-O2",) if self.double else ("-Os",)

    @property
    def missing(self) -> str | None:
        """The tool that is not there, if any."""
        tools = (self.compiler, self.emulator[0])
        return next((tool for tool in tools if shutil.which(tool) is None), None)


def _arm(name: str, key: str, double: bool, core: str, unit: str, clock: float) -> Target:
    flags = (f"-mcpu={core}", "-mthumb", "-mfloat-abi=hard", f"-mfpu={unit}")
    place = ("-Wl,-Ttext-segment=0x100000", *LIBRARIES)
    return Target(
        name, key, double, "arm-none-eabi-gcc", flags, place, ("qemu-arm", "-cpu", "max"), clock
    )


def _riscv(name: str, key: str, double: bool, march: str, abi: str, clock: float) -> Target:
    flags = (
        *(f"-march={march}", f"-mabi={abi}", "-mcmodel=medany"),
        *("-isystem", f"{_PICOLIBC}/include"),
    )
    libraries = f"{_PICOLIBC}/lib/{march.replace('gc', 'imafdc')}/{abi}"
    return Target(
        name,
        key,
        double,
        "riscv64-unknown-elf-gcc",
        flags,
        (f"-L{libraries}", *LIBRARIES),
        (f"qemu-{march[:4].replace('rv', 'riscv')}",),
        clock,
    )


TARGETS = (
    _arm("Cortex-M7 (double hardware)", "m7", True, "cortex-m7", "fpv5-d16", 480.0),
    _arm("Cortex-M4F (single only)", "m4f", False, "cortex-m4", "fpv4-sp-d16", 168.0),
    _riscv("RV64GC", "rv64gc", True, "rv64gc", "lp64d", 1000.0),
    _riscv("RV32IM (no floating point)", "rv32im", False, "rv32im", "ilp32", 100.0),
    Target(
        "Cortex-A53",
        "a53",
        True,
        "aarch64-linux-gnu-gcc",
        ("-mcpu=cortex-a53", "-fno-tree-loop-distribute-patterns"),
        (*LIBRARIES[:-1], "-lgcc_eh", LIBRARIES[-1]),
        ("qemu-aarch64",),
        1200.0,
        hosted=True,
    ),
)
"""In the order of the table."""

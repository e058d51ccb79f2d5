"""Processors: how to compile for each, and what runs it."""

from __future__ import annotations

import shutil
from dataclasses import dataclass, replace

FLAGS = "-ffp-contract=off -ffreestanding -ffunction-sections -fdata-sections".split()
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
        pairs: whether the library computes in pairs of floats (sculler_real.h).
        quick: whether code is to be quick rather than small, without hardware for doubles.
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
    pairs: bool = False
    quick: bool = False

    @property
    def optimised(self) -> tuple[str, ...]:
        """Without hardware for doubles an operation is a call: small code is what counts."""
        return ("-O2",) if self.double or self.quick else ("-Os",)

    @property
    def precision(self) -> tuple[str, ...]:
        """What a program that includes the library's headers is compiled with."""
        return ("-DSCULLER_DOUBLE_SINGLE",) if self.pairs else ()

    @property
    def language(self) -> tuple[str, ...]:
        """The library's own language."""
        return ("-x", "c++", "-std=gnu++11", "-fno-exceptions") if self.pairs else ("-std=gnu99",)

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


M4F = _arm("Cortex-M4F (single only)", "m4f", False, "cortex-m4", "fpv4-sp-d16", 168.0)
TARGETS = (
    _arm("Cortex-M7 (double hardware)", "m7", True, "cortex-m7", "fpv5-d16", 480.0),
    M4F,
    replace(M4F, name="Cortex-M4F, double-single", key="m4f-pairs", pairs=True),
    replace(M4F, name="the same, quick", key="m4f-pairs-quick", pairs=True, quick=True),
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

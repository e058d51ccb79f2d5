"""The firmware, compiled by a cross compiler."""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sculler.soc.plan import SocPlan
from sculler.soc.texts import firmware_texts
from sculler_model.errors import InputError
from sculler_sim import processes

PREFIX = "riscv64-unknown-elf-"
"""Of the cross compiler's programs."""

FLAGS = (
    "-msave-restore -march=rv32im -mabi=ilp32 -misa-spec=2.2 --specs=picolibc.specs -std=c99 -Os"
    " -ffp-contract=off -ffunction-sections -fdata-sections -Wall -Wextra -DSCULLER_ALIGN_PARTS=16u"
).split()
ALIGNMENT = ("sculler_align.c", "sculler_fine.c")
ESTIMATE = "sculler_noise.c"
"""Of the host in C's files, what a firmware calls only where it aligns; and what never."""

LINKING = "-nostartfiles -Wl,--gc-sections -T soc.ld -lm".split()


@dataclass(frozen=True)
class Firmware:
    """A compiled firmware.

    Attributes:
        elf: the program.
        hex: its words of 32 bits as $readmemh reads them.
        code: bytes of instructions and constants.
        variables: bytes of variables.
        compiler: its version.
    """

    elf: bytes
    hex: str
    code: int
    variables: int
    compiler: str


def makefile(plan: SocPlan) -> str:
    """NAME_soc.mk: compiles the firmware anew, and makes a bitstream for an ECP5."""
    name = plan.design.name
    own = " ".join(_sources(plan, firmware_texts(plan)))
    hardware = " ".join(f"{name}{part}.v" for part in ("", "_front", "_bus", "_unit"))
    sizes = " ".join(_sizes(plan))
    return f"""# {name}_soc, made by `sculler soc`:
#   make -f {name}_soc.mk {name}_firmware.hex   the firmware, after a change
#   make -f {name}_soc.mk                       the bitstream, with the tools of PyPI
#   ... PREFIX= PART="--85k --package CABGA381" PINS=my.lpf
CROSS ?= {PREFIX}
PREFIX ?= yowasp-
PART ?= --25k --package CABGA381
PINS ?=

{name}_soc.bit: {name}_soc.config
\t$(PREFIX)ecppack --compress $< $@

{name}_soc.config: {name}_soc_netlist.json $(PINS)
\t$(PREFIX)nextpnr-ecp5 $(PART) --freq {plan.clock_mhz:g} $(if $(PINS),--lpf $(PINS),\\
\t  --lpf-allow-unconstrained) --json $< --textcfg $@

# without the models of the part's blocks, which are for simulators
VERILOG := {hardware} VexRiscv.v {name}_soc.v
{name}_soc_netlist.json: $(VERILOG) {name}_firmware.hex
\t$(PREFIX)yosys -q -p "read_verilog $(VERILOG); synth_ecp5 -top {name}_soc -json $@"

{name}_firmware.hex: {name}_firmware.elf
\t$(CROSS)objcopy -O verilog --verilog-data-width=4 $< $@

FIRMWARE := {own}
{name}_firmware.elf: $(FIRMWARE) $(wildcard *.h) soc.ld
\t$(CROSS)gcc {" ".join(FLAGS)} \\
\t  $(FIRMWARE) {" ".join(LINKING)} \\
\t  {sizes} -o $@
"""


def _sources(plan: SocPlan, texts: Iterable[str]) -> list[str]:
    """Those of the files that are compiled."""
    without = {ESTIMATE, *(() if plan.align else ALIGNMENT)}
    return [file for file in texts if file.endswith((".c", ".S")) and file not in without]


def _sizes(plan: SocPlan) -> tuple[str, str]:
    """What the linker script asks for."""
    return (
        f"-Wl,--defsym=_memory_bytes={plan.memory * 1024}",
        f"-Wl,--defsym=_stack_bytes={plan.stack_bytes}",
    )


def require_compiler() -> None:
    """See that there is a cross compiler.

    Raises:
        InputError: there is none.
    """
    if shutil.which(f"{PREFIX}gcc") is None:
        raise InputError(
            f"the firmware needs {PREFIX}gcc with picolibc, not found on PATH: on Debian, apt-get"
            " install gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf"
        )


def compile_firmware(plan: SocPlan, registers: str) -> Firmware:
    """Compile a chip's firmware.

    Args:
        plan: of the chip.
        registers: the text of NAME_regs.h.

    Raises:
        InputError: the cross compiler is not installed, it fails, or the memory is too small.
    """
    require_compiler()
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        texts = {**firmware_texts(plan), f"{plan.design.name}_regs.h": registers}
        for file, text in texts.items():
            (work / file).write_text(text, encoding="utf-8")
        sources = _sources(plan, texts)
        _called(work, f"{PREFIX}gcc", *FLAGS, *sources, *LINKING, *_sizes(plan), "-o", "f.elf")
        _called(work, f"{PREFIX}objcopy", "-O", "binary", "f.elf", "f.bin")
        size = _called(work, f"{PREFIX}size", "f.elf").splitlines()[1].split()
        version = _called(work, f"{PREFIX}gcc", "--version").splitlines()[0]
        image = (work / "f.bin").read_bytes()
        words = np.frombuffer(image + bytes(-len(image) % 4), "<u4")
        text = "".join(f"{word:08x}\n" for word in words.tolist())
        elf = (work / "f.elf").read_bytes()
    return Firmware(elf, text, int(size[0]), int(size[2]), version)


def _called(work: Path, *command: str) -> str:
    (ended,) = processes.run([*command], folder=work)
    if ended.status:
        full = re.search(r"will not fit in region|no room for the stack|overflowed by", ended.said)
        if full:
            raise InputError("the firmware does not fit the memory, give a larger --memory")
        tail = " | ".join(line.strip() for line in ended.said.strip().splitlines()[-4:])
        raise InputError(f"{command[0]} failed ({ended.how}) on the firmware: {tail}")
    return ended.said

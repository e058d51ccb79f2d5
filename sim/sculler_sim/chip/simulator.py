"""Compiles a chip with its lines into a program, and runs it."""

from __future__ import annotations

import json
import platform
import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Literal

from sculler_model.errors import InputError
from sculler_model.front import Spi, Uart
from sculler_sim import processes
from sculler_sim.engines import cache
from sculler_sim.engines.verilator_build import Tools

RESET_CLOCKS = 16
READY_S = 20e-6
"""How long data-ready is high."""

_VERILATOR = (
    "--cc -O3 --x-assign fast --x-initial fast --no-assert --no-timing --make json --prefix Vchip"
    " --Mdir model -Wno-lint -Wno-style -Wno-fatal"
).split()
_COMPILER = "-std=c++17 -O2 -fno-tree-vectorize -pthread".split()
_PARITIES: dict[Literal["none", "even", "odd"], int] = {"none": 0, "odd": 1, "even": 2}


@dataclass(frozen=True)
class Chip:
    """A chip to simulate.

    Attributes:
        top: its module, with the ports clk and rst; other inputs but the sensor's stay low.
        verilog: texts by name of file.
        memory: files that it reads when it starts, by name.
        sensor: the line at `sensor_pin`; or SPI, at sck, cs_n, mosi, miso and data_ready.
        clock_hz: of clk.
        clocks_a_bit: of the line at `telemetry_pin`.
        sensor_pin, telemetry_pin: names of ports.
    """

    top: str
    verilog: Mapping[str, str]
    memory: Mapping[str, str]
    sensor: Uart | Spi
    clock_hz: float
    clocks_a_bit: int
    sensor_pin: str = "rx"
    telemetry_pin: str = "telemetry_tx"


@dataclass(frozen=True)
class Sent:
    """What a chip sent.

    Attributes:
        data: the bytes.
        clocks: of each byte the clock in which its start bit began; 0 is the first of the reset.
    """

    data: bytes
    clocks: tuple[int, ...]


def fly(chip: Chip, line: Iterable[tuple[int, ...]], clocks: int) -> Sent:
    """Run a chip from its reset on.

    Args:
        chip: the chip.
        line: bytes on the sensor's line: the clock in which the start bit begins, and the byte.
            Over SPI: the clock in which data-ready rises, and all bytes of the sample.
        clocks: how long.

    Raises:
        InputError: Verilator or a compiler is missing or fails, or the chip sent a byte without a
            stop bit.
    """
    program = _build(chip)
    with cache.workshop() as work:
        for name, text in chip.memory.items():
            (work / name).write_text(text, encoding="ascii")
        counted = isinstance(chip.sensor, Spi)
        rows = [(row[0], len(row) - 1, *row[1:]) if counted else row for row in line]
        text = "".join(" ".join(map(str, row)) + "\n" for row in rows)
        (work / "line.txt").write_text(text, encoding="ascii")
        _called(chip, [str(program), "line.txt", "sent.txt", str(clocks)], work)
        sent = [row.split() for row in (work / "sent.txt").read_text("ascii").splitlines()]
    if any(byte == "-1" for _, byte in sent):
        raise InputError(f"{chip.top}: a byte of its telemetry has no stop bit")
    return Sent(bytes(int(byte) for _, byte in sent), tuple(int(clock) for clock, _ in sent))


def _build(chip: Chip) -> Path:
    """The program, from the cache or newly built."""
    tools = Tools.find()
    harness = (
        resources.files("sculler_sim").joinpath("chip", "simulator.cpp").read_text(encoding="utf-8")
    )
    defines = [
        *_line(chip),
        f"-DTELEMETRY_PIN={chip.telemetry_pin}",
        f"-DCLOCKS_A_TELEMETRY_BIT={chip.clocks_a_bit}",
        f"-DRESET_CLOCKS={RESET_CLOCKS}",
    ]
    made_of = [tools.verilator_version, tools.compiler_version, platform.machine(), harness]
    flags = [*_VERILATOR, *_COMPILER, *defines]
    program = cache.entry(
        chip.top, ".chip", *made_of, *flags, *chip.verilog, *chip.verilog.values()
    )
    if program.exists():
        return program
    with cache.workshop() as work:
        for name, text in chip.verilog.items():
            (work / name).write_text(text, encoding="utf-8")
        (work / "simulator.cpp").write_text(harness, encoding="utf-8")
        verilator = [*tools.verilator, *_VERILATOR, "--top-module", chip.top, *chip.verilog]
        _called(chip, verilator, work, tools.environment)
        parts = json.loads((work / "model/Vchip.json").read_text("utf-8"))["sources"]
        sources = [path for kind in parts.values() for path in kind if path.endswith(".cpp")]
        whole = "".join(f'#include "{path}"\n' for path in [*sources, "simulator.cpp"])
        (work / "whole.cpp").write_text(whole, encoding="utf-8")
        include = ["-I.", "-Imodel", f"-I{tools.root}/include", f"-I{tools.root}/include/vltstd"]
        compiling = [*tools.compiler, *_COMPILER, *defines, *include]
        _called(chip, [*compiling, "whole.cpp", "-o", "chip"], work)
        (work / "chip").replace(program)
    return program


def _line(chip: Chip) -> list[str]:
    """What the harness is told of the sensor's wire."""
    wire = chip.sensor
    if isinstance(wire, Spi):
        ready = max(1, round(READY_S * chip.clock_hz))
        return [f"-DSENSOR_REQUESTS={','.join(map(str, wire.requests))}", f"-DREADY_CLOCKS={ready}"]
    return [
        f"-DSENSOR_PIN={chip.sensor_pin}",
        f"-DCLOCKS_A_SENSOR_BIT={chip.clock_hz / wire.baud!r}",
        f"-DSENSOR_PARITY={_PARITIES[wire.parity]}",
    ]


def _called(
    chip: Chip, command: list[str], work: Path, environment: Mapping[str, str] | None = None
) -> None:
    (ended,) = processes.run(command, folder=work, environment=environment)
    if ended.status:
        log = cache.folder() / f"{chip.top}-chip.log"
        log.write_text(f"{shlex.join(command)}\n{ended.said}", encoding="utf-8")
        raise InputError(
            f"{chip.top}: {Path(command[0]).name} failed ({ended.how}) in the simulation of the"
            f" chip, see {log}"
        )

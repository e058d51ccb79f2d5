"""The ports of every core, by name."""

from typing import NamedTuple

from amaranth import signed, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_model.design import AXES, STATUS_BITS, Design
from sculler_model.golden import COUNTER_BITS, PORT_MAJOR_BITS, WORD_BITS


class Port(NamedTuple):
    """A port: its name, its width, and whether it holds a signed number."""

    name: str
    bits: int
    signed: bool = False

    @property
    def shape(self) -> object:
        """For Amaranth; a single bit is just that."""
        if self.bits == 1:
            return 1
        return signed(self.bits) if self.signed else unsigned(self.bits)


def sample_ports(design: Design) -> list[Port]:
    """The ports that a sample stands on, in their order: the counts and the fault mark."""
    counts = [
        Port(f"sample_{sensor}_{axis}", getattr(design.words, sensor).bits, signed=True)
        for sensor in ("gyro", "accel")
        for axis in AXES
    ]
    return [*counts, Port("sample_fault", 1)]


def component_ports(design: Design) -> list[Port]:
    """The ports of a result's components, where all are shown at once."""
    return [
        Port(f"result_{vector}_{axis}", getattr(design.words, vector).bits, signed=True)
        for vector in design.vectors
        for axis in AXES
    ]


def result_ports(design: Design) -> list[Port]:
    """The ports that a result, or a word of it, stands on, in their order."""
    if design.hardware.handover == "stream":
        return [Port("result_data", WORD_BITS), Port("result_last", 1)]
    head = [Port("result_major", PORT_MAJOR_BITS), Port("result_status", STATUS_BITS)]
    return [*head, *component_ports(design)]


def counter_ports(design: Design) -> list[Port]:
    """The ports that count what was lost since reset."""
    names = ["samples_lost", *(["results_dropped"] if design.drops_results else [])]
    return [Port(name, COUNTER_BITS) for name in names]


def port_members(design: Design) -> dict[str, wiring.Member]:
    """Ports of the design's core in the order they stand in the Verilog; `clk` and `rst` apart."""
    return {
        "sample_valid": In(1),
        "sample_ready": Out(1),
        **{port.name: In(port.shape) for port in sample_ports(design)},
        "result_valid": Out(1),
        "result_ready": In(1),
        **{port.name: Out(port.shape) for port in result_ports(design)},
        **{port.name: Out(port.shape) for port in counter_ports(design)},
    }

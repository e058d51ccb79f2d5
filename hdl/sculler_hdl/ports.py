"""The ports of every core, by name."""

from amaranth import signed, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_model.cycles import PORT_MAJOR_BITS
from sculler_model.design import Design
from sculler_model.stream import WORD_BITS
from sculler_model.vectors import AXES


def port_members(design: Design) -> dict[str, wiring.Member]:
    """Ports of the design's core in the order they stand in the Verilog; `clk` and `rst` apart."""
    words = design.words
    members = {"sample_valid": In(1), "sample_ready": Out(1)}
    for sensor in ("gyro", "accel"):
        for axis in AXES:
            members[f"sample_{sensor}_{axis}"] = In(signed(getattr(words, sensor).bits))
    members |= {"sample_fault": In(1), "result_valid": Out(1), "result_ready": In(1)}
    if design.hardware.handover == "stream":
        return members | {"result_data": Out(unsigned(WORD_BITS)), "result_last": Out(1)}
    members |= {"result_major": Out(unsigned(PORT_MAJOR_BITS)), "result_status": Out(2)}
    for name in design.vectors:
        for axis in AXES:
            members[f"result_{name}_{axis}"] = Out(signed(getattr(words, name).bits))
    return members

"""Shapes that the parts share."""

from collections.abc import Sequence

from amaranth import Mux, Value, signed, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.plan.ports import Port, core_ports
from sculler_model.design import AXES, Design, Interval


def vector(interval: Interval) -> data.ArrayLayout:
    """Three signed components (x, y, z), each just wide enough for the interval."""
    return data.ArrayLayout(signed(interval.bits), 3)


def is_one_of(value: Value, choices: list[int]) -> Value:
    """1 where the value equals one of the choices."""
    return value.matches(*choices)


def chosen(number: Value, data: Sequence[Value]) -> Value:
    """The one of this number."""
    if len(data) == 1:
        return data[0]
    level = (len(data) - 1).bit_length() - 1
    return Mux(
        number[level], chosen(number, data[1 << level :]), chosen(number, data[: 1 << level])
    )


def core_members(design: Design) -> dict[str, wiring.Member]:
    """Ports of the design's core in the order they stand in the Verilog; `clk` and `rst` apart."""
    return {port.name: (Out if port.output else In)(shape_of(port)) for port in core_ports(design)}


def plain_members(design: Design) -> dict[str, wiring.Member]:
    """`core_members` without what hardening adds."""
    return {name: member for name, member in core_members(design).items() if name != "upset"}


def behind_members(design: Design) -> dict[str, wiring.Member]:
    """`plain_members` of a core behind compensation, which sees what is lost and counts that.

    Members besides:
        sample_rail (in): a count that the sample is made of stands at its rail.
        sample_lost (in): a sample was lost before it.
    """
    members = {n: member for n, member in plain_members(design).items() if n != "samples_lost"}
    return members | {"sample_rail": In(1), "sample_lost": In(1)}


def sample_counts(core: wiring.Component) -> dict[str, list[Value]]:
    """A core's ports of the counts, x, y and z of `gyro` and of `accel`."""
    return {
        sensor: [getattr(core, f"sample_{sensor}_{axis}") for axis in AXES]
        for sensor in ("gyro", "accel")
    }


def hand_counts(core: wiring.Component, part: wiring.Component) -> list[object]:
    """The counts at a core's ports to the members `gyro` and `accel` of a part of it."""
    return [
        getattr(part, sensor)[i].eq(port)
        for sensor, ports in sample_counts(core).items()
        for i, port in enumerate(ports)
    ]


def shape_of(port: Port) -> object:
    """The shape of a port's signal."""
    return signed(port.bits) if port.declared_signed else unsigned(port.bits)

"""The newest sample, in registers, for all that calculates with it."""

from __future__ import annotations

from amaranth import Module, Signal, Value

from sculler_hdl.lib.delay import APART, SkewedSignal
from sculler_hdl.plan.arrival import at_once
from sculler_hdl.plan.schedule import MINOR_CLOCK, TAP_CLOCK
from sculler_model.design import AXES

Counts = dict[str, list[SkewedSignal]]
"""The three counts of each sensor."""


class SampleRegisters:
    """Each count in two registers one behind the other, put into the core.

    Args:
        m: the core.
        ports: the sample's counts by sensor.

    Attributes:
        first: the counts at `TAP_CLOCK`, for A and B and the rails.
        second: the counts at `MINOR_CLOCK`, for all else.
    """

    def __init__(self, m: Module, ports: dict[str, list[Value]]) -> None:
        self.first: Counts = {}
        self.second: Counts = {}
        for sensor, counts in ports.items():
            self.first[sensor], self.second[sensor] = [], []
            for axis, count in zip(AXES, counts, strict=True):
                name, bits = f"{sensor}_{axis}", len(count)
                register = Signal(bits, name=f"{name}_sample", reset_less=True)
                m.d.sync += register.eq(count)
                self.first[sensor].append(
                    SkewedSignal(m, f"{name}_sample", register, at_once(bits, TAP_CLOCK))
                )
                # `WeightedSum` has an equal one: one could not stand near all that reads it
                apart = Signal(bits, name=name, reset_less=True, attrs=APART)
                m.d.sync += apart.eq(register)
                self.second[sensor].append(SkewedSignal(m, name, apart, at_once(bits, MINOR_CLOCK)))

    def at_clock(self, sensor: str, clock: int) -> list[Value]:
        """A sensor's three counts at a clock; emits the registers that they wait in."""
        held = self.first if clock == TAP_CLOCK else self.second
        return [word.at_clock(clock) for word in held[sensor]]

"""Delay lines that bring pipeline branches of unequal latency together."""

from amaranth import Module, Signal
from amaranth.hdl import ShapeLike
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out


class Delay(wiring.Component):
    """`output` is `input` as it was `latency` clocks ago.

    Args:
        shape: shape of both ports.
        latency: clocks, 0 (a wire) or more.
        resets: True for flags, which reset must clear; data may keep its old content.
    """

    def __init__(self, shape: ShapeLike, latency: int, *, resets: bool = False) -> None:
        self.shape = shape
        self.latency = latency
        self.resets = resets
        super().__init__({"input": In(shape), "output": Out(shape)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        stage = self.input
        for clock in range(self.latency):
            register = Signal(self.shape, name=f"stage{clock + 1}", reset_less=not self.resets)
            m.d.sync += register.eq(stage)
            stage = register
        m.d.comb += self.output.eq(stage)
        return m

"""Exact signed multiplication."""

from amaranth import Module, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_model.wordlength import Interval


class Multiplier(wiring.Component):
    """output = left * right, exact, as wide as the product of the ranges.

    Registers before, behind and once inside, for the synthesiser to place in its multiplier
    blocks.  Latency 3, one product per clock.

    Args:
        left, right: ranges of the operands.
    """

    latency = 3

    def __init__(self, left: Interval, right: Interval) -> None:
        self.result = left * right
        super().__init__(
            {
                "left": In(signed(left.bits)),
                "right": In(signed(right.bits)),
                "output": Out(signed(self.result.bits)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        left = Signal.like(self.left, name="left_reg", reset_less=True)
        right = Signal.like(self.right, name="right_reg", reset_less=True)
        inside = Signal.like(self.output, name="inside_reg", reset_less=True)
        product = Signal.like(self.output, name="product_reg", reset_less=True)
        m.d.sync += [
            left.eq(self.left),
            right.eq(self.right),
            inside.eq(left * right),
            product.eq(inside),
        ]
        m.d.comb += self.output.eq(product)
        return m

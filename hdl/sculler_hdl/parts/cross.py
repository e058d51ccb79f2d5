"""Sums of cross products."""

from amaranth import Module, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.layout import vector
from sculler_hdl.parts.multiply import Multiplier
from sculler_model.wordlength import ZERO, Interval, cross


def cross_latency(pairs: int) -> int:
    """Clocks of a sum of `pairs` cross products: multiply, subtract, and add if there are two."""
    return Multiplier.latency + pairs


class CrossSum(wiring.Component):
    """output = left0 x right0 (+ left1 x right1), exact, six multipliers a product.

    Members are left0, right0, left1, right1, output; vectors of three.

    Latency: `cross_latency`; one sum per clock.

    Args:
        pairs: the operands' ranges, one or two pairs.
    """

    def __init__(self, *pairs: tuple[Interval, Interval]) -> None:
        if len(pairs) not in (1, 2):
            raise ValueError(f"CrossSum takes one or two pairs, not {len(pairs)}")
        self.pairs = pairs
        self.products = [cross(left, right) for left, right in pairs]
        self.result = sum(self.products, ZERO)
        self.latency = cross_latency(len(pairs))
        members = {}
        for i, (left, right) in enumerate(pairs):
            members[f"left{i}"] = In(vector(left))
            members[f"right{i}"] = In(vector(right))
        super().__init__({**members, "output": Out(vector(self.result))})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        for axis, name in enumerate("xyz"):
            j, k = (axis + 1) % 3, (axis + 2) % 3
            differences = []
            for i, (left, right) in enumerate(self.pairs):
                a, b = getattr(self, f"left{i}"), getattr(self, f"right{i}")
                forward, backward = Multiplier(left, right), Multiplier(left, right)
                m.submodules[f"forward{i}_{name}"] = forward
                m.submodules[f"backward{i}_{name}"] = backward
                difference = Signal(
                    signed(self.products[i].bits), name=f"difference{i}_{name}", reset_less=True
                )
                m.d.comb += [
                    forward.left.eq(a[j]),
                    forward.right.eq(b[k]),
                    backward.left.eq(a[k]),
                    backward.right.eq(b[j]),
                ]
                m.d.sync += difference.eq(forward.output - backward.output)
                differences.append(difference)
            total = differences[0]
            if len(differences) == 2:
                total = Signal(signed(self.result.bits), name=f"total_{name}", reset_less=True)
                m.d.sync += total.eq(differences[0] + differences[1])
            m.d.comb += self.output[axis].eq(total)
        return m

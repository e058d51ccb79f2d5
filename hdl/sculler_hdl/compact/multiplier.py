"""One exact signed 18 x 18 product, by whatever the target has."""

from __future__ import annotations

from amaranth import C, Cat, Module, Mux, Signal, Value, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.multiplier_block import MultiplierBlock
from sculler_hdl.plan.compact.digits import OPERAND
from sculler_hdl.plan.compact.plan import CompactPlan

BITS = OPERAND.bits


class DigitMultiplier(wiring.Component):
    """output = left * right, `latency` = `Pipeline.product` steps later.

    Members:
        step (in): the operands are new in the next clock.  Without a multiplier block they must
            then stay for all of `Pipeline.step` clocks, in the last of which the product stands.
        left, right (in), output (out): signed.

    Args:
        plan: the plan.
        primitive: whether to instantiate the target's own multiplier block.

    Attributes:
        latency: steps from the operands to their product.
    """

    def __init__(self, plan: CompactPlan, *, primitive: bool = True) -> None:
        self.plan = plan
        self.primitive = primitive
        self.latency = plan.pipeline.product
        super().__init__(
            {
                "step": In(1),
                "left": In(signed(BITS)),
                "right": In(signed(BITS)),
                "output": Out(signed(2 * BITS)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        target = self.plan.target
        if self.plan.serial:
            self._serial(m)
        elif min(target.multiplier_bits) >= BITS:
            m.submodules.tile = tile = MultiplierBlock(target, BITS, BITS, primitive=self.primitive)
            m.d.comb += [
                tile.left.eq(self.left),
                tile.right.eq(self.right),
                self.output.eq(tile.output),
            ]
        else:
            self._with_residue(m)
        return m

    def _with_residue(self, m: Module) -> None:
        """The block takes the operands' high parts; the f low bits of both are added beside it.

        With left = 2^f l + i, right = 2^f r + j:  left * right = 2^(2 f) l r + 2^f l j + i right.
        """
        target = self.plan.target
        high = min(target.multiplier_bits)
        f = BITS - high
        m.submodules.tile = tile = MultiplierBlock(target, high, high, primitive=self.primitive)
        m.d.comb += [
            tile.left.eq(self.left[f:].as_signed()),
            tile.right.eq(self.right[f:].as_signed()),
        ]
        rows = [Signal(signed(BITS + f), name=f"row{i}", reset_less=True) for i in range(2)]
        fringe = [
            Signal(signed(BITS + 2 * f), name=f"fringe{i}", reset_less=True) for i in range(2)
        ]
        m.d.sync += [
            rows[0].eq(_rows(self.left[f:].as_signed(), self.right, f)),
            rows[1].eq(_rows(self.right, self.left, f)),
            fringe[0].eq(Cat(C(0, f), rows[0]).as_signed() + rows[1]),
            fringe[1].eq(fringe[0]),
        ]
        low = 2 * f
        product = Signal(signed(2 * BITS), reset_less=True)
        whole = (tile.output + fringe[1][low:].as_signed())[: 2 * BITS - low]
        m.d.sync += product.eq(Cat(fringe[1][:low], whole))
        m.d.comb += self.output.eq(product)

    def _serial(self, m: Module) -> None:
        """Shift and add, a bit of `right` per clock, lowest first; the top bit counts negative."""
        load = Signal()
        last = Signal()
        count = Signal(range(BITS + 1))
        product = Signal(2 * BITS, reset_less=True)
        high = product[BITS:].as_signed()
        row = Mux(product[0], Mux(last, ~self.left, self.left), 0)
        total = (high + row + (last & product[0]))[: BITS + 1]
        m.d.comb += [
            last.eq(count == BITS - 1),
            self.output.eq(product.as_signed()),
        ]
        m.d.sync += load.eq(self.step)
        with m.If(load):
            m.d.sync += [product.eq(self.right.as_unsigned()), count.eq(0)]
        with m.Elif(count != BITS):
            m.d.sync += [product.eq(Cat(product[1:BITS], total)), count.eq(count + 1)]


def _rows(value: Value, bits: Value, count: int) -> Value:
    """value * the `count` lowest bits of `bits`, unsigned."""
    total: Value = C(0)
    for bit in range(count):
        total = total + Mux(bits[bit], Cat(C(0, bit), value).as_signed(), 0)
    return total

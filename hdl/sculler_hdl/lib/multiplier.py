"""Exact products of any widths from multiplier blocks of fixed width."""

from __future__ import annotations

from amaranth import C, Cat, Module, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.adder_tree import emit_adder_tree
from sculler_hdl.lib.delay import SkewedSignal
from sculler_hdl.lib.multiplier_block import MultiplierBlock
from sculler_hdl.plan.adder_tree import AdderTreePlan
from sculler_hdl.plan.arrival import Limbs, spans
from sculler_hdl.plan.multiplier import MultiplierPlan


class Multiplier(wiring.Component):
    """output = left * right, exact.

    The cores put the blocks and rows of many products into one module (`emit_multiplier`) and add
    them all up in one tree.

    Members:
        left, right: the operands, signed, as `plan.left_arrival` and `plan.right_arrival` say.
        output: the product, signed, as `arrival` says.

    One product per clock.

    Args:
        plan: the plan.
        limb: how sums are cut.
        primitive: whether to instantiate the target's multiplier blocks.

    Attributes:
        arrival: when the bits of the product are there: 4 clocks for a block and its way, then the
            additions.
    """

    def __init__(self, plan: MultiplierPlan, limb: Limbs, *, primitive: bool = True) -> None:
        self.plan = plan
        self.primitive = primitive
        self.tree = AdderTreePlan(plan.addends, plan.left * plan.right, limb)
        self.arrival = self.tree.arrival
        super().__init__(
            {
                "left": In(plan.left.bits),
                "right": In(plan.right.bits),
                "output": Out(self.tree.result.bits),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        left = SkewedSignal(m, "left", self.left, plan.left_arrival)
        right = SkewedSignal(m, "right", self.right, plan.right_arrival)
        terms = emit_multiplier(m, "unit", plan, left, right, primitive=self.primitive)
        m.d.comb += self.output.eq(emit_adder_tree(m, "product", self.tree, terms).value)
        return m


def emit_multiplier(
    m: Module,
    name: str,
    plan: MultiplierPlan,
    left: SkewedSignal,
    right: SkewedSignal,
    *,
    primitive: bool,
    read: int | None = None,
) -> list[Value]:
    """Put a product's blocks and rows into a module; the values of `plan.addends`.

    Args:
        m: the module.
        name: of the product.
        plan: its plan.
        left, right: the operands.
        primitive: whether to instantiate the target's multiplier blocks.
        read: bits of the product that are added up, where that is to be told in the names of
            registers that have more, for linters to let them pass.
    """
    blocks = _emit_blocks(m, name, plan, left, right, primitive=primitive, read=read)
    return [*blocks, *_emit_rows(m, name, plan, left, right)]


def _emit_blocks(
    m: Module,
    name: str,
    plan: MultiplierPlan,
    left: SkewedSignal,
    right: SkewedSignal,
    *,
    primitive: bool,
    read: int | None,
) -> list[Value]:
    values: list[Value] = []
    names = plan.block_names(name)
    for block_name, (a, b), addend in zip(names, plan.piece_pairs, plan.addends, strict=False):
        clock = plan.block_clock(a, b)
        first, second = _operand(left, *a, clock), _operand(right, *b, clock)
        if plan.turned:
            first, second = second, first
        m.submodules[block_name] = block = MultiplierBlock(
            plan.target, len(first), len(second), addend.range.bits, primitive=primitive
        )
        m.d.comb += [block.left.eq(first), block.right.eq(second)]
        # the block may stand far from the adder: the way there has a clock of its own
        more = read is not None and addend.low + len(block.output) > read
        register_name = f"{block_name}_product{'_unused_above' * more}"
        behind = Signal.like(block.output, name=register_name, reset_less=True)
        m.d.sync += behind.eq(block.output)
        values.append(behind)
    return values


def _emit_rows(
    m: Module, name: str, plan: MultiplierPlan, left: SkewedSignal, right: SkewedSignal
) -> list[Value]:
    """A row of AND gates for each bit of the residues, behind registers."""
    values: list[Value] = []
    for word, other, low, residue in (
        (left, right, 0, plan.left_split.residue),
        (right, left, plan.left_split.residue, plan.right_split.residue),
    ):
        for bit in range(residue):
            number = plan.block_count + len(values)
            row: list[Value] = []
            for first, end, clock in spans(plan.addends[number].arrival, low):
                gate = word.slice_at(bit, bit + 1, clock - 1)
                bits, row_name = end - first, f"{name}_row{number}_{first}"
                part = Signal(bits, name=row_name, reset_less=True)
                # not a Mux with 0: synthesis would make it a reset, one wire to all the row
                gated = other.slice_at(first, end, clock - 1) & gate.replicate(bits)
                m.d.sync += part.eq(gated)
                row.append(part)
            values.append(Cat(*row))
    return values


def _operand(word: SkewedSignal, lo: int, hi: int, clock: int) -> Value:
    """A piece as a signed operand."""
    bits = word.slice_at(lo, hi, clock)
    return bits if hi == len(word.value) else Cat(bits, C(0, 1))

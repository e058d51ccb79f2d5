"""One multiplier block."""

from typing import Any

from amaranth import ClockSignal, Const, Instance, Module, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.plan.multiplier import BLOCK_LATENCY
from sculler_hdl.targets import Target


class MultiplierBlock(wiring.Component):
    """output = left * right, exact, in one multiplier block of the target.

    Registers before, inside and behind the multiplier; they are not reset.

    Latency 3, one product per clock.

    Args:
        target: whose block it is.
        left_bits, right_bits: widths of the signed operands, at most `target.multiplier_bits`.
        product_bits: low bits of the product to give; None for all.
        primitive: whether to instantiate the block where the target has one of its own.  False
            gives the same behaviour by inference, for simulators that run no instances.

    Raises:
        ValueError: an operand wider than the block's.
    """

    latency = BLOCK_LATENCY

    def __init__(
        self,
        target: Target,
        left_bits: int,
        right_bits: int,
        product_bits: int | None = None,
        *,
        primitive: bool = True,
    ) -> None:
        if left_bits > target.multiplier_bits[0] or right_bits > target.multiplier_bits[1]:
            raise ValueError(f"{left_bits} x {right_bits} bits do not fit {target}")
        self.target = target
        self.primitive = primitive
        super().__init__(
            {
                "left": In(signed(left_bits)),
                "right": In(signed(right_bits)),
                "output": Out(signed(product_bits or left_bits + right_bits)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        cell = self.target.multiplier_cell
        if cell is not None and self.primitive:
            left, right = (
                Signal(signed(bits), name=name)
                for bits, name in zip(
                    self.target.multiplier_bits, ("block_left", "block_right"), strict=True
                )
            )
            # linters let pass what is called unused
            product = Signal(signed(sum(self.target.multiplier_bits)), name="product_unused_above")
            m.d.comb += [
                left.eq(self.left),
                right.eq(self.right),
                self.output.eq(product[: len(self.output)]),
            ]
            given = product
            if cell in _WITHOUT_PIPELINE:
                given = Signal.like(product, name="block_product_unused_above")
                later = Signal.like(self.output, name="later", reset_less=True)
                m.d.sync += later.eq(given[: len(later)])
                m.d.comb += product[: len(later)].eq(later)
            m.submodules.dsp = _CELLS[cell](left, right, given)
            return m
        left = Signal.like(self.left, name="left_reg", reset_less=True)
        right = Signal.like(self.right, name="right_reg", reset_less=True)
        inside = Signal.like(self.output, name="inside_reg", reset_less=True)
        product = Signal.like(self.output, name="product_reg", reset_less=True)
        m.d.sync += [
            left.eq(self.left),
            right.eq(self.right),
            inside.eq((left * right)[: len(inside)]),
            product.eq(inside),
        ]
        m.d.comb += self.output.eq(product)
        return m


def _mult18x18d(left: Signal, right: Signal, product: Signal) -> Instance:
    ports: dict[str, Any] = {}
    for prefix, value in (("i_A", left), ("i_B", right), ("o_P", product)):
        ports |= {f"{prefix}{bit}": value[bit] for bit in range(len(value))}
    # What is left open is unknown to a simulator.  SRIA and SRIB alone stay so: nothing but a
    # neighbour's outputs can be routed to them, not even a constant, and SOURCE* turns them off.
    unused = [f"{kind}{number}" for kind in ("CLK", "CE", "RST") for number in (1, 2, 3)]
    unused += [f"C{bit}" for bit in range(18)]
    ports |= {f"i_{name}": Const(0) for name in unused}
    registers = ("INPUTA", "INPUTB", "PIPELINE", "OUTPUT")
    return Instance(
        "MULT18X18D",
        **{f"p_REG_{register}_CLK": "CLK0" for register in registers},
        i_CLK0=ClockSignal(),
        i_CE0=Const(1),
        i_RST0=Const(0),
        i_SIGNEDA=Const(1),
        i_SIGNEDB=Const(1),
        i_SOURCEA=Const(0),
        i_SOURCEB=Const(0),
        **ports,
    )


def _sb_mac16(left: Signal, right: Signal, product: Signal) -> Instance:
    used = Const(1, 1)
    registers = (
        "A_REG",
        "B_REG",
        "TOP_8x8_MULT_REG",
        "BOT_8x8_MULT_REG",
        "PIPELINE_16x16_MULT_REG1",
        "PIPELINE_16x16_MULT_REG2",
    )
    # what is left open is unknown to a simulator
    unused = "AHOLD BHOLD CHOLD DHOLD IRSTTOP IRSTBOT ORSTTOP ORSTBOT OLOADTOP OLOADBOT"
    unused += " OHOLDTOP OHOLDBOT ADDSUBTOP ADDSUBBOT CI ACCUMCI SIGNEXTIN"
    return Instance(
        "SB_MAC16",
        **{f"p_{register}": used for register in registers},
        p_A_SIGNED=used,
        p_B_SIGNED=used,
        p_TOPOUTPUT_SELECT=Const(3, 2),  # the multiplier's last register
        p_BOTOUTPUT_SELECT=Const(3, 2),
        i_CLK=ClockSignal(),
        i_CE=Const(1),
        i_A=left,
        i_B=right,
        i_C=Const(0, 16),
        i_D=Const(0, 16),
        **{f"i_{name}": Const(0) for name in unused.split()},
        o_O=product,
    )


def _multpreadd18x18(left: Signal, right: Signal, product: Signal) -> Instance:
    """The one of Nexus' blocks that no other maker's block is called like; it adds 0 to `right`."""
    registers = ("INPUTA", "INPUTB", "INPUTC", "OUTPUT")
    operands = ("A", "B", "C")
    return Instance(
        "MULTPREADD18X18",
        **{f"p_REG{register}": "REGISTER" for register in registers},
        i_A=left,
        i_B=right,
        i_C=Const(0, 18),
        i_CLK=ClockSignal(),
        **{f"i_SIGNED{operand}": Const(1) for operand in operands},
        **{f"i_CE{name}": Const(1) for name in (*operands, "OUT")},
        **{f"i_RST{name}": Const(0) for name in (*operands, "OUT")},
        o_Z=product,
    )


def _mult18x18(left: Signal, right: Signal, product: Signal) -> Instance:
    used = Const(1, 1)
    registers = ("AREG", "BREG", "OUT_REG", "PIPE_REG", "ASIGN_REG", "BSIGN_REG")
    return Instance(
        "MULT18X18",
        **{f"p_{register}": used for register in registers},
        i_A=left,
        i_B=right,
        i_SIA=Const(0, 18),
        i_SIB=Const(0, 18),
        i_ASIGN=Const(1),
        i_BSIGN=Const(1),
        i_ASEL=Const(0),
        i_BSEL=Const(0),
        i_CE=Const(1),
        i_CLK=ClockSignal(),
        i_RESET=Const(0),
        o_DOUT=product,
    )


_CELLS = {
    "MULT18X18D": _mult18x18d,
    "SB_MAC16": _sb_mac16,
    "MULTPREADD18X18": _multpreadd18x18,
    "MULT18X18": _mult18x18,
}
"""By `Target.multiplier_cell`."""

_WITHOUT_PIPELINE = frozenset({"MULTPREADD18X18"})
"""Blocks without a register inside the multiplier: one more behind them makes up the clocks."""

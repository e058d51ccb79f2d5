"""Addition and subtraction of skewed words, cut into limbs."""

from __future__ import annotations

from collections.abc import Callable

from amaranth import C, Cat, Module, Signal, Value

from sculler_hdl.lib.delay import SkewedSignal
from sculler_hdl.plan.arrival import Limbs, limbs


def add(
    left: SkewedSignal,
    right: SkewedSignal,
    name: str,
    top: int,
    clock: int,
    limb: Limbs,
    *,
    subtract: bool = False,
    carry: Value | None = None,
    step: Callable[[int], Value] | None = None,
    clear: Callable[[int], Value] | None = None,
    also: Callable[[int, int, int, Value], None] | None = None,
) -> SkewedSignal:
    """left + right or left - right, modulo 2^top, in registers that are put into left's module.

    The limb that is worked on q clocks after limb 0 is there at `clock` + q + 1.

    Args:
        left, right: the operands; bits that are worked on q clocks later are there at `clock` + q.
        name: for the registers.
        top: end bit of the result; its lowest, where limb 0 starts, is the lower of the operands'.
        clock: at which limb 0 is added.
        limb: how the sum is cut.
        subtract: the difference instead.
        carry: added, or if `subtract` taken away, at the lowest bit where the operands meet.
        step: the limb of q clocks later is taken only where step(q) is 1, else kept; it starts from
            0 and is reset.
            Without it a sum is taken at every clock.
        clear: where clear(q) is 1 that limb becomes 0 instead, with its carry.
        also: told (q, first bit, end bit, bits) of each limb, as it goes into its register: for
            another register that takes it at the same clock.
    """
    m = left.m
    low = min(left.low, right.low)
    start = right.low if subtract else max(left.low, right.low)
    lower = left if subtract or left.low <= right.low else right
    pieces: list[Value] = []
    arrival: list[tuple[int, int]] = []
    for q, first, end in limbs(top - low, limb):
        lo, hi, now = low + first, low + end, clock + q
        begin = min(max(lo, start), hi)
        bits = [lower.slice_at(lo, begin, now)] if lo < begin else []
        more = int(begin < hi < top)  # a carry goes on
        if begin < hi:
            x, y = left.slice_at(begin, hi, now), right.slice_at(begin, hi, now)
            bits.append(_sum(m, f"{name}_{q}", x, y, more, subtract=subtract, carry=carry))
        piece = Signal(hi - lo + more, name=f"{name}_{q}", reset_less=step is None)
        if step is None:
            m.d.sync += piece.eq(Cat(*bits))
        else:
            with m.If(step(q)):
                m.d.sync += piece.eq(Cat(*bits))
        if clear is not None:
            with m.If(clear(q)):
                m.d.sync += piece.eq(0)
        if also is not None:
            also(q, lo, hi, Cat(*bits)[: hi - lo])
        pieces.append(piece[: hi - lo])
        carry = piece[-1] if more else None
        for _ in range(1, limb.clocks if more else 1):
            before, carry = carry, Signal(name=f"{name}_{q}_carry", reset_less=True)
            m.d.sync += carry.eq(before)
        arrival.append((hi - lo, now + 1))
    return SkewedSignal(m, name, Cat(*pieces), tuple(arrival), low)


def _sum(
    m: Module, name: str, x: Value, y: Value, more: int, *, subtract: bool, carry: Value | None
) -> Value:
    """One limb of the sum, with `more` = 1 its carry on top."""
    bits = len(x) + more
    if carry is None:
        return (x - y if subtract else x + y)[:bits]
    # a bit below makes it: 1 + carry, or 0 - carry
    x, y = Cat(C(not subtract, 1), x), Cat(carry, y)
    made = x - y if subtract else x + y
    # linters let pass what is called unused
    total = Signal(made.shape(), name=f"{name}_unused_below")
    m.d.comb += total.eq(made)
    return total[1 : 1 + bits]

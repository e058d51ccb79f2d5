"""Words that are held from sample to sample, or shown in some samples only."""

from __future__ import annotations

from amaranth import Cat, Mux, Signal, Value

from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.plan.arrival import spans


def emit_previous(word: SkewedSignal, step: ControlDelay) -> Value:
    """The word of the sample before, at the clocks at which the word's bits are there."""
    pieces = []
    for lo, hi, clock in spans(word.arrival):
        register = Signal(hi - lo, name=f"{word.name}_previous_{lo}")
        with word.m.If(step.at_clock(clock)):
            word.m.d.sync += register.eq(word.value[lo:hi])
        pieces.append(register)
    return Cat(*pieces)


def emit_gated(flag: ControlDelay, word: SkewedSignal, *, level: int = 1) -> Value:
    """The word, a clock later, in samples with the flag, or without it if `level` is 0; else 0."""
    pieces = []
    for lo, hi, clock in spans(word.arrival):
        name = f"{word.name}_{flag.name}{level}_{lo}"
        register = Signal(hi - lo, name=name, reset_less=True)
        bits = word.value[lo:hi]
        choices = (bits, 0) if level else (0, bits)
        word.m.d.sync += register.eq(Mux(flag.at_clock(clock), *choices))
        pieces.append(register)
    return Cat(*pieces)

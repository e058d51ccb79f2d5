"""Whether a count stands at its rail, the end of its range."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from amaranth import Cat, Module, Signal, Value

from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.plan.schedule import RAIL_CLOCK, TAP_CLOCK


def emit_rail(
    m: Module,
    samples: Mapping[str, Sequence[SkewedSignal]],
    taken: ControlDelay,
    ended: ControlDelay,
) -> Value:
    """At `RAIL_CLOCK`: a count of the interval so far, this sample included, is at a rail.

    There every bit of it differs from its sign.  This is found in small steps, for the counts
    stand far apart.

    Args:
        m: the core.
        samples: the counts of each sensor, there at `TAP_CLOCK`.
        taken, ended: a sample is taken; it is its major interval's last.
    """
    return _of_interval(m, emit_newest_rail(m, samples), taken, ended)


def emit_newest_rail(m: Module, samples: Mapping[str, Sequence[SkewedSignal]]) -> Value:
    """At `TAP_CLOCK` + 3: a count of the sample is at a rail.

    Args:
        m: the core.
        samples: as for `emit_rail`.
    """
    sensors = []
    for sensor, words in samples.items():
        whole: list[Value] = []  # at TAP_CLOCK + 2, some for each count
        for word in words:
            *bits, sign = word.at_clock(TAP_CLOCK)
            few = [
                _held(m, f"{word.name}_rail{i}", Cat(bit != sign for bit in bits[i : i + 3]))
                for i in range(0, len(bits), 3)
            ]
            parts = [
                _held(m, f"{word.name}_rails{i}", Cat(few[i : i + 4]))
                for i in range(0, len(few), 4)
            ]
            whole.append(Cat(parts).all())
        sensors.append(Signal(name=f"{sensor}_at_rail"))
        m.d.sync += sensors[-1].eq(Cat(whole).any())
    return Cat(sensors).any()


def emit_told_rail(m: Module, told: Value, taken: ControlDelay, ended: ControlDelay) -> Value:
    """The same where the sample comes with its own mark of that, at clock 0.

    Args:
        m: the core.
        told: a count that the sample is made of is at a rail.
        taken, ended: as for `emit_rail`.
    """
    newest = SkewedSignal(m, "told_rail", told, ((1, 0),)).at_clock(RAIL_CLOCK - 2)
    return _of_interval(m, newest, taken, ended)


def _of_interval(m: Module, at_rail: Value, taken: ControlDelay, ended: ControlDelay) -> Value:
    """At `RAIL_CLOCK`, of the interval so far; of its newest sample two clocks before."""
    newest, rail = Signal(name="newest_at_rail"), Signal(name="rail")
    m.d.sync += [
        newest.eq(at_rail & taken.at_clock(RAIL_CLOCK - 2)),
        rail.eq(newest | (rail & ~ended.at_clock(RAIL_CLOCK))),
    ]
    return rail


def _held(m: Module, name: str, bits: Value) -> Value:
    """Whether all bits are 1, a clock later."""
    held = Signal(name=name, reset_less=True)
    m.d.sync += held.eq(bits.all())
    return held

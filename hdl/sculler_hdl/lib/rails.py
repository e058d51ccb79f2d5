"""Whether a count that comes one after the other is at a rail."""

from __future__ import annotations

from amaranth import Cat, Signal, Value

from sculler_model.design import WordLengths


def differ_from_sign(count: Signal, is_gyro: Value, words: WordLengths) -> list[Value]:
    """Whether each three bits of a count differ from its sign: at a rail all do.

    Args:
        count: signed, as wide as the wider sensor's; the sign fills up a narrower one.
        is_gyro: it is a gyro's.
        words: widths of the sensors' counts.
    """
    *bits, sign = count
    found = []
    for first in range(0, len(bits), 3):
        differ = Value.cast(1)
        for place in range(first, min(first + 3, len(bits))):
            beyond = [is_gyro] * (place >= words.gyro.bits - 1)
            beyond += [~is_gyro] * (place >= words.accel.bits - 1)
            differ &= Cat(bits[place] != sign, *beyond).any()
        found.append(differ)
    return found

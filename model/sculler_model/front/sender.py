"""The sensor's side of a wire: frames from numbers."""

from __future__ import annotations

from collections.abc import Sequence

from sculler_model.front.layout import Layout, Number


def frame_of(
    layout: Layout,
    gyro: Sequence[int],
    accel: Sequence[int],
    number: int,
    fault: bool = False,
) -> bytes:
    """A whole frame as the sensor would send it, of the first kind that holds a sample.

    `Receiver` reads it back.  What the layout does not tell of is 0.

    Args:
        layout: of the sensor.
        gyro, accel: x, y, z, in LSB.
        number: of the sample, from 0; the counter shows it.
        fault: raise the first status flag, where there is one.

    Raises:
        ValueError: a count does not fit the frame.
    """
    kind = next(kind for kind in layout.kinds if kind.sample)
    frame = bytearray(kind.length)
    frame[: len(kind.first)] = kind.first
    for place, value in zip((*layout.gyro, *layout.accel), (*gyro, *accel), strict=True):
        _put(frame, place, value)
    if layout.counter is not None:
        count = number * layout.counter.step % layout.counter.modulus
        _put(frame, layout.counter.number, count)
    for flags in (*layout.absent, *layout.faults):
        frame[flags.place] |= flags.normal & flags.mask
    if fault and layout.faults:
        first = layout.faults[0]
        frame[first.place] ^= first.mask & -first.mask
    check = layout.check
    if check is not None:
        covered = bytes(frame[check.first : kind.length + check.last + 1]) + bytes(kind.zeros)
        _put(frame, check.given, check.of(covered))
    return bytes(frame)


def _put(frame: bytearray, number: Number, value: int) -> None:
    """Write a number, bits that stand in its bytes already kept."""
    signed = value < 0
    if signed and not number.signed:
        raise ValueError(f"{value} in a number without sign")
    try:
        content = value.to_bytes(len(number.places), "big", signed=number.signed)
    except OverflowError as error:
        raise ValueError(f"{value} does not fit {number.bits} bits") from error
    for place, byte in zip(number.places, content, strict=True):
        frame[place] |= byte

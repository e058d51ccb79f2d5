"""The design file's [hardware.front.frame]: a sensor's own frame."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from sculler_model.front import Check, Counter, Flags, Kind, Layout, Number
from sculler_model.schema import Part

LONGEST = 256
"""Bytes of a frame."""

Endian = Literal["big", "little", "little-words"]
_ENDIAN = '"big", "little" or "little-words" (16-bit words, the low one first, each big)'
_Place = Annotated[int, Field(ge=0, lt=LONGEST, description="a byte of the frame, 0 to 255")]
_Byte = Annotated[int, Field(ge=0, le=255, description="a number from 0 to 255")]


def _number(byte: int, size: int, endian: Endian, signed: bool) -> Number:
    places = list(range(byte, byte + size))
    if endian == "little":
        places.reverse()
    elif endian == "little-words":
        words = [places[begin : begin + 2] for begin in range(0, size, 2)]
        places = [place for word in reversed(words) for place in word]
    return Number(tuple(places), signed)


class AxesField(Part):
    """Where the counts of a sensor stand.

    Attributes:
        at: first byte of x, y, z.
        bytes: of each.
        endian: order of the bytes.
        signed: two's complement; else without sign.
    """

    at: Annotated[
        list[_Place],
        Field(min_length=3, max_length=3, description="three bytes of the frame, of x, y, z"),
    ]
    bytes: Annotated[int, Field(ge=1, le=4, description="a whole number from 1 to 4")]
    endian: Annotated[Endian, Field(description=_ENDIAN)] = "big"
    signed: Annotated[bool, Field(description="true or false")] = True

    @property
    def numbers(self) -> tuple[Number, ...]:
        """Of the layout."""
        return tuple(_number(byte, self.bytes, self.endian, self.signed) for byte in self.at)


class CounterField(Part):
    """Where the frame's counter stands.

    Attributes:
        byte: its first.
        bytes: that it has.
        endian: their order.
        modulus: after how many it begins anew, a power of two; left out, all its bits count.
        step: from sample to sample.
    """

    byte: _Place
    bytes: Annotated[int, Field(ge=1, le=4, description="a whole number from 1 to 4")] = 1
    endian: Annotated[Endian, Field(description=_ENDIAN)] = "big"
    modulus: Annotated[
        int | None, Field(ge=2, le=1 << 32, description="a power of two from 2 to 2^32")
    ] = None
    step: Annotated[int, Field(ge=1, le=1 << 31, description="a whole number from 1")] = 1

    @property
    def counter(self) -> Counter:
        """Of the layout.

        Raises:
            ValueError: modulus or step are impossible.
        """
        number = _number(self.byte, self.bytes, self.endian, False)
        modulus = self.modulus or 1 << number.bits
        if modulus & (modulus - 1) or modulus > 1 << number.bits:
            raise ValueError(f"modulus {modulus} is no power of two that {self.bytes} bytes hold")
        if not self.step % modulus:
            raise ValueError(f"step {self.step} is a multiple of the modulus {modulus}")
        return Counter(number, modulus.bit_length() - 1, self.step)


class StatusField(Part):
    """A status byte.

    Attributes:
        byte: which.
        mask: its bits that count.
        normal: what they are while all is well.
    """

    byte: _Place
    mask: Annotated[int, Field(ge=1, le=255, description="a number from 1 to 255")] = 0xFF
    normal: _Byte = 0


class CheckField(Part):
    """The frame's checksum.

    Attributes:
        kind: "crc", or "sum" or "xor" of words.
        bits: its width.
        byte: its first.
        endian: order of its bytes.
        first, last: the bytes it covers.
        polynomial, initial, reflected, final: of the CRC, as the catalogue of CRC algorithms has
            them; `initial` and `final` of a sum too.
        word_bytes: of the words of a sum.
        words: order of the bytes in them.
    """

    kind: Annotated[Literal["crc", "sum", "xor"], Field(description='"crc", "sum" or "xor"')]
    bits: Annotated[Literal[8, 16, 24, 32], Field(description="8, 16, 24 or 32")]
    byte: _Place
    endian: Annotated[Endian, Field(description=_ENDIAN)] = "big"
    first: _Place
    last: _Place
    polynomial: Annotated[
        int | None, Field(ge=1, lt=1 << 32, description="a number of `bits` bits")
    ] = None
    initial: Annotated[int, Field(ge=0, lt=1 << 32, description="a number of `bits` bits")] = 0
    reflected: Annotated[bool, Field(description="true or false")] = False
    final: Annotated[int, Field(ge=0, lt=1 << 32, description="a number of `bits` bits")] = 0
    word_bytes: Annotated[Literal[1, 2], Field(description="1 or 2")] = 1
    words: Annotated[Literal["big", "little"], Field(description='"big" or "little"')] = "big"

    def check(self, length: int) -> Check:
        """Of the layout of a frame of some length.

        Raises:
            ValueError: parameters do not go together.
        """
        for name in ("polynomial", "initial", "final"):
            if (getattr(self, name) or 0) >> self.bits:
                raise ValueError(f"check.{name} has more than {self.bits} bits")
        if (self.kind == "crc") != (self.polynomial is not None):
            raise ValueError('check.polynomial goes with kind = "crc", and that needs it')
        if self.reflected and self.kind != "crc":
            raise ValueError('check.reflected goes with kind = "crc"')
        if self.kind == "crc" and self.word_bytes != 1:
            raise ValueError('check.word_bytes goes with kind = "sum" or "xor"')
        size = self.bits // 8
        if self.first > self.last or self.last >= length:
            raise ValueError(
                f"check covers no bytes of a frame of {length}: {self.first} to {self.last}"
            )
        if self.first <= self.byte + size - 1 and self.byte <= self.last:
            raise ValueError("check covers itself, let it end before check.byte")
        if (self.last - self.first + 1) % self.word_bytes:
            raise ValueError("check covers half a word")
        return Check(
            self.kind,
            self.bits,
            _number(self.byte, size, self.endian, False),
            self.first,
            self.last - length,
            self.polynomial or 0,
            self.initial,
            self.reflected,
            self.final,
            self.word_bytes,
            self.words == "little",
        )


class CustomFrame(Part):
    """A frame of fixed length.  Bytes are numbered from 0, the first of `sync`.

    Attributes:
        sync: the bytes that it begins with.
        length: bytes of all of it.
        gyro, accel: where the counts stand.
        check: its checksum.
        counter: of samples.
        status: bytes that mark the sample with a fault.
    """

    sync: Annotated[
        list[_Byte], Field(min_length=1, max_length=8, description="a list of 1 to 8 bytes")
    ]
    length: Annotated[int, Field(ge=8, le=LONGEST, description="a whole number from 8 to 256")]
    gyro: Annotated[AxesField, Field(description="a table with at and bytes")]
    accel: Annotated[AxesField, Field(description="a table with at and bytes")]
    check: Annotated[CheckField, Field(description="a table with kind, bits, byte, first, last")]
    counter: Annotated[CounterField | None, Field(description="a table with byte")] = None
    status: Annotated[
        list[StatusField] | None, Field(max_length=16, description="a list of tables with byte")
    ] = None

    @property
    def layout(self) -> Layout:
        """As the front end has it.

        Raises:
            ValueError: fields lie outside of the frame, on the sync bytes, or do not fit together.
        """
        check = self.check.check(self.length)
        counter = None if self.counter is None else self.counter.counter
        flags = tuple(Flags(s.byte, s.mask, s.normal) for s in self.status or ())
        fields = [("gyro", n) for n in self.gyro.numbers]
        fields += [("accel", n) for n in self.accel.numbers]
        fields += [("check", check.given)]
        fields += [] if counter is None else [("counter", counter.number)]
        fields += [("status", Number((each.place,))) for each in flags]
        for name, number in fields:
            if max(number.places) >= self.length:
                raise ValueError(f"{name} goes beyond the frame's {self.length} bytes")
            if min(number.places) < len(self.sync):
                raise ValueError(f"{name} lies on the sync bytes")
        kind = Kind(bytes(self.sync), self.length)
        return Layout((kind,), self.gyro.numbers, self.accel.numbers, check, counter, flags)

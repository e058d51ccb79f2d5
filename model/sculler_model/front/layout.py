"""What a sensor's frames look like: one description for the model, the hardware and `convert`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

AXES = 3


@dataclass(frozen=True)
class Number:
    """A whole number in a frame.

    Attributes:
        places: of its bytes, most significant first; from 0 at the frame's first byte, or
            negative from its end, where -1 is the last.
        signed: two's complement, else without sign.
    """

    places: tuple[int, ...]
    signed: bool = False

    @property
    def bits(self) -> int:
        """Its width."""
        return 8 * len(self.places)

    def of(self, frame: bytes) -> int:
        """The number that a frame holds."""
        content = bytes(frame[place] for place in self.places)
        return int.from_bytes(content, "big", signed=self.signed)


@dataclass(frozen=True)
class Counter:
    """A number that goes on from sample to sample, so that lost ones can be told.

    Attributes:
        number: where it stands; its lowest bits count.
        bits: that count; it begins anew after 2^bits.
        step: from one sample to the next, 1 or more.
    """

    number: Number
    bits: int
    step: int = 1

    def __post_init__(self) -> None:
        if not 1 <= self.bits <= self.number.bits or self.step < 1 or not self.step % self.modulus:
            raise ValueError(f"a counter of {self.bits} bits with step {self.step}")

    @property
    def modulus(self) -> int:
        """After how many counts it begins anew."""
        return 1 << self.bits

    @property
    def common_bits(self) -> int:
        """Lowest bits of a difference that are 0 whenever it is a whole number of steps."""
        step = self.step % self.modulus
        return (step & -step).bit_length() - 1

    @property
    def samples(self) -> int:
        """After how many samples it begins anew, a power of two."""
        return self.modulus >> self.common_bits

    def steps(self, difference: int) -> int | None:
        """How many steps a difference of two counts is, 0 to `samples` - 1; None for no number."""
        difference %= self.modulus
        if difference % (1 << self.common_bits):
            return None
        return (difference >> self.common_bits) * self.inverse % self.samples

    @property
    def inverse(self) -> int:
        """Of the odd part of the step, modulo `samples`."""
        return pow(self.step >> self.common_bits, -1, self.samples)


@dataclass(frozen=True)
class Flags:
    """Bits of a byte that should have one value.

    Attributes:
        place: of the byte, as in `Number`.
        mask: the bits that count.
        normal: what they are while all is well.
    """

    place: int
    mask: int = 0xFF
    normal: int = 0

    def raised_in(self, frame: bytes) -> bool:
        """Whether a frame has them otherwise."""
        return bool((frame[self.place] ^ self.normal) & self.mask)


@dataclass(frozen=True)
class Check:
    """How a frame tells that it is whole.

    The parameters of a CRC are those of the catalogue of CRC algorithms (Williams' model).

    Attributes:
        kind: a "crc", or the "sum" or "xor" of words.
        bits: its width.
        given: where it stands in the frame.
        first, last: first and last byte that it covers; `last` is negative, from the end.
        polynomial: without the highest term, most significant bit first (crc).
        initial: value before the first byte.
        reflected: bits go in and the result comes out least significant first (crc).
        final: XORed to the result.
        word_bytes: 1 or 2 (sum, xor).
        little: words are least significant byte first.
    """

    kind: Literal["crc", "sum", "xor"]
    bits: int
    given: Number
    first: int
    last: int
    polynomial: int = 0
    initial: int = 0
    reflected: bool = False
    final: int = 0
    word_bytes: int = 1
    little: bool = False

    def of(self, content: bytes) -> int:
        """Over the bytes it covers (and the zeros after them that a kind of frame asks for)."""
        value = self._crc(content) if self.kind == "crc" else self._words(content)
        return value ^ self.final

    def _words(self, content: bytes) -> int:
        value = self.initial
        for place, byte in enumerate(content):
            low = self.word_bytes == 1 or place % 2 == (0 if self.little else 1)
            part = byte if low else byte << 8
            value = value + part if self.kind == "sum" else value ^ part
        return value % (1 << self.bits)

    def _crc(self, content: bytes) -> int:
        """Bit by bit, in a register that moves to the left."""
        top, mask = 1 << (self.bits - 1), (1 << self.bits) - 1
        value = self.initial
        for byte in content:
            for place in range(8):
                bit = byte >> (place if self.reflected else 7 - place) & 1
                out = bool(value & top) != bool(bit)
                value = value << 1 & mask
                if out:
                    value ^= self.polynomial
        if self.reflected:
            value = int(f"{value:0{self.bits}b}"[::-1], 2)
        return value


@dataclass(frozen=True)
class Kind:
    """One kind of frame of a sensor.

    Attributes:
        first: its first bytes, by which it is known; none where the wire tells its begin.
        length: bytes of all of it.
        zeros: bytes of 0 that the check covers after those of the frame.
        sample: whether it holds a sample.
    """

    first: bytes
    length: int
    zeros: int = 0
    sample: bool = True


@dataclass(frozen=True)
class Layout:
    """All that a sensor sends.

    Attributes:
        kinds: of frames; none begins as another does.
        gyro, accel: x, y, z.
        check: the same for all kinds; None where frames have none.
        counter: of samples; None without one.
        faults: the sample is marked where one is raised.
        absent: the frame holds no sample where one is raised.
        latency: a number that tells how old the sample was; None without one.
        some_set: a frame whose bytes are all zero is broken: so reads a wire without a sensor.
    """

    kinds: tuple[Kind, ...]
    gyro: tuple[Number, ...]
    accel: tuple[Number, ...]
    check: Check | None
    counter: Counter | None = None
    faults: tuple[Flags, ...] = ()
    absent: tuple[Flags, ...] = ()
    latency: Number | None = None
    some_set: bool = False

    @property
    def aligned(self) -> bool:
        """Whether the wire tells where a frame begins."""
        return not self.kinds[0].first

    @property
    def longest(self) -> int:
        """Bytes of the longest kind."""
        return max(kind.length for kind in self.kinds)

    def kind_of(self, content: Sequence[int]) -> Kind | None:
        """The kind that begins so, or may when more bytes come; None where none does."""
        for kind in self.kinds:
            both = min(len(kind.first), len(content))
            if bytes(content[:both]) == kind.first[:both]:
                return kind
        return None

    def is_whole(self, frame: bytes, kind: Kind) -> bool:
        """Whether a frame's check is right, where it has one."""
        if self.some_set and not any(frame):
            return False
        check = self.check
        if check is None:
            return True
        covered = frame[check.first : len(frame) + check.last + 1] + bytes(kind.zeros)
        return check.of(covered) == check.given.of(frame)

"""A sensor on its wire: layout, rates and time-outs of one front end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from sculler_model.front.layout import Layout


@dataclass(frozen=True)
class Uart:
    """An asynchronous line (RS-422, RS-232, a pin): 8 data bits, least significant first, 1 stop.

    Attributes:
        baud: bits a second.
        parity: of the bit after the data.
    """

    baud: float
    parity: Literal["none", "even", "odd"] = "none"

    @property
    def bits_per_byte(self) -> int:
        """With start, parity and stop."""
        return 10 + (self.parity != "none")


@dataclass(frozen=True)
class Spi:
    """A port that the front end reads at each edge of data-ready, in mode 3.

    Attributes:
        sck_hz: of its clock, at most.
        requests: words of 16 bits that are sent, one after the other.  What comes with the first
            is nothing; after the last, zeros are sent until the frame is whole.
        pause_s: between two words, with the sensor unselected; 0 for a burst in one.
    """

    sck_hz: float
    requests: tuple[int, ...]
    pause_s: float = 0.0


@dataclass(frozen=True)
class Link:
    """A sensor on its wire.

    Attributes:
        layout: of its frames.
        wire: how they come.
        clock_hz: of the core.
        sample_rate_hz: of the sensor.
        patience: sample intervals without a sample before time-outs insert placeholders.
    """

    layout: Layout
    wire: Uart | Spi
    clock_hz: float
    sample_rate_hz: float
    patience: int

    @property
    def interval(self) -> int:
        """Clocks of a sample interval, rounded."""
        return round(self.clock_hz / self.sample_rate_hz)

    @property
    def time_out(self) -> int:
        """Clocks from a frame's last byte to the first time-out: `patience` intervals and a half.

        Every further one comes an `interval` later.
        """
        return self.patience * self.interval + self.interval // 2

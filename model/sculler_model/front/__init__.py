"""Sensor front ends as a page: from the bytes of a sensor to samples in their places.

`Layout` describes a sensor's frames, the makers' own or a design's; `Link` is a sensor on its
wire.  `Receiver` finds frames, `Sequence` puts samples in their places, `FrontModel` is both: the
golden model that the hardware is held against; `frame_of` is the sensor's side of the wire.  Plain
integers, and nothing of the core.
"""

from sculler_model.front.layout import Check, Counter, Flags, Kind, Layout, Number
from sculler_model.front.link import Link, Spi, Uart
from sculler_model.front.makers import (
    ADIS_BOTH,
    ADIS_BURST,
    ADIS_PAUSE_S,
    ADIS_RATES,
    ADIS_REGISTERS,
    STIM300_IDENTIFIERS,
    adis,
    adis_registers,
    adis_requests,
    hg4930,
    stim300,
)
from sculler_model.front.model import FrontModel
from sculler_model.front.receiver import Receiver
from sculler_model.front.sender import frame_of
from sculler_model.front.sequence import FrontCounters, FrontSample, Sequence

__all__ = [
    "ADIS_BOTH",
    "ADIS_BURST",
    "ADIS_PAUSE_S",
    "ADIS_RATES",
    "ADIS_REGISTERS",
    "STIM300_IDENTIFIERS",
    "Check",
    "Counter",
    "Flags",
    "FrontCounters",
    "FrontModel",
    "FrontSample",
    "Kind",
    "Layout",
    "Link",
    "Number",
    "Receiver",
    "Sequence",
    "Spi",
    "Uart",
    "adis",
    "adis_registers",
    "adis_requests",
    "frame_of",
    "hg4930",
    "stim300",
]

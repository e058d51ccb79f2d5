"""Samples with a clock and units, of the datagrams of a raw log."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import isclose
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.formats.log import COUNTS
from sculler.readers.format import UNITS, Format, Head, Request, scaled
from sculler.readers.raw.datagrams import Bytes, Census, Part, Places, Protocol, read, share_of
from sculler.readers.recording import (
    ACCEL_UNITS,
    GYRO_UNITS,
    Clock,
    Recording,
    Samples,
    Unit,
    require_finite,
)
from sculler_model.design import Design
from sculler_model.errors import InputError

_HEAD_BYTES = 1 << 18
_SHORT = 4  # modulus


@dataclass(frozen=True)
class Scales:
    """What a count is worth, by the unit it may be of.

    Attributes:
        gyro, accel: names of `GYRO_UNITS` and `ACCEL_UNITS`, and how many of it a count is.
    """

    gyro: Mapping[str, float]
    accel: Mapping[str, float]


@dataclass(frozen=True)
class Ticks:
    """A device's counter or clock.

    Attributes:
        seconds: one tick lasts; None for the design's sample interval.
        modulus: after how many it begins anew; of several possible ones, growing, the least that
            is more than what was counted; None for never.
        told: what it is.
        counts: it counts samples from anywhere, so that time is taken from 0 before the first.
    """

    seconds: float | None
    modulus: tuple[int, ...] | None
    told: str
    counts: bool = False


class RawProtocol(Protocol):
    """A protocol whose datagrams hold samples of one sensor.

    Attributes:
        scales: what counts are worth; set by `settle` where the datagrams say it.
        ticks: of its counter or clock, None without one; likewise.
    """

    scales: Scales
    ticks: Ticks | None

    def settle(self, path: Path, head: Bytes) -> None:
        """Find out from a file's first bytes what its datagrams hold.

        Raises:
            InputError: no gyro and accelerometer that belong together.
        """

    def notes(self) -> Mapping[str, str]:
        """What is worth telling, by topic, once all has been read."""
        return {}


def raw_format(name: str, about: str, protocol: Callable[[], RawProtocol]) -> Format:
    """The format of a protocol's logs."""

    def open_raw(path: Path, request: Request) -> Recording:
        return recording_of(path, protocol(), request)

    def looks(head: Head) -> float:
        # what the bytes say of themselves goes before: a chance hit has no such share
        return 0.99 * min(share_of(protocol(), head.content), 1.0)

    return Format(name, about, open_raw, UNITS, looks)


def recording_of(path: Path, protocol: RawProtocol, request: Request) -> Recording:
    """The samples of a raw log with clock and units.

    Raises:
        InputError: the file cannot be read, is empty, or is of no such datagrams.
    """
    try:
        with path.open("rb") as file:
            head = np.frombuffer(file.read(_HEAD_BYTES), np.uint8)
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the log ({error.strerror}), check the path"
        ) from error
    if not len(head):
        raise InputError(f"{path}: the log is empty, give samples")
    protocol.settle(path, head)
    units = (
        _unit(path, "gyro", protocol.scales.gyro, GYRO_UNITS, request),
        _unit(path, "accel", protocol.scales.accel, ACCEL_UNITS, request),
    )
    counter = None if protocol.ticks is None else _Counter(protocol.ticks, request.design, units[0])
    census = Census()
    notes: dict[str, str] = {}
    warnings: list[str] = []

    def chunks() -> Iterator[Samples]:
        first = 0
        for part in read(path, protocol, census, request.advance):
            values, faults = part.decoded.values, part.decoded.faults
            require_finite(path, first, values, COUNTS)
            first += len(values)
            times = None if counter is None else counter(part)
            if times is None:
                faults = faults | (part.passed_over > 0)
            yield Samples(values, faults.astype(np.uint8), times)
        notes["datagrams"] = census.told()
        notes.update(protocol.notes())
        warnings.extend(_warnings(census, protocol))

    if protocol.ticks is not None:
        notes["time stamps"] = protocol.ticks.told
    return Recording(
        *units,
        chunks(),
        has_faults=True,
        clock=None if counter is None else counter.clock,
        notes=notes,
        warnings=warnings,
        datagrams=census,
    )


def _warnings(census: Census, protocol: RawProtocol) -> Iterator[str]:
    if protocol.ticks is None:
        yield "the datagrams have neither counter nor time, so lost ones cannot be told"
    if census.bytes_passed_over:
        places = "in 1 place" if census.places == 1 else f"in {census.places:,} places, the first"
        after = (
            "the samples after them are marked as faults"
            if protocol.ticks is None
            else "what is lost there is told as gaps"
        )
        yield (
            f"{census.bytes_passed_over:,} bytes {places} at byte {census.first_place:,}, are of no"
            f" whole datagram; {after}"
        )


class _Counter:
    """Ticks that begin anew at their modulus to seconds."""

    def __init__(self, ticks: Ticks, design: Design, unit: Unit) -> None:
        self._seconds = ticks.seconds or design.sample_interval
        self._modulus = ticks.modulus
        self._usual = design.sample_interval / self._seconds
        self._whole = ticks.seconds == 1e-9
        self._first: int | None = None  # what to count the first sample as; None for what it says
        if ticks.counts:  # increments end at their stamp, rates stand there
            self._first = round(self._usual) * ((unit.kind or design.sensor.kind) == "increment")
        self._last: tuple[int, int] | None = None  # as counted, and as given
        self.clock = Clock("ns" if self._whole else "s")

    def __call__(self, part: Part) -> NDArray[np.float64]:
        """Seconds (N,) since the first sample of all."""
        ticks = part.decoded.ticks
        assert ticks is not None
        if self._modulus is not None:
            ticks = self._unwrapped(ticks, part)
        if self._whole:
            return self.clock(ticks)
        return self.clock(ticks.astype(np.float64) * self._seconds)

    def _unwrapped(self, ticks: Places, part: Part) -> Places:
        """Ticks that go on, those that the bytes passed over must have had counted in."""
        assert self._modulus is not None
        given = int(ticks[0])
        begin = given if self._first is None else self._first
        begin, given = self._last or (begin - round(self._usual), given - round(self._usual))
        before = np.concatenate([[given], ticks[:-1]])
        steps = ticks - before
        which = np.searchsorted(self._modulus, before, side="right")
        modulus = np.array(self._modulus)[which.clip(max=len(self._modulus) - 1)]
        # of a counter of two bits no step is a whole round, of a longer one a repeated sample
        steps += np.where((steps < 0) | (steps == 0) & (modulus <= _SHORT), modulus, 0)
        # an interval for this sample, and one for each that the bytes passed over have room for
        expected = self._usual * (1 + part.passed_over / part.length)
        rounds = np.rint((expected - steps) / modulus).clip(0).astype(np.int64)
        rounds[part.passed_over == 0] = 0
        counted: Places = begin + np.cumsum(steps + rounds * modulus)
        self._last = int(counted[-1]), int(ticks[-1])
        return counted


def _unit(
    path: Path,
    sensor: str,
    scales: Mapping[str, float],
    units: Mapping[str, Unit],
    request: Request,
) -> Unit:
    """The unit of a sensor's counts: as asked for, as the datagrams say, or the design's own."""
    given: Unit | None = getattr(request, sensor)
    scale: float | None = getattr(request, f"{sensor}_scale")
    if given is not None and (scale is not None or given.si is None):
        return scaled(sensor, given, scale)
    if scale is not None:
        raise InputError(f"--{sensor}-scale goes with --{sensor}-unit, give both")
    if given is not None:
        if given.name not in scales:
            known = f", or one of {', '.join(scales)}" if scales else ""
            raise InputError(
                f"{path}: what one count in {given.name} is worth is not known, give"
                f" --{sensor}-scale too{known}"
            )
        return _count(given, scales[given.name])
    if len(scales) == 1:
        ((name, lsb),) = scales.items()
        return _count(units[name], lsb)
    own = request.design.sensor.gyro.lsb if sensor == "gyro" else request.design.sensor.accel.lsb
    for name, lsb in scales.items():
        unit = units[name]
        assert unit.si is not None
        if unit.kind == request.design.sensor.kind and isclose(unit.si * lsb, own, rel_tol=1e-6):
            return _count(unit, lsb)
    choice = f"one of {', '.join(scales)}" if scales else f"with --{sensor}-scale"
    raise InputError(
        f"{path}: the datagrams do not say what a count of the {sensor} is worth, and the design's"
        f" is none of the sensor's; give --{sensor}-unit, {choice}, or counts for the design's own"
    )


def _count(unit: Unit, lsb: float) -> Unit:
    assert unit.si is not None
    return unit if lsb == 1 else Unit(f"{lsb:.9g} {unit.name}", unit.si * lsb, unit.kind)

"""The text format `.imu` of laser-gyro logs (PSINS): integer increments under a head of facts.

Lines that begin with % are comments.  Then come three lines of six numbers: attitude and velocity;
latitude, longitude (degrees), height (m), start time (s), sampling interval (ms), g (m/s²); and the
scale of each gyro (arcseconds) and accelerometer (micro-g seconds) count.  Then the samples, gyro
and accelerometer counts.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isclose, pi
from pathlib import Path
from typing import TextIO

from sculler.formats.log import COUNTS
from sculler.readers.format import Format, Request, begins
from sculler.readers.recording import Recording, Samples, Unit
from sculler.readers.text import Column, number_rows, open_text
from sculler_model.errors import InputError

_ARCSECOND = pi / 180 / 3600


def read_psins(path: Path, request: Request) -> Recording:
    """A laser-gyro log; its sampling interval must be the design's.

    Raises:
        InputError: the file cannot be read or its head is at fault.
    """
    design = request.design
    with open_text(path) as file:
        lines, attitude, place, scales = _head(file, path)
    latitude, longitude, height, _, interval_ms, g = place
    if not isclose(interval_ms * 1e-3, design.sample_interval, rel_tol=1e-6):
        raise InputError(
            f"{path}: the log's sampling interval is {interval_ms:g} ms but sensor.sample_rate_hz"
            f" = {design.sensor.sample_rate_hz:g}, use a design for this sensor"
        )
    for name, triple in (("gyro", scales[:3]), ("accelerometer", scales[3:])):
        if triple[0] <= 0 or len(set(triple)) > 1:
            raise InputError(f"{path}: the {name} scales are not one number > 0 for all axes")

    def chunks() -> Iterator[Samples]:
        columns = [Column(name, at) for at, name in enumerate(COUNTS)]
        with open_text(path) as file:
            for _ in range(lines):
                file.readline()
            for rows in number_rows(file, path, lines + 1, columns, None, request.advance):
                yield Samples(rows.values)

    return Recording(
        Unit(f"{scales[0]:g} arcsec", scales[0] * _ARCSECOND, "increment"),
        Unit(f"{scales[3]:g} ug*s", scales[3] * 1e-6 * g, "increment"),
        chunks(),
        notes={
            "position": f"{latitude:.8f}° N, {longitude:.8f}° E, {height:g} m",
            "attitude": "pitch {:g}°, roll {:g}°, yaw {:g}° (as the file says)".format(
                *attitude[:3]
            ),
            "g": f"{g:g} m/s²",
        },
    )


def _head(file: TextIO, path: Path) -> tuple[int, list[float], list[float], list[float]]:
    """Number of lines before the samples, and the three lines of facts."""
    facts: list[list[float]] = []
    number = 0
    while len(facts) < 3:
        line = file.readline()
        number += 1
        if not line:
            raise InputError(f"{path}: the head is cut short, it should have three lines of facts")
        if line.lstrip().startswith("%") or line.isspace():
            continue
        try:
            values = [float(cell) for cell in line.split()]
        except ValueError:
            values = []
        if len(values) != len(COUNTS):
            raise InputError(f"{path}: line {number}: give six numbers, as PSINS logs have there")
        facts.append(values)
    return number, *facts  # type: ignore[return-value]


FORMATS = (
    Format(
        "psins",
        "text logs of PSINS, integer increments under a head",
        read_psins,
        looks=begins(b"% PSINS"),
        suffixes=(".imu",),
    ),
)

"""Sensors worth a preset: what `preset = "..."` fills into a design file.

Each LSB is the maker's or a maintained driver's figure.  The algorithm part is a good start, not
a recommendation: 2 kHz units get 4 samples x 5 minors (100 Hz majors), slow ones M = 1.
"""

from __future__ import annotations

from math import radians
from typing import Any

_ARCSECOND = radians(1) / 3600  # rad
_FOOT = 0.3048  # m


def _preset(
    rate: float, gyro: tuple[int, float], accel: tuple[int, float], minors: int
) -> dict[str, Any]:
    return {
        "sensor": {
            "kind": "increment",
            "sample_rate_hz": rate,
            "gyro": {"bits": gyro[0], "lsb": gyro[1]},
            "accel": {"bits": accel[0], "lsb": accel[1]},
        },
        "algorithm": {"family": "frequency-taylor", "samples": 4, "history": 0, "minors": minors},
        "hardware": {"core": "pipelined"},
    }


PRESETS: dict[str, dict[str, Any]] = {
    # Honeywell HG4930: int32 messages, 2^-33 rad and 2^-27 ft/s
    "hg4930": _preset(100.0, (32, 2.0**-33), (32, _FOOT * 2.0**-27), 1),
    # Sensonor STIM300, 10 g accelerometers: 24 bit, 2^-21 degree and 2^-22 m/s
    "stim300": _preset(2000.0, (24, radians(2.0**-21)), (24, 2.0**-22), 5),
    # Northrop Grumman LN-200 in NovAtel's raw log: int32 fields, 2^-19 rad and 2^-14 m/s
    "ln200": _preset(200.0, (32, 2.0**-19), (32, 2.0**-14), 1),
    # Analog Devices ADIS16488: int32, 720 degrees / 2^31 and 200 m/s / 2^31
    "adis16488": _preset(2460.0, (32, radians(720) / 2**31), (32, 200.0 / 2**31), 5),
    # The laser-gyro unit of the PSINS log: 0.1 arcsecond and 125 ug*s with g = 9.780327 m/s^2.
    # The log states no word length; 24 bits hold 168 degrees and 10 km/s in one sample.
    "lasergyro": _preset(100.0, (24, 0.1 * _ARCSECOND), (24, 125e-6 * 9.780327), 1),
}

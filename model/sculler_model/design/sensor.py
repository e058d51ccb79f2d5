"""The design file's [sensor]: what the sensor delivers."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from sculler_model.design.filters import Filter
from sculler_model.design.sensor_errors import SensorErrors
from sculler_model.schema import Part


class Axes(Part):
    """Word length and scale of three like sensor axes.

    Attributes:
        bits: of a count, two's complement, 8 to 32.
        lsb: of a count: rad or m/s (increments), rad/s or m/s² (rates).
    """

    bits: Annotated[int, Field(ge=8, le=32, description="a whole number from 8 to 32")]
    lsb: Annotated[
        float,
        Field(ge=1e-30, le=1e6, description="a number from 1e-30 to 1e6 (SI units per count)"),
    ]


class Sensor(Part):
    """What the sensor delivers.

    Attributes:
        kind: "increment" (angle and velocity over each sample interval) or "rate".
        sample_rate_hz: 1/T.
        gyro, accel: their words.
        filter: what the samples of both have passed, stage after stage; None where nothing is
            stated: then increments have passed nothing, and rates a mean over the sample interval.
        errors: what it does wrong in `sculler motion`; None for a perfect sensor.
    """

    kind: Annotated[Literal["increment", "rate"], Field(description='"increment" or "rate"')]
    sample_rate_hz: Annotated[
        float, Field(ge=1e-6, le=1e9, description="a number from 1e-6 to 1e9")
    ]
    gyro: Annotated[Axes, Field(description="a table with bits and lsb")]
    accel: Annotated[Axes, Field(description="a table with bits and lsb")]
    filter: Filter = None
    errors: Annotated[SensorErrors | None, Field(description="a table")] = None

"""The design file's [sensor]: what the sensor delivers."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from sculler_model.schema import Part


class Axes(Part):
    """Word length and scale of three like sensor axes."""

    bits: Annotated[int, Field(ge=8, le=32, description="a whole number from 8 to 32")]
    lsb: Annotated[
        float,
        Field(ge=1e-30, le=1e6, description="a number from 1e-30 to 1e6 (SI units per count)"),
    ]


class Sensor(Part):
    """What the sensor delivers."""

    kind: Annotated[Literal["increment", "rate"], Field(description='"increment" or "rate"')]
    sample_rate_hz: Annotated[
        float, Field(ge=1e-6, le=1e9, description="a number from 1e-6 to 1e9")
    ]
    gyro: Annotated[Axes, Field(description="a table with bits and lsb")]
    accel: Annotated[Axes, Field(description="a table with bits and lsb")]

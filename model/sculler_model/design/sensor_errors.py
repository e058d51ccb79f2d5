"""The design file's [sensor.errors]: what the sensor does wrong, in the units of data sheets.

`sculler motion` makes such samples; the core and the navigator know nothing of it.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from sculler_model.schema import Part

PRESETS: dict[str, dict[str, Any]] = {
    # Sensonor STIM300, data sheet TS1524: 10 g accelerometers; turn-on biases as the sheet's ranges
    "stim300": {
        "gyro": {
            "bias": {"sigma": 4.0},
            "flicker": 0.5 / 0.664,
            "random_walk": 0.15,
            "scale_factor": {"sigma": 500.0},
            "misalignment": {"sigma": 1.0},
            "g_sensitivity": {"sigma": 1.0},
            "range": 400.0,
        },
        "accel": {
            "bias": {"sigma": 0.75},
            "flicker": 0.05 / 0.664,
            "random_walk": 0.06,
            "scale_factor": {"sigma": 300.0},
            "misalignment": {"sigma": 1.0},
            "range": 10.0,
        },
    },
    # Honeywell HG9900, brochure N61-1638: a laser gyro unit of navigation grade
    "hg9900": {
        "gyro": {
            "bias": {"sigma": 0.0035},
            "random_walk": 0.002,
            "scale_factor": {"sigma": 5.0},
        },
        "accel": {"bias": {"sigma": 0.025}, "scale_factor": {"sigma": 100.0}},
    },
}
"""Makers' figures, by sensor."""


class Drawn(Part):
    """Values drawn anew for every seed, normally distributed, one for each place.

    Attributes:
        sigma: their standard deviation.
    """

    sigma: Annotated[float, Field(ge=0, le=1e9, description="a number from 0 to 1e9")]


def _three(value: Any) -> Any:
    """A number is the same for all axes."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return [float(value)] * 3
    return value


def _floats(value: Any) -> Any:
    return [float(each) for each in value] if _numbers(value) else value


def _numbers(value: Any) -> bool:
    return isinstance(value, list) and all(
        isinstance(each, int | float) and not isinstance(each, bool) for each in value
    )


RANDOM = ("markov", "markov_time_s", "flicker", "random_walk", "rate_random_walk", "range")
"""Keys of `AxisErrors` that nobody can undo."""

_SIZE = "a number from 0 to 1e9"
_THREE = "a number, three numbers x, y, z, or {sigma = a number}"
_SIX = "six numbers xy, xz, yx, yz, zx, zy, or {sigma = a number}"

_Number = Annotated[float, Field(ge=-1e9, le=1e9)]
Three = Annotated[
    Drawn | Annotated[list[_Number], Field(min_length=3, max_length=3)] | None,
    BeforeValidator(_floats),
    BeforeValidator(_three),
    Field(description=_THREE),
]
Six = Annotated[
    Drawn | Annotated[list[_Number], Field(min_length=6, max_length=6)] | None,
    BeforeValidator(_floats),
    Field(description=_SIX),
]
Size = Annotated[float | None, Field(ge=0, le=1e9, description=_SIZE)]
Rows = Annotated[
    list[Annotated[list[_Number], Field(min_length=3, max_length=3)]] | None,
    Field(
        min_length=3, max_length=3, description="three rows x, y, z (m), one for each accelerometer"
    ),
]


class AxisErrors(Part):
    """Errors of three like axes; what is left out is not there.

    The unit of a value is that of data sheets: ° per hour for gyros, mg for accelerometers.

    Attributes:
        bias: °/h or mg.
        markov: standard deviation, °/h or mg, of a bias that wanders (first-order Gauss-Markov).
        markov_time_s: its correlation time.
        flicker: B of IEEE Std 952, °/h or mg: the flat part of the Allan deviation is at 0.664 B.
        random_walk: °/√h or m/s/√h: white noise of the rate.
        rate_random_walk: °/h/√h or mg/√h.
        scale_factor: ppm.
        asymmetry: ppm more where the input is positive and less where it is negative.
        square: ppm of the input for each °/s or g of it.
        misalignment: mrad, row by row: how much of the second axis the first one feels.
        g_sensitivity: °/h for each g along the same axis; gyros only.
        range: °/s or g; beyond, the sensor stays at it.
    """

    bias: Annotated[Three, Field(description=f"°/h or mg: {_THREE}")] = None
    markov: Annotated[Size, Field(description=f"°/h or mg: {_SIZE}")] = None
    markov_time_s: Annotated[
        float | None, Field(gt=0, le=1e9, description="s: a number > 0, at most 1e9")
    ] = None
    flicker: Annotated[Size, Field(description=f"B, °/h or mg: {_SIZE}")] = None
    random_walk: Annotated[Size, Field(description=f"°/√h or m/s/√h: {_SIZE}")] = None
    rate_random_walk: Annotated[Size, Field(description=f"°/h/√h or mg/√h: {_SIZE}")] = None
    scale_factor: Annotated[Three, Field(description=f"ppm: {_THREE}")] = None
    asymmetry: Annotated[Three, Field(description=f"ppm: {_THREE}")] = None
    square: Annotated[Three, Field(description=f"ppm for each °/s or g: {_THREE}")] = None
    misalignment: Annotated[Six, Field(description=f"mrad: {_SIX}")] = None
    g_sensitivity: Annotated[Three, Field(description=f"°/h/g, gyros only: {_THREE}")] = None
    range: Annotated[float | None, Field(gt=0, le=1e9, description="°/s or g: a number > 0")] = None

    @model_validator(mode="after")
    def _keys_fit(self) -> AxisErrors:
        if (self.markov is None) != (self.markov_time_s is None):
            raise ValueError("markov and markov_time_s: give both or neither")
        return self


class SensorErrors(Part):
    """What the sensor does wrong.

    Attributes:
        gyro, accel: of the three axes.
        delay_samples: how many sample intervals later than the gyros the accelerometers see.
        arms_m: where each accelerometer sits, from the point that is navigated, body axes, m.
    """

    preset: Annotated[
        Literal["stim300", "hg9900"] | None,
        Field(description=f"one of {', '.join(PRESETS)}"),
    ] = None
    gyro: Annotated[AxisErrors, Field(description="a table", validate_default=True)] = AxisErrors()
    accel: Annotated[AxisErrors, Field(description="a table", validate_default=True)] = AxisErrors()
    delay_samples: Annotated[
        float | None, Field(ge=-1000, le=1000, description="a number from -1000 to 1000")
    ] = None
    arms_m: Rows = None

    @model_validator(mode="before")
    @classmethod
    def _filled_in(cls, data: Any) -> Any:
        """The preset's values where the file says nothing."""
        if not isinstance(data, dict) or data.get("preset") not in PRESETS:
            return data
        merged = dict(data)
        for part, values in PRESETS[data["preset"]].items():
            given = data.get(part, {})
            merged[part] = {**values, **given} if isinstance(given, dict) else given
        return merged

    @model_validator(mode="after")
    def _keys_fit(self) -> SensorErrors:
        if self.accel.g_sensitivity is not None:
            raise ValueError("accel.g_sensitivity: only gyros have one, leave it out")
        return self


def why_not_undone(key: str, value: object) -> str | None:
    """What is to be said of a key of `AxisErrors` that is random or a limit; None of others."""
    if value is None or not (key in RANDOM or isinstance(value, Drawn)):
        return None
    return "is random or a limit, so it cannot be undone, leave it out or give numbers"

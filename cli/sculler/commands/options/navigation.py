"""Options of `navigate` that describe gravity and the sensors, and what they stand for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import degrees, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from sculler import terminal

if TYPE_CHECKING:
    from sculler_model.navigation import Alignment, FineAlignment, Gravity, SensorNoise

Command = TypeVar("Command", bound=Callable[..., Any])

GRAVITY_COLUMNS = ("lat_deg", "height_m", "gravity")
_MOST_POINTS = 1_000_000

_NOISE = (
    (
        "--gyro-noise",
        "DEG/SQRT(H)",
        "Random walk of each gyro, for --align; the window shows it if left out.",
    ),
    (
        "--accel-noise",
        "M/S/SQRT(H)",
        "Random walk of each accelerometer, for --align; the window shows it if left out.",
    ),
    (
        "--gyro-bias-sigma",
        "DEG/H",
        "How far a gyro's bias may be off (1 sigma); in no stated sigma if left out, for no window"
        " shows it.",
    ),
    (
        "--accel-bias-sigma",
        "M/S^2",
        "How far an accelerometer's bias may be off (1 sigma); likewise.",
    ),
)


def gravity_option(command: Command) -> Command:
    """`--gravity`."""
    return click.option(
        "--gravity",
        "gravity",
        default="normal",
        show_default=True,
        metavar="normal|constant[:G]|FILE",
        help="Gravity to navigate by: the normal field of WGS-84, one value everywhere (9.80665, or"
        " G in m/s^2), or a CSV lat_deg,height_m,gravity: a grid, a profile or one measured point.",
    )(command)


def noise_options(command: Command) -> Command:
    """What is known of the sensors."""
    for flag, metavar, text in reversed(_NOISE):
        command = click.option(flag, type=terminal.number_type(0), metavar=metavar, help=text)(
            command
        )
    return command


def gravity_model(text: str) -> Gravity:
    """The model that `--gravity` asks for.

    Raises:
        InputError: it is none, or the table has a fault.
    """
    from sculler_model.errors import InputError
    from sculler_model.navigation import NORMAL, constant_gravity

    if text == "normal":
        return NORMAL
    if text == "constant":
        return constant_gravity()
    if text.startswith("constant:"):
        try:
            value = float(text.removeprefix("constant:"))
        except ValueError:
            raise InputError(
                f"--gravity {text}: not a number, give m/s² as in constant:9.81"
            ) from None
        return constant_gravity(value)
    return read_gravity_table(Path(text))


def read_gravity_table(path: Path) -> Gravity:
    """Gravity at the points of a CSV with the columns `GRAVITY_COLUMNS`, in any order of rows.

    The points are all pairs of some latitudes and some heights; one latitude is a profile over
    height, one point a measured local gravity.

    Raises:
        InputError: it cannot be read, is not such a grid, or its values are no gravity.
    """
    import numpy as np

    from sculler.readers.text import Column, number_rows, open_text
    from sculler_model.errors import InputError
    from sculler_model.navigation import table_of_gravity

    if not path.is_file():
        raise InputError(
            f"--gravity {path}: no such file, give one, or normal, constant or constant:9.81"
        )
    with open_text(path) as file:
        names = [name.strip() for name in file.readline(1000).rstrip("\n").split(",")]
        missing = [name for name in GRAVITY_COLUMNS if name not in names]
        if missing:
            raise InputError(
                f"{path}: no column {missing[0]}, give the header {','.join(GRAVITY_COLUMNS)}"
            )
        columns = [Column(name, names.index(name)) for name in GRAVITY_COLUMNS]
        parts: list[Any] = []
        for rows in number_rows(file, path, 2, columns, ",", terminal.silent):
            parts.append(rows.values)
            if sum(map(len, parts)) > _MOST_POINTS:
                raise InputError(f"{path}: more than {_MOST_POINTS:,} points, give fewer")
    lat, height, value = np.concatenate(parts).T
    lats, i = np.unique(lat, return_inverse=True)
    heights, j = np.unique(height, return_inverse=True)
    if len(lats) * len(heights) > _MOST_POINTS:
        raise InputError(f"{path}: more than {_MOST_POINTS:,} points in the grid, give fewer")
    counts = np.zeros((len(lats), len(heights)), np.int64)
    np.add.at(counts, (i, j), 1)
    if (counts != 1).any():
        row, column = np.argwhere(counts != 1)[0]
        word = "missing" if counts[row, column] == 0 else "there more than once"
        raise InputError(
            f"{path}: the point at latitude {lats[row]:g}°, height {heights[column]:g} m is {word};"
            " give every pair of the latitudes and heights once"
        )
    grid = np.empty(counts.shape)
    grid[i, j] = value
    try:
        return table_of_gravity(np.radians(lats), heights, grid)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def refuse_noise_without(align_seconds: float | None, known: Mapping[str, float | None]) -> None:
    """Noise is for the alignment only.

    Raises:
        UsageError: it is given without one.
    """
    for name, value in known.items():
        if value is not None and align_seconds is None:
            raise click.UsageError(f"--{name.replace('_', '-')} is for --align, give that too")


def sensor_noise(
    gyro_noise: float | None,
    accel_noise: float | None,
    gyro_bias_sigma: float | None,
    accel_bias_sigma: float | None,
) -> SensorNoise:
    """What the options say of the sensors, in SI."""
    from sculler_model.navigation import SensorNoise

    return SensorNoise(
        angle_random_walk=None if gyro_noise is None else radians(gyro_noise) / 60,
        velocity_random_walk=None if accel_noise is None else accel_noise / 60,
        gyro_bias=None if gyro_bias_sigma is None else radians(gyro_bias_sigma) / 3600,
        accel_bias=accel_bias_sigma,
    )


def sigma_facts(found: Alignment | FineAlignment, noise: SensorNoise) -> dict[str, Any]:
    """Told sigmas of an alignment, and the noise that they come from, as plain data."""
    roll, pitch, heading = map(degrees, found.euler_sigma)
    return {
        "sigma_deg": {"roll": roll, "pitch": pitch, "heading": heading},
        "heading_sigma_deg": degrees(found.sigma[2]),
        "noise": {
            "gyro_deg_per_sqrt_h": degrees(noise.angle_random_walk or 0.0) * 60,
            "accel_m_per_s_per_sqrt_h": (noise.velocity_random_walk or 0.0) * 60,
            "gyro_bias_sigma_deg_per_h": (
                None if noise.gyro_bias is None else degrees(noise.gyro_bias) * 3600
            ),
            "accel_bias_sigma": noise.accel_bias,
        },
    }


def sigmas_told(found: Mapping[str, Any]) -> str:
    """The stated sigmas in words, and the noise behind them."""
    angles = ", ".join(f"{name} {value:.2g}°" for name, value in found["sigma_deg"].items())
    noise = found["noise"]
    return (
        f"1 σ: {angles}, by {noise['gyro_deg_per_sqrt_h']:.2g} °/√h and"
        f" {noise['accel_m_per_s_per_sqrt_h']:.2g} m/s/√h"
    )


def biases_told(found: Mapping[str, Any]) -> str:
    """What of the gyros' biases was looked for, in words."""
    sigma = found["noise"]["gyro_bias_sigma_deg_per_h"]
    if sigma is None:
        return "of which about north alone was looked for (--gyro-bias-sigma: all three)"
    return f"of {sigma:.2g} °/h (1 σ) to expect"

"""Truth motions, and what a sensor would deliver of them."""

from __future__ import annotations

from inspect import signature
from math import degrees, radians
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.library.logs import Log
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.frames import from_euler_rows
from sculler_model.motion import MOTIONS, PLACE, Motion, Points, delivered, through
from sculler_model.samples import Imperfect, Quantiser, sample_stamp


def motion(
    name: str,
    *,
    lat: float = degrees(PLACE[0]),
    lon: float = degrees(PLACE[1]),
    height: float = PLACE[2],
    **parameters: float,
) -> Motion:
    """A motion over the turning Earth whose attitude, velocity and position are known exactly.

    Args:
        name: one of the catalogue: rest, coning, sculling, spin-cone, spin-rock-size, spin-accel,
            turn, great-circle, pole, flight, demo.
        lat, lon: where it begins, degrees, geodetic on WGS-84; a motion whose place is its own
            (pole, demo) takes no notice of what does not apply.
        height: m above the ellipsoid.
        parameters: the motion's own, in SI units and rad (`sculler_model.motion`), such as
            `speed=30.0` or `half_angle=0.01`.

    Returns:
        The motion: `state(t)` is the truth at instants t (s); `increments` and `rates` are exact
        samples (N, 6), rad and m/s (rad/s and m/s²), body frame forward, right, down.

    Raises:
        InputError: there is no such motion or parameter.

    Examples:
        >>> import numpy as np, sculler
        >>> turn = sculler.motion("turn", lat=48, lon=11, height=500, speed=20.0)
        >>> truth = turn.state(np.array([0.0, 1.0]))
        >>> bool(np.allclose(np.hypot(truth.v[:, 0], truth.v[:, 1]), 20.0, atol=0.01))
        True
    """
    if name not in MOTIONS:
        raise InputError(f"motion: {name!r} is not known, give one of {', '.join(MOTIONS)}")
    make = MOTIONS[name].make
    allowed = signature(make).parameters
    for key in parameters:
        if key not in allowed:
            raise InputError(
                f"motion: {name} has no parameter {key}, it has {', '.join(allowed) or 'none'}"
            )
    place: dict[str, Any] = {"lat": radians(lat), "lon": radians(lon), "h": height}
    return make(**{key: value for key, value in place.items() if key in allowed}, **parameters)


def motion_through(
    time: Any,
    lat: Any,
    lon: Any,
    height: Any,
    attitude: Any = None,
    *,
    smoothness: int = 3,
) -> Motion:
    """A smooth motion over the turning Earth that meets given points.

    Args:
        time: (N,) s, running forwards; the motion's time 0 is the first one.
        lat, lon: (N,) degrees, geodetic on WGS-84.
        height: (N,) m above the ellipsoid.
        attitude: (N, 4) quaternions, body (forward, right, down) to north-east-down; or (N, 3)
            roll, pitch, heading in degrees; None for the nose along the way.
        smoothness: continuous derivatives of place and attitude, 2, 3 or 4.

    Returns:
        The motion, as `motion` returns it.

    Raises:
        InputError: shapes do not agree, or no motion goes through the points
            (`sculler_model.motion.through`).

    Examples:
        >>> import numpy as np, sculler
        >>> time = np.arange(5.0)
        >>> east = sculler.motion_through(time, 0 * time, 0.001 * time, 100 + 0 * time)
        >>> f"{east.state(np.array([2.5])).v[0, 1]:.3f} m/s"
        '111.321 m/s'
    """
    columns = [np.asarray(values, dtype=np.float64) for values in (time, lat, lon, height)]
    shapes = {column.shape for column in columns}
    if len(shapes) > 1 or columns[0].ndim != 1:
        told = ", ".join(str(column.shape) for column in columns)
        raise InputError(f"time, lat, lon, height are of shapes {told}, give (N,) each")
    if not all(np.isfinite(column).all() for column in columns):
        raise InputError("time, lat, lon, height: there is a NaN or an infinity, give numbers")
    if (np.diff(columns[0]) <= 0).any():
        raise InputError("time does not run forwards, put the points in order of time")
    q = None if attitude is None else _quaternions(attitude, len(columns[0]))
    points = Points(columns[0], np.radians(columns[1]), np.radians(columns[2]), columns[3], q)
    return through(points, smoothness)


def _quaternions(attitude: Any, many: int) -> NDArray[np.float64]:
    """(N, 4) of length 1."""
    given = np.asarray(attitude, dtype=np.float64)
    if given.shape not in ((many, 3), (many, 4)) or not np.isfinite(given).all():
        raise InputError(
            f"attitude is of shape {given.shape}, give numbers: quaternions ({many}, 4), or angles"
            f" ({many}, 3)"
        )
    if given.shape[1] == 3:
        return from_euler_rows(np.radians(given))
    length = np.linalg.norm(given, axis=1, keepdims=True)
    if (np.abs(length - 1) > 1e-6).any():
        raise InputError("attitude: a quaternion is not of length 1, divide it by its length")
    whole: NDArray[np.float64] = given / length
    return whole


def record(design: Design, motion: Motion, seconds: float, *, seed: int = 1) -> Log:
    """What the design's sensor would deliver of a motion: exact samples, rounded to counts.

    Rounding is carried on from sample to sample, so that sums keep to half a count
    (`sculler_model.samples.Quantiser`).

    Args:
        design: gives kind, rate, widths, scales, and a digital filter of increments.
        motion: from time 0 on.
        seconds: how long.
        seed: of the random numbers, where the design has [sensor.errors].

    Returns:
        N = seconds times the rate samples, with stamps on a clock that began with the log (s).

    Raises:
        InputError: no sample fits in that time, or the sensor's width does not hold the motion.

    Examples:
        >>> import sculler
        >>> design = sculler.Design.preset("stim300")
        >>> log = sculler.record(design, sculler.motion("rest"), 0.01)
        >>> log.counts.shape, log.times[-1].item()
        ((20, 6), 0.01)
    """
    samples = int(seconds * design.sensor.sample_rate_hz + 1e-9)
    if samples < 1:
        raise InputError(f"seconds: {seconds:g} holds no sample, give more")
    quantise, imperfect = Quantiser(design), Imperfect(design, seed)
    chunks = delivered(motion, design, samples)
    counts = np.concatenate([quantise(imperfect(chunk)) for chunk in chunks])
    first = sample_stamp(design, 0)
    times = first + np.arange(samples) / design.sensor.sample_rate_hz
    return Log(counts, times=times)

"""Coarse and fine alignment by a design's host in C."""

from __future__ import annotations

import ctypes
from dataclasses import replace
from math import nan, sin

import numpy as np
from numpy.typing import NDArray

from sculler.host_c.engine import HostInC, NavigatorInC, address
from sculler_model.errors import InputError
from sculler_model.host import MajorIncrements
from sculler_model.navigation import (
    ESTIMATED,
    NORMAL,
    Alignment,
    FineAlignment,
    Gravity,
    NavState,
    SensorNoise,
    alignment_warnings,
    gravity_at,
    refuse_unfit_window,
)

Array = NDArray[np.float64]


class _Found(ctypes.Structure):
    """`engine_alignment` of engine.c.in."""

    _fields_ = (
        ("q", ctypes.c_double * 4),
        ("covariance", ctypes.c_double * 9),
        ("seconds", ctypes.c_double),
        ("horizontal_rate", ctypes.c_double),
        ("down_rate", ctypes.c_double),
        ("specific_force", ctypes.c_double),
        ("gravity", ctypes.c_double),
        ("noise", ctypes.c_double * 5),
        ("fine_q", ctypes.c_double * 4),
        ("fine_covariance", ctypes.c_double * 9),
        ("gyro_bias", ctypes.c_double * 3),
        ("gyro_bias_sigma", ctypes.c_double * 3),
        ("surprise", ctypes.c_double),
    )


def align_in_c(
    host: HostInC,
    increments: MajorIncrements,
    lat: float,
    h: float,
    noise: SensorNoise = ESTIMATED,
    gravity: Gravity = NORMAL,
) -> Alignment:
    """`sculler_model.navigation.align`, by the host in C; to rounding the same.

    Raises:
        InputError: as `align`.
    """
    return _coarse(_aligned(host, increments, lat, h, noise, gravity, False), lat, noise)


def align_finely_in_c(
    host: HostInC,
    increments: MajorIncrements,
    lat: float,
    h: float,
    noise: SensorNoise = ESTIMATED,
    gravity: Gravity = NORMAL,
) -> FineAlignment:
    """`sculler_model.navigation.align_finely`, by the host in C; to rounding the same.

    Raises:
        InputError: as `align`.
    """
    found = _aligned(host, increments, lat, h, noise, gravity, True)
    w, x, y, z = found.fine_q
    bias_x, bias_y, bias_z = found.gyro_bias
    north, east, down = (nan if sigma < 0 else sigma for sigma in found.gyro_bias_sigma)
    return FineAlignment(
        coarse=_coarse(found, lat, noise),
        q=(w, x, y, z),
        covariance=np.array(found.fine_covariance).reshape(3, 3),
        gyro_bias=(bias_x, bias_y, bias_z),
        gyro_bias_sigma=(north, east, down),
        surprise=found.surprise,
    )


def _aligned(
    host: HostInC,
    increments: MajorIncrements,
    lat: float,
    h: float,
    noise: SensorNoise,
    gravity: Gravity,
    fine: bool,
) -> _Found:
    """What the library found."""
    increments.require_whole("alignment")
    functions, interval = host.functions, ctypes.c_double(host.design.major_interval)
    place = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), lat, 0.0, h)
    model = NavigatorInC(host, place, gravity=gravity)
    count = ctypes.c_size_t(len(increments))
    phi, dv = (np.ascontiguousarray(a, np.float64) for a in (increments.phi, increments.dv_sf))
    known = [
        -1.0 if value is None else value
        for value in (
            noise.angle_random_walk,
            noise.velocity_random_walk,
            noise.velocity_noise,
            noise.gyro_bias,
            noise.accel_bias,
        )
    ]
    found = _Found()
    error = functions.engine_align(
        ctypes.create_string_buffer(functions.engine_align_size()),
        ctypes.create_string_buffer(functions.engine_align_steps(interval, count)),
        count,  # there is room for as many steps as intervals, or for less, all that are needed
        *(address(phi), address(dv), count, interval),
        *(ctypes.c_double(lat), ctypes.c_double(h), model.carried),
        (ctypes.c_double * 5)(*known),
        ctypes.c_int(fine),
        ctypes.byref(found),
    )
    if error:
        g = gravity_at(gravity, sin(lat), h)[1]
        refuse_unfit_window(increments, host.design.major_interval, lat, g)
        raise InputError(f"host in C: the window cannot be aligned on (error {error})")
    return found


def _coarse(found: _Found, lat: float, given: SensorNoise) -> Alignment:
    """The coarse stage's part."""
    w, x, y, z = found.q
    walk, white, blue, *_ = found.noise
    result = Alignment(
        q=(w, x, y, z),
        seconds=found.seconds,
        horizontal_rate=found.horizontal_rate,
        down_rate=found.down_rate,
        specific_force=found.specific_force,
        gravity=found.gravity,
        noise=given.completed(SensorNoise(walk, white, velocity_noise=blue)),
        covariance=np.array(found.covariance).reshape(3, 3),
        warnings=(),
    )
    return replace(result, warnings=alignment_warnings(result, lat))

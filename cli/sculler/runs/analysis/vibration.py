"""Rectified coning and sculling of a shaken sensor assembly."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np

from sculler.words import Advance, silent
from sculler_model.analysis.advice import PER_HOUR
from sculler_model.analysis.vibration import (
    Errors,
    G,
    Mount,
    MountResponse,
    Spectrum,
    respond,
    step_for,
    trial,
)
from sculler_model.design import Design

PARTS = 8
"""Runs that a check is made of."""


@dataclass(frozen=True)
class VibrationPlan:
    """What to study.

    Attributes:
        designs: by name; one at least.
        spectrum: of the vehicle's vibration.
        mount: that it passes.
        check_seconds: run so long a random vibration through the integer path; None for none.
        seed: of the check.
    """

    designs: Mapping[str, Design]
    spectrum: Spectrum
    mount: Mount
    check_seconds: float | None = None
    seed: int = 1

    @property
    def steps(self) -> int:
        """What `Advance` is told in all."""
        return PARTS * len(self.designs) if self.check_seconds is not None else 0


@dataclass(frozen=True)
class VibrationStudy:
    """What came of it.

    Attributes:
        response: of the sensor assembly, at the first design's frequencies.
        data: what --json prints, but for the picture.
    """

    response: MountResponse
    data: dict[str, Any]

    def told(self) -> dict[str, str]:
        """The motion, in rows."""
        data = self.data

        def rectified(name: str) -> str:
            found = data[name]
            return (
                f"coning {found['coning_deg_per_h']:.4g} °/h, sculling {found['sculling_y_ug']:.4g}"
                f" and {found['sculling_z_ug']:.4g} µg along y and z"
            )

        return {
            "input": f"{data['input_g_rms']:.3g} g rms",
            "sensor assembly": f"{data['response_g_rms']:.3g} g rms,"
            f" {data['rotation_y_rad_rms']:.3g} and {data['rotation_z_rad_rms']:.3g} rad rms about"
            " y and z",
            "rectified, model": rectified("model"),
            "rectified, worst phase": rectified("worst_phase"),
        }


def vibration_study(plan: VibrationPlan, *, advance: Advance = silent) -> VibrationStudy:
    """What a vibration rectifies to in a sensor assembly on isolators, and what is left of it."""
    first, designs = None, {}
    for name, design in plan.designs.items():
        step = step_for(design.table.samples, design.sensor.sample_rate_hz)
        response = respond(plan.spectrum, plan.mount, step)
        first = first or response
        designs[name] = _of_design(plan, design, response, advance)
    assert first is not None
    data = {"study": "vibration", "spectrum": plan.spectrum.name, **_motion(first)}
    return VibrationStudy(first, data | {"designs": designs})


def _of_design(
    plan: VibrationPlan, design: Design, response: MountResponse, advance: Advance
) -> dict[str, Any]:
    sensor = design.sample_interval, design.sensor.kind, design.sensor_response
    found: dict[str, Any] = {
        "sample_rate_hz": design.sensor.sample_rate_hz,
        "model": _errors(response.rectified.errors(design.table, *sensor)),
        "worst_phase": _errors(response.worst_phase.errors(design.table, *sensor)),
    }
    if plan.check_seconds is not None:
        found["check"] = _check(plan, design, plan.check_seconds, advance)
    return found


def _errors(errors: Errors) -> dict[str, float]:
    along = errors.sculling / G * 1e6
    return {
        "coning_deg_per_h": errors.coning * PER_HOUR,
        "sculling_y_ug": float(along[1]),
        "sculling_z_ug": float(along[2]),
    }


def _motion(response: MountResponse) -> dict[str, Any]:
    """What the sensor assembly feels, and what it rectifies to."""
    y, z = response.angle_rms
    motion: dict[str, Any] = {
        "input_g_rms": response.input_rms / G,
        "response_g_rms": response.force_rms / G,
        "rotation_y_rad_rms": y,
        "rotation_z_rad_rms": z,
        "rotation_rad_rms": sqrt(y * y + z * z),
    }
    for name, found in (("model", response.rectified), ("worst_phase", response.worst_phase)):
        force = found.sculling_force / G * 1e6
        motion[name] = {
            "coning_deg_per_h": found.coning_rate * PER_HOUR,
            "sculling_y_ug": float(force[1]),
            "sculling_z_ug": float(force[2]),
        }
    return motion


def _check(plan: VibrationPlan, design: Design, seconds: float, advance: Advance) -> dict[str, Any]:
    """Random vibrations through the integer path: mean errors and how sure they are."""
    coning, sculling = [], []
    for part in range(PARTS):
        found = trial(design, plan.spectrum, plan.mount, seconds / PARTS, plan.seed + part)
        coning.append((found.coning - found.true_coning) * PER_HOUR)
        sculling.append((found.sculling - found.true_sculling) / G * 1e6)
        advance(1)
    columns = np.column_stack((coning, np.array(sculling)[:, 1:]))
    names = ("coning_deg_per_h", "sculling_y_ug", "sculling_z_ug")
    means, sigmas = columns.mean(axis=0), columns.std(axis=0, ddof=1) / sqrt(PARTS)
    return {
        "seconds": seconds,
        "seed": plan.seed,
        "error": dict(zip(names, means.tolist(), strict=True)),
        "sigma": dict(zip(names, sigmas.tolist(), strict=True)),
    }

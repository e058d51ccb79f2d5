"""Calibration files: what is known of a sensor's errors, in the tables of [sensor.errors]."""

from __future__ import annotations

from pathlib import Path

from pydantic import ValidationError

from sculler_model.design import SensorErrors, fault_of
from sculler_model.errors import InputError
from sculler_model.inputs import read_toml
from sculler_model.samples import Calibration


def read_calibration(path: Path) -> Calibration:
    """A calibration file.

    Raises:
        InputError: it cannot be read, has a fault, or has what cannot be undone.
    """
    data = read_toml(path, "calibration file", "a calibration in TOML")
    try:
        errors = SensorErrors.model_validate(data)
    except ValidationError as error:
        named = dict(fault_of(SensorErrors, details) for details in error.errors())
        faults = [f"{key}: {fault}" if key else fault for key, fault in named.items()]
        raise InputError(f"{path}: " + "; ".join(faults)) from error
    try:
        return Calibration.of(errors)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error

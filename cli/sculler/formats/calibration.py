"""Calibration files: what is known of a sensor's errors, in the tables of [sensor.errors]."""

from __future__ import annotations

from pathlib import Path

from pydantic import ValidationError

from sculler_model.design import SensorErrors, faults_of
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
        raise InputError(f"{path}: " + "; ".join(faults_of(SensorErrors, error))) from error
    try:
        return Calibration.of(errors)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error

"""The formats of `convert`: which there are, and the module of `sculler.readers` that reads each.

A module of readers has `FORMATS`, a `sculler.readers.format.Format` for each of its names here.
This module imports none of them, so that `--help` is quick.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sculler.readers.format import Format

MODULES = {
    "csv": "delimited",
    "euroc": "delimited",
    "ros": "delimited",
    "kfgins": "kfgins",
    "kfgins-binary": "kfgins",
    "mat": "mat",
    "hdf5": "mat",
    "npz": "arrays",
    "parquet": "arrays",
    "psins": "psins",
    "rosbag": "rosbag",
    "stim300": "raw.stim300",
    "novatel": "raw.novatel",
    "vectornav": "raw.vectornav",
    "xsens": "raw.xsens",
    "adis16495": "raw.adis",
    "adis16470": "raw.adis",
    "adis16470-32": "raw.adis",
    "hg4930": "raw.hg4930",
    "front": "raw.front",
}
"""Names of formats, and of the modules."""


def find(name: str) -> Format:
    """The format of a name of `MODULES`."""
    module = import_module(f"sculler.readers.{MODULES[name]}")
    found: Format = next(each for each in module.FORMATS if each.name == name)
    return found


def every() -> Iterator[Format]:
    """All formats, in the order of `MODULES`."""
    return map(find, MODULES)

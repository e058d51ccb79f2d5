"""Values that are handed out stay as they are: many are kept, and shared by all who ask again."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import is_dataclass
from importlib import import_module
from pkgutil import walk_packages

import sculler.formats.comparison
import sculler_model

COUNTED = {"_Run", "FrontCounters"}
"""Those that count or collect, and so change."""


def dataclasses() -> Iterator[type]:
    names = [found.name for found in walk_packages(sculler_model.__path__, "sculler_model.")]
    for name in [*names, sculler.formats.comparison.__name__]:
        for value in vars(import_module(name)).values():
            if isinstance(value, type) and is_dataclass(value) and value.__module__ == name:
                yield value


def test_no_value_can_be_changed() -> None:
    found = {kind: kind.__dataclass_params__.frozen for kind in dataclasses()}  # type: ignore[attr-defined]
    assert len(found) > 50
    assert {kind.__name__ for kind, frozen in found.items() if not frozen} == COUNTED

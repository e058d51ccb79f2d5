"""From a mapping as TOML has it to a design: presets filled in, faults put into words."""

from __future__ import annotations

import difflib
import re
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from sculler_model.design.presets import PRESETS
from sculler_model.errors import InputError


def with_preset(data: dict[str, Any], faults: list[str], where: str) -> dict[str, Any]:
    """Take `preset` out of the data and put what it stands for under the file's own entries."""
    data = dict(data)
    names = []
    if "preset" in data:
        names.append(("preset", data.pop("preset")))
    sensor = data.get("sensor")
    if isinstance(sensor, dict) and "preset" in sensor:
        data["sensor"] = {key: value for key, value in sensor.items() if key != "preset"}
        names.append(("sensor.preset", sensor["preset"]))
    if not names:
        return data
    key, name = names[0]
    if len(names) > 1 and names[1][1] != name:
        faults.append(f"sensor.preset: {names[1][1]!r} and preset = {name!r} differ, give one")
    if not isinstance(name, str) or name not in PRESETS:
        known = ", ".join(sorted(PRESETS))
        raise InputError(f"{where}: {key}: {_short(name)} is not known, give one of {known}")
    merged = _merge(PRESETS[name], data)
    if "name" not in merged:
        merged["name"] = name  # stands where samples or minors have faults of their own
        match merged["algorithm"]:
            case {"samples": int(samples), "minors": int(minors)} if min(samples, minors) > 0:
                merged["name"] = f"{name}_{samples}x{minors}"
    return merged


def _merge(base: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in over.items():
        below = merged.get(key)
        both = isinstance(below, dict) and isinstance(value, dict)
        merged[key] = _merge(below, value) if both else value  # type: ignore[arg-type]
    return merged


def faults_of(root: type[BaseModel], error: ValidationError) -> list[str]:
    """What is wrong with a file, in words: one fault a key.

    Args:
        root: what the file's tables were to be.
        error: what pydantic found.
    """
    # of the ways to read a value, the last one looked deepest
    named = dict(_fault_of(root, details) for details in error.errors())
    return [f"{key}: {fault}" if key else fault for key, fault in named.items()]


def _fault_of(root: type[BaseModel], details: ErrorDetails) -> tuple[str, str]:
    """One pydantic error as its key and what is wrong and allowed."""
    path = [str(part) for part in details["loc"]]
    part: type[BaseModel] = root
    allowed = ""
    known: list[str] = []
    key: list[str] = []
    for step in path:
        field = part.model_fields.get(step)
        if field is None and step.isdigit() and key:  # one of several filters
            key[-1] += f"[{step}]" if step != "0" else ""
            continue
        if field is None:
            known = list(part.model_fields)
            if details["type"] == "extra_forbidden":
                key.append(step if step.isprintable() else repr(step))
            break
        key.append(step)
        allowed = field.description or ""
        inner = _table_in(field.annotation)
        if inner is None:
            break
        part = inner
    name = ".".join(key)
    if details["type"] == "extra_forbidden":
        near = difflib.get_close_matches(key[-1], known, n=1)
        hint = f"did you mean {near[0]}?" if near else f"the keys here are {', '.join(known)}"
        return name, f"unknown key, {hint}"
    if details["type"] == "missing":
        return name, f"missing, give {allowed}"
    if details["type"] == "value_error":
        fault = str(details["ctx"]["error"])
        # the fault names its key itself
        own = re.match(rf"((?:{name}|sensor|algorithm)\.[^: ]+): (.*)", fault)
        return (own[1], own[2]) if own else (name, fault)
    return name, f"{_short(details['input'])} is not allowed, give {allowed}"


def _table_in(annotation: Any) -> type[BaseModel] | None:
    """The table of the design file that a key of this type holds, alone or in a list."""
    parts = get_args(annotation)
    if parts:
        return next((table for table in map(_table_in, parts) if table is not None), None)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return None


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."

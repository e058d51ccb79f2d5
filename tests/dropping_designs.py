"""Designs with `overrun = "drop-result"`, on both cores in all their forms."""

from __future__ import annotations

from typing import Any

from position_designs import HIGH_RESOLUTION
from sculler_model.design import Design
from strategies import DESIGNS, with_hardware

_FORMS: dict[str, dict[str, Any]] = {
    "pipelined": {},
    "streaming": {"handover": "stream"},
    "ecp5": {"target": "ecp5"},
    "shared-streaming-ice40": {"multipliers": 12, "handover": "stream", "target": "ice40"},
    "compact": {"core": "compact"},
    "compact-ice40": {"core": "compact", "target": "ice40"},
    "compact-ecp5": {"core": "compact", "target": "ecp5"},
}
_SHAPES = {
    "stim300_4x5": list(_FORMS),
    "smallest": list(_FORMS),
    "wide_5p0": ["streaming", "shared-streaming-ice40"],
    "dense_odd_3": ["ecp5", "compact-ice40"],
    "smallest_hr": ["streaming", "compact"],
    "taylor_2p1_hr": ["ecp5", "compact-ecp5"],
}

DROPPING: dict[str, Design] = {
    f"{name}-{form}": with_hardware(
        {**DESIGNS, **HIGH_RESOLUTION}[name], overrun="drop-result", **_FORMS[form]
    )
    for name, forms in _SHAPES.items()
    for form in forms
}
DROPPING["smallest-serial"] = with_hardware(
    DESIGNS["smallest"], core="compact", multipliers=0, overrun="drop-result"
)
"""By NAME-FORM."""

FEW_DROPPING: dict[str, Design] = {
    name: DROPPING[name]
    for name in (
        "stim300_4x5-ecp5",
        "smallest-pipelined",
        "wide_5p0-streaming",
        "dense_odd_3-compact-ice40",
        "smallest-compact",
    )
}
"""One or two of each kind."""

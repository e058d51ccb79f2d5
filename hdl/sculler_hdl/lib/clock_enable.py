"""A clock enable for parts that have vendors' blocks among them."""

from __future__ import annotations

from typing import Any

from amaranth import EnableInserter
from amaranth.hdl import Instance

_ENABLES = {
    "MULT18X18D": ("CE0",),
    "SB_MAC16": ("CE",),
    "MULTPREADD18X18": ("CEA", "CEB", "CEC", "CEOUT"),
    "MULT18X18": ("CE",),
    "DP16KD": ("CEA", "CEB", "OCEB"),
}
"""What lets a block's registers move, or its memory be written."""


class ClockEnableInserter(EnableInserter):
    """Amaranth's `EnableInserter`, which stops vendors' blocks too; use it in the same way.

    While the enable is low, registers and memories keep what they hold and instances of the blocks
    that this package makes do so too.  A reset goes before it.

    Args:
        controls: the enable of the domain `sync`, or enables by domain.
    """

    def on_fragment(self, fragment: Any) -> Any:
        made = super().on_fragment(fragment)
        if isinstance(made, Instance):
            enable = self.controls.get("sync")
            for port in _ENABLES.get(made.type, ()) if enable is not None else ():
                value, direction = made.ports[port]
                made.ports[port] = (value & enable, direction)
        return made

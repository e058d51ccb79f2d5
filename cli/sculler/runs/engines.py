"""Which simulator runs the hardware."""

from __future__ import annotations

import os
from typing import Literal

from sculler_model.errors import InputError

SimulationEngine = Literal["verilator", "amaranth"]
"""The emitted Verilog in Verilator, or the Amaranth design in its own simulator."""

_ADVICE = (", or choose the engine amaranth", "; or choose the engine amaranth")


def choose_engine() -> tuple[SimulationEngine, str | None]:
    """Verilator where it can be used, else Amaranth; and why not Verilator, in a line.

    Raises:
        InputError: $CXX is set and cannot be used.
    """
    why = why_no_verilator()
    return ("verilator", None) if why is None else ("amaranth", why)


def why_no_verilator() -> str | None:
    """What Verilator lacks here, in a line; None if it can be used.

    Raises:
        InputError: $CXX is set and cannot be used.
    """
    from sculler_sim.engines.verilator_build import Tools

    try:
        Tools.find()
    except InputError as error:
        if "CXX" in os.environ:
            raise
        reason = str(error)
        for advice in _ADVICE:
            reason = reason.removesuffix(advice)
        return reason
    return None

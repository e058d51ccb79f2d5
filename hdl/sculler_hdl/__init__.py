"""What becomes gates: the integer coning/sculling core in Amaranth, and its Verilog.

    generate(design)    the Verilog text, its `Manifest`, models of vendor blocks, a listing
    build_core(design)  the core as an Amaranth component, for one's own top level
    ClockedCore(core)   the same with the clock, reset and clock enable of the Verilog module
    properties(design)  what the core promises on its ports, as SystemVerilog assertions
    StreamCore(design)  the same with Amaranth's streams at its boundary
    timing(design)      the clocks that the core takes, without building it
    expected_rate(design)   the clock rate it may count on, from designs that were placed

It may import the exact side of `sculler_model` only.  Inside, arrows point one way:

    export  ─▶  clocked  ─▶  core  ─▶  pipelined, compact  ─▶  lib  ─▶  plan  ─▶  targets

`plan` is plain Python: what to build, with its clocks and widths.  The others are Amaranth.  The
names below are loaded when they are first used, so that a plan needs no Amaranth.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sculler_hdl.bus.bus import ResultBus as ResultBus
    from sculler_hdl.clocked import ClockedCore as ClockedCore
    from sculler_hdl.core import Core as Core
    from sculler_hdl.core import build_core as build_core
    from sculler_hdl.export.amaranth_source import amaranth_source as amaranth_source
    from sculler_hdl.export.manifest import Manifest as Manifest
    from sculler_hdl.export.manifest import describe_ports as describe_ports
    from sculler_hdl.export.manifest import module_ports as module_ports
    from sculler_hdl.export.properties import PROPERTIES as PROPERTIES
    from sculler_hdl.export.properties import properties as properties
    from sculler_hdl.export.unit import unit_ports as unit_ports
    from sculler_hdl.export.verilog import Generated as Generated
    from sculler_hdl.export.verilog import generate as generate
    from sculler_hdl.lib.clock_enable import ClockEnableInserter as ClockEnableInserter
    from sculler_hdl.plan.bus_ports import BUS_PREFIXES as BUS_PREFIXES
    from sculler_hdl.plan.bus_ports import own_bus_ports as own_bus_ports
    from sculler_hdl.plan.bus_ports import packet_sample_ports as packet_sample_ports
    from sculler_hdl.plan.bus_ports import unread_ports as unread_ports
    from sculler_hdl.plan.front import front_counter_ports as front_counter_ports
    from sculler_hdl.plan.front import front_ports as front_ports
    from sculler_hdl.plan.front import pin_ports as pin_ports
    from sculler_hdl.plan.ports import Port as Port
    from sculler_hdl.plan.ports import component_ports as component_ports
    from sculler_hdl.plan.ports import counter_ports as counter_ports
    from sculler_hdl.plan.ports import result_ports as result_ports
    from sculler_hdl.plan.ports import sample_ports as sample_ports
    from sculler_hdl.plan.registers import RegisterMap as RegisterMap
    from sculler_hdl.plan.timing import timing as timing
    from sculler_hdl.rates import ExpectedRate as ExpectedRate
    from sculler_hdl.rates import Placed as Placed
    from sculler_hdl.rates import expected_rate as expected_rate
    from sculler_hdl.rates import kind_of as kind_of
    from sculler_hdl.rates import placed_designs as placed_designs
    from sculler_hdl.rates import rate_of as rate_of
    from sculler_hdl.streams import StreamCore as StreamCore
    from sculler_hdl.streams import result_layout as result_layout
    from sculler_hdl.streams import sample_layout as sample_layout
    from sculler_hdl.targets import BLOCK_ATTRIBUTES as BLOCK_ATTRIBUTES
    from sculler_hdl.targets import TARGETS as TARGETS
    from sculler_hdl.targets import Target as Target
    from sculler_hdl.targets import cell_models as cell_models

_PLACES = {
    "BLOCK_ATTRIBUTES": "targets",
    "BUS_PREFIXES": "plan.bus_ports",
    "ClockEnableInserter": "lib.clock_enable",
    "ClockedCore": "clocked",
    "PROPERTIES": "export.properties",
    "Core": "core",
    "ExpectedRate": "rates",
    "Generated": "export.verilog",
    "Manifest": "export.manifest",
    "Placed": "rates",
    "Port": "plan.ports",
    "RegisterMap": "plan.registers",
    "ResultBus": "bus.bus",
    "StreamCore": "streams",
    "TARGETS": "targets",
    "Target": "targets",
    "amaranth_source": "export.amaranth_source",
    "build_core": "core",
    "cell_models": "targets",
    "component_ports": "plan.ports",
    "counter_ports": "plan.ports",
    "describe_ports": "export.manifest",
    "expected_rate": "rates",
    "front_counter_ports": "plan.front",
    "front_ports": "plan.front",
    "generate": "export.verilog",
    "kind_of": "rates",
    "module_ports": "export.manifest",
    "own_bus_ports": "plan.bus_ports",
    "packet_sample_ports": "plan.bus_ports",
    "pin_ports": "plan.front",
    "placed_designs": "rates",
    "properties": "export.properties",
    "rate_of": "rates",
    "result_layout": "streams",
    "result_ports": "plan.ports",
    "sample_layout": "streams",
    "sample_ports": "plan.ports",
    "timing": "plan.timing",
    "unit_ports": "export.unit",
    "unread_ports": "plan.bus_ports",
}

__all__ = [
    "BLOCK_ATTRIBUTES",
    "BUS_PREFIXES",
    "PROPERTIES",
    "TARGETS",
    "ClockEnableInserter",
    "ClockedCore",
    "Core",
    "ExpectedRate",
    "Generated",
    "Manifest",
    "Placed",
    "Port",
    "RegisterMap",
    "ResultBus",
    "StreamCore",
    "Target",
    "amaranth_source",
    "build_core",
    "cell_models",
    "component_ports",
    "counter_ports",
    "describe_ports",
    "expected_rate",
    "front_counter_ports",
    "front_ports",
    "generate",
    "kind_of",
    "module_ports",
    "own_bus_ports",
    "packet_sample_ports",
    "pin_ports",
    "placed_designs",
    "properties",
    "rate_of",
    "result_layout",
    "result_ports",
    "sample_layout",
    "sample_ports",
    "timing",
    "unit_ports",
    "unread_ports",
]


def __getattr__(name: str) -> object:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_PLACES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

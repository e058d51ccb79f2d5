"""What is read off a core's gates without a solver: who depends on whom, what a reset does.

Gates and registers are those of Yosys after `simplemap`, one bit each.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sculler_model.design import Design
from sculler_sim.place.tools import YOSYS, ToolError
from sculler_sim.prove.problem import write_core

_SCRIPT = """
read_verilog {sources}
hierarchy -check -top {name}
proc
flatten
delete t:$print
memory_map
opt -full
dffunmap -ce-only
simplemap
techmap
simplemap
opt_clean
write_json gates.json
"""

_REGISTER = re.compile(
    r"\$_(?:DFF_P_|DFFE_P(?P<only>[PN])_"
    r"|SDFFE?_P(?P<reset>[PN])(?P<value>[01])(?P<enable>[PN])?_)"
)
"""Registers of a rising clock; a reset goes before the enable."""

_GATES = {"$_NOT_": "A", "$_AND_": "AB", "$_OR_": "AB", "$_XOR_": "AB", "$_MUX_": "ABS"}

_SAME, _OTHER = 2, 3
"""Beside 0 and 1, levels in two cores that are compared: unknown, but the same; perhaps not."""

_PATIENCE = 64
"""Clocks after a reset that are looked at."""

Net = int | str
"""A net's number, or the constant "0", "1" or "x"."""


@dataclass(frozen=True)
class _Driver:
    """The gate or register that drives a net, and the nets that it is made of, by port."""

    type: str
    nets: dict[str, Net]

    @property
    def inputs(self) -> str:
        """Of a gate, its ports."""
        return _GATES[self.type]

    @property
    def register(self) -> re.Match[str] | None:
        """If it is one."""
        return _REGISTER.fullmatch(self.type)


class Gates:
    """A core as gates.

    Args:
        design: the design.
        folder: to work in, a folder that is there.
        verilog: in place of the core's text.

    Raises:
        InputError: Yosys is not installed.
        ToolError: it failed.
    """

    def __init__(self, design: Design, folder: Path, verilog: str | None = None) -> None:
        script = _SCRIPT.format(sources=write_core(design, folder, verilog), name=design.name)
        (folder / "gates.ys").write_text(script, encoding="utf-8")
        status, said = YOSYS.run(folder, "-q", "gates.ys")
        if status:
            raise ToolError(YOSYS, said)
        module = json.loads((folder / "gates.json").read_text())["modules"][design.name]
        self._ports: dict[str, list[Net]] = {
            name: port["bits"] for name, port in module["ports"].items()
        }
        self.inputs = [n for n, port in module["ports"].items() if port["direction"] == "input"]
        self.outputs = [n for n, port in module["ports"].items() if port["direction"] == "output"]
        self._driven = _drivers(module["cells"].values())
        self._initial = _initial(module["netnames"].values())

    def within_a_clock(self, output: str) -> set[str]:
        """The inputs that an output depends on without a register between."""
        met = self._cone(self._ports[output], through=False)
        return {name for name in self.inputs if name != "clk" and met & set(self._ports[name])}

    def forgets_after(self, outputs: Iterable[str]) -> int | None:
        """How long these outputs can tell a reset from power-up, and never in what they show.

        Two cores are followed: one is reset for a clock from any state, the other powers up.
        Inputs are the same and anything.  A second reset begins the same again.

        Returns:
            Clocks after the reset until all registers that these outputs ever depend on hold the
            same in both; 0 where one clock of reset puts all of them to their initial values.
            None where they do not within `_PATIENCE`, or an output may differ before.
        """
        shown = [net for output in outputs for net in self._ports[output]]
        cone = self._cone(shown, through=True)
        registers = [net for net in cone if net in self._driven and self._driven[net].register]
        state = self._after(dict.fromkeys(registers, _OTHER), reset=1)
        for net, value in state.items():
            if value != self._initial.get(net, _OTHER):
                state[net] = _OTHER
        for clocks in range(_PATIENCE):
            if _OTHER not in state.values():
                return clocks
            levels = self._levels(state, 0)
            if any(self._level(net, levels) == _OTHER for net in shown):
                return None
            state = self._after(state, reset=0)
        return None

    def _after(self, state: dict[Net, int], reset: int) -> dict[Net, int]:
        """The registers a clock later."""
        levels = self._levels(state, reset)
        return {net: self._next(net, levels) for net in state}

    def _levels(self, state: dict[Net, int], reset: int) -> dict[Net, int]:
        inputs = {net: _SAME for name in self.inputs for net in self._ports[name]}
        return {"0": 0, "1": 1, **inputs, self._ports["rst"][0]: reset, **state}

    def _next(self, net: Net, levels: dict[Net, int]) -> int:
        """What a register holds in the next clock."""
        driver = self._driven[net]
        form = driver.register
        assert form is not None
        level = {port: self._level(n, levels) for port, n in driver.nets.items() if port in "DER"}
        value = level["D"]
        if "E" in level:
            enabled = (
                level["E"] ^ ((form["only"] or form["enable"]) == "N")
                if level["E"] < _SAME
                else level["E"]
            )
            value = _choice(enabled, levels[net], value)
        if "R" in level:
            reset = level["R"] ^ (form["reset"] == "N") if level["R"] < _SAME else level["R"]
            value = _choice(reset, value, int(form["value"]))
        return value

    def _level(self, net: Net, levels: dict[Net, int]) -> int:
        """A net's level; those that it is made of are put into `levels`."""
        left = [net]
        while left:  # no recursion: logic may be deep
            now = left[-1]
            driver = self._driven.get(now)
            if now in levels or driver is None or driver.register:
                levels.setdefault(now, _OTHER)
                left.pop()
                continue
            missing = [n for p, n in driver.nets.items() if p != "Y" and n not in levels]
            if missing:
                left += missing
                continue
            levels[now] = _gate(driver.type, [levels[driver.nets[p]] for p in driver.inputs])
            left.pop()
        return levels[net]

    def _cone(self, starts: Iterable[Net], *, through: bool) -> set[Net]:
        """All nets that these are made of, through registers or up to them."""
        met: set[Net] = set()
        left = list(starts)
        while left:
            net = left.pop()
            if net in met:
                continue
            met.add(net)
            driver = self._driven.get(net)
            if driver is not None and (through or not driver.register):
                left += (n for port, n in driver.nets.items() if port not in ("C", "Q", "Y"))
        return met


def _choice(select: int, low: int, high: int) -> int:
    """What a multiplexer gives."""
    if select < _SAME:
        return high if select else low
    if low == high and low < _SAME:
        return low
    return max(select, low, high)


def _gate(kind: str, levels: Sequence[int]) -> int:
    """What a gate gives: a level if it is known, else whether both cores have the same."""
    unknown = max(levels)
    if kind == "$_MUX_":
        return _choice(levels[2], levels[0], levels[1])
    if kind == "$_AND_":
        return 0 if 0 in levels else unknown
    if kind == "$_OR_":
        return 1 if 1 in levels else unknown
    if unknown >= _SAME:
        return unknown
    return 1 - levels[0] if kind == "$_NOT_" else levels[0] ^ levels[1]


def _drivers(cells: Iterable[Any]) -> dict[Net, _Driver]:
    driven: dict[Net, _Driver] = {}
    for cell in cells:
        if cell["type"] == "$scopeinfo":
            continue
        if cell["type"] not in _GATES and not _REGISTER.fullmatch(cell["type"]):
            raise ToolError(YOSYS, f"{cell['type']} is no gate that is known here")
        nets = {port: nets[0] for port, nets in cell["connections"].items()}
        driven[nets["Q" if "Q" in nets else "Y"]] = _Driver(cell["type"], nets)
    return driven


def _initial(nets: Iterable[Any]) -> dict[Net, int]:
    """The value of each bit at power-up, where it has one."""
    found: dict[Net, int] = {}
    for net in nets:
        value = net["attributes"].get("init")
        if value is not None:
            for bit, character in zip(net["bits"], reversed(value), strict=False):
                if character in "01":
                    found[bit] = int(character)
    return found

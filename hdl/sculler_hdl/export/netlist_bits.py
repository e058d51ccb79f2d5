"""What Amaranth 0.5 does with each bit of a netlist, in less time and room (`netlist`).

The functions take the places of those of Amaranth that they are named after.
"""

from __future__ import annotations

from typing import Any

from amaranth.hdl import _ast, _ir, _nir

_CONSTANTS = _nir.Net(0), _nir.Net(1)
_emit_rhs = _ir.NetlistEmitter.emit_rhs


def from_const(bit: int) -> Any:
    """As `Net.from_const`: 0 or 1."""
    return _CONSTANTS[bit]


def from_cell(cell: int, bit: int) -> Any:
    """As `Net.from_cell`: a bit of a cell's output."""
    return _nir.Net(cell << 16 | bit)


def value(cls: type, nets: Any = ()) -> Any:
    """As `Value(nets)`: of one net, or of some, the lowest first."""
    if type(nets) is cls:
        return nets
    return tuple.__new__(cls, (nets,) if isinstance(nets, _nir.Net) else nets)


def add_value_cell(netlist: Any, width: int, cell: Any) -> Any:
    """As `Netlist.add_value_cell`: a cell, and the nets that it drives."""
    if width > 1 << 16:
        raise AssertionError(f"{width} bits are more than a cell may have")
    first = netlist.add_cell(cell) << 16
    return _nir.Value(map(_nir.Net, range(first, first + width)))


def alloc_late_value(netlist: Any, signal: Any) -> Any:
    """As `Netlist.alloc_late_value`: nets below 0, which are but other names."""
    last = netlist.last_late_net
    netlist.last_late_net = first = last - len(signal)
    return _nir.Value(map(_nir.Net, range(first, last)))


class Connections:
    """What drives each net below 0, as a dict has it.

    Attributes:
        drivers: of the nets -1, -2 and so on; None for nothing yet.
    """

    def __init__(self) -> None:
        self.drivers: list[Any] = []

    def __contains__(self, net: Any) -> bool:
        return ~net < len(self.drivers) and self.drivers[~net] is not None

    def __getitem__(self, net: Any) -> Any:
        return self.drivers[~net]

    def __setitem__(self, net: Any, driver: Any) -> None:
        self.drivers += [None] * (1 + ~net - len(self.drivers))
        self.drivers[~net] = driver

    def clear(self) -> None:
        """Forget them."""
        self.drivers.clear()


class NamesOfBits:
    """The signal and the number of its bit that a net below 0 stands for, as a dict has it."""

    def __init__(self, netlist: Any) -> None:
        self._netlist = netlist

    def __getitem__(self, net: Any) -> tuple[Any, int]:
        for signal, nets in self._netlist.signals.items():
            if net in nets:
                return signal, nets.index(net)
        raise KeyError(net)


def emit_signal(emitter: Any, signal: Any) -> Any:
    """As `NetlistEmitter.emit_signal`: the nets of a signal."""
    signals = emitter.netlist.signals
    if signal not in signals:
        signals[signal] = emitter.netlist.alloc_late_value(signal)
    return signals[signal]


def emit_rhs(emitter: Any, module: int, value: Any) -> Any:
    """As `NetlistEmitter.emit_rhs`: the nets of a value, and whether it is signed.

    Slices and what is joined, which most are, are told by their types alone.
    """
    kind, cache = type(value), emitter.rhs_cache
    if kind is not _ast.Slice and kind is not _ast.Concat:
        return _emit_rhs(emitter, module, value)
    if id(value) not in cache:
        if kind is _ast.Slice:
            nets = emitter.emit_rhs(module, value.value)[0][value.start : value.stop]
        else:
            nets = [net for part in value.parts for net in emitter.emit_rhs(module, part)[0]]
        cache[id(value)] = _nir.Value(nets), False, value
    return cache[id(value)][:2]


def extend(emitter: Any, nets: Any, signed: bool, width: int) -> Any:
    """As `NetlistEmitter.extend`: by the sign or by zeros, to `width` bits at least."""
    missing = width - len(nets)
    if missing <= 0:
        return _nir.Value(nets)
    return _nir.Value((*nets, *[nets[-1] if signed else _CONSTANTS[0]] * missing))


def connect(emitter: Any, lhs: Any, rhs: Any, *, src_loc: Any) -> None:
    """As `NetlistEmitter.connect`: nets below 0, and what drives them.

    Raises:
        DriverConflict: something does already.
    """
    assert len(lhs) == len(rhs)
    connections = emitter.netlist.connections
    for left, right in zip(lhs, rhs, strict=True):
        if left in connections:
            signal, bit = emitter.netlist.late_to_signal[left]
            other = next(at for nets, at in emitter.connect_src_loc.items() if left in nets)
            raise _ir.DriverConflict(
                f"Bit {bit} of signal {signal!r} has multiple drivers: "
                f"{other[0]}:{other[1]} and {src_loc[0]}:{src_loc[1]}"
            )
        connections[left] = right
    emitter.connect_src_loc[lhs] = src_loc


def emit_undriven(emitter: Any) -> None:
    """As `NetlistEmitter.emit_undriven`: bits that nothing drives have their initial value."""
    connections = emitter.netlist.connections
    for signal, nets in emitter.netlist.signals.items():
        for bit, net in enumerate(nets):
            if net < 0 and net not in connections:
                connections[net] = _CONSTANTS[signal.init >> bit & 1]


def resolve_value(netlist: Any, nets: Any) -> Any:
    """As `Netlist.resolve_value`: what drives each net."""
    if not nets or min(nets) >= 0:
        return nets
    drivers, found = netlist.connections.drivers, []
    for net in nets:
        while net < 0:
            net = drivers[~net]
        found.append(net)
    return _nir.Value(found)


def sigspec(emitter: Any, *parts: Any) -> str:
    """As `rtlil.ModuleEmitter.sigspec`: the text of some nets, each part's lowest first."""
    nets: list[Any] = []
    for part in parts:
        if isinstance(part, _nir.Net):
            nets.append(part)
        else:
            nets.extend(part)
    chunks = []
    wires, place, count = emitter.nets, 0, len(nets)
    while place < count:
        begin = place
        if nets[begin] <= 1:
            while place < count and 0 <= nets[place] <= 1:
                place += 1
            bits = "".join("1" if net else "0" for net in reversed(nets[begin:place]))
            chunks.append(f"{place - begin}'{bits}")
            continue
        wire, low = wires[nets[begin]]
        high = low
        place += 1
        while place < count and nets[place] > 1:
            other, bit = wires[nets[place]]
            if other is not wire or bit != high + 1:
                break
            high = bit
            place += 1
        chunks.append(f"{wire.name} [{low}]" if high == low else f"{wire.name} [{high}:{low}]")
    return chunks[0] if len(chunks) == 1 else "{ " + " ".join(reversed(chunks)) + " }"

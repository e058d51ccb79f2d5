"""Amaranth's netlist of single bits, made with less work where it is large.

Amaranth 0.5 keeps a number for every bit of every signal.  It looks at the type of each when it
joins them, and follows each back through everything that it is made of to find combinational loops.
A large core has two million.  While `quick_netlists` lasts, bits are joined without that look, and
loops are sought among whole cells first: a loop of bits runs through cells that make a loop, so
where cells make none there is none.  Where they do, Amaranth's own search decides.  The netlist is
the same.  What is done with is let go at once: nested functions that call themselves hold a netlist
until Python looks for garbage, which takes two seconds.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from threading import RLock, get_ident
from typing import Any
from unittest.mock import patch

from amaranth.hdl import _nir

_one_thread_at_a_time = RLock()


@contextmanager
def quick_netlists() -> Iterator[None]:
    """Let Amaranth make netlists so; of another version of it as it does by itself.

    Another thread waits for its turn.  The netlists that this thread makes meanwhile are emptied at
    the end; those of a thread that does not ask for it stay.
    """
    made: list[Any] = []
    thread = get_ident()

    def begin(netlist: Any) -> None:
        if get_ident() == thread:
            made.append(netlist)
        _begin(netlist)

    with _one_thread_at_a_time, ExitStack() as stack:
        if _is_known():
            stack.enter_context(patch.object(_nir.Value, "__new__", _value))
            for name, function in _METHODS.items():
                stack.enter_context(patch.object(_nir.Netlist, name, function))
            stack.enter_context(patch.object(_nir.Netlist, "__init__", begin))
        yield
    for netlist in made:
        vars(netlist).clear()


def _is_known() -> bool:
    """Whether this Amaranth has what is replaced, and nets are numbers as here."""
    return (
        all(hasattr(_nir.Netlist, name) for name in _METHODS)
        and issubclass(_nir.Net, int)
        and issubclass(_nir.Value, tuple)
        and _nir.Net.from_cell(3, 5) == 3 << 16 | 5
    )


def _value(cls: type, nets: Any = ()) -> Any:
    return tuple.__new__(cls, (nets,) if isinstance(nets, _nir.Net) else nets)


def _add_value_cell(netlist: Any, width: int, cell: Any) -> Any:
    """As `Netlist.add_value_cell`: a cell, and the nets that it drives."""
    if width > 1 << 16:
        raise AssertionError(f"{width} bits are more than a cell may have")
    first = netlist.add_cell(cell) << 16
    return _nir.Value(map(_nir.Net, range(first, first + width)))


def _resolve_value(netlist: Any, value: Any) -> Any:
    """As `Netlist.resolve_value`: what drives each net; a net below 0 is but another name."""
    if not value or min(value) >= 0:
        return value
    return _nir.Value(map(netlist.resolve_net, value))


def _resolve_all_nets(netlist: Any) -> None:
    """As `Netlist.resolve_all_nets`; what the other names stood for is not needed after it."""
    _resolve_all(netlist)
    netlist.connections.clear()
    netlist.late_to_signal.clear()


_begin, _resolve_all = _nir.Netlist.__init__, _nir.Netlist.resolve_all_nets
_check_every_bit = _nir.Netlist.check_comb_cycles


def _check_comb_cycles(netlist: Any) -> None:
    """As `Netlist.check_comb_cycles`: raises `CombinationalCycle` where there is one."""
    if _loops(netlist):
        _check_every_bit(netlist)


_METHODS: dict[str, Any] = {
    "add_value_cell": _add_value_cell,
    "resolve_value": _resolve_value,
    "resolve_all_nets": _resolve_all_nets,
    "check_comb_cycles": _check_comb_cycles,
}


def _loops(netlist: Any) -> bool:
    """Whether whole cells make a combinational loop."""
    connections, state = netlist.connections, bytearray(len(netlist.cells))
    for begin in range(1, len(netlist.cells)):
        if state[begin]:
            continue
        state[begin] = _UNDER_WAY
        path = [(begin, _sources(netlist.cells[begin], connections))]
        while path:
            cell, sources = path[-1]
            for source in sources:
                if state[source] == _UNDER_WAY:
                    return True
                if not state[source]:
                    state[source] = _UNDER_WAY
                    path.append((source, _sources(netlist.cells[source], connections)))
                    break
            else:
                state[cell] = _DONE
                path.pop()
    return False


_UNDER_WAY, _DONE = 1, 2


def _sources(cell: Any, connections: dict[Any, Any]) -> Iterator[int]:
    """The cells whose outputs a cell's outputs follow at once."""
    nets: Iterable[Any]
    if isinstance(cell, _nir.FlipFlop):
        nets = {cell.clk, cell.arst}
    elif isinstance(cell, (_nir.SyncReadPort, _nir.Instance)):
        nets = ()
    else:
        nets = cell.input_nets()
    found = set()
    for net in nets:
        while net < 0:
            net = connections[net]
        found.add(net >> 16)
    found.discard(0)  # constants and inputs
    return iter(found)

"""Amaranth's netlist of single bits, made with less work and room where it is large.

Amaranth 0.5 keeps a number for every bit of every signal.  It looks at the type of each when it
joins them, keeps the name of each for messages, and follows each back through everything that it is
made of to find combinational loops.  A large core has a million.  While `quick_netlists` lasts

* when a statement is put into a module, nothing looks through what it reads for values of
  simulators, nor at each bit it drives for a driver in another clock domain: both are refused later
  (`netlist_statements`);
* bits are joined without that look, and names of bits are looked up when a message needs them
  (`netlist_bits`);
* slices and what is joined, of which most values are made, are told by their types alone, and stay
  the same objects where clock domains are put in (`netlist_statements`);
* loops are sought among whole cells first: a loop of bits runs through cells that make a loop, so
  where cells make none there is none.  Where they do, Amaranth's own search decides;
* of the bits that stay in their module nothing is kept when ports of modules are found;
* what is done with is let go at once: nested functions that call themselves hold it until Python
  looks for garbage, which takes two seconds.

The netlist and its text are the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from threading import RLock, get_ident
from typing import Any
from unittest.mock import patch

from amaranth.back import rtlil
from amaranth.hdl import _ast, _dsl, _ir, _nir, _xfrm

from sculler_hdl.export import netlist_bits, netlist_statements

_one_thread_at_a_time = RLock()


def rtlil_text(design: Any, name: str) -> str:
    """As Amaranth's `rtlil.convert_fragment`, without source locations, one module after another.

    Args:
        design: a prepared design, of which nothing but its ports is left.
        name: of its module.

    Raises:
        CombinationalCycle, DriverConflict: as Amaranth has it.
    """
    texts = []
    with quick_netlists():
        netlist = _ir.build_netlist(design, name=name)
        empty = rtlil.EmptyModuleChecker(netlist)
        names = _ast.SignalDict()
        for index, module in enumerate(netlist.modules):
            if empty.is_empty(index):
                continue
            alone = rtlil.Design(emit_src=False)
            made = alone.module(".".join(module.name))
            if index == 0:
                made.attribute("top", 1)
            emitter = rtlil.ModuleEmitter(made, netlist, module, names, empty_checker=empty)
            emitter.emit()
            texts.append(str(alone))
            vars(emitter).clear()
    return "".join(texts)


@contextmanager
def quick_netlists() -> Iterator[None]:
    """Let Amaranth make netlists so; of another version of it as it does by itself.

    Another thread waits for its turn.  The netlists that this thread makes meanwhile are emptied at
    the end, and the prepared design of each as soon as its netlist is there; those of a thread that
    does not ask for it stay.
    """
    made: list[Any] = []
    thread = get_ident()

    def begin(netlist: Any) -> None:
        _begin(netlist)
        netlist.connections = netlist_bits.Connections()
        netlist.late_to_signal = netlist_bits.NamesOfBits(netlist)
        if get_ident() == thread:
            made.append(netlist)

    def emit(netlist: Any, design: Any, **kwargs: Any) -> None:
        _emit_netlist(netlist, design, **kwargs)
        if get_ident() == thread:  # its ports are all that is asked for again
            ports = design.ports
            vars(design).clear()
            design.ports = ports

    with _one_thread_at_a_time, ExitStack() as stack:
        if _is_known():
            for owner, functions in _REPLACED.items():
                for name, function in functions.items():
                    stack.enter_context(patch.object(owner, name, function))
            stack.enter_context(patch.object(_nir.Netlist, "__init__", begin))
            stack.enter_context(patch.object(_ir, "_emit_netlist", emit))
        yield
    for netlist in made:
        vars(netlist).clear()


def _is_known() -> bool:
    """Whether this Amaranth has what is replaced, and nets are numbers as here."""
    return (
        all(hasattr(owner, name) for owner, names in _REPLACED.items() for name in names)
        and hasattr(_ir, "_emit_netlist")
        and issubclass(_nir.Net, int)
        and issubclass(_nir.Value, tuple)
        and _nir.Net.from_cell(3, 5) == 3 << 16 | 5
    )


_begin, _resolve_all = _nir.Netlist.__init__, _nir.Netlist.resolve_all_nets
_check_every_bit = _nir.Netlist.check_comb_cycles


def _emit_netlist(netlist: Any, design: Any, **kwargs: Any) -> None:
    """As `_ir._emit_netlist`; what nested functions hold of it is let go."""
    emitter = _ir.NetlistEmitter(netlist, design, **kwargs)
    emitter.emit_fragment(design.fragment, None)
    vars(emitter).clear()


def _resolve_all_nets(netlist: Any) -> None:
    """As `Netlist.resolve_all_nets`; what the other names stood for is not needed after it."""
    _resolve_all(netlist)
    netlist.connections.clear()


def _check_comb_cycles(netlist: Any) -> None:
    """As `Netlist.check_comb_cycles`: raises `CombinationalCycle` where there is one."""
    if _loops(netlist):
        _check_every_bit(netlist)


def _loops(netlist: Any) -> bool:
    """Whether whole cells make a combinational loop."""
    drivers, state = netlist.connections.drivers, bytearray(len(netlist.cells))
    for begin in range(1, len(netlist.cells)):
        if state[begin]:
            continue
        state[begin] = _UNDER_WAY
        path = [(begin, _sources(netlist.cells[begin], drivers))]
        while path:
            cell, sources = path[-1]
            for source in sources:
                if state[source] == _UNDER_WAY:
                    return True
                if not state[source]:
                    state[source] = _UNDER_WAY
                    path.append((source, _sources(netlist.cells[source], drivers)))
                    break
            else:
                state[cell] = _DONE
                path.pop()
    return False


_UNDER_WAY, _DONE = 1, 2


def _sources(cell: Any, drivers: list[Any]) -> Iterator[int]:
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
            net = drivers[~net]
        found.add(net >> 16)
    found.discard(0)  # constants and inputs
    return iter(found)


def _compute_net_flows(netlist: Any) -> None:
    """As `_ir._compute_net_flows`, of the bits that are used beyond the module of their cell.

    Each module between the two gets an entry: "output" on the way up from the cell, "input" on the
    way down to the use, "internal" where both ways meet.  Bits without one stay in their module.
    """
    modules = netlist.modules
    home = [cell.module_idx for cell in netlist.cells]
    flows = [module.net_flow for module in modules]
    parent = [module.parent for module in modules]
    depth = [len(module.name) for module in modules]
    meets: dict[int, int] = {}  # where the ways of a bit meet so far
    internal, inward, outward = (
        _nir.ModuleNetFlow.Internal,
        _nir.ModuleNetFlow.Input,
        _nir.ModuleNetFlow.Output,
    )

    def use(net: Any, user: int) -> None:
        if net in flows[user]:
            return
        maker = meets.get(net, home[net >> 16])
        while depth[maker] > depth[user]:
            flows[maker][net] = outward
            maker = parent[maker]
        while depth[maker] < depth[user]:
            if net in flows[user]:
                return
            flows[user][net] = inward
            user = parent[user]
        while maker != user:
            flows[maker][net], flows[user][net] = outward, inward
            maker, user = parent[maker], parent[user]
        flows[maker][net] = internal
        meets[net] = maker

    for cell in netlist.cells:
        user = cell.module_idx
        for net in cell.input_nets():
            if net > 1 and home[net >> 16] != user:
                use(net, user)
    for user, module in enumerate(modules):
        for signal in module.signal_names:
            for net in netlist.signals[signal]:
                if net > 1 and home[net >> 16] != user:
                    use(net, user)


_REPLACED: dict[Any, dict[str, Any]] = {
    _dsl: {
        "_check_rhs": netlist_statements.check_nothing,
        "LHSMaskCollector": netlist_statements.NoTargets,
    },
    _xfrm.ValueTransformer: {
        "on_value": netlist_statements.on_value,
        "on_Slice": netlist_statements.on_slice,
        "on_Concat": netlist_statements.on_concat,
    },
    _ast.SignalDict: {"__contains__": netlist_statements.contains},
    _ir.Design: {"_collect_used_signals_value": netlist_statements.collect_used_signals},
    _nir.Net: {
        "from_const": staticmethod(netlist_bits.from_const),
        "from_cell": staticmethod(netlist_bits.from_cell),
    },
    _nir.Value: {"__new__": netlist_bits.value},
    _nir.Netlist: {
        "add_value_cell": netlist_bits.add_value_cell,
        "alloc_late_value": netlist_bits.alloc_late_value,
        "resolve_value": netlist_bits.resolve_value,
        "resolve_all_nets": _resolve_all_nets,
        "check_comb_cycles": _check_comb_cycles,
    },
    _ir.NetlistEmitter: {
        "emit_signal": netlist_bits.emit_signal,
        "emit_rhs": netlist_bits.emit_rhs,
        "extend": netlist_bits.extend,
        "connect": netlist_bits.connect,
        "emit_undriven": netlist_bits.emit_undriven,
    },
    rtlil.ModuleEmitter: {"sigspec": netlist_bits.sigspec},
    _ir: {"_compute_net_flows": _compute_net_flows},
}
"""Functions of Amaranth, by owner and name, and what does the same for them."""

"""What Amaranth 0.5 does with each value of a statement, in less time and room (`netlist`).

The functions take the places of those of Amaranth that they are named after.
"""

from __future__ import annotations

from typing import Any

from amaranth.hdl import _ast, _ir, _xfrm

_on_value = _xfrm.ValueTransformer.on_value
_collect_used_signals_value = _ir.Design._collect_used_signals_value


def check_nothing(value: Any) -> None:
    """In the place of `_dsl._check_rhs`: what only simulators can read has no nets either."""


class NoTargets:
    """In the place of `_dsl.LHSMaskCollector`: drivers in two domains are found among nets."""

    def visit_stmt(self, statement: Any) -> None:
        """Nothing is kept of a statement."""

    def masks(self) -> tuple[()]:
        """Nothing is assigned."""
        return ()


def contains(signals: Any, signal: Any) -> bool:
    """As `signal in SignalDict`, without an exception where it is not."""
    return signals._map_key(signal) in signals._storage


def on_value(lowerer: Any, whole: Any) -> Any:
    """As `ValueTransformer.on_value`; kinds that are frequent are told by their types alone."""
    kind = type(whole)
    if kind is _ast.Signal:
        return lowerer.on_Signal(whole)
    if kind is _ast.Slice:
        made = lowerer.on_Slice(whole)
    elif kind is _ast.Concat:
        made = lowerer.on_Concat(whole)
    elif kind is _ast.Operator:
        made = lowerer.on_Operator(whole)
    else:
        return _on_value(lowerer, whole)
    made.src_loc = whole.src_loc
    return made


def on_slice(lowerer: Any, whole: Any) -> Any:
    """As `ValueTransformer.on_Slice`; a slice of what stays as it is stays too.

    Operators are made anew each time, as Amaranth does it, so that no two uses share a cell.
    """
    inner = lowerer.on_value(whole.value)
    return whole if inner is whole.value else _ast.Slice(inner, whole.start, whole.stop)


def on_concat(lowerer: Any, whole: Any) -> Any:
    """As `ValueTransformer.on_Concat`; what is joined of parts that stay stays too."""
    parts = [lowerer.on_value(part) for part in whole.parts]
    same = all(new is old for new, old in zip(parts, whole.parts, strict=True))
    return whole if same else _ast.Concat(parts)


def collect_used_signals(design: Any, fragment: Any, value: Any) -> None:
    """As `Design._collect_used_signals_value`: marks the signals of a value as used."""
    kind = type(value)
    if kind is _ast.Signal:
        design._use_signal(fragment, value)
    elif kind is _ast.Slice:
        design._collect_used_signals_value(fragment, value.value)
    elif kind is _ast.Concat:
        for part in {id(part): part for part in value.parts}.values():
            design._collect_used_signals_value(fragment, part)
    else:
        _collect_used_signals_value(design, fragment, value)

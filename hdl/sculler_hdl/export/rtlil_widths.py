"""Write out operand widths in RTLIL, so that the Verilog text has no implicit ones.

Verilog gives ``a + b`` the width of what it is assigned to and extends or cuts without a word;
linters ask that this be written.  This pass rewrites the additions, subtractions and comparisons
of a module so that both operands and the result are equally wide:

* a sum whose top bits nobody reads loses them (it is exact modulo 2^width all the same),
* narrower operands are extended by their sign, or by zeros.

Products lose unread top bits too, but their operands are left alone: synthesisers size multipliers
by the operands' widths, and linters accept them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from sculler_hdl.export.rtlil_text import Cell, Module, pieces, slice_of

_SUMS = ("$add", "$sub")
_COMPARISONS = ("$eq", "$ne", "$lt", "$le", "$gt", "$ge")
_RESULT = "\\Y"


def equal_widths(module: Module) -> None:
    """Put every addition, subtraction and comparison of a module at one width.

    ``$logic_not`` of several bits becomes a comparison with 0.
    """
    widths = module.widths
    needed = _needed_widths(module, widths)
    for cell in module.cells.values():
        if cell.kind in (*_SUMS, "$mul", *_COMPARISONS, "$logic_not"):
            _equalise(cell, widths, needed)
    for name, width in needed.items():
        module.wires[name].width = width


def _needed_widths(module: Module, widths: Mapping[str, int]) -> dict[str, int]:
    """How many low bits of each sum's result wire are read, for those not read whole."""
    sums = {cell.connections[_RESULT] for cell in module.cells.values() if _is_sum(cell)}
    read: dict[str, int] = {}
    for signal in _others(module):
        for name, low, width in pieces(signal, widths):
            if name in widths:
                read[name] = max(read.get(name, 0), low + width)
    return {name: read[name] for name in sums & read.keys() if read[name] < widths[name]}


def _is_sum(cell: Cell) -> bool:
    return cell.kind in (*_SUMS, "$mul")


def _others(module: Module) -> Iterator[str]:
    """All signals but the results of sums and products."""
    for cell in module.cells.values():
        for port, signal in cell.connections.items():
            if port != _RESULT or not _is_sum(cell):
                yield signal
    for pair in module.connections:
        yield from pair


def _equalise(cell: Cell, widths: Mapping[str, int], needed: Mapping[str, int]) -> None:
    parameters, connections = cell.parameters, cell.connections
    if cell.kind == "$logic_not":
        cell.kind = "$eq"
        bits = int(parameters["\\A_WIDTH"])
        parameters |= {"\\A_SIGNED": "0", "\\B_SIGNED": "0", "\\B_WIDTH": str(bits)}
        connections["\\B"] = f"{bits}'{'0' * bits}"
    if _is_sum(cell):
        width = needed.get(connections[_RESULT], int(parameters["\\Y_WIDTH"]))
        parameters["\\Y_WIDTH"] = str(width)
        if cell.kind == "$mul":
            return
    else:
        width = max(int(parameters[f"\\{port}_WIDTH"]) for port in "AB")
    signed = all(parameters[f"\\{port}_SIGNED"] == "1" for port in "AB")
    for port in "AB":
        missing = width - int(parameters[f"\\{port}_WIDTH"])
        if missing > 0:
            signal = connections[f"\\{port}"]
            fill = top_bit(signal, widths) if signed else "1'0"
            connections[f"\\{port}"] = f"{{ {' '.join([fill] * missing)} {signal} }}"
            parameters[f"\\{port}_WIDTH"] = str(width)


def top_bit(signal: str, widths: Mapping[str, int]) -> str:
    """The most significant bit of an RTLIL signal expression, itself as an expression.

    Args:
        signal: a wire, a slice, a constant or a concatenation (most significant part first).
        widths: widths of the module's wires.
    """
    name, low, width = pieces(signal, widths)[-1]
    if name not in widths:  # a constant
        return f"1'{name[0]}"
    return slice_of(name, low + width - 1, 1, widths[name])

"""Choices of many, as of a state machine, written as choices of two.

Yosys writes them as a `casez` whose patterns overlap in the eyes of Verilator.
"""

from __future__ import annotations

from sculler_hdl.export.rtlil_text import Cell, Module, Wire, bits_in, of_bits


def choices_of_two(module: Module) -> None:
    """Put a chain of ``$mux`` cells in the place of each ``$pmux``, whose selectors exclude."""
    for name in [name for name, cell in module.cells.items() if cell.kind == "$pmux"]:
        cell = module.cells.pop(name)
        width = int(cell.parameters["\\WIDTH"])
        widths = module.widths
        choices = bits_in(cell.connections["\\B"], widths)
        selectors = bits_in(cell.connections["\\S"], widths)
        value = cell.connections["\\A"]
        for number, selector in enumerate(selectors):
            last = number == len(selectors) - 1
            result = cell.connections["\\Y"] if last else f"{name}${number}"
            if not last:
                module.wires[result] = Wire(width)
            module.cells[f"{name}$mux{number}"] = Cell(
                "$mux",
                {"\\WIDTH": str(width)},
                {
                    "\\A": value,
                    "\\B": of_bits(choices[number * width : (number + 1) * width], widths),
                    "\\S": of_bits([selector], widths),
                    "\\Y": result,
                },
            )
            value = result

"""What systemrdl-compiler reads in the emitted description of the registers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

Facts = dict[str, tuple[int, int]]
"""Of each field: the address of its register, and its mask.  Window: address, and words."""


def from_rdl(text: str, folder: Path) -> tuple[Facts, dict[str, int]]:
    """What systemrdl-compiler reads: fields, and their reset values."""
    pytest.importorskip("systemrdl", reason="systemrdl-compiler is not installed")
    from systemrdl import RDLCompiler
    from systemrdl.node import RegNode

    path = folder / "registers.rdl"
    path.write_text(text)
    compiler = RDLCompiler()
    compiler.compile_file(str(path))
    facts: Facts = {}
    resets: dict[str, int] = {}
    for node in compiler.elaborate().top.descendants():
        if not isinstance(node, RegNode):
            continue
        if node.is_array:
            assert node.array_stride == 4
            facts[node.inst_name] = (node.raw_address_offset, node.n_elements)
            continue
        for field in node.fields():
            name = f"{node.inst_name}_{field.inst_name}"
            mask = (1 << field.high + 1) - (1 << field.low)
            facts[name] = (node.absolute_address, mask)
            reset: Any = field.get_property("reset")
            if reset is not None:
                resets[name] = reset
    return facts, resets

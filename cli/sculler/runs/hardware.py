"""A design's hardware as files."""

from __future__ import annotations

import json
from pathlib import Path

from sculler_hdl import Generated, generate, timing
from sculler_model.design import Design
from sculler_model.outputs import gathering
from sculler_sim.testbench import write_testbench


def texts_of(generated: Generated) -> dict[str, str]:
    """The files of a generated core, but for its test bench: texts by name."""
    name = generated.manifest.design.name
    texts = {
        f"{name}.v": generated.verilog,
        f"{name}.json": json.dumps(generated.manifest.as_json(), indent=2) + "\n",
        **{f"{cell}.v": text for cell, text in generated.cells.items()},
    }
    if generated.listing is not None:
        texts[f"{name}_schedule.txt"] = generated.listing
    return texts


def write_hardware(design: Design, folder: Path) -> list[Path]:
    """Verilog, manifest and test bench of a design; they appear together.

    Returns:
        The files, in `folder`, which is made if need be.

    Raises:
        InputError: the folder cannot be made or written to.
    """
    generated = generate(design)
    texts = texts_of(generated)
    with gathering(folder) as gathered:
        for name, text in texts.items():
            (gathered / name).write_text(text, encoding="utf-8", newline="\n")
        bench = write_testbench(design, gathered, timing(design), generated.cells)
        names = [*texts, *(file.name for file in bench)]
    return [folder / name for name in names]

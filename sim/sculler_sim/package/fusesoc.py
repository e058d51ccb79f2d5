"""NAME.core: the package for FuseSoC, in its core description format CAPI2.

Targets: `lint` (Verilator), `sim` (the generated bench in Icarus Verilog) and `sim_verilator` (the
same in Verilator); for a board, one of its name, which ends in a bitstream.

Source of the format: FuseSoC's documentation, "CAPI2 reference"; of the flows' options: Edalize's
documentation.
"""

from __future__ import annotations

from typing import Any

from sculler_model.errors import InputError
from sculler_sim.package.boards import Board
from sculler_sim.package.contents import LIBRARY, VENDOR, Contents


def fusesoc_core(contents: Contents, board: Board | None = None) -> str:
    """The text of NAME.core.

    Args:
        contents: the package.
        board: whose top level goes with it.

    Raises:
        InputError: PyYAML is not installed.
    """
    try:
        import yaml
    except ImportError as error:
        raise InputError("PyYAML is not installed, run: pip install 'sculler[package]'") from error
    text: str = yaml.safe_dump(_core(contents, board), sort_keys=False, width=100)
    return f"CAPI=2:\n{text}"


def _core(contents: Contents, board: Board | None) -> dict[str, Any]:
    name = contents.name
    filesets: dict[str, Any] = {
        "rtl": {"files": list(contents.verilog), "file_type": "verilogSource-2005"},
        "bench": {"files": _bench(contents)},
        "sdc": {"files": [{f"{name}.sdc": {"file_type": "SDC"}}]},
    }
    if contents.models:
        models = {"files": list(contents.models), "file_type": "verilogSource-2005"}
        filesets["models"] = models
    with_models = ["rtl", *(["models"] if contents.models else [])]
    targets: dict[str, Any] = {
        "default": {"filesets": ["rtl"]},
        "lint": {
            "description": "Lint by Verilator, with all warnings",
            "filesets": with_models,
            "toplevel": contents.top,
            "flow": "lint",
            "flow_options": {"tool": "verilator", "verilator_options": ["-Wall"]},
        },
        **_simulations(name, [*with_models, "bench"]),
    }
    if board is not None:
        filesets[board.name] = _board_files(contents.name, board)
        targets[board.name] = _board_target(contents.name, board)
    return {
        "name": f"{VENDOR}:{LIBRARY}:{name}:{contents.version}",
        "description": contents.summary,
        "filesets": filesets,
        "targets": targets,
    }


def _simulations(name: str, filesets: list[str]) -> dict[str, Any]:
    return {
        "sim": {
            "description": "The self-checking test bench in Icarus Verilog",
            "filesets": filesets,
            "toplevel": f"{name}_tb",
            "flow": "sim",
            "flow_options": {"tool": "icarus", "iverilog_options": ["-g2005", "-Wall"]},
        },
        "sim_verilator": {
            "description": "The self-checking test bench in Verilator, 5 or newer",
            "filesets": filesets,
            "toplevel": f"{name}_tb",
            "flow": "sim",
            "flow_options": {
                "tool": "verilator",
                "mode": "binary",
                "verilator_options": [*"--timing --output-split 0 -CFLAGS -std=c++20".split()],
            },
        },
    }


def _bench(contents: Contents) -> list[Any]:
    """The bench reads its vectors in the folder where it runs."""
    bench, *vectors = contents.bench
    copied = [{file: {"file_type": "user", "copyto": file}} for file in vectors]
    return [{bench: {"file_type": "verilogSource-2005"}}, *copied]


def _board_files(name: str, board: Board) -> dict[str, Any]:
    pins, kind = board.pin_file(name), "LPF" if board.family == "ecp5" else "PCF"
    files = [*board.sources(name), {pins: {"file_type": kind}}]
    return {"files": files, "file_type": "verilogSource-2005"}


def _board_target(name: str, board: Board) -> dict[str, Any]:
    return {
        "description": f"Bitstream for the {board.title}",
        "filesets": [board.name],
        "toplevel": f"{name}_{board.name}",
        "flow": {"ecp5": "trellis", "ice40": "icestorm"}[board.family],
        "flow_options": {
            "nextpnr_options": [*board.options.split(), "--report", "report.json"],
        },
    }

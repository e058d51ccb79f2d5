"""What a core takes of a device, counted in the netlist."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from sculler_sim.place.devices import Family
from sculler_sim.place.nextpnr import Usage


@dataclass(frozen=True)
class Area:
    """What the core takes by itself, without the harness.

    Attributes:
        luts: look-up tables with 4 inputs (Xilinx, Intel: 6; GateMate: of all kinds): logic, carry
            chains and small memories.
        flip_flops: flip-flops.
        multipliers: multiplier blocks.
        memories: block RAMs (Xilinx: of 18 kbit, GateMate: of 20 kbit).
        usage: by kind of the device's cells, used and available; empty where the core is not packed
            alone.
    """

    luts: int
    flip_flops: int
    multipliers: int
    memories: int
    usage: Usage


class _Cells(NamedTuple):
    """Kinds of a family's cells: look-up tables and memories each takes; names' beginnings."""

    luts: Mapping[str, int]
    flip_flops: tuple[str, ...]
    multipliers: tuple[str, ...]
    memories: Mapping[str, int]


def _ones(kinds: str) -> dict[str, int]:
    return dict.fromkeys(kinds.split(), 1)


# CCU2C and CCU2 are two look-up tables with a carry; 16 words of 4 bits take four, and two for the
# write port
_KINDS: dict[Family, _Cells] = {
    "ecp5": _Cells(
        {"LUT4": 1, "CCU2C": 2, "TRELLIS_DPR16X4": 6},
        ("TRELLIS_FF",),
        ("MULT18X18D",),
        _ones("DP16KD PDPW16KD"),
    ),
    "ice40": _Cells({"SB_LUT4": 1}, ("SB_DFF",), ("SB_MAC16",), {"SB_RAM40_4K": 1}),
    "nexus": _Cells(
        {"LUT4": 1, "CCU2": 2, "WIDEFN9": 2, "DPR16X4": 6},
        ("FD1P3",),
        ("MULT18X18", "MULTPREADD18X18"),
        _ones("PDPSC16K PDP16K DP16K"),
    ),
    "gowin": _Cells(
        _ones("LUT1 LUT2 LUT3 LUT4 ALU RAM16SDP1") | {"RAM16SDP2": 2, "RAM16SDP4": 4},
        ("DFF",),
        ("MULT18X18",),
        _ones("SP SPX9 SDPB SDPX9B DPB DPX9B pROM pROMX9"),
    ),
    "gatemate": _Cells(
        _ones("CC_LUT1 CC_LUT2 CC_L2T4 CC_L2T5 CC_MX2 CC_ADDF"),
        ("CC_DFF",),
        (),
        {"CC_BRAM_20K": 1, "CC_BRAM_40K": 2},
    ),
    "xilinx": _Cells(
        _ones("LUT1 LUT2 LUT3 LUT4 LUT5 LUT6 SRL16E SRLC32E RAM32X1D RAM64X1D")
        | {"RAM32M": 4, "RAM64M": 4, "RAM32M16": 8, "RAM64M8": 8},
        ("FD",),
        ("DSP48E1", "DSP48E2"),
        {"RAMB18E1": 1, "RAMB36E1": 2, "RAMB18E2": 1, "RAMB36E2": 2},
    ),
    "intel": _Cells(
        _ones("MISTRAL_NOT MISTRAL_ALUT2 MISTRAL_ALUT3 MISTRAL_ALUT4 MISTRAL_ALUT5")
        | _ones("MISTRAL_ALUT6 MISTRAL_ALUT_ARITH MISTRAL_MLAB"),
        ("MISTRAL_FF",),
        ("MISTRAL_MUL9X9", "MISTRAL_MUL18X18", "MISTRAL_MUL27X27"),
        {"MISTRAL_M10K": 1},
    ),
}


def count(family: Family, counts: Mapping[str, int], usage: Usage) -> Area:
    """The area of a netlist.

    Args:
        family: whose cells it has.
        counts: how many, by type (`Synthesis.counts`).
        usage: of the core packed alone.
    """
    kinds = _KINDS[family]
    return Area(
        luts=sum(each * counts.get(kind, 0) for kind, each in kinds.luts.items()),
        flip_flops=sum(n for kind, n in counts.items() if kind.startswith(kinds.flip_flops)),
        multipliers=sum(counts.get(kind, 0) for kind in kinds.multipliers),
        memories=sum(each * counts.get(kind, 0) for kind, each in kinds.memories.items()),
        usage=usage,
    )


ROOM: dict[str, dict[str, str]] = {
    "ecp5": {
        "logic cells": "TRELLIS_COMB",
        "flip-flops": "TRELLIS_FF",
        "multipliers": "MULT18X18D",
        "block RAMs": "DP16KD",
    },
    "ice40": {
        "logic cells": "ICESTORM_LC",
        "multipliers": "ICESTORM_DSP",
        "block RAMs": "ICESTORM_RAM",
    },
}
"""What a device has, and nextpnr's name for it."""

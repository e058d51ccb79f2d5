"""The whole navigation computer on one chip: `sculler soc`.

    plan.py        what is asked for, and what a design must have for a chip
    texts.py       the top level, the firmware's sources, the processor from its package
    firmware.py    compiles them
    telemetry.py   what the chip sent, as vectors and states
    following.py   what Python's navigator makes of its results
    flight.py      a log through the chip in Verilator

It uses `sculler.host_c` for the firmware's arithmetic and `sculler_sim.chip` for the simulation.
"""

from sculler.soc.firmware import Firmware, compile_firmware, makefile, require_compiler
from sculler.soc.flight import Flight, fly_log
from sculler.soc.following import Aligned, Followed, follow
from sculler.soc.plan import ChipAlignment, SocPlan, check_soc, chip_alignment
from sculler.soc.telemetry import ALIGNMENT, ChipRecord, read_chip
from sculler.soc.texts import firmware_texts, soc_texts

__all__ = [
    "ALIGNMENT",
    "Aligned",
    "ChipAlignment",
    "ChipRecord",
    "Firmware",
    "Flight",
    "Followed",
    "SocPlan",
    "check_soc",
    "chip_alignment",
    "compile_firmware",
    "firmware_texts",
    "fly_log",
    "follow",
    "makefile",
    "read_chip",
    "require_compiler",
    "soc_texts",
]

"""The whole navigation computer on one chip: `sculler soc`.

    texts.py       the top level, the firmware's sources, the processor from its package
    firmware.py    compiles them
    telemetry.py   what the chip sent, as vectors and states
    flight.py      a log through the chip in Verilator

It uses `sculler.host_c` for the firmware's arithmetic and `sculler_sim.chip` for the simulation.
"""

from sculler.soc.firmware import Firmware, compile_firmware, makefile, require_compiler
from sculler.soc.flight import Flight, fly_log
from sculler.soc.telemetry import ChipRecord, read_chip
from sculler.soc.texts import SocPlan, check_soc, firmware_texts, soc_texts

__all__ = [
    "ChipRecord",
    "Firmware",
    "Flight",
    "SocPlan",
    "check_soc",
    "compile_firmware",
    "firmware_texts",
    "fly_log",
    "makefile",
    "read_chip",
    "require_compiler",
    "soc_texts",
]

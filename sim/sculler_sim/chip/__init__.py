"""A whole chip in Verilator: its sensor's bytes in, by UART or SPI, bytes of its telemetry out.

`fly` compiles a chip's Verilog once and runs it, clock by clock; its memory's content is read when
it starts, so a new firmware needs no new simulator.
"""

from sculler_sim.chip.simulator import Chip, Sent, fly

__all__ = ["Chip", "Sent", "fly"]

"""The ports of every core, by name, with what they mean."""

from __future__ import annotations

from typing import NamedTuple

from sculler_model.design import AXES, Design
from sculler_model.golden import COUNTER_BITS, PORT_MAJOR_BITS, WORD_BITS


class Port(NamedTuple):
    """A port: its name, its width, whether it holds a signed number, whether it is an output.

    `told` is what it means, where that does not follow from its name.
    """

    name: str
    bits: int
    signed: bool = False
    output: bool = False
    told: str = ""

    @property
    def declared_signed(self) -> bool:
        """Whether it is declared so; a single bit, which is always 0 then, is not."""
        return self.signed and self.bits > 1

    @property
    def direction(self) -> str:
        """As Verilog has it."""
        return "output" if self.output else "input"

    @property
    def meaning(self) -> str:
        """In words, for the manifest and the head of the Verilog."""
        return self.told or _meaning(self.name)


def clock_ports(design: Design) -> list[Port]:
    """Those that the Verilog module has and the Amaranth component has not: clock, reset, enable.

    The reset is `rst`, or `rst_n` where it is active low.
    """
    ports = [Port("clk", 1), Port(reset_name(design), 1, told=reset_told(design))]
    return [*ports, Port("clk_en", 1)] if design.hardware.clock_enable else ports


def part_clock_ports(design: Design) -> list[Port]:
    """Those of a part around the core, which goes on while the core stands still."""
    told = "clock enable of the core, which gives and takes only while it is high"
    return [
        port._replace(told=told) if port.name == "clk_en" else port for port in clock_ports(design)
    ]


def reset_name(design: Design, of: str = "rst") -> str:
    """What a reset port is called: with `_n` where it is active low."""
    return f"{of}_n" if design.hardware.reset_active == "low" else of


def reset_told(design: Design) -> str:
    """What kind of reset it is."""
    hardware = design.hardware
    kind = (
        "asynchronous reset, which ends with the clock"
        if hardware.resets_at_once
        else "synchronous reset"
    )
    return f"{kind}, active {hardware.reset_active or 'high'}"


def sample_ports(design: Design) -> list[Port]:
    """The ports that a sample stands on, in their order: counts, fault mark, tags of a channel."""
    counts = [
        Port(f"sample_{sensor}_{axis}", getattr(design.words, sensor).bits, signed=True)
        for sensor in ("gyro", "accel")
        for axis in AXES
    ]
    tags = [Port("sample_channel", channel_bits(design)), Port("sample_restart", 1)]
    return [*counts, Port("sample_fault", 1), *(tags if design.channels > 1 else [])]


def channel_bits(design: Design) -> int:
    """Width of the number of a channel."""
    return (design.channels - 1).bit_length()


def component_ports(design: Design) -> list[Port]:
    """The ports of a result's components, where all are shown at once."""
    return [
        Port(
            f"result_{vector}_{axis}", getattr(design.words, vector).bits, signed=True, output=True
        )
        for vector in design.vectors
        for axis in AXES
    ]


def result_ports(design: Design) -> list[Port]:
    """The ports that a result, or a word of it, stands on, in their order."""
    if design.hardware.handover == "stream":
        words = [Port("result_data", WORD_BITS, output=True), Port("result_last", 1, output=True)]
        if design.channels == 1:
            return words
        return [*words, Port("result_channel", channel_bits(design), output=True)]
    head = [
        Port("result_major", PORT_MAJOR_BITS, output=True),
        Port("result_status", design.status_bits, output=True),
    ]
    return [*head, *component_ports(design)]


def counter_ports(design: Design) -> list[Port]:
    """The ports that count what was lost since reset."""
    names = ["samples_lost", *(["results_dropped"] if design.drops_results else [])]
    return [Port(name, COUNTER_BITS, output=True) for name in names]


def core_ports(design: Design) -> list[Port]:
    """All ports in the order they stand in the Verilog; `clk` and `rst` apart."""
    return [
        Port("sample_valid", 1),
        Port("sample_ready", 1, output=True),
        *sample_ports(design),
        Port("result_valid", 1, output=True),
        Port("result_ready", 1),
        *result_ports(design),
        *counter_ports(design),
        *([] if design.hardware.hardening is None else [Port("upset", 1, output=True)]),
    ]


_MEANINGS = {
    "clk": "clock, rising edge",
    "rst": "synchronous reset, active high",
    "clk_en": "clock enable: while it is low all but the reset stands still",
    "sample_valid": "a sample is offered",
    "sample_ready": "the offered sample is taken in this clock",
    "sample_channel": "whose sample it is, from 0; one that is not there is taken for nothing",
    "sample_restart": "its channel begins anew with this sample: no history, results from 0",
    "result_channel": "whose result it is, the same with all its words",
    "sample_fault": "the sensor marks this sample; shown in result_status bit 1",
    "result_valid": "a result, or a word of it, waits",
    "result_ready": "the host takes what waits in this clock",
    "result_data": "a word of the result, 16 bits; columns in order, least significant word first",
    "result_last": "this word is the result's last",
    "result_major": "number of the major interval, from 0 after reset",
    "result_status": "bit 0: history reached before the first sample; bit 1: a sample had fault;"
    " bit 2: a count stood at its rail; bit 3: a sample was lost",
    "upset": "an upset was seen; as long as result_status bit 4 tells so",
    "samples_lost": "samples offered and not taken since reset; at its highest: so many or more",
    "results_dropped": "results dropped since reset; at its highest: so many or more",
}

_VECTOR_MEANINGS = {
    "alpha": "angle sum over Dw",
    "nu": "velocity sum over Dw",
    "coning_within": "coning inside minor intervals over Dc",
    "coning_between": "coning between minor intervals over 2 Dw^2",
    "sculling_within": "sculling inside minor intervals over Dc",
    "sculling_between": "sculling between minor intervals over 2 Dw^2",
    "s_alpha": "integral of the angle sum over the sample interval, over 12",
    "s_nu": "integral of the velocity sum over the sample interval, over 12",
    "scrolling": "scrolling over the sample interval, over 4320",
    "coning_third": "coning of third order over D3",
    "sculling_third": "sculling of third order over D3",
    "coning_fourth": "coning of fourth order over D4",
    "sculling_fourth": "sculling of fourth order over D4",
}


def _meaning(port: str) -> str:
    if port in _MEANINGS:
        return _MEANINGS[port]
    kind, _, name = port.partition("_")
    if kind == "sample":
        sensor, axis = name.split("_")
        return f"{'gyro' if sensor == 'gyro' else 'accelerometer'} counts, {axis} axis"
    vector, axis = name.rsplit("_", 1)
    return f"{_VECTOR_MEANINGS[vector]}, {axis} axis"

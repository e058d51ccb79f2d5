"""The design file's [hardware.bus]: how results leave the core, and samples come, by a bus."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from sculler_model.schema import Part

DEEPEST = 1024
"""Results that a bus can hold."""


class Bus(Part):
    """What stands between the core and a host's bus: NAME_bus.v.

    Attributes:
        result: how results are handed over.  "axi-lite", "wishbone" (B4, classic),
            "wishbone-pipelined" and "apb": a file of registers; "axi-stream": a packet a result;
            "stream": the same with plain valid and ready.
        sample: where samples come from.  "ports": the core's sample port; "axi-stream": a packet a
            sample; "stream": the same with plain valid and ready; "front": the sensor front end,
            and so it is where there is one.
        depth: results that wait for the host, a power of two.
        time_stamps: whether a counter of clocks tells when samples came and results were made.
        clock: "same", the bus has the core's clock; "separate", a clock of its own.
    """

    result: Annotated[
        Literal["stream", "axi-stream", "axi-lite", "wishbone", "wishbone-pipelined", "apb"],
        Field(
            description='"stream", "axi-stream", "axi-lite", "wishbone", "wishbone-pipelined" or'
            ' "apb"'
        ),
    ]
    sample: Annotated[
        Literal["ports", "axi-stream", "stream", "front"] | None,
        Field(description='"ports", "axi-stream", "stream" or "front"'),
    ] = None
    depth: Annotated[
        int, Field(ge=2, le=DEEPEST, description=f"a power of two from 2 to {DEEPEST}")
    ] = 4
    time_stamps: Annotated[bool, Field(description="true or false")] = True
    clock: Annotated[Literal["same", "separate"], Field(description='"same" or "separate"')] = (
        "same"
    )

    @field_validator("sample")
    @classmethod
    def _ports_are_left_unsaid(cls, value: str | None) -> str | None:
        return None if value == "ports" else value

    @field_validator("depth")
    @classmethod
    def _depth_is_a_power_of_two(cls, depth: int) -> int:
        if depth & (depth - 1):
            raise ValueError(f"{depth} is not allowed, give a power of two from 2 to {DEEPEST}")
        return depth

    @property
    def has_registers(self) -> bool:
        """Whether the host reads and writes registers, and does not get a stream."""
        return self.result not in ("stream", "axi-stream")

    @property
    def takes_packets(self) -> bool:
        """Whether samples come as packets."""
        return self.sample in ("axi-stream", "stream")

    @property
    def depth_log2(self) -> int:
        """The results that it holds, as a power of two."""
        return self.depth.bit_length() - 1

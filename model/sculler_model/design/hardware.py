"""The design file's [hardware]: how it becomes gates."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, ValidationInfo, field_validator, model_validator

from sculler_model.design.bus import Bus
from sculler_model.design.front import Front
from sculler_model.schema import Part

MOST_CHANNELS = 1024
"""Sensors that one core may serve."""


class Hardware(Part):
    """How it becomes gates.  Field order matters: later ones are checked against earlier.

    Attributes:
        core: "pipelined" (fast) or "compact" (small, one multiplication at a time).
        target: whose multiplier and memory blocks to use; "generic" leaves them to the
            synthesiser.
        multipliers: multiplier blocks the core may use.  The pipelined core takes as many clocks
            per sample as follow from it, and without it one, or with orders above 2 as many as it
            must.  The compact core uses 1 (default)
            or 0.
        bus: what stands between the core and a host's bus; None: the core's own ports.
        handover: "parallel" shows a whole result at once, "stream" word by word (`stream`); the
            compact core streams, the pipelined core does what is asked, by default
            "parallel".  With a bus both stream.
        overrun: what gives way when results are not taken in time.  "drop-sample", which is the
            default: the sensor is made to wait, and a sample that cannot is lost, which status
            bit 3 tells; "drop-result": the oldest result that waits, which `results_dropped`
            tells.
        initial: whether the text gives registers and memories the values they have before the
            first reset, which is the default.  False leaves them out, for devices and ASICs that
            have none; then nothing means anything until the core has been reset for one clock.
        front: the sensor's wire, where a front end reads it; None without one.
        reset: "sync", which is the default: it acts with the clock; "async": it acts at once and
            ends with the clock.
        reset_active: "high", which is the default: the port is `rst`; "low": it is `rst_n`.
        clock_enable: whether there is a port `clk_en`, without which the core stands still; bus and
            front end go on, and give and take only while it is high.
        hardening: what is done about upsets, single bits of the core's state that turn over; None,
            which is the default: nothing.  "detect": the core is there twice, and where the two
            differ status bit 4 and the port `upset` tell so.  "recover": it is there three times,
            the majority goes to the ports, and a copy that differs is started again at the next
            major interval.
        channels: sensors that the core serves, each with numbers of its own; None, which is the
            default: one.
    """

    core: Annotated[
        Literal["pipelined", "compact"], Field(description='"pipelined" or "compact"')
    ] = "pipelined"
    target: Annotated[
        Literal["generic", "ecp5", "ice40", "xilinx", "nexus", "gowin"],
        Field(description='"generic", "ecp5", "ice40", "xilinx", "nexus" or "gowin"'),
    ] = "generic"
    multipliers: Annotated[
        int | None, Field(ge=0, le=4096, description="a whole number from 0 to 4096")
    ] = None
    front: Annotated[Front | None, Field(description="a table with sensor and clock_hz")] = None
    bus: Annotated[Bus | None, Field(description="a table")] = None
    handover: Annotated[
        Literal["parallel", "stream"] | None,
        Field(description='"parallel" or "stream"', validate_default=True),
    ] = None

    overrun: Annotated[
        Literal["drop-sample", "drop-result"] | None,
        Field(description='"drop-sample" or "drop-result"'),
    ] = None

    initial: Annotated[bool | None, Field(description="true or false")] = None
    reset: Annotated[Literal["sync", "async"] | None, Field(description='"sync" or "async"')] = None
    reset_active: Annotated[Literal["high", "low"] | None, Field(description='"high" or "low"')] = (
        None
    )
    clock_enable: Annotated[bool | None, Field(description="true or false")] = None
    hardening: Annotated[
        Literal["off", "detect", "recover"] | None,
        Field(description='"off", "detect" or "recover"'),
    ] = None
    channels: Annotated[
        int | None, Field(ge=1, le=MOST_CHANNELS, description="a whole number from 1 to 1024")
    ] = None

    @property
    def resets_at_once(self) -> bool:
        """Whether the reset is asynchronous."""
        return self.reset == "async"

    @property
    def clocked_plainly(self) -> bool:
        """Whether it has a synchronous active-high reset and no clock enable."""
        return self.resets_plainly and not self.clock_enable

    @property
    def resets_plainly(self) -> bool:
        """Whether it has a synchronous active-high reset."""
        return not (self.reset or self.reset_active)

    @model_validator(mode="before")
    @classmethod
    def _many_channels_stream(cls, data: Any) -> Any:
        """A core with channels hands over a stream, whichever core it is."""
        if not isinstance(data, dict) or data.get("handover") is not None:
            return data
        channels = data.get("channels")
        many = isinstance(channels, int) and channels > 1
        return {**data, "handover": "stream"} if many else data

    @field_validator("initial")
    @classmethod
    def _with_initial_values_is_left_unsaid(cls, value: bool | None) -> bool | None:
        return None if value else value

    @field_validator("overrun", "reset", "reset_active")
    @classmethod
    def _the_usual_is_left_unsaid(cls, value: str | None) -> str | None:
        return None if value in ("drop-sample", "sync", "high") else value

    @field_validator("hardening")
    @classmethod
    def _hardening_is_built(cls, hardening: str | None, info: ValidationInfo) -> str | None:
        if hardening in (None, "off"):
            return None
        if info.data.get("core") == "pipelined":
            if info.data.get("bus") is not None:
                raise ValueError(
                    f'"{hardening}" is not built for core = "pipelined" with [hardware.bus]: leave'
                    ' one out, or give core = "compact"'
                )
            for key, value in {"handover": "stream", "overrun": "drop-result"}.items():
                if info.data.get(key) == value:
                    raise ValueError(
                        f'"{hardening}" is not built for core = "pipelined" with'
                        f' {key} = "{value}": leave that out, or give core = "compact"'
                    )
        return hardening

    @field_validator("channels")
    @classmethod
    def _channels_are_built(cls, channels: int | None, info: ValidationInfo) -> int | None:
        if channels in (None, 1):
            return None
        if info.data.get("handover") == "parallel":
            raise ValueError(f'{channels} is not built with handover = "parallel": leave one out')
        for part in ("bus", "front"):
            if info.data.get(part) is not None:
                raise ValueError(
                    f"{channels} is not built for a core with [hardware.{part}]: leave one out"
                )
        for key in ("overrun", "reset", "clock_enable", "hardening"):
            value = info.data.get(key)
            if value is not None:
                told = "true" if value is True else f'"{value}"'
                raise ValueError(f"{channels} is not built with {key} = {told}: leave one out")
        return channels

    @field_validator("clock_enable")
    @classmethod
    def _no_clock_enable_is_left_unsaid(cls, value: bool | None) -> bool | None:
        return value or None

    @field_validator("multipliers")
    @classmethod
    def _multipliers_fit_core(cls, multipliers: int | None, info: ValidationInfo) -> int | None:
        core = info.data.get("core")
        if core == "compact" and multipliers not in (None, 0, 1):
            raise ValueError(f'{multipliers} is not allowed, core = "compact" uses 0 or 1')
        if core == "pipelined" and multipliers == 0:
            raise ValueError('0 is not allowed, give 1 or more, or core = "compact"')
        return multipliers

    @field_validator("bus")
    @classmethod
    def _samples_come_from_one_place(cls, bus: Bus | None, info: ValidationInfo) -> Bus | None:
        front = info.data.get("front") is not None
        if bus is not None and bus.sample == "front" and not front:
            raise ValueError(
                'hardware.bus.sample: "front" needs [hardware.front], give that or leave it out'
            )
        if bus is not None and bus.takes_packets and front:
            raise ValueError(
                f'hardware.bus.sample: "{bus.sample}" is not possible with [hardware.front], which'
                " gives the samples: leave it out"
            )
        return bus

    @field_validator("handover")
    @classmethod
    def _handover_fits_core(cls, handover: str | None, info: ValidationInfo) -> str | None:
        compact = info.data.get("core") == "compact"
        bus = info.data.get("bus") is not None
        if bus and handover == "parallel":
            raise ValueError(
                "not possible with [hardware.bus], which reads the stream: leave it out"
            )
        if compact and handover == "parallel":
            raise ValueError('not possible with core = "compact", which streams: leave it out')
        return handover or ("stream" if compact or bus else "parallel")

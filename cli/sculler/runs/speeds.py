"""How many samples a second a design takes in real devices, at the rate it may count on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sculler_hdl import ExpectedRate, expected_rate, placed_designs, timing
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import clocks_per_major


@dataclass(frozen=True)
class Speed:
    """A design with a core for a target.

    Attributes:
        design: the design.
        clocks_per_sample: in the long run, at the fastest; None where it cannot be built.
        rate: the clock rate to count on, and its basis; or why it cannot be built.
    """

    design: Design
    clocks_per_sample: float | None
    rate: ExpectedRate

    @property
    def samples_per_second(self) -> float | None:
        """At that clock rate; None where there is none."""
        if self.rate.mhz is None or self.clocks_per_sample is None:
            return None
        return 1e6 * self.rate.mhz / self.clocks_per_sample

    @property
    def fits(self) -> bool | None:
        """Whether it takes the samples of all its sensors; None where there is no rate."""
        taken = self.samples_per_second
        asked = self.design.channels * self.design.sensor.sample_rate_hz
        return None if taken is None else taken >= asked

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        hardware = self.design.hardware
        return {
            "core": hardware.core,
            "target": hardware.target,
            "multipliers": hardware.multipliers,
            "clocks_per_sample": self.clocks_per_sample,
            "expected_mhz": self.rate.mhz,
            "basis": self.rate.basis,
            "samples_per_second": self.samples_per_second,
            "fits": self.fits,
        }


def speeds(design: Design, base: Design) -> list[Speed]:
    """The design with the hardware of `base`, or with each core and target that was placed.

    Args:
        design: the design.
        base: whose hardware, where its target is not "generic".
    """
    if base.hardware.target != "generic":
        return [_speed(design, base.as_json()["hardware"])]
    kinds = [one.kind for one in placed_designs() if not one.tuned]
    pairs = dict.fromkeys((kind.core, kind.target) for kind in kinds)
    return [_speed(design, {"core": core, "target": target}) for core, target in pairs]


def _speed(design: Design, hardware: dict[str, Any]) -> Speed:
    plain = {key: hardware[key] for key in ("core", "target")}
    try:
        made = _with(design, hardware)
        clocks = clocks_per_major(made, timing(made))
    except InputError as error:  # multipliers are too few, or this hardware is not built for it
        return Speed(_with(design, plain), None, ExpectedRate(None, str(error)))
    return Speed(made, clocks / made.samples_per_major, expected_rate(made))


def _with(design: Design, hardware: dict[str, Any]) -> Design:
    return Design.parse(design.as_json() | {"hardware": hardware})

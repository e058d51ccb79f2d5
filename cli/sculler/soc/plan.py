"""A chip to make, and what a design must have for one."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, cos, sqrt

from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import words_per_column
from sculler_model.navigation import (
    MIN_ALIGNMENT_INTERVALS,
    MIN_ALIGNMENT_SECONDS,
    NavState,
    SensorNoise,
)

BAUD = 921_600
"""Of the telemetry's line."""

COUNTERS = ("FRAMES_TAKEN", "FRAMES_BAD", "FRAMES_MISSED", "FRAMES_LATE", "SAMPLES_LOST")
"""Registers of the unit that each result's telemetry tells."""

MEMORY_KIB, LARGE_MEMORY_KIB = 64, 128
"""The usual ones; the large one for a firmware that aligns, or has orders beyond the second."""


@dataclass(frozen=True)
class ChipAlignment:
    """A chip that finds its attitude at rest.

    Attributes:
        results: of the window.
        fine: whether a Kalman filter follows the coarse stage, and its gyro bias is taken out.
        noise: of the sensors, all of it known.
    """

    results: int
    fine: bool
    noise: SensorNoise


def chip_alignment(
    design: Design, seconds: float, fine: bool, noise: SensorNoise, lat: float
) -> ChipAlignment:
    """An alignment of so many seconds.

    Args:
        design: of the chip.
        seconds: of the window, at least 10.
        fine: whether the fine stage follows.
        noise: random walks, and biases where something is known of them; the noise of the velocity
            at one instant is that of the accelerometers' counts where it is left out.
        lat: rad.

    Raises:
        InputError: the window is too short, the noise is not known, or north cannot be found there.
    """
    results = max(1, round(seconds / design.major_interval))
    least = max(MIN_ALIGNMENT_INTERVALS, ceil(MIN_ALIGNMENT_SECONDS / design.major_interval - 1e-9))
    if results < least:
        raise InputError(
            f"--align {seconds:g}: {results} results are too short, give"
            f" {least * design.major_interval:g} or more"
        )
    if noise.angle_random_walk is None or noise.velocity_random_walk is None:
        raise InputError(
            "--align: the chip has no time to find the sensors' noise in its window, give"
            " --gyro-noise and --accel-noise"
        )
    if cos(lat) < 0.01:
        raise InputError("--align: too near a pole to find north, leave it out")
    counts = design.sensor.accel.lsb / sqrt(12.0)
    if design.sensor.kind == "rate":
        counts /= design.sensor.sample_rate_hz
    return ChipAlignment(results, fine, noise.completed(SensorNoise(velocity_noise=counts)))


@dataclass(frozen=True)
class SocPlan:
    """A chip to make.

    Attributes:
        design: with a sensor front end, and Wishbone as its bus.
        start: where the navigation begins, at the end of the first result of full history; its
            time is not looked at.  With an alignment the place counts alone, of a unit at rest.
        position_every: major intervals from one position update to the next.
        memory_kib: of the processor, a power of two; None for what is usual.
        align: whether the chip finds its attitude, and how.

    Raises:
        InputError: the design is none for a chip, or a number is out of its range.
    """

    design: Design
    start: NavState
    position_every: int = 1
    memory_kib: int | None = None
    align: ChipAlignment | None = None

    def __post_init__(self) -> None:
        check_soc(self.design)
        if not 32 <= self.memory <= 1024 or self.memory & (self.memory - 1):
            raise InputError(f"--memory {self.memory}: give a power of two from 32 to 1024 (KiB)")

    @property
    def memory(self) -> int:
        """KiB of the processor's memory."""
        if self.memory_kib is not None:
            return self.memory_kib
        more = self.align is not None or self.design.order > 2
        return LARGE_MEMORY_KIB if more else MEMORY_KIB

    @property
    def stack_bytes(self) -> int:
        """That must be free; an alignment takes 6.2 KiB, an update 2.4."""
        return 8192 if self.align else 6144

    @property
    def ring(self) -> int:
        """Results that wait for the firmware: more where an alignment keeps it busy."""
        return 32 if self.align else 8

    @property
    def busy_clocks(self) -> int:
        """About how long the end of a window keeps the firmware busy."""
        if self.align is None:
            return 0
        return 6_000_000 + self.align.fine * 1_500_000 * self.steps

    @property
    def steps(self) -> int:
        """Of the fine stage, one a second; 1 without it, for C has no empty array."""
        if self.align is None or not self.align.fine:
            return 1
        return self.align.results // max(1, int(1.0 / self.design.major_interval + 0.5))

    @property
    def divisor(self) -> int:
        """Clocks a bit of telemetry."""
        return clocks_a_bit(self.design)

    @property
    def clock_mhz(self) -> float:
        """Of the chip."""
        front = self.design.hardware.front
        assert front is not None
        return front.clock_hz / 1e6


def clocks_a_bit(design: Design) -> int:
    """Clocks a bit of telemetry."""
    front = design.hardware.front
    assert front is not None
    return round(front.clock_hz / BAUD)


def check_soc(design: Design) -> None:
    """See that a design is one for a chip.

    Raises:
        InputError: it has no front end, another bus than Wishbone, no time stamps, or a clock that
            is too slow for the telemetry.
    """
    hardware = design.hardware
    if hardware.front is None:
        raise InputError(
            f"{design.name}: a chip needs the sensor's wire, add a [hardware.front] to the design"
        )
    bus = hardware.bus
    if bus is None or bus.result != "wishbone" or bus.clock != "same" or not bus.time_stamps:
        raise InputError(
            f"{design.name}: the processor's bus is Wishbone, add [hardware.bus] with result ="
            ' "wishbone", clock = "same" and time_stamps = true'
        )
    error = clocks_a_bit(design) * BAUD / hardware.front.clock_hz - 1
    if abs(error) > 0.02:
        raise InputError(
            f"hardware.front.clock_hz {hardware.front.clock_hz:g}: {BAUD} baud of telemetry are off"
            f" by {100 * abs(error):.1f} %, give a faster clock"
        )
    rate = design.sensor.sample_rate_hz / design.samples_per_major
    if rate * bytes_a_result(design) * 10 > 0.95 * BAUD:
        raise InputError(
            f"{design.name}: telemetry of {rate:g} results a second is more than {BAUD} baud, give"
            " more algorithm.minors"
        )


def registers_of(design: Design) -> int:
    """Registers of 32 bits of a result, with its time stamps."""
    return len(design.columns) * -(-words_per_column(design) // 2) + 7


def bytes_a_result(design: Design) -> int:
    """Of telemetry: a frame of kind 2 and one of kind 1."""
    return 8 + 8 + 4 * (registers_of(design) + len(COUNTERS)) + 24 + 4 + 116

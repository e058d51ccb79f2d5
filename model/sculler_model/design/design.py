"""`Design`: the one object that carries a design's parameters to model, hardware and host.

A design file (TOML, docs/reference/design-file.md) is validated whole: every fault is named by its
key and its allowed range, and all faults are reported together.  Its tables are `sensor`,
`algorithm` (with `options`) and `hardware`; `reading` puts presets in and faults into words.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PrivateAttr, ValidationError, ValidationInfo, field_validator

from sculler_model.algorithms import Composition, Made, Response, TapTable, composition, make
from sculler_model.design.algorithm import (
    Algorithm,
    recipe_of,
    require_narrow,
    require_summed,
    sensor_response,
    tap_table_of,
)
from sculler_model.design.compensation import Compensation, compensated_sensor
from sculler_model.design.compensation_plan import CompensationPlan
from sculler_model.design.filters import with_measured_points
from sculler_model.design.front import link_of
from sculler_model.design.hardware import Hardware
from sculler_model.design.history import reaches, short_samples
from sculler_model.design.interval import Interval
from sculler_model.design.names import name_fault
from sculler_model.design.reading import faults_of, with_preset
from sculler_model.design.result import (
    FOURTH_ORDER_VECTORS,
    HIGH_RESOLUTION_VECTORS,
    STATUS_BITS,
    THIRD_ORDER_VECTORS,
    VECTORS,
    columns_of,
    components_of,
)
from sculler_model.design.sensor import Sensor
from sculler_model.design.word_lengths import WordLengths, word_lengths
from sculler_model.errors import InputError
from sculler_model.front import Link
from sculler_model.inputs import read_toml
from sculler_model.schema import Part


class Design(Part):
    """A complete, valid design.

    Build one with `Design.load` (file), `Design.parse` (mapping) or `Design.preset`; it never
    changes.  Everything derived is an attribute: `table`, `words`, `samples_per_major`, scales and
    rates.

    Attributes:
        name: of the Verilog module.
        sensor: what the sensor delivers: kind, rate, widths and scales.
        algorithm: the high-rate algorithm: family, n samples, p of history, M minors.
        hardware: how it becomes gates.
        compensation: known errors of the sensor that are taken out before the core; None for none.

    Examples:
        >>> import sculler
        >>> design = sculler.Design.preset("stim300", samples=4, minors=5)
        >>> design.samples_per_major, design.major_interval
        (20, 0.01)
    """

    name: Annotated[str, Field(description="a Verilog name: letters, digits, single _")]
    sensor: Annotated[Sensor, Field(description="a table")]
    algorithm: Annotated[Algorithm, Field(description="a table")]
    hardware: Annotated[Hardware, Field(description="a table", validate_default=True)] = Hardware()
    compensation: Annotated[Compensation | None, Field(description="a table")] = None
    _before: int = PrivateAttr(default=0)  # counts before its own that a compensated sample is of

    @field_validator("name")
    @classmethod
    def _name_is_usable(cls, name: str) -> str:
        said = name_fault(name)
        if said is not None:
            raise ValueError(f"{name!r} {said}")
        return name

    @field_validator("algorithm")
    @classmethod
    def _family_fits_sensor(cls, algorithm: Algorithm, info: ValidationInfo) -> Algorithm:
        sensor = info.data.get("sensor")
        if sensor is None:
            return algorithm
        sensor_response(sensor, algorithm)
        table = tap_table_of(sensor, algorithm)
        if algorithm.order is not None:
            require_summed(table, sensor, algorithm)
        require_narrow(table, sensor, algorithm)
        if algorithm.position == "high-resolution":
            if sensor.kind != "increment":
                raise InputError(
                    'algorithm.position: "high-resolution" is not possible with sensor.kind ='
                    f' "{sensor.kind}", give sensor.kind = "increment" or leave it out'
                )
            if table.sum_denominator != 1 or table.weights != (1,) * table.samples + (0,):
                raise InputError(
                    'algorithm.position: "high-resolution" needs every sample of a minor interval'
                    " to count once, leave out algorithm.table.weights or position"
                )
        return algorithm

    @field_validator("hardware")
    @classmethod
    def _front_fits_sensor(cls, hardware: Hardware, info: ValidationInfo) -> Hardware:
        sensor = info.data.get("sensor")
        if sensor is not None and hardware.front is not None:
            try:
                link_of(hardware.front, sensor)
            except ValueError as error:
                raise ValueError(f"hardware.front.{error}") from error
        return hardware

    @field_validator("compensation")
    @classmethod
    def _compensation_is_built(
        cls, compensation: Compensation | None, info: ValidationInfo
    ) -> Compensation | None:
        sensor, algorithm, hardware = map(info.data.get, ("sensor", "algorithm", "hardware"))
        if compensation is None or sensor is None or algorithm is None or hardware is None:
            return compensation
        for key, value in (
            ("hardware.bus", hardware.bus),
            ("hardware.front", hardware.front),
            ("hardware.hardening", hardware.hardening),
            ("hardware.channels", hardware.channels),
        ):
            if value is not None:
                raise ValueError(f"is not built for a design with {key}: leave one out")
        if hardware.multipliers == 0:
            raise ValueError(
                "is not built without multiplier blocks: give hardware.multipliers = 1"
            )
        try:
            plan = compensation.plan(sensor)
        except ValueError as error:
            raise ValueError(f"compensation.{error}") from error
        require_narrow(tap_table_of(sensor, algorithm), compensated_sensor(sensor, plan), algorithm)
        return compensation

    @field_validator("hardware")
    @classmethod
    def _channels_fit_algorithm(cls, hardware: Hardware, info: ValidationInfo) -> Hardware:
        algorithm = info.data.get("algorithm")
        if hardware.channels is None or algorithm is None:
            return hardware
        further = [f"order = {algorithm.order}"] if algorithm.order is not None else []
        further += ['position = "high-resolution"'] * (algorithm.position == "high-resolution")
        if further:
            raise ValueError(
                f"hardware.channels: {hardware.channels} is not built with"
                f" algorithm.{further[0]}: leave one out"
            )
        return hardware

    @classmethod
    def load(cls, path: str | Path) -> Design:
        """Read and validate a design file (TOML, docs/reference/design-file.md).

        Args:
            path: of the file; paths inside it start from its folder.

        Raises:
            InputError: the file cannot be read, is not TOML, or has faults; all are named.
        """
        path = Path(path)
        data = read_toml(path, "design file", "a design in TOML")
        return cls.parse(data, where=str(path), folder=path.parent)

    @classmethod
    def preset(cls, name: str, **algorithm: Any) -> Design:
        """The design of a preset, with keys of [algorithm] replaced as given.

        Args:
            name: one of `PRESETS`.
            algorithm: such as `samples=4, minors=5`.

        Raises:
            InputError: there is no such preset, or a key is at fault.
        """
        return cls.parse({"preset": name, "algorithm": algorithm})

    @classmethod
    def parse(
        cls, data: dict[str, Any], where: str = "design", folder: Path | None = None
    ) -> Design:
        """Validate a mapping of the design file's shape.

        `preset`, at the top or in [sensor], fills in whatever the mapping leaves out.

        Args:
            data: what a design file holds, as `tomllib` gives it.
            where: names it in messages.
            folder: that relative paths in it start from; left out, the working directory.

        Raises:
            InputError: with every fault, each named by its key and allowed range.
        """
        faults: list[str] = []
        data = with_preset(data, faults, where)
        for table in ("sensor", "algorithm"):
            part = data.get(table)
            if isinstance(part, dict) and "filter" in part:
                try:
                    points = with_measured_points(
                        part["filter"], folder or Path(), f"{table}.filter"
                    )
                except InputError as error:
                    raise InputError(f"{where}: {error}") from error
                data = {**data, table: {**part, "filter": points}}
        design = None
        try:
            design = cls.model_validate(data)
        except ValidationError as error:
            faults += faults_of(cls, error)
        if faults or design is None:
            raise InputError(f"{where}: " + "; ".join(faults))
        return design

    def __hash__(self) -> int:
        return hash(self.digest)

    @cached_property
    def table(self) -> TapTable:
        """The tap table, exact integers in lowest terms."""
        return tap_table_of(self.sensor, self.algorithm)

    @cached_property
    def sensor_response(self) -> Response | None:
        """What the samples passed in the sensor; None where the design states nothing.

        Increments then have passed nothing, and rates a mean over the sample interval, sinc(ΩT/2).
        """
        return sensor_response(self.sensor, self.algorithm)

    @property
    def made(self) -> Made:
        """The computed table with what its family can tell of it: rounding, what is left.

        Raises:
            ValueError: family = "table", whose numbers are the user's own.
        """
        if self.algorithm.family == "table":
            raise ValueError('family = "table" is the user\'s own and not computed')
        return make(recipe_of(self.sensor, self.algorithm))

    @cached_property
    def words(self) -> WordLengths:
        """Worst-case range of every quantity the core holds, and of the sensor's counts."""
        if self.compensation is not None:
            counts = [Interval.signed(axes.bits) for axes in (self.sensor.gyro, self.sensor.accel)]
            return replace(self.inner.words, gyro=counts[0], accel=counts[1])
        return word_lengths(
            self.sensor.gyro.bits,
            self.sensor.accel.bits,
            self.algorithm.minors,
            self.table,
            self.high_resolution,
            self.order,
        )

    @cached_property
    def compensation_plan(self) -> CompensationPlan | None:
        """What stands before the core, in integers; None where nothing does."""
        return None if self.compensation is None else self.compensation.plan(self.sensor)

    @property
    def inner(self) -> Design:
        """The design of the core behind the compensation: itself where there is none.

        Its sensor's counts are the compensated samples: of more bits, and worth 1/D as much.
        """
        return self.compensated or self

    @cached_property
    def compensated(self) -> Design | None:
        """The design of the core behind the compensation; None where there is none."""
        plan = self.compensation_plan
        if plan is None:
            return None
        inner = Design.model_construct(
            name=self.name,
            sensor=compensated_sensor(self.sensor, plan),
            algorithm=self.algorithm,
            hardware=self.hardware,
            compensation=None,
        )
        inner._before = plan.reach
        return inner

    @property
    def drops_results(self) -> bool:
        """Whether the core drops a result that waits rather than make samples wait for it."""
        return self.hardware.overrun == "drop-result"

    @property
    def channels(self) -> int:
        """C, sensors that the core serves, each with numbers of its own."""
        return self.hardware.channels or 1

    @property
    def status_bits(self) -> int:
        """Width of the status: a hardened core has one bit more."""
        return STATUS_BITS + (self.hardware.hardening is not None)

    @property
    def has_initial_values(self) -> bool:
        """Whether registers and memories have values before the first reset."""
        return self.hardware.initial is not False

    @cached_property
    def front(self) -> Link | None:
        """The sensor on its wire, where a front end reads it."""
        front = self.hardware.front
        return None if front is None else link_of(front, self.sensor)

    @property
    def high_resolution(self) -> bool:
        """Whether it hands over what high-resolution position needs."""
        return self.algorithm.position == "high-resolution"

    @property
    def order(self) -> int:
        """Up to which products of increments it forms rotation vector and velocity: 2, 3 or 4."""
        return self.algorithm.order or 2

    @cached_property
    def composition(self) -> Composition:
        """Denominators and factors of the terms of third and fourth order."""
        return composition(self.table)

    @cached_property
    def vectors(self) -> tuple[str, ...]:
        """Names of the vectors it hands over, in order."""
        position = HIGH_RESOLUTION_VECTORS if self.high_resolution else ()
        third = THIRD_ORDER_VECTORS if self.order > 2 else ()
        fourth = FOURTH_ORDER_VECTORS if self.order > 3 else ()
        return (*VECTORS, *position, *third, *fourth)

    @cached_property
    def components(self) -> tuple[str, ...]:
        """Names of the vectors' components, in order."""
        return components_of(self.vectors)

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """Names of everything it hands over, in order: `major`, `status` and the components."""
        return columns_of(self.vectors)

    @cached_property
    def reaches(self) -> tuple[int, ...]:
        """For each phase 1..n, how many samples before its own the oldest one lies that it uses."""
        return reaches(self.table, self.high_resolution)

    @cached_property
    def short_samples(self) -> tuple[bool, ...]:
        """For each sample t from reset, whether it uses one before sample 0; later ones do not.

        A result is of short history (status bit 0) where one of its samples does.
        """
        before = self.inner._before
        return short_samples(self.table, self.high_resolution, before)

    @cached_property
    def short_majors(self) -> int:
        """How many major intervals from reset are of short history (status bit 0).

        A phase that reaches far enough back in some interval does so in every earlier one.
        """
        last = max((t for t, short in enumerate(self.short_samples) if short), default=-1)
        return last // self.samples_per_major + 1

    @property
    def samples_per_major(self) -> int:
        """Samples of a major interval, N = n M."""
        return self.algorithm.samples * self.algorithm.minors

    @property
    def sample_interval(self) -> float:
        """T, the time from sample to sample, s."""
        return 1.0 / self.sensor.sample_rate_hz

    @property
    def major_interval(self) -> float:
        """The time from result to result, N T, s."""
        return self.samples_per_major / self.sensor.sample_rate_hz

    @property
    def count_scales(self) -> tuple[float, float]:
        """What a count of the sensor adds up to, rad and m/s (rate sensors: LSB * T)."""
        step = 1.0 if self.sensor.kind == "increment" else self.sample_interval
        return self.sensor.gyro.lsb * step, self.sensor.accel.lsb * step

    @property
    def gyro_scale(self) -> float:
        """g, rad per count of the products: of the sensor's counts, or of compensated ones."""
        return self.count_scales[0] / self._finer[0]

    @property
    def accel_scale(self) -> float:
        """a, m/s per count of the products, as `gyro_scale`."""
        return self.count_scales[1] / self._finer[1]

    @property
    def _finer(self) -> tuple[int, int]:
        plan = self.compensation_plan
        return (1, 1) if plan is None else plan.denominators

    def as_json(self) -> dict[str, Any]:
        """The design as plain data, the form `parse` reads; JSON can hold it."""
        return self.model_dump(mode="json", exclude_none=True)

    @property
    def digest(self) -> str:
        """SHA-256 (hexadecimal) of the design's content."""
        return hashlib.sha256(json.dumps(self.as_json(), sort_keys=True).encode()).hexdigest()

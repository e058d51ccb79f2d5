"""`Design`: the one object that carries a design's parameters to model, hardware and host.

A design file (TOML, DESIGN section 4) is validated whole: every fault is named by its key and its
allowed range, and all faults are reported together.
"""

from __future__ import annotations

import difflib
import hashlib
import json
import re
import sys
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field, ValidationError, ValidationInfo, field_validator
from pydantic_core import ErrorDetails

from sculler_model.algorithms import (
    BASES,
    FAMILIES,
    MAX_SAMPLES,
    TABLES,
    Made,
    Match,
    Recipe,
    Sum,
    TapTable,
    make,
    rational,
)
from sculler_model.design import names
from sculler_model.design.options import Band, Filter, Mount, response, with_measured_points
from sculler_model.design.presets import PRESETS
from sculler_model.design.result import HIGH_RESOLUTION_VECTORS, VECTORS, columns_of, components_of
from sculler_model.design.word_lengths import MAX_BITS, WordLengths, word_lengths
from sculler_model.errors import InputError
from sculler_model.inputs import read_small
from sculler_model.schema import Part

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


class Axes(Part):
    """Word length and scale of three like sensor axes."""

    bits: Annotated[int, Field(ge=8, le=32, description="a whole number from 8 to 32")]
    lsb: Annotated[
        float,
        Field(ge=1e-30, le=1e6, description="a number from 1e-30 to 1e6 (SI units per count)"),
    ]


class Sensor(Part):
    """What the sensor delivers."""

    kind: Annotated[Literal["increment", "rate"], Field(description='"increment" or "rate"')]
    sample_rate_hz: Annotated[
        float, Field(ge=1e-6, le=1e9, description="a number from 1e-6 to 1e9")
    ]
    gyro: Annotated[Axes, Field(description="a table with bits and lsb")]
    accel: Annotated[Axes, Field(description="a table with bits and lsb")]


class UserTable(Part):
    """The user's own tap table, in the form `sculler coefficients --json` prints."""

    denominator: Annotated[int, Field(ge=1, description="a whole number >= 1")]
    taps: Annotated[
        list[int | list[int]],
        Field(min_length=1, description="n rows of whole numbers, or one flat row for phase n"),
    ]
    sum_denominator: Annotated[int, Field(ge=1, description="a whole number >= 1")] = 1
    weights: Annotated[
        list[int] | None, Field(description="up to n + 1 whole numbers, distance 0..n")
    ] = None


class Algorithm(Part):
    """The high-rate algorithm.  Field order matters: later ones are checked against earlier.

    position: "high-resolution" adds the vectors s_alpha, s_nu and scrolling (`scrolling`), from
        which the host has the way over each major interval; "trapezoidal", which is the default,
        has none of them.
    """

    samples: Annotated[
        int, Field(ge=1, le=MAX_SAMPLES, description=f"a whole number from 1 to {MAX_SAMPLES}")
    ]
    history: Annotated[int, Field(ge=0, description="a whole number from 0 to samples")] = 0
    minors: Annotated[int, Field(ge=1, le=4096, description="a whole number from 1 to 4096")]
    family: Annotated[
        Literal[
            "frequency-taylor",
            "filtered-rate",
            "time-taylor",
            "uncompressed",
            "least-squares",
            "tuned",
            "table",
        ],
        Field(description=", ".join(f'"{family}"' for family in FAMILIES) + ' or "table"'),
    ]
    table: Annotated[
        UserTable | None,
        Field(description="a table with denominator and taps", validate_default=True),
    ] = None
    base: Annotated[
        Literal["frequency-taylor", "least-squares", "tuned"] | None,
        Field(description=" or ".join(f'"{base}"' for base in BASES)),
    ] = None
    match: Annotated[Match | None, Field(description='"taylor" or "least-squares"')] = None
    filter: Annotated[
        list[Filter] | None,
        Field(description="a table with kind, or several", validate_default=True, max_length=16),
    ] = None
    sum: Annotated[Sum | None, Field(description='"zeng", "newton-cotes" or "plain"')] = None
    band: Annotated[
        Band | None,
        Field(description="a table with low_hz and high_hz, psd or profile", validate_default=True),
    ] = None
    denominator_bits: Annotated[
        int | None, Field(ge=1, le=48, description="a whole number from 1 to 48")
    ] = None
    position: Annotated[
        Literal["trapezoidal", "high-resolution"] | None,
        Field(description='"trapezoidal" or "high-resolution"'),
    ] = None

    @field_validator("history")
    @classmethod
    def _history_in_samples(cls, history: int, info: ValidationInfo) -> int:
        samples = info.data.get("samples")
        if samples is not None and history > samples:
            raise ValueError(
                f"{history} is not allowed, give a whole number from 0 to samples = {samples}"
            )
        return history

    @field_validator("family")
    @classmethod
    def _family_can_be_made(cls, family: str, info: ValidationInfo) -> str:
        samples, history = info.data.get("samples"), info.data.get("history")
        # an uncompressed table may start from another base, which is not known yet
        computed = TABLES.get(family) if family != "uncompressed" else None
        if computed is not None and samples is not None and history is not None:
            computed(samples, history)
        return family

    @field_validator("table")
    @classmethod
    def _table_is_consistent(
        cls, table: UserTable | None, info: ValidationInfo
    ) -> UserTable | None:
        family, samples = info.data.get("family"), info.data.get("samples")
        if family == "table" and table is None:
            raise ValueError(
                'missing, family = "table" needs [algorithm.table] with denominator and taps'
            )
        if family in FAMILIES and table is not None:
            raise ValueError(
                f'not used by family = "{family}", leave it out or give family = "table"'
            )
        if table is not None and samples is not None:
            _user_table(table, samples)
        return table

    @field_validator("position")
    @classmethod
    def _the_usual_is_left_unsaid(cls, value: str | None) -> str | None:
        return None if value == "trapezoidal" else value

    @field_validator("filter", mode="before")
    @classmethod
    def _one_filter_is_a_list(cls, value: Any) -> Any:
        return [value] if isinstance(value, dict) else value

    @field_validator("base", "match", "filter", "sum", "band", "denominator_bits")
    @classmethod
    def _option_fits_family(cls, value: Any, info: ValidationInfo) -> Any:
        """Options come with the families that use them; a filter or band in use must be there."""
        key = info.field_name or ""
        known = ("family", "base", "match")
        earlier = known[: known.index(key)] if key in known else known
        if any(name not in info.data for name in earlier):
            return value  # what it depends on is at fault itself
        family, match = info.data["family"], info.data.get("match")
        source = info.data.get("base") or "frequency-taylor" if family == "uncompressed" else family
        fitted = source == "least-squares" or (source == "tuned" and match == "least-squares")
        used = {
            "base": family == "uncompressed",
            "match": source == "tuned",
            "filter": source == "tuned",
            "sum": source == "tuned",
            "band": fitted,
            "denominator_bits": fitted or source == "tuned",
        }
        if value is not None and not used[key]:
            how = f'family = "{family}"'
            if family == "uncompressed" and key != "base":
                how = f'base = "{source}"'
            if key == "band" and source == "tuned":
                how = 'match = "taylor"'
            raise ValueError(f"not used by {how}, leave it out")
        if value is None and used[key] and key in ("filter", "band"):
            allowed = cls.model_fields[key].description
            raise ValueError(f'missing, "{source}" needs it: give {allowed}')
        return value


class Hardware(Part):
    """How it becomes gates.  Field order matters: later ones are checked against earlier.

    core: "pipelined" (fast) or "compact" (small, one multiplication at a time).
    target: whose multiplier and memory blocks to use; "generic" leaves them to the synthesiser.
    multipliers: multiplier blocks the core may use.  The pipelined core takes as many clocks per
        sample as follow from it, and without it one.  The compact core uses 1 (default) or 0.
    handover: "parallel" shows a whole result at once, "stream" word by word (`stream`); the
        compact core streams, the pipelined core does what is asked, by default "parallel".
    overrun: what gives way when results are not taken in time.  "drop-sample", which is the
        default: the sensor is made to wait, and a sample that cannot is lost, which status bit 3
        tells; "drop-result": the oldest result that waits, which `results_dropped` tells.
    """

    core: Annotated[
        Literal["pipelined", "compact"], Field(description='"pipelined" or "compact"')
    ] = "pipelined"
    target: Annotated[
        Literal["generic", "ecp5", "ice40", "xilinx"],
        Field(description='"generic", "ecp5", "ice40" or "xilinx"'),
    ] = "generic"
    multipliers: Annotated[
        int | None, Field(ge=0, le=4096, description="a whole number from 0 to 4096")
    ] = None
    handover: Annotated[
        Literal["parallel", "stream"] | None,
        Field(description='"parallel" or "stream"', validate_default=True),
    ] = None

    overrun: Annotated[
        Literal["drop-sample", "drop-result"] | None,
        Field(description='"drop-sample" or "drop-result"'),
    ] = None

    @field_validator("overrun")
    @classmethod
    def _the_usual_is_left_unsaid(cls, value: str | None) -> str | None:
        return None if value == "drop-sample" else value

    @field_validator("multipliers")
    @classmethod
    def _multipliers_fit_core(cls, multipliers: int | None, info: ValidationInfo) -> int | None:
        core = info.data.get("core")
        if core == "compact" and multipliers not in (None, 0, 1):
            raise ValueError(f'{multipliers} is not allowed, core = "compact" uses 0 or 1')
        if core == "pipelined" and multipliers == 0:
            raise ValueError('0 is not allowed, give 1 or more, or core = "compact"')
        return multipliers

    @field_validator("handover")
    @classmethod
    def _handover_fits_core(cls, handover: str | None, info: ValidationInfo) -> str | None:
        compact = info.data.get("core") == "compact"
        if compact and handover == "parallel":
            raise ValueError('not possible with core = "compact", which streams: leave it out')
        return handover or ("stream" if compact else "parallel")


def _user_table(table: UserTable, samples: int) -> TapTable:
    return TapTable.from_integers(
        samples, table.denominator, table.taps, table.sum_denominator, table.weights
    )


def _table(sensor: Sensor, algorithm: Algorithm) -> TapTable:
    """The tap table, the user's own or computed."""
    if algorithm.table is not None:
        return _user_table(algorithm.table, algorithm.samples)
    return make(_recipe(sensor, algorithm)).table


def _require_narrow(table: TapTable, sensor: Sensor, algorithm: Algorithm) -> None:
    """See that a core of this table can be built.

    Raises:
        InputError: its denominators or results are wider than `MAX_BITS`.
    """
    words = word_lengths(sensor.gyro.bits, sensor.accel.bits, algorithm.minors, table)
    widths = {vector: getattr(words, vector).bits for vector in VECTORS}
    widths["denominator"] = table.denominator.bit_length()
    widths["sum_denominator"] = table.sum_denominator.bit_length()
    widest = max(widths, key=lambda name: widths[name])
    if widths[widest] > MAX_BITS:
        raise InputError(
            f"algorithm.table: {widest} would have {widths[widest]:,} bits, more than the"
            f" {MAX_BITS} that a core can have; give smaller taps and weights (no published table"
            " needs more than 395)"
        )


def _recipe(sensor: Sensor, algorithm: Algorithm) -> Recipe:
    """What a computed family is designed from.

    Raises:
        InputError: a filter that no sensor can have.
    """
    sample_rate = rational(sensor.sample_rate_hz)
    match = algorithm.match or "taylor"
    # a fit is to the drift as it is; Zeng's equations take his sum for exact
    usual: Sum = "zeng" if sensor.kind == "rate" and match == "taylor" else "plain"
    if algorithm.sum is not None and sensor.kind == "increment":
        raise InputError(
            'algorithm.sum: not used by sensor.kind = "increment", whose samples just add up'
        )
    return Recipe(
        family=algorithm.family,
        samples=algorithm.samples,
        history=algorithm.history,
        kind=sensor.kind,
        sample_rate=sample_rate,
        base=algorithm.base or "frequency-taylor",
        match=match,
        sum=algorithm.sum or usual,
        response=response(algorithm.filter or [], sample_rate),
        band=algorithm.band.exact() if algorithm.band is not None else None,
        denominator_bits=algorithm.denominator_bits,
    )


class Design(Part):
    """A complete, valid design.

    Build one with `Design.load` (file), `Design.parse` (mapping) or `Design.preset`.
    Everything derived is an attribute: `table`, `words`, `samples_per_major`, scales and rates.
    """

    name: Annotated[str, Field(description="a Verilog name: letters, digits, single _")]
    sensor: Annotated[Sensor, Field(description="a table")]
    algorithm: Annotated[Algorithm, Field(description="a table")]
    hardware: Annotated[Hardware, Field(description="a table", validate_default=True)] = Hardware()

    @field_validator("name")
    @classmethod
    def _name_is_usable(cls, name: str) -> str:
        said = names.fault(name)
        if said is not None:
            raise ValueError(f"{name!r} {said}")
        return name

    @field_validator("algorithm")
    @classmethod
    def _family_fits_sensor(cls, algorithm: Algorithm, info: ValidationInfo) -> Algorithm:
        sensor = info.data.get("sensor")
        if sensor is None:
            return algorithm
        table = _table(sensor, algorithm)
        _require_narrow(table, sensor, algorithm)
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

    @classmethod
    def load(cls, path: str | Path) -> Design:
        """Read and validate a design file.

        Raises:
            InputError: the file cannot be read, is not TOML, or has faults; all are named.
        """
        path = Path(path)
        text = read_small(path, "design file", "a design in TOML")
        try:
            data = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise InputError(f"{path}: not valid TOML: {error}") from error
        except ValueError as error:  # Python's limit on the digits of a whole number
            raise InputError(f"{path}: a number of too many digits, give fewer") from error
        except RecursionError as error:
            raise InputError(f"{path}: brackets too deep in each other, give a design") from error
        return cls.parse(data, where=str(path), folder=path.parent)

    @classmethod
    def preset(cls, name: str, **algorithm: Any) -> Design:
        """The design of a preset, with keys of [algorithm] replaced as given."""
        return cls.parse({"preset": name, "algorithm": algorithm})

    @classmethod
    def parse(
        cls, data: dict[str, Any], where: str = "design", folder: Path | None = None
    ) -> Design:
        """Validate a mapping of the design file's shape.

        `preset`, at the top or in [sensor], fills in whatever the mapping leaves out.

        Raises:
            InputError: with every fault, each named by its key and allowed range.
        """
        faults: list[str] = []
        data = _with_preset(data, faults, where)
        algorithm = data.get("algorithm")
        if isinstance(algorithm, dict) and "filter" in algorithm:
            try:
                filters = with_measured_points(algorithm["filter"], folder or Path())
            except InputError as error:
                raise InputError(f"{where}: {error}") from error
            data = {**data, "algorithm": {**algorithm, "filter": filters}}
        design = None
        try:
            design = cls.model_validate(data)
        except ValidationError as error:
            # one fault a key: of the ways to read a value, the last one looked deepest
            named = dict(map(_fault, error.errors()))
            faults += [f"{key}: {fault}" for key, fault in named.items()]
        if faults or design is None:
            raise InputError(f"{where}: " + "; ".join(faults))
        return design

    def __hash__(self) -> int:
        return hash(self.digest)

    @cached_property
    def table(self) -> TapTable:
        """The tap table, exact integers in lowest terms."""
        return _table(self.sensor, self.algorithm)

    @property
    def made(self) -> Made:
        """The computed table with what its family can tell of it: rounding, what is left.

        Raises:
            ValueError: family = "table", whose numbers are the user's own.
        """
        if self.algorithm.family == "table":
            raise ValueError('family = "table" is the user\'s own and not computed')
        return make(_recipe(self.sensor, self.algorithm))

    @cached_property
    def words(self) -> WordLengths:
        """Worst-case range of every quantity the core holds."""
        return word_lengths(
            self.sensor.gyro.bits,
            self.sensor.accel.bits,
            self.algorithm.minors,
            self.table,
            self.high_resolution,
        )

    @property
    def drops_results(self) -> bool:
        """Whether the core drops a result that waits rather than make samples wait for it."""
        return self.hardware.overrun == "drop-result"

    @property
    def high_resolution(self) -> bool:
        """Whether it hands over what high-resolution position needs."""
        return self.algorithm.position == "high-resolution"

    @cached_property
    def vectors(self) -> tuple[str, ...]:
        """Names of the vectors it hands over, in order."""
        return (*VECTORS, *HIGH_RESOLUTION_VECTORS) if self.high_resolution else VECTORS

    @cached_property
    def components(self) -> tuple[str, ...]:
        """Names of the vectors' components, in order."""
        return components_of(self.vectors)

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """Names of everything it hands over, in order: `major`, `status` and the components."""
        return columns_of(self.vectors)

    @property
    def samples_per_major(self) -> int:
        """Samples of a major interval, n * M."""
        return self.algorithm.samples * self.algorithm.minors

    @property
    def sample_interval(self) -> float:
        """T, seconds."""
        return 1.0 / self.sensor.sample_rate_hz

    @property
    def major_interval(self) -> float:
        """Seconds between results."""
        return self.samples_per_major / self.sensor.sample_rate_hz

    @property
    def gyro_scale(self) -> float:
        """g, rad per count of the products (rate sensors: LSB * T)."""
        lsb = self.sensor.gyro.lsb
        return lsb if self.sensor.kind == "increment" else lsb * self.sample_interval

    @property
    def accel_scale(self) -> float:
        """a, m/s per count of the products (rate sensors: LSB * T)."""
        lsb = self.sensor.accel.lsb
        return lsb if self.sensor.kind == "increment" else lsb * self.sample_interval

    def as_json(self) -> dict[str, Any]:
        """The design as plain data, the form `parse` reads."""
        return self.model_dump(mode="json", exclude_none=True)

    @property
    def digest(self) -> str:
        """SHA-256 of the design's content."""
        return hashlib.sha256(json.dumps(self.as_json(), sort_keys=True).encode()).hexdigest()


def _with_preset(data: dict[str, Any], faults: list[str], where: str) -> dict[str, Any]:
    """Take `preset` out of the data and put what it stands for under the file's own entries."""
    data = dict(data)
    names = []
    if "preset" in data:
        names.append(("preset", data.pop("preset")))
    sensor = data.get("sensor")
    if isinstance(sensor, dict) and "preset" in sensor:
        data["sensor"] = {key: value for key, value in sensor.items() if key != "preset"}
        names.append(("sensor.preset", sensor["preset"]))
    if not names:
        return data
    key, name = names[0]
    if len(names) > 1 and names[1][1] != name:
        faults.append(f"sensor.preset: {names[1][1]!r} and preset = {name!r} differ, give one")
    if not isinstance(name, str) or name not in PRESETS:
        known = ", ".join(sorted(PRESETS))
        raise InputError(f"{where}: {key}: {_short(name)} is not known, give one of {known}")
    merged = _merge(PRESETS[name], data)
    if "name" not in merged:
        merged["name"] = name  # stands where samples or minors have faults of their own
        match merged["algorithm"]:
            case {"samples": int(samples), "minors": int(minors)} if min(samples, minors) > 0:
                merged["name"] = f"{name}_{samples}x{minors}"
    return merged


def _merge(base: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in over.items():
        below = merged.get(key)
        both = isinstance(below, dict) and isinstance(value, dict)
        merged[key] = _merge(below, value) if both else value  # type: ignore[arg-type]
    return merged


def _fault(details: ErrorDetails) -> tuple[str, str]:
    """One pydantic error as its key and what is wrong and allowed."""
    path = [str(part) for part in details["loc"]]
    part: type[BaseModel] = Design
    allowed = ""
    known: list[str] = []
    key: list[str] = []
    for step in path:
        field = part.model_fields.get(step)
        if field is None and step.isdigit() and key:  # one of several filters
            key[-1] += f"[{step}]" if step != "0" else ""
            continue
        if field is None:
            known = list(part.model_fields)
            if details["type"] == "extra_forbidden":
                key.append(step if step.isprintable() else repr(step))
            break
        key.append(step)
        allowed = field.description or ""
        inner = next((c for c in _PARTS if c.__name__ in str(field.annotation)), None)
        if inner is None:
            break
        part = inner
    name = ".".join(key)
    if details["type"] == "extra_forbidden":
        near = difflib.get_close_matches(key[-1], known, n=1)
        hint = f"did you mean {near[0]}?" if near else f"the keys here are {', '.join(known)}"
        return name, f"unknown key, {hint}"
    if details["type"] == "missing":
        return name, f"missing, give {allowed}"
    if details["type"] == "value_error":
        fault = str(details["ctx"]["error"])
        own = re.match(rf"({name}\.[^:]+): (.*)", fault)  # the fault names its key itself
        return (own[1], own[2]) if own else (name, fault)
    return name, f"{_short(details['input'])} is not allowed, give {allowed}"


_PARTS: tuple[type[BaseModel], ...] = (
    Sensor,
    UserTable,
    Algorithm,
    Hardware,
    Axes,
    Filter,
    Band,
    Mount,
)


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."

"""The campaign file: a motion, designs, initial errors, and how many runs."""

from __future__ import annotations

import hashlib
import inspect
import json
from math import radians
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, model_validator

from sculler.runs.motion import Shaking, read_points
from sculler_model.design import Design, faults_of
from sculler_model.errors import InputError
from sculler_model.inputs import read_toml
from sculler_model.motion import MOTIONS, PLACE, Motion
from sculler_model.schema import Part

_ANGLES = ("lat", "lon", "heading")
Many = Annotated[float, Field(ge=0, le=1e9, description="a number from 0 to 1e9")]


class MotionTable(Part):
    """What is flown.

    Attributes:
        name: of the catalogue; or
        points: a file that `sculler motion --from` takes.
        parameters: of the catalogue's motion, in SI units and rad, but lat, lon, heading in °.
        smoothness: of the curve through points.
    """

    name: Annotated[str | None, Field(description="a motion's name")] = None
    points: Annotated[str | None, Field(description="the name of a file")] = None
    parameters: Annotated[
        dict[str, float], Field(description="numbers by name", default_factory=dict)
    ]
    smoothness: Annotated[int, Field(ge=2, le=4, description="2, 3 or 4")] = 3

    @model_validator(mode="after")
    def _one_of_two(self) -> MotionTable:
        if (self.name is None) == (self.points is None):
            raise ValueError("name, points: give one of them")
        if self.name is not None and self.name not in MOTIONS:
            raise ValueError(f"name: {self.name!r} is not known, give one of {', '.join(MOTIONS)}")
        if self.name is not None:
            known = inspect.signature(MOTIONS[self.name].make).parameters
            wrong = [key for key in self.parameters if key not in known]
            if wrong:
                told = ", ".join(known) or "none"
                raise ValueError(f"parameters.{wrong[0]}: {self.name} has {told}")
        elif self.parameters:
            raise ValueError("parameters: they belong to a motion of the catalogue, leave them out")
        return self


class VibrationTable(Part):
    """Random vibration on top of the motion, the same in every run.

    Attributes:
        g, rate: rms of each axis, g and °/s.
        low, high: the band, Hz.
        lines, seed: as of `sculler motion`.
    """

    g: Many = 0.0
    rate: Many = 0.0
    low: Many = 20.0
    high: Many = 200.0
    lines: Annotated[int, Field(ge=1, le=1000, description="a whole number from 1 to 1000")] = 20
    seed: Annotated[int, Field(ge=0, description="a whole number >= 0")] = 1


class InitialTable(Part):
    """Standard deviations of the initial error, drawn anew for every run.

    Attributes:
        tilt_mrad: about north and about east.
        heading_mrad: about down.
        velocity: m/s, each axis.
        position: m, each axis.
    """

    tilt_mrad: Many = 0.0
    heading_mrad: Many = 0.0
    velocity: Many = 0.0
    position: Many = 0.0


class NavigatorTable(Part):
    """How the host navigates.

    Attributes:
        height_damping: s, time constant of a loop that holds the height; none if left out.
        height: what it holds to: "initial", the run's first height, or "true", as a perfect
            barometer tells it ten times a second.
        position_every: major intervals from one position update to the next.
    """

    height_damping: Annotated[float | None, Field(gt=0, description="a number > 0 (s)")] = None
    height: Annotated[Literal["initial", "true"], Field(description="initial or true")] = "initial"
    position_every: Annotated[int, Field(ge=1, description="a whole number >= 1")] = 1


class RtlTable(Part):
    """Some of the runs through the hardware too, every integer beside the fast twin's.

    Attributes:
        runs: of each design, evenly spread over the seeds.
        seconds: from their beginning; the whole run if left out.
        engine: "verilator" (the emitted Verilog), "amaranth" (slow, needs no compiler), or "auto":
            Verilator where it is.
        stalls: samples and results wait at random; not where a core drops results.
    """

    runs: Annotated[int, Field(ge=1, le=1000, description="a whole number from 1 to 1000")] = 1
    seconds: Annotated[
        float | None, Field(gt=0, le=1e6, description="a number > 0, at most 1e6")
    ] = None
    engine: Annotated[
        Literal["auto", "verilator", "amaranth"],
        Field(description="auto, verilator or amaranth"),
    ] = "auto"
    stalls: Annotated[bool, Field(description="true or false")] = True

    @property
    def digest(self) -> str:
        """Of what a run through the hardware depends on."""
        text = self.model_dump_json(exclude={"runs"})
        return hashlib.sha256(text.encode()).hexdigest()[:12]


class DesignTable(Part):
    """A design that flies.

    Attributes:
        file: a design file, from the campaign file's folder; or
        preset: a preset's name.
        label: its name in tables and pictures; the design's if left out.
        errors: in place of the design's [sensor.errors].
    """

    file: Annotated[str | None, Field(description="the name of a file")] = None
    preset: Annotated[str | None, Field(description="a preset's name")] = None
    label: Annotated[str | None, Field(description="a name")] = None
    errors: Annotated[dict[str, Any] | None, Field(description="a table")] = None

    @model_validator(mode="after")
    def _one_of_two(self) -> DesignTable:
        if (self.file is None) == (self.preset is None):
            raise ValueError("file, preset: give one of them")
        return self


class Tables(Part):
    """The campaign file as it stands."""

    runs: Annotated[int, Field(ge=1, le=10**6, description="a whole number from 1 to 1e6")]
    seconds: Annotated[float, Field(gt=0, le=1e6, description="a number > 0, at most 1e6")]
    first_seed: Annotated[int, Field(ge=0, description="a whole number >= 0")] = 1
    checkpoints: Annotated[
        int, Field(ge=1, le=10_000, description="a whole number from 1 to 10000")
    ] = 20
    motion: Annotated[MotionTable, Field(description="a table with name or points")]
    vibration: Annotated[VibrationTable | None, Field(description="a table")] = None
    initial: Annotated[InitialTable, Field(description="a table")] = InitialTable()
    rtl: Annotated[RtlTable | None, Field(description="a table")] = None
    navigator: Annotated[NavigatorTable, Field(description="a table")] = NavigatorTable()
    design: Annotated[
        list[DesignTable], Field(min_length=1, max_length=100, description="1 to 100 tables")
    ]


class Campaign:
    """A campaign, valid.

    Args:
        tables: what the file says.
        folder: that names of files in it start from.

    Attributes:
        tables: as given.
        designs: the designs, in order.
        labels: their names.

    Raises:
        InputError: a design or the motion is at fault, or two designs have one label.
    """

    def __init__(self, tables: Tables, folder: Path) -> None:
        self.tables, self._folder = tables, folder
        self.designs = [self._design(table) for table in tables.design]
        self.labels = [
            table.label or design.name
            for table, design in zip(tables.design, self.designs, strict=True)
        ]
        twice = [label for label in self.labels if self.labels.count(label) > 1]
        if twice:
            raise InputError(f"design: two are called {twice[0]!r}, give each a label of its own")
        self._motion = self._made()

    @classmethod
    def load(cls, path: Path) -> Campaign:
        """Read a campaign file.

        Raises:
            InputError: it cannot be read or has faults; all are named.
        """
        data = read_toml(path, "campaign file", "a campaign in TOML")
        try:
            tables = Tables.model_validate(data)
        except ValidationError as error:
            raise InputError(f"{path}: " + "; ".join(faults_of(Tables, error))) from error
        try:
            return cls(tables, path.parent)
        except InputError as error:
            raise InputError(f"{path}: {error}") from error

    def _design(self, table: DesignTable) -> Design:
        if table.file is not None:
            design = Design.load(self._folder / table.file)
        else:
            design = Design.preset(table.preset or "")
        if table.errors is None:
            return design
        data = design.as_json()
        data["sensor"]["errors"] = table.errors
        return Design.parse(data, where=f"design {table.label or design.name}")

    def _made(self) -> Motion:
        table, shaking = self.tables.motion, self.tables.vibration
        if table.points is not None:
            given = read_points(str(self._folder / table.points), None, table.smoothness)
            if given.seconds < self.tables.seconds - 1e-9:
                raise InputError(
                    f"seconds: {table.points} ends {given.seconds:g} s after its first point"
                )
            motion = given.motion()
        else:
            make = MOTIONS[table.name or ""].make
            place = dict(zip(("lat", "lon", "h"), PLACE, strict=True))
            known = inspect.signature(make).parameters
            values = {key: place[key] for key in place if key in known}
            for key, value in table.parameters.items():
                values[key] = radians(value) if key in _ANGLES else value
            motion = make(**values)
        if shaking is not None and (shaking.g or shaking.rate):
            on_top = Shaking(
                shaking.g, shaking.rate, shaking.low, shaking.high, shaking.lines, shaking.seed
            )
            motion = on_top.vibration.on(motion)
        return motion

    @property
    def motion(self) -> Motion:
        """What is flown, vibration included."""
        return self._motion

    @property
    def seeds(self) -> range:
        """Of the runs of each design."""
        return range(self.tables.first_seed, self.tables.first_seed + self.tables.runs)

    @property
    def rtl_seeds(self) -> list[int]:
        """Of the runs of each design that go through the hardware too, evenly spread."""
        table, seeds = self.tables.rtl, self.seeds
        if table is None:
            return []
        many = min(table.runs, len(seeds))
        step = (len(seeds) - 1) / max(many - 1, 1)
        return [seeds[round(step * number)] for number in range(many)]

    def as_json(self) -> dict[str, Any]:
        """What would be flown, plain data."""
        seconds = self.tables.seconds
        samples = [round(seconds * design.sensor.sample_rate_hz) for design in self.designs]
        return {
            "runs": self.tables.runs,
            "first_seed": self.tables.first_seed,
            "seconds": seconds,
            "motion": self.motion.name,
            "designs": dict(zip(self.labels, samples, strict=True)),
            **({"rtl_seeds": self.rtl_seeds} if self.tables.rtl else {}),
        }

    @property
    def digest(self) -> str:
        """SHA-256 of everything that the results depend on, but the number of runs."""
        tables = self.tables.model_dump(
            mode="json", exclude={"runs", "design", "first_seed", "rtl"}
        )
        if self.tables.navigator.height == "initial":  # as before there was another
            del tables["navigator"]["height"]
        points = self.tables.motion.points
        data = {
            "tables": tables,
            "designs": [design.digest for design in self.designs],
            "points": (self._folder / points).read_bytes().hex() if points else "",
        }
        return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()

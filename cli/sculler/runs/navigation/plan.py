"""What a run of the navigator is asked for: where it begins, what carries the state, and how."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite, nan
from typing import Any, Literal, NamedTuple

from sculler_model.design import Design
from sculler_model.errors import ContradictionError, InputError
from sculler_model.frames import AxisMap, from_euler, to_euler
from sculler_model.host import refuse_of_samples, refuse_third_order
from sculler_model.navigation import (
    ESTIMATED,
    NORMAL,
    GeographicNavigator,
    Gravity,
    HeightDamping,
    HeightReference,
    Mechanisation,
    Navigator,
    NavState,
    RestBias,
    SensorNoise,
    attitude_state,
)
from sculler_model.samples import Calibration

Three = tuple[float | None, float | None, float | None]


class Given(NamedTuple):
    """What the user says of the initial state; None for what is left out.

    Attributes:
        angles: roll, pitch, heading, rad.
        velocity: north, east, down, m/s.
        place: lat (rad), lon (rad), height (m).
    """

    angles: Three
    velocity: Three
    place: Three

    def state(self, time: float, origin: NavState | None) -> NavState:
        """The initial state: as given, else as another tells, else level and still.

        Args:
            time: s.
            origin: the other state, NaN for what it does not tell.

        Raises:
            InputError: nobody tells the position.
        """
        level: tuple[float, float, float] = (0.0, 0.0, 0.0)
        told = origin is not None and isfinite(origin.q[0])
        q = origin.q if origin is not None and told else (1.0, 0.0, 0.0, 0.0)
        if any(angle is not None for angle in self.angles):
            q = from_euler(*_filled(self.angles, to_euler(q)))
        moving = origin is not None and isfinite(origin.v[0])
        v = _filled(self.velocity, origin.v if origin is not None and moving else level)
        lat, lon, h = self.position(origin)
        return NavState(time, q, v, lat, lon, h)

    def position(self, origin: NavState | None) -> tuple[float, float, float]:
        """Latitude, longitude (rad) and height (m); see `state`."""
        there = (None, None, None) if origin is None else (origin.lat, origin.lon, origin.h)
        place = [b if a is None else a for a, b in zip(self.place, there, strict=True)]
        for name, value in zip(("lat", "lon", "height"), place, strict=True):
            if value is None or not isfinite(value):
                raise InputError(
                    f"--{name}: missing, for the truth tells no position; say where the run begins"
                )
        lat, lon, h = (float(value or 0.0) for value in place)
        return lat, lon, h


def _filled(given: Three, other: tuple[float, float, float]) -> tuple[float, float, float]:
    a, b, c = (y if x is None else x for x, y in zip(given, other, strict=True))
    return a, b, c


def completed(state: NavState, other: NavState) -> NavState:
    """A state whose missing parts (NaN) another one tells."""
    if not isfinite(state.q[0]):
        state = state._replace(q=other.q)
    if not isfinite(state.v[0]):
        state = state._replace(v=other.v)
    if not isfinite(state.lat):
        state = state._replace(lat=other.lat, lon=other.lon, h=other.h)
    return state


ALTERNATIVES = "--azimuth, --attitude and --level-every"


@dataclass(frozen=True)
class Carrier:
    """What carries the state.

    Attributes:
        mechanisation: wander azimuth, which works at the poles too, or north-pointing.
        position_every: major intervals from one position update to the next (wander only).
        height_damping: s, time constant of the loop that holds the height, to the run's first one
            or to a reference; None for none.
        compiled, azimuth, attitude, level_every: as of `Navigator` (wander only).

    Raises:
        ContradictionError: the north-pointing one with what only the other has.
    """

    mechanisation: Literal["wander", "geographic"] = "wander"
    position_every: int = 1
    height_damping: float | None = None
    compiled: bool | None = None
    azimuth: Literal["wander", "free"] = "wander"
    attitude: Literal["quaternion", "cosines"] = "quaternion"
    level_every: int = 1

    def __post_init__(self) -> None:
        if self.mechanisation == "geographic" and self.compiled:
            raise ContradictionError("compiled is for the wander azimuth, leave it out")
        if self.mechanisation == "geographic" and self.position_every != 1:
            raise ContradictionError(
                "--position-every is for the wander azimuth, leave it out or give"
                " --mechanisation wander"
            )
        if self.mechanisation == "geographic" and not self.usual:
            raise ContradictionError(f"{ALTERNATIVES} are for the wander azimuth, leave them out")

    @property
    def usual(self) -> bool:
        """It has none of the alternatives."""
        return (self.azimuth, self.attitude, self.level_every) == ("wander", "quaternion", 1)

    def begin(
        self, start: NavState, interval: float, damping: HeightDamping | None, gravity: Gravity
    ) -> Mechanisation:
        """It, with a state.

        Args:
            start: the state.
            interval: a major interval, s.
            damping: what holds the height.
            gravity: the model.
        """
        if self.mechanisation == "geographic":
            return GeographicNavigator(start, interval, gravity, damping)
        return Navigator(
            start,
            interval,
            position_every=self.position_every,
            height_damping=damping,
            gravity=gravity,
            compiled=self.compiled,
            azimuth=self.azimuth,
            attitude=self.attitude,
            level_every=self.level_every,
        )


DAMPING = 100.0
"""s, of a height that has a reference, if nothing else is said."""

ANGLES, VELOCITIES = ("roll", "pitch", "heading"), ("vn", "ve", "vd")
NEEDS_MORE = (*VELOCITIES, "height_damping", "height_reference", "telemetry")
"""What attitude alone has no use for."""
NOISE = ("noise", "gyro_noise", "accel_noise", "gyro_bias_sigma", "accel_bias_sigma")
"""What only an alignment looks at: of the library all in one, of the verb one by one."""


def refuse_contradictions(
    asked: Mapping[str, Any], called: Callable[[str], str] = lambda name: name
) -> None:
    """See that what a user asks for goes together.

    Args:
        asked: arguments by name, of those that `sculler navigate` has; None or absent if left out.
        called: what the user calls an argument, for messages.

    Raises:
        ContradictionError: two of them do not go together.
    """

    def given(name: str) -> bool:
        return asked.get(name) is not None

    if asked.get("attitude_only"):
        for name in NEEDS_MORE:
            if given(name):
                raise ContradictionError(
                    f"{called(name)} is not for {called('attitude_only')}, which carries no"
                    " velocity and no place; leave one out"
                )
        if given("align") and not given("lat"):
            raise ContradictionError(
                f"{called('align')} finds north by the Earth's rate, give {called('lat')} too"
            )
    if given("rest") and asked.get("fine"):
        raise ContradictionError(
            f"{called('rest')} and {called('fine')} both take out the gyros' bias, give one"
        )
    align = called("align")
    if given("align"):
        for name in (*ANGLES, *VELOCITIES, "start"):
            if given(name):
                raise ContradictionError(
                    f"{called(name)} and {align} contradict each other, give one"
                )
    else:
        if asked.get("fine"):
            raise ContradictionError(f"{called('fine')} refines {align}, give that too")
        for name in NOISE:
            if given(name):
                raise ContradictionError(f"{called(name)} is for {align}, give that too")
    if asked.get("engine") == "c":
        engine = called("engine")
        if asked.get("mechanisation") == "geographic":
            raise ContradictionError(
                f"{engine} c has the wander azimuth only, leave out {called('mechanisation')}"
            )
    for name in ("height_lag", "height_noise"):
        if given(name) and not given("height_reference"):
            raise ContradictionError(
                f"{called(name)} is of {called('height_reference')}, give that too"
            )
    start, stop = asked.get("start"), asked.get("stop")
    if start is not None and stop is not None and not stop > start:
        raise ContradictionError(
            f"{called('stop')} {stop:g} is not after {called('start')} {start:g}, give a later time"
        )


@dataclass(frozen=True)
class Plan:
    """How to navigate with a file of vectors.

    Attributes:
        design: the design.
        name: of the vectors, for messages.
        given: what is said of the initial state.
        carrier: what carries the state.
        axes: from the sensor's axes to the body's.
        start, stop: the run's first and last instant (s), ends of major intervals; None for the
            first possible, the last.
        align: seconds of alignment at rest at the beginning; None for none.
        fine: refine it.
        third_order: correct φ and ΔV_SF by `ThirdOrder`.
        rotation: as of `host.major_increments`.
        split: begin anew after a break, which else is refused.
        gravity: the model of gravity.
        height_reference: a measured height that the damping holds to; None for the run's first one.
        noise: what is known of the sensors, for the alignment.
        realign: align anew after a break; else coast over it, and gather a window that a break
            cuts anew.
        engine: the host in Python, or the one in C that is generated, compiled and loaded.
        attitude_only: carry the attitude alone, with the Earth's rate where a latitude is given.
        rest: a window (s) in which the unit rests, to take the gyros' bias from; None for none.
        bias: that was found there, to be taken out.
        calibration: known errors of the sensor, to be taken out; None for none.
        channel: whose results to take, of a file of many channels.

    Raises:
        InputError: there is no such engine, or the window is empty.
        ContradictionError: the one in C, to be compiled by Numba.
    """

    design: Design
    name: str
    given: Given
    carrier: Carrier
    axes: AxisMap
    start: float | None = None
    stop: float | None = None
    align: float | None = None
    fine: bool = False
    third_order: bool = False
    rotation: Literal["exact", "first-order"] = "exact"
    split: bool = False
    gravity: Gravity = NORMAL
    height_reference: HeightReference | None = None
    noise: SensorNoise = ESTIMATED
    realign: bool = True
    engine: Literal["python", "c"] = "python"
    attitude_only: bool = False
    rest: tuple[float, float] | None = None
    bias: RestBias | None = None
    calibration: Calibration | None = None
    channel: int | None = None

    def __post_init__(self) -> None:
        if self.calibration is not None:
            if self.engine == "c" or self.rotation != "exact":
                raise ContradictionError(
                    "--calibration is for the engine python with the exact rotation, leave it out"
                    " or undo it in the log, by convert --calibration"
                )
            refuse_of_samples(self.design, self.calibration)
        if self.attitude_only and self.engine == "c":
            raise ContradictionError("--attitude-only is for the engine python, leave one out")
        if self.rest is not None and not self.rest[0] < self.rest[1]:
            raise InputError(
                f"--rest: {self.rest[0]:g} to {self.rest[1]:g} s is empty, give a later end"
            )
        if self.engine not in ("python", "c"):
            raise InputError(f'engine: {self.engine!r} is not allowed, give "python" or "c"')
        if self.third_order:
            refuse_third_order(self.design)
        if self.engine == "c" and self.carrier.compiled:
            raise ContradictionError("compiled is for the engine python, leave it out")
        if self.engine == "c" and not (self.carrier.usual and self.rotation == "exact"):
            raise ContradictionError(
                f"{ALTERNATIVES} and --rotation are for the engine python, leave them out"
            )

    def initial(self, time: float, origin: NavState | None, lat: float = nan) -> NavState:
        """The state to begin with.

        Args:
            time: s.
            origin: what the truth tells of it.
            lat: rad, of an attitude alone, if no other is given.

        Raises:
            InputError: nobody tells the position.
        """
        if not self.attitude_only:
            return self.given.state(time, origin)
        somewhere = self.given._replace(place=(0.0, 0.0, 0.0), velocity=(None, None, None))
        given = self.given.place[0]
        return attitude_state(
            time, somewhere.state(time, origin).q, lat if given is None else given
        )

    def damping(self, first_height: float) -> HeightDamping | None:
        """What holds the height of a run that began at a height (m)."""
        seconds, reference = self.carrier.height_damping, self.height_reference
        if seconds is None:
            return None
        if reference is None:
            return HeightDamping(first_height, seconds)
        return HeightDamping(None, seconds, reference.hold)

"""Increments of the vectors, and a run of the navigator over them in memory."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypedDict, cast

from sculler.formats import vectors as files
from sculler.formats.calibration import read_calibration
from sculler.formats.gravity import gravity_model
from sculler.formats.height import read_height_reference
from sculler.runs.navigation import AgainstTruth, Carrier, Given, NavigationRun, Plan
from sculler.runs.navigation.plan import DAMPING, refuse_contradictions
from sculler.runs.navigation.rest import with_rest_bias
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock
from sculler_model.frames import AxisMap
from sculler_model.host import MajorIncrements, ThirdOrder, major_increments, refuse_third_order
from sculler_model.navigation import (
    ESTIMATED,
    Alignment,
    FineAlignment,
    Gravity,
    HeightReference,
    NavHistory,
    NavState,
    RestBias,
    SensorNoise,
)
from sculler_model.samples import Calibration

if TYPE_CHECKING:
    from typing_extensions import Unpack


def increments(
    design: Design, vectors: VectorBlock, *, axes: str = "x,y,z", third_order: bool = False
) -> MajorIncrements:
    """φ, α, ΔV_SF and ΔR_SF of each major interval (Savage-98 Eq. 37 and 51, Yang Eq. 14).

    Args:
        design: whose vectors they are.
        vectors: the results of R consecutive major intervals.
        axes: which sensor axis becomes which body axis, as "y,x,-z"; sensor axes if left out.
        third_order: correct φ and ΔV_SF by the terms of third order that two-rate algorithms leave
            out, where the rate is smooth (`host.ThirdOrder`).  Give it the vectors from the first
            one on that you navigate with: what the first four lack is added to the fifth.

    Returns:
        phi, alpha (R, 3) rad; dv_sf (R, 3) m/s and, of a design with high-resolution position,
        dr_sf (R, 3) m, in the body frame at the START of each interval; with status, and times (s)
        of the intervals' ENDS where the vectors have them.

    Raises:
        InputError: the axes are no right-handed frame, or the vectors are of another design.

    Examples:
        >>> import numpy as np, sculler
        >>> design = sculler.Design.preset("stim300")
        >>> vectors = sculler.FastModel(design).feed(np.tile([5, 0, 0, 0, 0, -2], (20, 1)))
        >>> found = sculler.increments(design, vectors)
        >>> print(f"{found.phi[0, 0] / design.gyro_scale:.1f} counts")
        100.0 counts
    """
    _require_own(design, vectors)
    if third_order:
        refuse_third_order(design)
    found = major_increments(design, vectors).in_axes(AxisMap.parse(axes))
    return ThirdOrder()(found) if third_order else found


def _require_own(design: Design, vectors: VectorBlock) -> None:
    if vectors.columns != design.columns:
        raise InputError(
            f"vectors: {len(vectors.columns)} columns where design {design.name} has"
            f" {len(design.columns)}, give its own vectors"
        )


@dataclass(frozen=True)
class Navigated:
    """What a run of the navigator came to.

    Attributes:
        history: (R + 1,) states, at the start and at the end of each major interval; of true
            north, east and down on WGS-84.
        alignment: the coarse alignment at its beginning, or None.
        fine: the fine one, or None.
        warnings: what to look at before trusting the run, a line each.
        breaks: where intervals were missing, as plain data.
        left_out: results of short history (status bit 0) that the run begins after.
        errors: figures against the truth, as `sculler navigate --json` gives them, or None.
        rest: the gyros' biases seen in `rest`, which were taken out, or None.

    Examples:
        >>> import numpy as np, sculler
        >>> design = sculler.Design.preset("hg4930")
        >>> vectors = sculler.FastModel(design).feed(np.zeros((40, 6), int))
        >>> run = sculler.navigate(design, vectors, lat=48, lon=11, height=500)
        >>> isinstance(run, sculler.Navigated), run.alignment, run.breaks
        (True, None, [])
    """

    history: NavHistory
    alignment: Alignment | None = None
    fine: FineAlignment | None = None
    warnings: list[str] = field(default_factory=list)
    breaks: list[dict[str, float | int | str]] = field(default_factory=list)
    left_out: int = 0
    errors: Mapping[str, Any] | None = None
    rest: RestBias | None = None

    @property
    def start(self) -> NavState:
        """The first state."""
        return self.history.state(0)

    @property
    def end(self) -> NavState:
        """The last state."""
        return self.history.state(len(self.history) - 1)


class Begin(TypedDict, total=False):
    """Where a run begins, and what carries it: the keywords of `navigate` and `LiveNavigator`."""

    lat: float | None
    lon: float | None
    height: float | None
    roll: float | None
    pitch: float | None
    heading: float | None
    vn: float | None
    ve: float | None
    vd: float | None
    align: float | None
    fine: bool
    axes: str
    third_order: bool
    mechanisation: Literal["wander", "geographic"]
    position_every: int
    height_damping: float | None
    height_reference: str | Path | HeightReference | None
    height_lag: float | None
    height_noise: float | None
    gravity: str | Gravity
    noise: SensorNoise
    engine: Literal["python", "c"]
    azimuth: Literal["wander", "free"]
    attitude: Literal["quaternion", "cosines"]
    level_every: int
    rotation: Literal["exact", "first-order"]
    attitude_only: bool
    rest: tuple[float, float] | None
    calibration: str | Path | Calibration | None


def _radians(value: float | None) -> float | None:
    return None if value is None else radians(value)


def make_plan(
    design: Design,
    name: str,
    asked: Begin,
    start: float | None = None,
    stop: float | None = None,
) -> Plan:
    """A plan from keywords in degrees, metres and seconds.

    Raises:
        ContradictionError: two of them do not go together.
        InputError: one has a fault.
        TypeError: there is no such keyword.
    """
    for key in asked:
        if key not in Begin.__annotations__:
            raise TypeError(
                f"unexpected keyword {key!r}, give some of {', '.join(Begin.__annotations__)}"
            )
    get = cast("dict[str, Any]", asked).get
    refuse_contradictions({**asked, "start": start, "stop": stop})
    known = get("calibration")
    if isinstance(known, str | Path):
        known = read_calibration(Path(known))
    gravity, reference = get("gravity", "normal"), get("height_reference")
    lag, noise = get("height_lag") or 0.0, get("height_noise") or 0.0
    if isinstance(reference, str | Path):
        reference = read_height_reference(Path(reference), lag, noise)
    return Plan(
        design,
        name,
        Given(
            (_radians(get("roll")), _radians(get("pitch")), _radians(get("heading"))),
            (get("vn"), get("ve"), get("vd")),
            (_radians(get("lat")), _radians(get("lon")), get("height")),
        ),
        Carrier(
            get("mechanisation", "wander"),
            get("position_every", 1),
            get("height_damping") or (None if reference is None else DAMPING),
            azimuth=get("azimuth", "wander"),
            attitude=get("attitude", "quaternion"),
            level_every=get("level_every", 1),
        ),
        AxisMap.parse(get("axes", "x,y,z")),
        start=start,
        stop=stop,
        align=get("align"),
        fine=get("fine", False),
        third_order=get("third_order", False),
        rotation=get("rotation", "exact"),
        height_reference=reference,
        gravity=gravity_model(gravity) if isinstance(gravity, str) else gravity,
        noise=get("noise", ESTIMATED),
        engine=get("engine", "python"),
        attitude_only=get("attitude_only", False),
        rest=get("rest"),
        calibration=known,
    )


def require_place(asked: Begin) -> None:
    """See that the position is told.

    Raises:
        InputError: a part of it is missing.
    """
    for name in () if asked.get("attitude_only") else ("lat", "lon", "height"):
        if asked.get(name) is None:
            raise InputError(f"{name}: missing, say where the run begins")


def navigate(
    design: Design,
    vectors: VectorBlock | str | Path,
    *,
    start: float | None = None,
    stop: float | None = None,
    truth: str | Path | None = None,
    breaks: Literal["refuse", "split"] = "refuse",
    **begin: Unpack[Begin],
) -> Navigated:
    """Carry attitude, velocity and position with the vectors, as `sculler navigate` does.

    Wander azimuth over WGS-84 after Savage-98 Table 1, in double precision, once a major interval.
    The body frame is x forward, y right, z down.  Results of short history at the beginning
    (status bit 0) are left out, and the run begins at their end.

    Args:
        design: whose vectors they are.
        vectors: the results of consecutive major intervals, or the path of a vectors file.
        start, stop: s, the run's first and last instant, ends of major intervals; None for the
            first possible and the last.
        truth: a truth file to hold the run against; it tells what of the beginning is left out.
        breaks: refuse vectors with intervals missing, or begin anew after a break.
        begin: where the run begins and what carries it; each may be left out but for the place:

            - `lat`, `lon` (degrees, geodetic), `height` (m above the ellipsoid)
            - `roll`, `pitch`, `heading` (degrees; heading from north to east), `vn`, `ve`, `vd`
              (m/s): 0 if left out
            - `align`: seconds at rest at the beginning to find the attitude from; `fine`: refine it
            - `axes`: which sensor axis becomes which body axis, as "y,x,-z"
            - `third_order`: correct φ and ΔV_SF by the terms of third order where the rate is
              smooth
            - `mechanisation`: "wander" (works at the poles) or "geographic"; `position_every`:
              major intervals from one position update to the next
            - `height_damping`: s, time constant of a loop that holds the height, to the first one
              or to `height_reference`: a CSV of time_s, height_m with `height_lag` (s) and
              `height_noise` (m), or a `HeightReference`
            - `gravity`: "normal", "constant", "constant:G", a table's path or a `Gravity`
            - `noise`: a `SensorNoise`, what is known of the sensors, for the alignment
            - other forms, to see what each is worth: `azimuth` "free", `attitude` "cosines",
              `level_every` (major intervals), `rotation` "first-order"
            - `attitude_only`: carry no place, which then need not be given, and no velocity: both
              are NaN; with `lat` the attitude is against the turning Earth, else against the stars
            - `rest`: (begin, end), s, where the unit rests; the gyro bias seen there, less the
              Earth's rate where the latitude is known, is taken out
            - `calibration`: a calibration file, or a `sculler_model.samples.Calibration`: known
              errors of the sensor, which are taken out
            - `engine`: "python", or "c": the host in C, compiled here; the same numbers

    Returns:
        The states, at the start and at the end of every major interval, and what was seen.

    Raises:
        InputError: an argument or a file has a fault, there is a break that is refused, or the
            navigator cannot follow the vectors.

    Examples:
        >>> import sculler
        >>> design = sculler.Design.preset("hg4930")
        >>> log = sculler.record(design, sculler.motion("rest", lat=48, lon=11, height=500), 2)
        >>> vectors = sculler.FastModel(design).feed(log.counts)
        >>> run = sculler.navigate(design, vectors, lat=48, lon=11, height=500)
        >>> len(run.history), f"{run.end.time:.2f} s", f"{abs(run.end.h - 500):.0f} m"
        (51, '2.00 s', '0 m')
    """
    path = None if isinstance(vectors, VectorBlock) else str(vectors)
    plan = make_plan(design, "vectors" if path is None else path, begin, start, stop)
    plan = replace(plan, split=breaks == "split")
    if truth is None:
        require_place(begin)
    if isinstance(vectors, VectorBlock):
        _require_own(design, vectors)

    def blocks() -> Iterable[VectorBlock]:
        if isinstance(vectors, VectorBlock):
            return [vectors]
        return files.read_vectors(vectors, design, missing=True)

    def compared() -> AgainstTruth | None:
        if truth is None:
            return None
        only = plan.attitude_only
        return AgainstTruth(Path(truth), design.major_interval, attitude_only=only)

    plan = with_rest_bias(plan, blocks, compared)
    reference = compared()
    parts: list[NavHistory] = []
    run = NavigationRun(plan, parts.append, reference)
    run.take(blocks())
    seen = run.seen
    return Navigated(
        NavHistory.concatenate(parts),
        seen.alignment,
        seen.fine,
        seen.warnings,
        seen.breaks,
        seen.left_out,
        None if reference is None else reference.summary(),
        plan.bias,
    )

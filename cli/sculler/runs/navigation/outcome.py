"""What a navigated file came to: as values, as plain data for JSON, as rows for a reader."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, degrees, hypot, isfinite, pi, sin
from pathlib import Path
from typing import Any

from sculler.runs.navigation import against_truth
from sculler.runs.navigation.against_truth import AgainstTruth
from sculler.runs.navigation.plan import Plan
from sculler.runs.navigation.seen import STATUSES, Seen
from sculler.words import plural, warning_rows
from sculler_model.frames import radii, to_euler
from sculler_model.navigation import Alignment, FineAlignment, NavState, RestBias, SensorNoise

ANGLES = ("roll", "pitch", "heading")

_POSITION = {
    "high-resolution": "of high resolution, by the vectors s_alpha, s_nu and scrolling",
    "trapezoidal": "by the trapezoid",
}


@dataclass(frozen=True)
class Outcome:
    """What a run came to.

    Attributes:
        plan: what was asked for.
        output: the states.
        seen: what the run came by; its warnings are `warnings`, with those of the files.
        start, end: the first and the last state.
        errors: `AgainstTruth.summary`; None without a truth.
        pictures: the files; None if none were asked for or none could be drawn.
        no_pictures: why none could be drawn.
    """

    plan: Plan
    output: Path
    seen: Seen
    start: NavState
    end: NavState
    errors: dict[str, Any] | None
    pictures: list[Path] | None
    no_pictures: str | None

    @classmethod
    def of(
        cls,
        plan: Plan,
        output: Path,
        seen: Seen,
        reference: AgainstTruth | None,
        pictures: list[Path] | None,
        no_pictures: str | None,
    ) -> Outcome:
        """Of a run that is over."""
        if seen.start is None or seen.end is None:
            raise ValueError("the run is not over")
        errors = None if reference is None else reference.summary()
        return cls(plan, output, seen, seen.start, seen.end, errors, pictures, no_pictures)

    @property
    def warnings(self) -> list[str]:
        """What to look at before trusting the run."""
        rest = [] if self.plan.bias is None else list(self.plan.bias.warnings)
        return rest + self.seen.warnings + ([] if self.no_pictures is None else [self.no_pictures])

    def as_json(self) -> dict[str, Any]:
        """As plain data."""
        seen, plan = self.seen, self.plan
        data = self._motion()
        if seen.alignment is not None:
            data["alignment"] = _alignment_facts(seen.alignment)
        for key in STATUSES:
            data[key] = seen.statuses.get(key, (0, 0.0))[0]
        data["short_history_results_left_out"] = seen.left_out
        data["breaks"] = seen.breaks
        if plan.third_order:
            data["third_order"] = dict(zip(("corrected", "left"), seen.third_order, strict=True))
        if plan.calibration is not None:
            data["calibrated"] = True
        if plan.bias is not None:
            data["rest"] = _rest_facts(plan.bias)
        data["engine"] = plan.engine
        data["gravity"] = str(plan.gravity)
        data["warnings"] = self.warnings
        if self.no_pictures is not None:
            data["no_pictures"] = self.no_pictures
        fine_position = plan.design.high_resolution and plan.carrier.mechanisation == "wander"
        data["position_algorithm"] = "high-resolution" if fine_position else "trapezoidal"
        if plan.attitude_only:
            del data["gravity"], data["position_algorithm"]
            lat = self.start.lat
            data["attitude_only"] = True
            data["earth_rate_at_lat_deg"] = degrees(lat) if isfinite(lat) else None
        if seen.fine is not None:
            data["alignment"] |= _fine_facts(seen.fine)
        if self.errors is not None:
            data["errors"] = self.errors
        if self.pictures is not None:
            data["plots"] = [str(path) for path in self.pictures]
        return data

    def _motion(self) -> dict[str, Any]:
        """Where it went."""
        start, end = self.start, self.end
        if self.plan.attitude_only:
            return self._turned()
        meridian, prime_vertical = radii(sin(start.lat))
        north = (end.lat - start.lat) * (meridian + start.h)
        turned = (end.lon - start.lon + pi) % (2 * pi) - pi
        east = turned * (prime_vertical + start.h) * cos(start.lat)
        data = self._turned()
        heading = {key: data.pop(key) for key in list(data) if key.startswith("heading_change")}
        per_hour = 3600 / data["seconds"] if data["seconds"] else 0.0
        return data | {
            "end_velocity": dict(zip(("north", "east", "down"), end.v, strict=True)),
            "end_position": {
                "lat_deg": degrees(end.lat),
                "lon_deg": degrees(end.lon),
                "height_m": end.h,
            },
            "moved_m": {"north": north, "east": east, "up": end.h - start.h},
            "moved_horizontally_m": hypot(north, east),
            "moved_horizontally_km_per_h": hypot(north, east) * per_hour / 1000,
            **heading,
        }

    def _turned(self) -> dict[str, Any]:
        """How it turned."""
        start, end = self.start, self.end
        seconds = end.time - start.time
        angles = [degrees(angle) for angle in to_euler(start.q)]
        end_angles = [degrees(angle) for angle in to_euler(end.q)]
        heading_change = (end_angles[2] - angles[2] + 180) % 360 - 180
        return {
            "design": self.plan.design.name,
            "vectors": self.plan.name,
            "output": str(self.output),
            "start_s": start.time,
            "seconds": seconds,
            "start_attitude_deg": dict(zip(ANGLES, angles, strict=True)),
            "end_attitude_deg": dict(zip(ANGLES, end_angles, strict=True)),
            "heading_change_deg": heading_change,
            "heading_change_deg_per_h": heading_change * (3600 / seconds if seconds else 0.0),
        }


def _rest_facts(found: RestBias) -> dict[str, Any]:
    """Biases seen at rest as plain data."""
    return {
        "from_s": found.begin,
        "to_s": found.end,
        "gyro_bias_deg_per_h": [degrees(rate) * 3600 for rate in found.bias],
        "sigma_deg_per_h": [degrees(rate) * 3600 for rate in found.sigma],
        "earth_rate_taken_off": found.earth,
    }


def _alignment_facts(found: Alignment) -> dict[str, Any]:
    """An alignment as plain data."""
    return {
        "seconds": found.seconds,
        "rate_deg_per_h": degrees(found.rate) * 3600,
        "specific_force": found.specific_force,
        "gravity": found.gravity,
        "implied_latitude_deg": degrees(found.latitude),
        "warnings": list(found.warnings),
        **_sigma_facts(found, found.noise),
    }


def _fine_facts(found: FineAlignment) -> dict[str, Any]:
    """What the fine stage adds to the alignment's data."""
    north, east, _ = map(degrees, found.sigma)
    return _sigma_facts(found, found.coarse.noise) | {
        "level_sigma_deg": hypot(north, east),
        "gyro_bias_deg_per_h": [degrees(rate) * 3600 for rate in found.gyro_bias],
        "surprise": found.surprise,
        "warnings": list(found.warnings),
    }


def _sigma_facts(found: Alignment | FineAlignment, noise: SensorNoise) -> dict[str, Any]:
    """Told sigmas of an alignment, and the noise that they come from, as plain data."""
    roll, pitch, heading = map(degrees, found.euler_sigma)
    return {
        "sigma_deg": {"roll": roll, "pitch": pitch, "heading": heading},
        "heading_sigma_deg": degrees(found.sigma[2]),
        "noise": {
            "gyro_deg_per_sqrt_h": degrees(noise.angle_random_walk or 0.0) * 60,
            "accel_m_per_s_per_sqrt_h": (noise.velocity_random_walk or 0.0) * 60,
            "gyro_bias_sigma_deg_per_h": (
                None if noise.gyro_bias is None else degrees(noise.gyro_bias) * 3600
            ),
            "accel_bias_sigma": noise.accel_bias,
        },
    }


def told(data: Mapping[str, Any]) -> dict[str, str]:
    """`Outcome.as_json` in words: name and value of what is worth saying."""
    rows = {}
    if "alignment" in data:
        found = data["alignment"]
        rows["alignment"] = (
            f"{found['seconds']:g} s at rest: rate {found['rate_deg_per_h']:.3f} °/h, implied"
            f" latitude {found['implied_latitude_deg']:.3f}°;"
            f" {_sigmas_told(found)}"
        )
        if "level_sigma_deg" in found:
            bias = ", ".join(f"{rate:+.4f}" for rate in found["gyro_bias_deg_per_h"])
            rows["fine alignment"] = (
                f"level to {found['level_sigma_deg']:.2g}°, gyro biases {bias} °/h in the body,"
                f" {_biases_told(found)}"
            )
    rows |= warning_rows(data["warnings"])
    if data["short_history_results_left_out"]:
        rows["short history"] = (
            f"{plural(data['short_history_results_left_out'], 'result')} reached before"
            " the first sample (status bit 0) and cannot be carried: the run begins after that, at"
            f" {data['start_s']:.15g} s, where the initial state holds"
        )

    if "calibrated" in data:
        rows["calibration"] = "known errors of the sensor taken out of the results"
    if "rest" in data:
        rows["rest"] = _rest_told(data["rest"])
    if "third_order" in data:
        rows["third order"] = _third_order_told(**data["third_order"])

    return rows | {
        "duration": f"{data['seconds']:,.6g} s from {data['start_s']:.15g} s on",
        "start attitude": _angles_told(data["start_attitude_deg"]),
        "end attitude": _angles_told(data["end_attitude_deg"]),
        **(_attitude_told(data) if "attitude_only" in data else _place_told(data)),
        **({"engine": "the host in C, compiled"} if data["engine"] == "c" else {}),
        **(
            {"gravity": data["gravity"], "position": _POSITION[data["position_algorithm"]]}
            if "gravity" in data
            else {}
        ),
        "wrote": ", ".join(data[key] for key in ("output", "telemetry") if key in data),
        **(against_truth.facts(data["errors"]) if "errors" in data else {}),
        **({"pictures": ", ".join(data["plots"])} if "plots" in data else {}),
        **({"report": data["report"]} if "report" in data else {}),
    }


def _angles_told(angles: dict[str, float]) -> str:
    return ", ".join(f"{name} {_four_places(angle)}°" for name, angle in angles.items())


def _heading_told(data: Mapping[str, Any]) -> str:
    change, rate = data["heading_change_deg"], data["heading_change_deg_per_h"]
    return f"{_four_places(change)}°, {_four_places(rate)} °/h"


def _attitude_told(data: Mapping[str, Any]) -> dict[str, str]:
    """Of a run that carried the attitude alone."""
    lat = data["earth_rate_at_lat_deg"]
    against = "the stars: no latitude was given for the Earth's rate"
    if lat is not None:
        against = f"the turning Earth at latitude {lat:g}°"
    return {"heading change": _heading_told(data), "attitude": f"against {against}"}


def _place_told(data: Mapping[str, Any]) -> dict[str, str]:
    """Where it went."""
    moved, velocity, place = data["moved_m"], data["end_velocity"], data["end_position"]
    return {
        "end velocity": ", ".join(f"{name} {_four_places(v)}" for name, v in velocity.items())
        + " m/s",
        "end position": f"lat {place['lat_deg']:.7f}°, lon {place['lon_deg']:.7f}°,"
        f" height {place['height_m']:.2f} m",
        "moved": ", ".join(f"{name} {metres:,.2f} m" for name, metres in moved.items()),
        "moved per hour": f"{data['moved_horizontally_km_per_h']:.4g} km/h horizontally, start to"
        " end",
        "heading change": _heading_told(data),
    }


def _rest_told(found: Mapping[str, Any]) -> str:
    """Biases seen at rest, in words."""
    biases = ", ".join(
        f"{rate:+.4g} ± {sigma:.2g}"
        for rate, sigma in zip(found["gyro_bias_deg_per_h"], found["sigma_deg_per_h"], strict=True)
    )
    earth = "less the Earth's rate" if found["earth_rate_taken_off"] else "the Earth's rate in it"
    span = f"{found['from_s']:g} to {found['to_s']:g} s"
    return f"{span}: gyro biases {biases} °/h in the body, {earth}; taken out"


def _sigmas_told(found: Mapping[str, Any]) -> str:
    """The stated sigmas in words, and the noise behind them."""
    angles = ", ".join(f"{name} {value:.2g}°" for name, value in found["sigma_deg"].items())
    noise = found["noise"]
    return (
        f"1 σ: {angles}, by {noise['gyro_deg_per_sqrt_h']:.2g} °/√h and"
        f" {noise['accel_m_per_s_per_sqrt_h']:.2g} m/s/√h"
    )


def _biases_told(found: Mapping[str, Any]) -> str:
    """What of the gyros' biases was looked for, in words."""
    sigma = found["noise"]["gyro_bias_sigma_deg_per_h"]
    if sigma is None:
        return "of which about north alone was looked for (--gyro-bias-sigma: all three)"
    return f"of {sigma:.2g} °/h (1 σ) to expect"


def _third_order_told(corrected: int, left: int) -> str:
    """Where it held, in words."""
    if not left:
        return f"all {corrected} intervals corrected"
    return (
        f"{corrected} of {corrected + left} intervals corrected; over the others the rate is not"
        " smooth (vibration above a 17th of the update rate, noise), and they stay as they are"
    )


def _four_places(value: float) -> str:
    """With four decimals, and no minus sign before a zero."""
    return f"{round(value, 4) + 0.0:.4f}"

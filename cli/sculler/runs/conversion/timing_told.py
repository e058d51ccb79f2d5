"""What a recording's stamps showed and what was done, as data, in words and as a table."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from sculler.readers.timing import Gaps, Steps, Timing
from sculler.words import plural
from sculler_model.design import Design


def as_json(timing: Timing, design: Design, gaps: Gaps, steps: Steps) -> dict[str, Any]:
    """What the stamps showed, and what was done."""
    found = timing.report
    plain = found.shortest_step <= found.longest_step
    return {
        "samples_read": found.samples,
        "start_s": found.start,
        "end_s": found.start + found.span,
        "rate_hz": found.rate,
        "design_rate_hz": design.sensor.sample_rate_hz,
        "shortest_step_s": found.shortest_step if plain else None,
        "longest_step_s": found.longest_step if plain else None,
        "unequal_steps": found.unequal,
        "repeated_stamps": found.repeated,
        "samples_twice": found.twice,
        "passed_over": found.passed_over,
        "first_passed_over": found.first_passed_over,
        "samples_too_many": found.too_many,
        "rollovers": [asdict(rollover) for rollover in found.rollovers],
        "gap_count": found.gap_count,
        "missing_samples": found.missing,
        "gaps": [asdict(gap) for gap in found.gaps],
        "gaps_are": {"bridge": "bridged", "ignore": "ignored", "refuse": "refused"}[gaps],
        "steps": steps,
    }


def warnings(timing: Timing, design: Design, gaps: Gaps, steps: Steps) -> list[str]:
    """What the user should know of the stamps."""
    found = timing.report
    told = [
        f"time went back by {rollover.width:.15g} s at sample {rollover.sample}: the width of"
        f" {rollover.name}, so it goes on from there"
        for rollover in found.rollovers
    ]
    if gaps == "ignore" and found.gap_count:
        told.append(
            f"{plural(found.gap_count, 'gap')} left as they are: model and simulate refuse"
            " the log there, or begin anew (--breaks split)"
        )
    if found.passed_over:
        told.append(
            f"{plural(found.passed_over, 'stamp')} passed over, the first at sample"
            f" {found.first_passed_over}: they repeat, or stray by more than 0.75 intervals"
            f" ({found.repeated:,} do not grow); these samples are taken as one interval after the"
            " one before"
        )
    if found.twice and found.too_many:
        told.append(
            f"{plural(found.twice, 'sample')} with the stamp and the six numbers of the"
            " sample before: if the log has rows twice, take them out"
        )
    if found.too_many and found.rate is not None:
        told.append(
            f"{plural(found.too_many, 'sample')} more than the stamps have time for: if"
            " they are real, the stamps are not; time_s goes by the sample rate from there on"
        )
    if steps == "resample" or found.rate is None or found.too_many:
        return told
    off = found.rate / design.sensor.sample_rate_hz - 1
    strayed = abs(off) * found.samples  # intervals, from the first stamp to the last
    longest = max(found.longest_step / design.sample_interval, 1.0)  # a late stamp at either end
    if abs(off) > 1e-4 and strayed > longest:
        told.append(
            f"the stamps show {found.rate:.9g} Hz, {off * 1e6:+.0f} ppm from"
            " sensor.sample_rate_hz: give --steps resample, or the design that rate"
        )
    return told


def words(timing: dict[str, Any]) -> str:
    """The data of `as_json` in a line."""
    if timing["samples_read"] < 2:
        return "one sample"
    told = f"from {timing['start_s']:.6f} s to {timing['end_s']:.6f} s"
    if timing["rate_hz"] is not None:
        told = f"{timing['rate_hz']:.9g} Hz {told}"
    if timing["longest_step_s"] is not None:
        told += f", steps {timing['shortest_step_s']:.6g} s to {timing['longest_step_s']:.6g} s"
    if timing["unequal_steps"]:
        treated = "resampled" if timing["steps"] == "resample" else "taken as even"
        told += f" ({timing['unequal_steps']:,} unequal, {treated})"
    if not timing["gap_count"]:
        return told + ", no gaps"
    gaps = plural(timing["gap_count"], "gap")
    missing = plural(timing["missing_samples"], "sample")
    return told + f"; {gaps}, {missing} missing, {timing['gaps_are']}"

"""How far back a design's samples reach, and so which results lack samples before the first one.

The one rule of status bit 0 (short history): golden and fast model and both cores take it from
here, as `Design.reaches`, `.short_samples` and `.short_majors`.
"""

from __future__ import annotations

from sculler_model.algorithms import TapTable


def reaches(table: TapTable, high_resolution: bool) -> tuple[int, ...]:
    """For each phase 1..n, how many samples before its own the oldest one lies that it uses.

    A phase uses the samples of its non-zero taps, the last one of a minor interval those of the
    non-zero weights too, and with high-resolution position every phase the sample before.

    Args:
        table: the tap table.
        high_resolution: whether the design has high-resolution position.
    """
    furthest = []
    for phase, row in enumerate(table.taps, start=1):
        used = [distance for distance, tap in enumerate(row, start=1) if tap]
        if phase == table.samples:
            used += [distance for distance, weight in enumerate(table.weights) if weight]
        furthest.append(max([int(high_resolution), *used]))
    return tuple(furthest)


def short_samples(table: TapTable, high_resolution: bool, before: int = 0) -> tuple[bool, ...]:
    """For each sample t = 0, 1, ... from reset, whether it uses one before sample 0; later none.

    Args:
        table, high_resolution: as for `reaches`.
        before: how many counts before its own a sample is made of, by compensation.
    """
    furthest = reaches(table, high_resolution)
    count = max(table.history, int(high_resolution)) + before
    return tuple(furthest[t % table.samples] + before > t for t in range(count))

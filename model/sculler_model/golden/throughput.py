"""How fast a core takes samples in the long run, from its clocks (`cycles.Timing`)."""

from __future__ import annotations

from sculler_model.design import Design
from sculler_model.golden.cycles import Timing
from sculler_model.golden.stream import words_per_result


def clocks_per_minor(design: Design, timing: Timing) -> int:
    """Clocks between the ends of minor intervals when samples are always offered."""
    n = design.algorithm.samples
    busy = [(k, work) for k, work in enumerate(timing.work, start=1) if work]
    if not busy:
        return n * timing.samples_apart
    following = [k for k, _ in busy[1:]] + [busy[0][0] + n]
    return sum(
        max((later - k) * timing.samples_apart, work)
        for (k, work), later in zip(busy, following, strict=True)
    )


def clocks_per_major(design: Design, timing: Timing) -> int:
    """Clocks between results when samples are always offered and results taken at once.

    A result must have been taken before there is room for another's last sample, unless the core
    drops results: then the samples alone set the pace, and if handing over takes longer, not every
    result is seen.
    """
    samples = design.algorithm.minors * clocks_per_minor(design, timing)
    if timing.dropping is not None:
        return samples
    words = words_per_result(design) if design.hardware.handover == "stream" else 1
    own = timing.latency - timing.beside
    handing_over = own + (words - 1) * timing.handover_spacing + 1
    return max(
        samples,
        -(-handing_over // timing.results),
        words * timing.handover_spacing,
    )

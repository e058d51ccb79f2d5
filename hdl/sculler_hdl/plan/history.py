"""Which samples after a reset reach back before the first one: one rule for both cores.

It is that of the golden model: a tap or weight that is not 0 is in use at a distance before sample
0, or high-resolution position, which uses the sample before, works on the first one.
"""

from __future__ import annotations

from sculler_model.design import Design


def short_samples(design: Design) -> list[bool]:
    """For each sample from reset, up to the longest history, whether it reaches too far back."""
    table = design.table
    short = []
    for t in range(table.history):
        k = t % table.samples + 1
        used = [d for d, c in enumerate(table.taps[k - 1], start=1) if c]
        if k == table.samples:
            used += [d for d, w in enumerate(table.weights) if w]
        short.append(max(used, default=0) > t)
    if design.high_resolution:  # reaches one sample back
        short[:1] = [True]
    return short


def short_majors(design: Design) -> int:
    """How many major intervals from reset have such a sample.

    A phase that reaches far enough back in some interval does so in every earlier one, so they
    come first.
    """
    short = [t for t, value in enumerate(short_samples(design)) if value]
    return short[-1] // design.samples_per_major + 1 if short else 0

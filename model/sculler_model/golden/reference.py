"""The reference model: the high-rate algorithm in plain integers.

It is written to be held against the page (docs/explanation/theory.md) line by line.  It knows
nothing of the hardware and is not fast; `sculler_model.fast` is its fast twin and is tested equal
to it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from sculler_model.algorithms import (
    ZERO,
    Dual,
    HigherOrder,
    HighResolution,
    Vec,
    cross,
    dual_sum,
    dual_times,
    times,
    vector_sum,
    whole_numbers,
)
from sculler_model.design import (
    AXES,
    STATUS_FAULT,
    STATUS_LOST,
    STATUS_RAIL,
    STATUS_SHORT_HISTORY,
    STATUS_UPSET,
    Design,
    Interval,
    Result,
    WordLengths,
)
from sculler_model.errors import InputError
from sculler_model.golden.compensation import Compensator

Sample = tuple[Vec, Vec, int]
"""One six-axis reading: gyro counts, accelerometer counts, fault flag (0 or 1)."""


def check_widths(words: WordLengths, t: int, counts: Sequence[int]) -> None:
    """See that the six counts of sample t (gyro x, y, z, accelerometer x, y, z) fit the sensors.

    Raises:
        InputError: naming the first that does not.
    """
    for column, count in enumerate(counts):
        name, allowed = ("gyro", words.gyro) if column < 3 else ("accel", words.accel)
        if count not in allowed:
            raise InputError(
                f"sample {t}: {name}_{AXES[column % 3]} = {count} does not fit"
                f" {allowed.bits} bits, give {allowed.lo} to {allowed.hi}"
            )


def at_rail(counts: Vec, allowed: Interval) -> bool:
    """Whether a count is the most negative or the most positive one that its sensor can send."""
    return any(count in (allowed.lo, allowed.hi) for count in counts)


class GoldenModel:
    """Exact coning/sculling accumulators for one design.

    Feed samples one at a time with `step`; it returns the major interval's `Result` on the
    interval's last sample, else None.  Sample history runs on across intervals until `reset`.
    Where a sample was lost between two of them, say so with `lose`.

    Args:
        design: the design.

    Attributes:
        t: running number of the next sample.
        major: number of the present major interval.
        status: its status so far; `alpha` and the other vectors of `Result` its sums so far.

    Examples:
        >>> import sculler
        >>> model = sculler.GoldenModel(sculler.Design.preset("stim300"))
        >>> results = [model.step((1, 2, 3), (0, 0, -5)) for _ in range(20)]
        >>> results[18] is None, results[19].alpha, results[19].nu
        (True, (20, 40, 60), (0, 0, -100))
    """

    def __init__(self, design: Design) -> None:
        self.design = design
        self.reset()

    def reset(self) -> None:
        """Forget everything: the next sample is the first, the next major interval is 0."""
        self.t = 0  # running number of the next sample
        self.s: list[Vec] = []  # gyro counts, or compensated ones, newest last
        self.r: list[Vec] = []  # accelerometer counts, newest last
        plan = self.design.compensation_plan
        self.compensator = None if plan is None else Compensator(plan)
        self.position = HighResolution() if self.design.high_resolution else None
        self.higher = None
        if self.design.order > 2:
            self.higher = HigherOrder(self.design.table, self.design.order)
        self.major = 0
        self._clear()

    def _clear(self) -> None:
        self.status = 0
        self.alpha = self.coning_within = self.coning_between = ZERO
        self.nu = self.sculling_within = self.sculling_between = ZERO
        if self.position is not None:
            self.position.clear()
        if self.higher is not None:
            self.higher.clear()
        self._within = Dual(ZERO, ZERO)  # the sums within at the last minor interval's end

    def _weighted_sum(self, coefficients: Iterable[tuple[int, int]], counts: list[Vec]) -> Vec:
        """Sum of c * counts[t-d] over pairs (d, c); samples before the first one are zero."""
        terms = [times(c, counts[-1 - d]) for d, c in coefficients if c and d <= self.t]
        return vector_sum(ZERO, *terms)

    def lose(self) -> None:
        """A sample was offered and not taken: it marks the interval of the next one taken."""
        self.status |= STATUS_LOST

    def upset(self) -> None:
        """A hardened core has seen an upset: it marks the interval of the next sample."""
        self.status |= STATUS_UPSET

    def step(self, gyro: Vec, accel: Vec, fault: int = 0) -> Result | None:
        """Take the sample of time t.

        Args:
            gyro, accel: integer counts within the design's widths (signed), of any integer type.
            fault: 1 marks the interval's status, as a count at either end of its width does.

        Returns:
            The interval's result after its last sample, else None.

        Raises:
            InputError: a count is no whole number, or does not fit the sensor's width.
        """
        gyro = whole_numbers(f"sample {self.t}: gyro", gyro)
        accel = whole_numbers(f"sample {self.t}: accel", accel)
        table, words = self.design.table, self.design.words
        check_widths(words, self.t, (*gyro, *accel))
        rail = at_rail(gyro, words.gyro) or at_rail(accel, words.accel)
        if self.compensator is not None:
            gyro, accel, fault, rail = self.compensator.step(gyro, accel, fault, rail)
        self.s.append(gyro)
        self.r.append(accel)
        if fault:
            self.status |= STATUS_FAULT
        if rail:
            self.status |= STATUS_RAIL
        if any(self.design.short_samples[self.t : self.t + 1]):
            self.status |= STATUS_SHORT_HISTORY

        self._every_sample(gyro, accel)
        result = None
        if (self.t + 1) % table.samples == 0:
            self._every_minor_end()
        if (self.t + 1) % self.design.samples_per_major == 0:
            result = self._every_major_end()

        self.t += 1
        del self.s[: -table.history - 1], self.r[: -table.history - 1]
        return result

    def _every_sample(self, gyro: Vec, accel: Vec) -> None:
        table = self.design.table
        k = self.t % table.samples + 1  # phase in the minor interval, 1..n
        row = list(enumerate(table.taps[k - 1], start=1))
        A = self._weighted_sum(row, self.s)
        B = self._weighted_sum(row, self.r)
        self.coning_within = vector_sum(self.coning_within, cross(A, gyro))
        self.sculling_within = vector_sum(self.sculling_within, cross(A, accel), cross(B, gyro))
        if self.position is not None:
            self.position.step(gyro, accel)

    def _every_minor_end(self) -> None:
        weights = list(enumerate(self.design.table.weights))
        theta = self._weighted_sum(weights, self.s)
        v = self._weighted_sum(weights, self.r)
        if self.higher is not None:
            self._higher_order(self.higher)
        self.coning_between = vector_sum(self.coning_between, cross(self.alpha, theta))
        self.sculling_between = vector_sum(
            self.sculling_between, cross(self.alpha, v), cross(self.nu, theta)
        )
        self.alpha = vector_sum(self.alpha, theta)
        self.nu = vector_sum(self.nu, v)

    def _higher_order(self, higher: HigherOrder) -> None:
        """Hand `HigherOrder` the samples, and all sums as before this minor interval."""
        n = self.design.table.samples
        within = Dual(self.coning_within, self.sculling_within)
        kappa = dual_sum(within, dual_times(-1, self._within))
        higher.step(
            [Dual(*sample) for sample in zip(self.s[-n:], self.r[-n:], strict=True)],
            Dual(self.alpha, self.nu),
            self._within,
            Dual(self.coning_between, self.sculling_between),
            kappa,
        )
        self._within = within

    def _every_major_end(self) -> Result:
        result = Result(
            self.major,
            self.status,
            self.alpha,
            self.coning_within,
            self.coning_between,
            self.nu,
            self.sculling_within,
            self.sculling_between,
        )
        if self.position is not None:
            result = result._replace(
                s_alpha=self.position.s_alpha,
                s_nu=self.position.s_nu,
                scrolling=self.position.scrolling,
            )
        if self.higher is not None:
            third, fourth = self.higher.third, self.higher.fourth
            result = result._replace(coning_third=third.angle, sculling_third=third.velocity)
            if self.design.order > 3:
                result = result._replace(
                    coning_fourth=fourth.angle, sculling_fourth=fourth.velocity
                )
        self.major += 1
        self._clear()
        return result

    def run(self, samples: Iterable[Sample]) -> Iterator[Result]:
        """Results of all complete major intervals of a sequence of samples.

        Raises:
            InputError: as `step`.
        """
        for gyro, accel, fault in samples:
            result = self.step(gyro, accel, fault)
            if result is not None:
                yield result

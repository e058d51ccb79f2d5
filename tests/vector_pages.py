"""The vector engine's program in plain Python: a slot at a time, on the pipeline's own sums."""

from __future__ import annotations

from sculler_hdl.plan.vector.page import HALVES, Form, Place, Step, Task
from sculler_hdl.plan.vector.program import Program
from sculler_model.design import Design
from sculler_model.golden import GoldenModel

Three = tuple[int, int, int]
GIVEN = {
    "within": ("coning_within", "sculling_within"),
    "between": ("coning_between", "sculling_between"),
}


class Interpreter:
    """Runs a program once a minor interval; memories hold what was stored, whenever it was.

    What the pipeline gives comes from a golden model of second order beside it.
    """

    def __init__(self, design: Design, program: Program) -> None:
        self.design, self.program, self.page = design, program, program.page
        # anything: a major interval's first minor interval counts it as 0
        self.memory = dict.fromkeys(self.page.ranges, (1, -1, 1))
        self.sums = dict.fromkeys(self.memory, (1, -1, 1))
        self._samples: list[tuple[Three, Three]] = []
        self._minor = 0
        self._plain = GoldenModel(design)

    def step(self, gyro: Three, accel: Three) -> dict[str, Three] | None:
        """Take a sample; the running sums after a major interval's last."""
        n, minors = self.design.algorithm.samples, self.design.algorithm.minors
        self._samples.append((gyro, accel))
        self._samples = self._samples[-n:]
        model = self._plain
        alpha = model.alpha, model.nu
        result = model.step(gyro, accel)
        if model.t % n:
            return None
        for d, sample in enumerate(reversed(self._samples)):
            self._give(f"sample{d}", sample)
        theta = tuple(
            tuple(map(sum, zip(*each, strict=True))) for each in zip(*self._samples, strict=True)
        )
        self._give("theta", theta)
        if minors > 1:
            self._give("alpha", alpha)
            source = result or model
            for name, halves in GIVEN.items():
                self._give(name, tuple(getattr(source, half) for half in halves))
        self._run()
        self._minor = (self._minor + 1) % minors
        return None if self._minor else self.sums

    def _give(self, name: str, halves: tuple[Three, ...]) -> None:
        for half, vector in zip(HALVES, halves, strict=True):
            self.memory[f"{name}.{half}"] = vector

    def _run(self) -> None:
        total: list[int] = []
        made: dict[str, list[int]] = {}
        for row in self.program.rows:
            if row.stored is not None:  # a clock before it can be read
                self._store(row.stored, made[row.stored.target])
            if row.step is None or row.task is None:
                continue
            if row.first:
                total = list(self.sums[row.task.target]) if self._counts(row.task) else [0, 0, 0]
            total = [old + self._product(row.step, i) for i, old in enumerate(total)]
            if row.last:
                made[row.task.target] = total

    def _counts(self, task: Task) -> bool:
        return task.grows and self._minor > 0

    def _product(self, step: Step, i: int) -> int:
        if step.old and self._minor == 0:
            return 0
        left = self.memory[step.left]
        sign = (-1 if step.subtract else 1) << step.digit * self.page.digit_bits
        if isinstance(step.right, int):
            assert step.form is Form.STRAIGHT
            return sign * left[i] * step.right
        a, b = (i + 1) % 3, (i + 2) % 3
        if step.form is Form.BACKWARD:
            a, b = b, a
        assert left[a] in self.page.left_range
        assert self.memory[step.right][b] in self.page.right_range
        return sign * left[a] * self.memory[step.right][b]

    def _store(self, task: Task, total: list[int]) -> None:
        low, bits = (task.digit or 0) * self.page.digit_bits, self.page.digit_bits
        if task.digit is not None:
            total = [number >> low for number in total]
            if task.digit + 1 < self.page.digit_count:
                total = [number & ((1 << bits) - 1) for number in total]
        for number in total:
            assert number in self.page.ranges[task.target], task.target
        x, y, z = total
        if Place.SUM in task.places:
            self.sums[task.target] = (x, y, z)
        if {Place.LEFT, Place.RIGHT} & {*task.places}:
            self.memory[task.target] = (x, y, z)

"""The schedule run in plain Python, instruction by instruction: what the engine must do."""

from __future__ import annotations

from sculler_hdl.plan.compact.digits import OPERAND, digit_count
from sculler_hdl.plan.compact.instructions import Base, Instruction, Program, SampleWord, When
from sculler_model.design import STATUS_RAIL, Interval
from sculler_model.golden import WORD_BITS, Sample, words_per_column, words_per_result


class Interpreter:
    """Runs a program sample by sample, as the engine does, and checks every range on the way.

    No word that counts may be read before it is written, for nobody knows what a memory holds.
    Stores take effect `delay` instructions later (`Pipeline.store`), as in the engine.
    """

    def __init__(self, program: Program, delay: int) -> None:
        self.program = program
        self.delay = delay
        self.memory: dict[str, dict[int, int]] = {"left": {}, "right": {}, "result": {}}
        # of results, the one being filled first
        self.banks: list[dict[int, int]] = [{} for _ in range(program.sizes.result_banks)]
        self.memory["result"] = self.banks[0]
        for load in program.startup:
            memory = self.banks[load.bank] if load.memory == "result" else self.memory[load.memory]
            memory[load.address] = load.value
        self.samples: list[list[int]] = []  # digits of each sample, newest last
        self.t = 0
        self.fault = 0
        self.rail = 0

    def step(self, sample: Sample) -> list[int] | None:
        """Take a sample; the words of the result on a major interval's last, else None."""
        design = self.program.design
        gyro, accel, fault = sample
        self.samples.append(
            [
                digit
                for counts, number in ((gyro, design.words.gyro), (accel, design.words.accel))
                for count in counts
                for digit in self._digits(count, digit_count(number.bits))
            ]
        )
        self.fault |= fault
        for counts, number in ((gyro, design.words.gyro), (accel, design.words.accel)):
            self.rail |= int(number.lo in counts or number.hi in counts)
        n, length = design.algorithm.samples, design.samples_per_major
        phase, major = self.t % n + 1, self.t // length
        first_minor = self.t % length < n
        conditions = {
            When.ALWAYS: True,
            When.CONTINUED: not first_minor,
            When.LATER_MAJOR: major > 0,
            When.NEXT_MAJOR: first_minor and major > 0,
            When.FAULT: bool(self.fault),
            When.SHORT: major < design.short_majors,
            When.FIRST_MINOR: first_minor,
            When.MAJOR_END: (self.t + 1) % length == 0,
        }
        self._run(self.program.phases.get(phase, ()), conditions)
        self.t += 1
        if self.t % length:
            return None
        filled, *others = self.banks
        self.banks = [*others, filled]
        self.memory["result"] = others[0]
        words = [filled[word] & (1 << WORD_BITS) - 1 for word in range(words_per_result(design))]
        # the engine puts it in where the status is stored
        words[design.columns.index("status") * words_per_column(design)] |= STATUS_RAIL * self.rail
        self.fault = self.rail = 0
        return words

    def _digits(self, count: int, needed: int) -> list[int]:
        """A count's digits, padded with words that nothing reads."""
        digits = [count >> WORD_BITS * i for i in range(needed)]
        digits[:-1] = [digit & (1 << WORD_BITS) - 1 for digit in digits[:-1]]
        return digits + [0] * (self.program.sizes.digits_per_count - needed)

    def _run(self, instructions: tuple[Instruction, ...], conditions: dict[When, bool]) -> None:
        accumulator = 0
        late: list[tuple[int, str, int, int]] = []  # when, memory, address, digit
        for now, instruction in enumerate(instructions):
            while late and late[0][0] <= now:
                _, memory, address, digit = late.pop(0)
                self.memory[memory][address] = digit
            product = 0
            if conditions[instruction.when]:
                left = self.memory["left"][instruction.left.address]
                product = _in(OPERAND, left) * _in(OPERAND, self._right(instruction))
            base = {Base.CLEAR: 0, Base.KEEP: accumulator, Base.SHIFT: accumulator >> WORD_BITS}
            accumulator = base[instruction.base] + (-product if instruction.subtract else product)
            _in(self.program.accumulator, accumulator)
            store = instruction.store
            if store is not None:
                digit = accumulator if store.signed else accumulator & (1 << WORD_BITS) - 1
                late += [
                    (now + self.delay, memory, store.address, _in(OPERAND, digit))
                    for memory in sorted(store.memories)
                ]
        for _, memory, address, digit in late:
            self.memory[memory][address] = digit

    def _right(self, instruction: Instruction) -> int:
        place = instruction.right
        if not isinstance(place, SampleWord):
            return self.memory["right"][place.address]
        if place.distance >= len(self.samples):
            return 0
        return self.samples[-1 - place.distance][place.index]


def _in(allowed: Interval, value: int) -> int:
    if value not in allowed:
        raise OverflowError(f"{value} is not in {allowed}")
    return value

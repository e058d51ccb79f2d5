"""The faults: a line of the project, what becomes of it, and the tests that are to notice."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
SOURCES = ("model", "hdl", "sim", "cli")


@dataclass(frozen=True)
class Fault:
    """A fault made on purpose.

    Attributes:
        what: what goes wrong, in a few words.
        line: a piece of text that one source file has once, wherever that file lies.
        wrong: what is put in its place.
        tests: test files, relative to tests/, of what the fault is in.
    """

    what: str
    line: str
    wrong: str
    tests: tuple[str, ...]

    def place(self, root: Path = ROOT) -> Path:
        """The file that has the line, relative to the root.

        Raises:
            LookupError: no file has it, or more than one, or one more than once.
        """
        found = [
            path.relative_to(root)
            for package in SOURCES
            for path in sorted((root / package).rglob("*"))
            if path.suffix in (".py", ".in", ".v", ".cpp", ".c", ".h")
            for _ in range(path.read_text(encoding="utf-8").count(self.line))
        ]
        if len(found) != 1:
            raise LookupError(f"{self.line!r}: {len(found)} places, not one: {found}")
        return found[0]


FAULTS: dict[str, Fault] = {
    "tap": Fault(
        "the furthest tap of a table is dropped",
        "_compressed(samples, solve_exactly(matrix, right)), [Fraction(1)] * samples",
        "_compressed(samples, solve_exactly(matrix, right)[:-1]), [Fraction(1)] * samples",
        ("model/test_coefficients.py",),
    ),
    "history": Fault(
        "the golden model takes each sample of the history one too late",
        "times(c, counts[-1 - d])",
        "times(c, counts[-max(d, 1)])",
        ("model/test_golden.py",),
    ),
    "rail": Fault(
        "the golden model does not raise status bit 2",
        "self.status |= STATUS_RAIL",
        "pass",
        ("model/test_golden.py", "model/test_fast.py"),
    ),
    "carry": Fault(
        "the fast model loses the carry from digit to digit, past 64 bits",
        "high += low >> self.bits",
        "high += 0",
        ("model/test_fast.py",),
    ),
    "loss": Fault(
        "the cycle model counts a lost sample a clock late",
        "self._lost.count(self._clock + 2)",
        "self._lost.count(self._clock + 3)",
        ("model/test_cycles.py",),
    ),
    "words": Fault(
        "the words of a streamed number come in the wrong order",
        "for column in row for i in range(count)]",
        "for column in row for i in reversed(range(count))]",
        ("model/test_stream.py",),
    ),
    "cross": Fault(
        "the pipelined core's cross products have the wrong sign",
        "enumerate([(one, two), (two, one)][: plan.sides])",
        "enumerate([(two, one), (one, two)][: plan.sides])",
        ("hdl/test_pipelined.py",),
    ),
    "compact rail": Fault(
        "the compact core does not raise status bit 2",
        "self.rail.eq(loaded & few.all())",
        "self.rail.eq(0)",
        ("hdl/test_compact.py",),
    ),
    "latency": Fault(
        "the compact core's result comes a clock before it says",
        "latency=published + handover,",
        "latency=published + handover + 1,",
        ("hdl/test_compact.py",),
    ),
    "majority": Fault(
        "a hardened core takes its second copy for the majority",
        "    return a & b | a & c | b & c\n",
        "    return b\n",
        ("sim/test_hardened.py",),
    ),
    "bench": Fault(
        "the generated test bench counts no lost sample",
        "if (withdrawn && lost != COUNTER_MAX) lost <= lost + 1;",
        "",
        ("sim/test_testbench.py",),
    ),
    "stamp": Fault(
        "an increment's stamp is one sample late",
        'return 1 if design.sensor.kind == "increment" else 0',
        'return 2 if design.sensor.kind == "increment" else 0',
        ("cli/test_instants.py",),
    ),
    "remainder": Fault(
        "the quantiser forgets the remainder between blocks",
        "self._carry = total[-1] - (rounded[-1] << _FRACTION_BITS)",
        "self._carry = np.zeros(6, np.int64)",
        ("model/test_quantise.py",),
    ),
    "between": Fault(
        "the host takes coning between minor intervals twice",
        "between=float(2 * table.sum_denominator**2),",
        "between=float(table.sum_denominator**2),",
        ("model/test_host.py",),
    ),
    "bytes": Fault(
        "the STIM300's datagrams are read with the wrong byte first",
        '">i3") for at in (1, 11)',
        '"<i3") for at in (1, 11)',
        ("cli/test_raw_logs.py",),
    ),
    "c-turn": Fault(
        "the host in C forgets the second order of the level frame's turn",
        "dv_sf_w = sculler_plus(sculler_plus(dv, once, -0.5), twice, 1.0 / 12.0);",
        "dv_sf_w = sculler_plus(dv, once, -0.5);",
        ("host_c/test_against_python.py",),
    ),
    "c-rounding": Fault(
        "the host in C cuts long integers off",
        "top |= rest ? UINT64_C(1) : UINT64_C(0);",
        "",
        ("host_c/test_against_python.py",),
    ),
    "c-crc": Fault(
        "the CRC of a frame from C leaves its last field out",
        "(void)put(to, sculler_crc32(frame, CRC_AT), 4u);",
        "(void)put(to, sculler_crc32(frame, CRC_AT - 8u), 4u);",
        ("cli/test_telemetry.py",),
    ),
    "overwrite": Fault(
        "an output may replace an input",
        "raise _both(path, run.inputs[key])",
        "return",
        ("cli/test_inputs_kept.py",),
    ),
}
"""By name."""

"""`Design`: what it accepts, what it derives, and every way a design file can be wrong."""

from __future__ import annotations

import copy
import errno
from math import pi, radians
from pathlib import Path
from typing import Any

import pytest

from sculler_model.algorithms import TapTable, filtered_rate, frequency_taylor
from sculler_model.design import COLUMNS, COMPONENTS, PRESETS, VECTORS, Design, Hardware
from sculler_model.errors import InputError
from strategies import DESIGNS

STIM300 = """\
name = "stim300_4x5"
[sensor]
kind = "increment"                  # or "rate"
sample_rate_hz = 2000.0
gyro  = { bits = 24, lsb = 8.322346e-09 }     # rad (or rad/s) per count
accel = { bits = 24, lsb = 2.384186e-07 }     # m/s (or m/s²) per count
[algorithm]
family  = "frequency-taylor"
samples = 4                         # n
history = 0                         # p
minors  = 5                         # M
[hardware]
core = "pipelined"
"""

GOOD: dict[str, Any] = {
    "name": "good",
    "sensor": {
        "kind": "increment",
        "sample_rate_hz": 2000.0,
        "gyro": {"bits": 24, "lsb": 1e-8},
        "accel": {"bits": 20, "lsb": 1e-7},
    },
    "algorithm": {"family": "frequency-taylor", "samples": 4, "history": 0, "minors": 5},
}

LEFT_OUT = object()


def changed(*changes: tuple[str, Any]) -> dict[str, Any]:
    """The good design with entries replaced, named by dotted keys."""
    data = copy.deepcopy(GOOD)
    for key, value in changes:
        *path, last = key.split(".")
        part = data
        for step in path:
            part = part.setdefault(step, {})
        if value is LEFT_OUT:
            del part[last]
        else:
            part[last] = value
    return data


def refusal(data: dict[str, Any]) -> str:
    """The message for a bad design: one line that begins with where it was found."""
    with pytest.raises(InputError) as raised:
        Design.parse(data, where="my.toml")
    message = str(raised.value)
    assert "\n" not in message
    assert message.startswith("my.toml: ")
    return message.removeprefix("my.toml: ")


class TestGoodDesigns:
    def test_the_file_of_the_design_page(self, tmp_path: Path) -> None:
        path = tmp_path / "stim300.toml"
        path.write_text(STIM300, encoding="utf-8")
        design = Design.load(path)
        assert design == Design.load(str(path))
        assert design.name == "stim300_4x5"
        assert design.table == frequency_taylor(4, 0)
        assert design.samples_per_major == 20
        assert design.sample_interval == pytest.approx(0.0005)
        assert design.major_interval == pytest.approx(0.01)
        assert (design.gyro_scale, design.accel_scale) == (8.322346e-09, 2.384186e-07)

    def test_what_may_be_left_out(self) -> None:
        design = Design.parse(changed(("algorithm.history", LEFT_OUT)))
        assert (design.algorithm.history, design.hardware.core) == (0, "pipelined")

    def test_rate_samples_are_scaled_by_the_interval(self) -> None:
        design = Design.parse(
            changed(("sensor.kind", "rate"), ("algorithm.family", "filtered-rate"))
        )
        assert design.table == filtered_rate(4)
        assert design.gyro_scale == pytest.approx(1e-8 / 2000, rel=1e-15)
        assert design.accel_scale == pytest.approx(1e-7 / 2000, rel=1e-15)

    @pytest.mark.parametrize("kind", ["increment", "rate"])
    def test_own_table_for_either_kind(self, kind: str) -> None:
        table = {"denominator": 60, "taps": [[], [6], [2, -4], []], "weights": [3] * 4}
        design = Design.parse(
            changed(
                ("sensor.kind", kind), ("algorithm.family", "table"), ("algorithm.table", table)
            )
        )
        assert design.table == TapTable(30, ((0, 0), (3, 0), (1, -2), (0, 0)), 1, (3, 3, 3, 3, 0))

    def test_numbers_of_any_size(self) -> None:
        table = {"denominator": 10**40, "taps": [3**90, -(7**50)], "sum_denominator": 10**20}
        design = Design.parse(changed(("algorithm.family", "table"), ("algorithm.table", table)))
        assert design.table.taps[-1] == (3**90, -(7**50))
        assert design.table.weights == (1, 1, 1, 1, 0)

    @pytest.mark.parametrize(
        ("key", "values"),
        [
            ("sensor.gyro.bits", [8, 32]),
            ("sensor.accel.bits", [8, 32]),
            ("sensor.accel.lsb", [1e-30, 1, 1e6]),
            ("sensor.sample_rate_hz", [1e-6, 100, 1e9]),
            ("algorithm.samples", [2, 16]),
            ("algorithm.history", [4]),
            ("algorithm.minors", [1, 4096]),
            ("name", ["x", "A_1_b", "x" * 64, "clock", "design_"]),
        ],
    )
    def test_ends_of_the_ranges(self, key: str, values: list[Any]) -> None:
        for value in values:
            Design.parse(changed((key, value)))

    @pytest.mark.parametrize("name", DESIGNS)
    def test_json_is_read_back(self, name: str) -> None:
        design = DESIGNS[name]
        again = Design.parse(design.as_json())
        assert again == design
        assert again.digest == design.digest
        assert again.table == design.table

    def test_digest_tells_designs_apart(self) -> None:
        digests = {Design.parse(changed(("algorithm.minors", M))).digest for M in range(1, 20)}
        assert len(digests) == 19
        assert all(len(digest) == 64 for digest in digests)


class TestPresets:
    @pytest.mark.parametrize(
        ("name", "rate", "gyro", "accel"),
        [
            # from the data sheets, each number worked out another way than in presets.py
            ("hg4930", 100.0, (32, 1 / 8589934592), (32, 0.3048 / 134217728)),
            ("stim300", 2000.0, (24, radians(1) / 2097152), (24, 1 / 4194304)),
            ("ln200", 200.0, (32, 1 / 524288), (32, 1 / 16384)),
            ("adis16488", 2460.0, (32, 4 * pi / 2147483648), (32, 200 / 2147483648)),
            ("lasergyro", 100.0, (24, pi / 6480000), (24, 0.000125 * 9.780327)),
        ],
    )
    def test_sensor(
        self, name: str, rate: float, gyro: tuple[int, float], accel: tuple[int, float]
    ) -> None:
        sensor = Design.preset(name).sensor
        assert (sensor.kind, sensor.sample_rate_hz) == ("increment", rate)
        assert (sensor.gyro.bits, sensor.accel.bits) == (gyro[0], accel[0])
        assert sensor.gyro.lsb == pytest.approx(gyro[1], rel=1e-14)
        assert sensor.accel.lsb == pytest.approx(accel[1], rel=1e-14)

    def test_all_are_tested_above(self) -> None:
        assert set(PRESETS) == {"hg4930", "stim300", "ln200", "adis16488", "lasergyro"}

    def test_the_page_and_the_preset_agree(self) -> None:
        sensor = Design.preset("stim300").sensor
        assert sensor.gyro.lsb == pytest.approx(8.322346e-09, rel=1e-5)
        assert sensor.accel.lsb == pytest.approx(2.384186e-07, rel=1e-6)

    @pytest.mark.parametrize("name", PRESETS)
    def test_alone_is_a_design(self, name: str) -> None:
        design = Design.parse({"preset": name})
        assert design == Design.preset(name)
        n, M = design.algorithm.samples, design.algorithm.minors
        assert design.name == f"{name}_{n}x{M}"
        assert design.words.alpha.bits >= design.sensor.gyro.bits

    def test_what_the_file_says_wins(self) -> None:
        design = Design.parse(
            {
                "preset": "stim300",
                "sensor": {"gyro": {"bits": 16}, "sample_rate_hz": 500.0},
                "algorithm": {"samples": 2, "minors": 3},
            }
        )
        plain = Design.preset("stim300")
        assert design.name == "stim300_2x3"
        assert (design.sensor.gyro.bits, design.sensor.sample_rate_hz) == (16, 500.0)
        assert design.sensor.gyro.lsb == plain.sensor.gyro.lsb
        assert design.sensor.accel == plain.sensor.accel
        assert design.table == frequency_taylor(2, 0)
        assert Design.parse({"preset": "stim300", "name": "mine"}).name == "mine"
        assert Design.preset("stim300") == plain  # the preset itself is as it was

    def test_keys_of_the_algorithm_as_arguments(self) -> None:
        design = Design.preset("ln200", samples=3, history=1, minors=7)
        assert (design.name, design.table) == ("ln200_3x7", frequency_taylor(3, 1))
        with pytest.raises(InputError, match=r"algorithm\.sample: unknown key.*samples"):
            Design.preset("ln200", sample=3)

    def test_in_the_sensor_table(self) -> None:
        assert Design.parse({"sensor": {"preset": "stim300"}}) == Design.preset("stim300")
        both = {"preset": "stim300", "sensor": {"preset": "stim300"}}
        assert Design.parse(both) == Design.preset("stim300")

    @pytest.mark.parametrize("name", ["stim301", "", 5, ["stim300"], {}, "x" * 500])
    @pytest.mark.parametrize("key", ["preset", "sensor.preset"])
    def test_unknown(self, key: str, name: Any) -> None:
        message = refusal({"preset": name} if key == "preset" else {"sensor": {"preset": name}})
        assert message.startswith(f"{key}: ")
        assert message.endswith("give one of adis16488, hg4930, lasergyro, ln200, stim300")
        assert len(message) < 200

    def test_two_that_differ(self) -> None:
        message = refusal({"preset": "stim300", "sensor": {"preset": "hg4930"}})
        assert message == "sensor.preset: 'hg4930' and preset = 'stim300' differ, give one"

    @pytest.mark.parametrize(
        ("algorithm", "message"),
        [
            (3, "algorithm: 3 is not allowed, give a table"),
            ({"samples": -2}, "algorithm.samples: -2 is not allowed, give a whole number from 1"),
            ({"minors": 2.5}, "algorithm.minors: 2.5 is not allowed, give a whole number from 1"),
            ({"samples": "4"}, "algorithm.samples: '4' is not allowed, give a whole number"),
        ],
    )
    def test_a_fault_of_the_algorithm_makes_none_of_the_name(
        self, algorithm: Any, message: str
    ) -> None:
        assert refusal({"preset": "stim300", "algorithm": algorithm}).startswith(message)
        assert "name" not in refusal({"preset": "stim300", "algorithm": algorithm})


BITS = "a whole number from 8 to 32"
TAPS = "give n rows of whole numbers, or one flat row for phase n"


class TestOneFault:
    @pytest.mark.parametrize(
        ("key", "allowed"),
        [
            ("name", "a Verilog name: letters, digits, single _"),
            ("sensor", "a table"),
            ("sensor.kind", '"increment" or "rate"'),
            ("sensor.sample_rate_hz", "a number from 1e-6 to 1e9"),
            ("sensor.gyro", "a table with bits and lsb"),
            ("sensor.gyro.bits", BITS),
            ("sensor.gyro.lsb", "a number from 1e-30 to 1e6 (SI units per count)"),
            ("sensor.accel", "a table with bits and lsb"),
            ("sensor.accel.bits", BITS),
            ("algorithm", "a table"),
            ("algorithm.samples", "a whole number from 1 to 16"),
            ("algorithm.minors", "a whole number from 1 to 4096"),
        ],
    )
    def test_missing_key(self, key: str, allowed: str) -> None:
        assert refusal(changed((key, LEFT_OUT))) == f"{key}: missing, give {allowed}"

    def test_missing_family(self) -> None:
        message = refusal(changed(("algorithm.family", LEFT_OUT)))
        assert message.startswith('algorithm.family: missing, give "frequency-taylor", ')
        assert message.endswith(' or "table"')

    @pytest.mark.parametrize(
        ("key", "hint"),
        [
            ("nmae", "did you mean name?"),
            ("zzz", "the keys here are name, sensor, algorithm, hardware, compensation"),
            ("sensor.gyros", "did you mean gyro?"),
            ("sensor.gyro.bit", "did you mean bits?"),
            ("sensor.accel.scale", "the keys here are bits, lsb"),
            ("algorithm.sample", "did you mean samples?"),
            ("hardware.cores", "did you mean core?"),
        ],
    )
    def test_unknown_key(self, key: str, hint: str) -> None:
        assert refusal(changed((key, 1))) == f"{key}: unknown key, {hint}"

    def test_unknown_key_that_is_no_line(self) -> None:
        assert refusal({**GOOD, "a\nb": 1}).startswith("'a\\nb': unknown key")

    @pytest.mark.parametrize(
        ("key", "value", "allowed"),
        [
            *(
                (f"sensor.{part}.bits", value, BITS)
                for part in ("gyro", "accel")
                for value in (7, 33, 0, -8, 16.0, "16", True, None, [16])
            ),
            *(
                ("sensor.gyro.lsb", value, "a number from 1e-30 to 1e6 (SI units per count)")
                for value in (
                    0,
                    0.0,
                    -1e-9,
                    9e-31,
                    1.1e6,
                    float("nan"),
                    float("inf"),
                    "1e-9",
                    False,
                )
            ),
            *(
                ("sensor.sample_rate_hz", value, "a number from 1e-6 to 1e9")
                for value in (0, -2000.0, 9e-7, 1.1e9, float("nan"), float("inf"), "2000", True)
            ),
            *(
                ("sensor.kind", value, '"increment" or "rate"')
                for value in ("Increment", "", 1, "a\nb")
            ),
            *(
                ("algorithm.samples", value, "a whole number from 1 to 16")
                for value in (0, 17, -1, 4.0, "4", True)
            ),
            *(
                ("algorithm.minors", value, "a whole number from 1 to 4096")
                for value in (0, 4097, -5, 5.0)
            ),
            *(
                ("algorithm.history", value, "a whole number from 0 to 16")
                for value in (-1, 17, 1.0)
            ),
            ("algorithm.family", "taylor", '"frequency-taylor", "filtered-rate"'),
            ("hardware.core", "tiny", '"pipelined"'),
            ("sensor", [1], "a table"),
            ("sensor.gyro", 24, "a table with bits and lsb"),
            ("hardware", "pipelined", ""),
        ],
    )
    def test_value_that_is_not_allowed(self, key: str, value: Any, allowed: str) -> None:
        message = refusal(changed((key, value)))
        assert message.startswith(f"{key}: {value!r} is not allowed, give {allowed}")
        assert ";" not in message

    @pytest.mark.parametrize(
        "name", ["", "4x5", "_a", "a b", "a-b", "a__b", "größe", "a.v", "a\n", "x" * 65]
    )
    def test_name_that_verilog_cannot_have(self, name: str) -> None:
        assert refusal(changed(("name", name))) == (
            f"name: {name!r} is not allowed,"
            " give a letter, then up to 63 letters, digits or single _"
        )

    @pytest.mark.parametrize(
        ("name", "what"),
        [
            ("module", "a reserved word of SystemVerilog"),
            ("lambda", "a reserved word of Python"),
            ("MULT18X18D", "the name of a block of ECP5 devices"),
            ("clk", "the name of a port"),
        ],
    )
    def test_name_that_is_taken(self, name: str, what: str) -> None:
        """In one line; `test_names` has them all."""
        assert refusal(changed(("name", name))) == f"name: {name!r} is {what}, give another name"

    @pytest.mark.parametrize(
        ("kind", "family", "needed"),
        [("rate", "frequency-taylor", "increment"), ("increment", "filtered-rate", "rate")],
    )
    def test_family_for_the_other_kind_of_sensor(self, kind: str, family: str, needed: str) -> None:
        data = changed(("sensor.kind", kind), ("algorithm.family", family))
        assert refusal(data) == (
            f'algorithm: family = "{family}" is for sensor.kind = "{needed}", but it is "{kind}";'
            " change one of them"
        )

    def test_one_sample_and_no_history(self) -> None:
        message = refusal(changed(("algorithm.samples", 1)))
        assert message.startswith("algorithm.family: ")
        assert message.endswith("give samples + history >= 2")


class TestTable:
    @pytest.mark.parametrize(
        ("table", "message"),
        [
            ({"taps": [1]}, "algorithm.table.denominator: missing, give a whole number >= 1"),
            ({"denominator": 3}, f"algorithm.table.taps: missing, {TAPS}"),
            (
                {"denominator": 0, "taps": [1]},
                "algorithm.table.denominator: 0 is not allowed, give a whole number >= 1",
            ),
            (
                {"denominator": 1, "taps": [1], "sum_denominator": 0},
                "algorithm.table.sum_denominator: 0 is not allowed, give a whole number >= 1",
            ),
            (
                {"denominator": 1, "taps": [1], "wieghts": [1]},
                "algorithm.table.wieghts: unknown key, did you mean weights?",
            ),
            ({"denominator": 1, "taps": []}, f"algorithm.table.taps: [] is not allowed, {TAPS}"),
            ({"denominator": 1, "taps": 5}, f"algorithm.table.taps: 5 is not allowed, {TAPS}"),
            (
                {"denominator": 1, "taps": [2, 1.5]},
                f"algorithm.table.taps: 1.5 is not allowed, {TAPS}",
            ),
            (
                {"denominator": 1, "taps": [[], [], [], [0.1]]},
                f"algorithm.table.taps: 0.1 is not allowed, {TAPS}",
            ),
            (
                {"denominator": 1, "taps": [1], "weights": [1, "1"]},
                "algorithm.table.weights: '1' is not allowed, give up to n + 1 whole numbers,"
                " distance 0..n",
            ),
            (
                {"denominator": 1, "taps": [1, [2]]},
                "algorithm.table: taps: numbers and rows are mixed, give one flat row or n rows",
            ),
            (
                {"denominator": 1, "taps": [[1]] * 3},
                "algorithm.table: taps: 3 rows for samples = 4, give one row per phase 1..n"
                " (empty rows count) or one flat row for phase n",
            ),
            (
                {"denominator": 1, "taps": [0, 0]},
                "algorithm.table: taps: every tap is zero, give at least one that is not",
            ),
            (
                {"denominator": 1, "taps": [1] * 33},
                "algorithm.table: taps: a row of 33 reaches too far back, give at most 32",
            ),
            (
                {"denominator": 1, "taps": [1], "weights": [1] * 6},
                "algorithm.table: weights: 6 numbers for samples = 4, give 1 to 5 (distance 0..n)",
            ),
            (
                {"denominator": 1, "taps": [1], "weights": [0]},
                "algorithm.table: weights: every weight is zero, give at least one that is not",
            ),
            ([1], "algorithm.table: [1] is not allowed, give a table with denominator and taps"),
        ],
    )
    def test_inconsistent_table(self, table: Any, message: str) -> None:
        data = changed(("algorithm.family", "table"), ("algorithm.table", table))
        assert refusal(data) == message

    def test_family_table_without_one(self) -> None:
        assert refusal(changed(("algorithm.family", "table"))) == (
            'algorithm.table: missing, family = "table" needs [algorithm.table] with denominator'
            " and taps"
        )

    def test_table_beside_a_computed_family(self) -> None:
        table = {"denominator": 1, "taps": [1]}
        assert refusal(changed(("algorithm.table", table))) == (
            'algorithm.table: not used by family = "frequency-taylor", leave it out or give'
            ' family = "table"'
        )


class TestManyFaults:
    def test_all_are_named_together(self) -> None:
        message = refusal(
            changed(
                ("name", "a b"),
                ("sensor.kind", "sort"),
                ("sensor.gyro.bits", 40),
                ("sensor.accel.lsb", LEFT_OUT),
                ("algorithm.samples", 0),
                ("algorithm.minor", 5),
                ("hardware.core", "?"),
            )
        )
        keys = [fault.split(": ")[0] for fault in message.split("; ")]
        assert keys == [
            "name",
            "sensor.kind",
            "sensor.gyro.bits",
            "sensor.accel.lsb",
            "algorithm.samples",
            "algorithm.minor",
            "hardware.core",
        ]

    def test_an_empty_file_lacks_everything_it_must_have(self) -> None:
        keys = [fault.split(": ")[0] for fault in refusal({}).split("; ")]
        assert keys == ["name", "sensor", "algorithm"]

    def test_faults_of_a_table_together(self) -> None:
        table = {"denominator": 2, "taps": [[1]], "weights": [0] * 7}
        message = refusal(changed(("algorithm.family", "table"), ("algorithm.table", table)))
        assert "taps: 1 rows for samples = 4" in message
        assert "weights: 7 numbers for samples = 4" in message

    def test_long_values_are_cut_short(self) -> None:
        assert len(refusal(changed(("sensor.gyro", "x" * 10000)))) < 200


class TestFiles:
    def refusal(self, path: Path) -> str:
        with pytest.raises(InputError) as raised:
            Design.load(path)
        message = str(raised.value)
        assert "\n" not in message
        assert message.startswith(f"{path}: ")
        return message.removeprefix(f"{path}: ")

    def test_absent(self, tmp_path: Path) -> None:
        message = self.refusal(tmp_path / "absent.toml")
        assert message == "cannot read the design file (No such file or directory), check the path"

    def test_folder(self, tmp_path: Path) -> None:
        assert self.refusal(tmp_path).startswith("cannot read the design file (Is a directory)")

    def test_not_permitted(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        def denied(*_: object, **__: object) -> str:
            raise PermissionError(errno.EACCES, "Permission denied")

        monkeypatch.setattr(Path, "open", denied)
        message = self.refusal(tmp_path / "secret.toml")
        assert message == "cannot read the design file (Permission denied), check the path"

    def test_not_utf_8(self, tmp_path: Path) -> None:
        path = tmp_path / "latin.toml"
        path.write_bytes(STIM300.encode("latin-1"))
        assert self.refusal(path) == "not a text file in UTF-8, give a design in TOML"

    @pytest.mark.parametrize(
        ("text", "where"),
        [
            ("name = ", "end of document"),
            ('name = "a"\nname = "b"\n', "line 2"),
            ("[sensor\n", "line 1"),
            (STIM300[: STIM300.index("bits")], ""),
            ("samples = 4x\n", "line 1"),
        ],
    )
    def test_not_toml(self, tmp_path: Path, text: str, where: str) -> None:
        path = tmp_path / "broken.toml"
        path.write_text(text, encoding="utf-8")
        message = self.refusal(path)
        assert message.startswith("not valid TOML: ")
        assert where in message

    def test_faults_name_the_file(self, tmp_path: Path) -> None:
        path = tmp_path / "faulty.toml"
        path.write_text(STIM300.replace("bits = 24", "bits = 99", 1), encoding="utf-8")
        assert self.refusal(path) == f"sensor.gyro.bits: 99 is not allowed, give {BITS}"


def test_a_design_cannot_be_changed() -> None:
    design = Design.preset("stim300")
    with pytest.raises(ValueError, match="frozen"):
        design.name = "other"  # type: ignore[misc]


class TestHardware:
    @staticmethod
    def hardware(**keys: object) -> Hardware:
        return Design.parse({"preset": "stim300", "hardware": keys}).hardware

    def test_what_is_left_out(self) -> None:
        assert self.hardware() == self.hardware(
            core="pipelined", target="generic", handover="parallel"
        )
        assert self.hardware().multipliers is None
        assert self.hardware(core="compact").handover == "stream"
        assert self.hardware(handover="stream").handover == "stream"

    @pytest.mark.parametrize(
        ("keys", "fault"),
        [
            ({"core": "compact", "multipliers": 2}, "multipliers: 2 is not allowed, core"),
            ({"multipliers": 0}, "multipliers: 0 is not allowed, give 1 or more"),
            ({"multipliers": -1}, "multipliers: -1 is not allowed, give a whole number from 0"),
            ({"core": "compact", "handover": "parallel"}, "handover: not possible with core"),
            ({"handover": "serial"}, "handover: 'serial' is not allowed"),
            ({"target": "ecp6"}, "target: 'ecp6' is not allowed"),
            ({"overrun": "drop"}, "overrun: 'drop' is not allowed, give \"drop-sample\" or"),
        ],
    )
    def test_what_is_refused(self, keys: dict[str, object], fault: str) -> None:
        with pytest.raises(InputError, match=f"hardware.{fault}") as raised:
            self.hardware(**keys)
        assert "\n" not in str(raised.value)

    def test_each_choice_is_another_design(self) -> None:
        keys: list[dict[str, object]] = [
            {},
            {"core": "compact"},
            {"core": "compact", "multipliers": 0},
            {"target": "ecp5"},
            {"multipliers": 28},
            {"handover": "stream"},
            {"overrun": "drop-result"},
        ]
        designs = [Design.parse({"preset": "stim300", "hardware": each}) for each in keys]
        assert len({design.digest for design in designs}) == len(designs)
        for design in designs:
            assert Design.parse(design.as_json()) == design

    def test_the_usual_overrun_is_no_other_design(self) -> None:
        usual = Design.parse({"preset": "stim300"})
        said = Design.parse({"preset": "stim300", "hardware": {"overrun": "drop-sample"}})
        assert said == usual
        assert said.digest == usual.digest
        assert not said.drops_results
        drops = Design.parse({"preset": "stim300", "hardware": {"overrun": "drop-result"}})
        assert drops.drops_results


class TestHighResolutionPosition:
    KEY = ("algorithm.position", "high-resolution")
    CORE = ("hardware", {"core": "compact"})

    def test_three_more_vectors(self) -> None:
        design = Design.parse(changed(self.KEY, self.CORE))
        assert design.high_resolution
        assert design.vectors == (*VECTORS, "s_alpha", "s_nu", "scrolling")
        assert design.components == (
            *COMPONENTS,
            *(f"{v}_{axis}" for v in ("s_alpha", "s_nu", "scrolling") for axis in "xyz"),
        )
        assert design.columns == ("major", "status", *design.components)
        assert Design.parse(design.as_json()) == design

    def test_not_asked_for(self) -> None:
        design = Design.parse(changed())
        assert design == Design.parse(changed(("algorithm.position", "trapezoidal")))
        assert (design.vectors, design.components, design.columns) == (VECTORS, COMPONENTS, COLUMNS)
        assert (design.words.s_alpha, design.words.s_nu, design.words.scrolling) == (None,) * 3

    def test_own_table_of_a_plain_sum(self) -> None:
        table = {"denominator": 3, "taps": [2], "weights": [7, 7], "sum_denominator": 7}
        own = {"family": "table", "samples": 2, "minors": 3, "table": table}
        assert Design.parse(changed(("algorithm", own), self.KEY, self.CORE)).high_resolution

    def test_another_value(self) -> None:
        assert refusal(changed(("algorithm.position", "high"), self.CORE)) == (
            'algorithm.position: \'high\' is not allowed, give "trapezoidal" or "high-resolution"'
        )

    @pytest.mark.parametrize("hardware", [{}, {"core": "pipelined"}, {"target": "ecp5"}])
    def test_the_pipelined_core_has_it_too(self, hardware: dict[str, str]) -> None:
        design = Design.parse(changed(self.KEY, ("hardware", hardware)))
        assert design.high_resolution
        assert design.hardware.core == "pipelined"

    def test_rate_samples(self) -> None:
        keys = (("sensor.kind", "rate"), ("algorithm.family", "filtered-rate"))
        assert refusal(changed(self.KEY, self.CORE, *keys)) == (
            'algorithm.position: "high-resolution" is not possible with sensor.kind = "rate", give'
            ' sensor.kind = "increment" or leave it out'
        )

    @pytest.mark.parametrize(
        "sums", [{"weights": [1, 2]}, {"weights": [1, 1, 1]}, {"weights": [1]}, {"weights": [2, 2]}]
    )
    def test_other_sums(self, sums: dict[str, Any]) -> None:
        table = {"denominator": 3, "taps": [2], **sums}
        own = {"family": "table", "samples": 2, "minors": 3, "table": table}
        assert refusal(changed(("algorithm", own), self.KEY, self.CORE)) == (
            'algorithm.position: "high-resolution" needs every sample of a minor interval to count'
            " once, leave out algorithm.table.weights or position"
        )


def test_equal_designs_are_equal_whatever_was_worked_out_of_them() -> None:
    one, other = (Design.parse(changed()) for _ in range(2))
    for each in (one, other):
        assert each.inner is each
        assert each.words.gyro.bits == 24
    assert one is not other
    assert one == other
    assert hash(one) == hash(other)

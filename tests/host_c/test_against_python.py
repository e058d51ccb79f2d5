"""The host in C against the host in Python: the same numbers, to the last bit."""

from __future__ import annotations

import ctypes
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest

from sculler.host_c import HostInC, NavigatorInC, host_texts
from sculler.library import motions
from sculler_hdl.plan.result_window import ResultWindow
from sculler_model.design import STATUS_SHORT_HISTORY, Design, Interval, scales_hash
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock, WideIntegers
from sculler_model.frames import AxisMap
from sculler_model.golden import to_words, words_per_column
from sculler_model.host import MajorIncrements, ThirdOrder, major_increments
from sculler_model.motion import MOTIONS
from sculler_model.navigation import (
    NORMAL,
    Gravity,
    HeightDamping,
    HeightReference,
    NavHistory,
    Navigator,
    NavState,
    coasted,
    constant_gravity,
    table_of_gravity,
)
from tiers import few_of

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")

DESIGNS = {
    "stim300": Design.preset("stim300"),
    "rate": Design.preset("adis16488"),
    "one minor": Design.preset("hg4930"),
    "high-resolution": Design.preset("stim300", position="high-resolution"),
    "wide": Design.parse(
        {
            "preset": "stim300",
            "name": "wide",
            "sensor": {"gyro": {"bits": 32, "lsb": 1e-11}, "accel": {"bits": 32, "lsb": 1e-9}},
            "algorithm": {"samples": 8, "history": 8, "minors": 16},
        }
    ),
}
HIGHER = {
    "third order": Design.preset("stim300", order=3),
    "fourth order": Design.preset("hg4930", samples=3, minors=4, order=4),
}
START = NavState(5.0, (0.6, 0.0, 0.0, 0.8), (10.0, -2.0, 1.0), 0.8, -2.9, 500.0, 0.3)
TABLE = table_of_gravity(
    np.radians([20.0, 50.0, 80.0]),
    np.array([-9e3, 9e5]),
    np.array([[9.79, 7.4], [9.81, 7.31], [9.83, 7.32]]),
)


def block_of(design: Design, intervals: int, seed: int = 1) -> VectorBlock:
    """Vectors of counts with a sensible size."""
    random, sensor = np.random.default_rng(seed), design.sensor
    size = np.repeat([2 ** (sensor.gyro.bits - 6), 2 ** (sensor.accel.bits - 6)], 3)
    counts = random.integers(-size, size, (intervals * design.samples_per_major, 6))
    return FastModel(design).feed(counts)


def same(one: MajorIncrements, other: MajorIncrements) -> bool:
    pairs = ((getattr(one, n), getattr(other, n)) for n in ("phi", "alpha", "dv_sf", "dr_sf"))
    return all((a is None and b is None) or np.array_equal(a, b) for a, b in pairs)


@pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS)
def test_words_are_those_of_the_stream(design: Design) -> None:
    block = block_of(design, 20)
    rows = [
        (int(major), int(status), *components)
        for major, status, components in zip(
            block.major, block.status, block.components.tolist(), strict=True
        )
    ]
    words = HostInC(design).words(block)
    assert words.tolist() == [to_words(design, row) for row in rows]


@pytest.mark.parametrize("design", few_of(HIGHER, ["fourth order"]))
def test_increments_of_third_and_fourth_order(design: Design) -> None:
    block = block_of(design, 200)
    expected = major_increments(design, block)
    assert same(HostInC(design).increments(block), expected)
    plain = Design.parse(
        design.as_json() | {"algorithm": design.as_json()["algorithm"] | {"order": 2}}
    )
    second = major_increments(plain, block_of(plain, 200))
    assert not np.allclose(second.phi, expected.phi, rtol=0, atol=1e-15)


@pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS)
def test_increments(design: Design) -> None:
    host, block, axes = HostInC(design), block_of(design, 400), AxisMap.parse("y,x,-z")
    expected = major_increments(design, block)
    assert same(host.increments(block), expected)
    expected = ThirdOrder()(expected.in_axes(axes))
    memory = host.third_order()
    halves = [host.increments(part, axes, memory) for part in (block[:150], block[150:])]
    assert same(MajorIncrements.concatenate(halves), expected)


@pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS)
def test_third_order(design: Design) -> None:
    """Where the rate is smooth, where it shakes, and after results of short history."""
    sensor, count = design.sensor, 120 * design.samples_per_major
    u = np.arange(count) / count
    curves = np.column_stack([np.sin((3 + k) * u + k) for k in range(6)])
    curves[(u > 0.5) & (u < 0.6)] *= -0.5
    size = np.repeat([2 ** (sensor.gyro.bits - 12), 2 ** (sensor.accel.bits - 6)], 3)
    block = FastModel(design).feed(np.rint(size * curves).astype(np.int64))
    host, expected = HostInC(design), ThirdOrder()
    memory = host.third_order()
    parts = [block[k : k + 7] for k in range(0, 120, 7)]
    for part in parts:
        assert same(
            host.increments(part, third_order=memory), expected(major_increments(design, part))
        )
    assert expected.corrected > 60
    assert expected.left > 10
    assert host.third_order_count(memory) == (expected.corrected, expected.left)


def test_increments_of_turns_beyond_a_radian_to_rounding() -> None:
    """There numpy's sine, which may not be the C library's, takes the place of the series."""
    sensor = {"gyro": {"bits": 24, "lsb": 2e-6}}
    asked = {"preset": "stim300", "sensor": sensor, "algorithm": {"position": "high-resolution"}}
    design = Design.parse(asked)
    block = block_of(design, 100)
    expected, found = major_increments(design, block), HostInC(design).increments(block)
    assert np.count_nonzero(np.linalg.norm(expected.alpha, axis=1) > 1) > 20
    for name in ("dv_sf", "dr_sf"):
        one, other = getattr(found, name), getattr(expected, name)
        np.testing.assert_allclose(one, other, rtol=1e-13, atol=1e-13 * np.abs(other).max())


def host_result(design: Design) -> type[ctypes.Structure]:
    """NAME_host_result."""
    limbs = -(-words_per_column(design) // 4)

    class Result(ctypes.Structure):
        _fields_ = (
            ("major", ctypes.c_uint64),
            ("status", ctypes.c_uint32),
            ("component", ctypes.c_uint64 * limbs * len(design.components)),
        )

    return Result


def integers(result: ctypes.Structure) -> list[int]:
    return [
        int.from_bytes(bytes(component), "little", signed=True) for component in result.component
    ]


@pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS)
def test_results_come_out_of_words_and_registers_as_they_went_in(design: Design) -> None:
    functions, size = HostInC(design).functions, words_per_column(design)
    random = np.random.default_rng(2)
    bounds: list[Interval] = [getattr(design.words, name[:-2]) for name in design.components]
    rows = [[b.lo for b in bounds], [b.hi for b in bounds], [0] * len(bounds), [-1] * len(bounds)]
    rows += [[int(random.uniform(b.lo, b.hi)) for b in bounds] for _ in range(20)]
    name = f"{design.name}_host"
    for number, row in enumerate(rows):
        major, status = (1 << min(16 * size, 64)) - 1 - number, number % 16
        result = host_result(design)()
        words = to_words(design, [major, status, *row])
        getattr(functions, f"{name}_from_words")(
            (ctypes.c_uint16 * len(words))(*words), ctypes.byref(result)
        )
        assert (result.major, result.status, integers(result)) == (major, status, row)

        registers = []
        for column in [major - (1 << 16 * size) if size < 4 else major, status, *row]:
            for place in range(-(-size // 2)):  # sign-extended
                registers.append(column >> 32 * place & 0xFFFFFFFF)
        result = host_result(design)()
        window = (ctypes.c_uint32 * len(registers))(*registers)
        getattr(functions, f"{name}_from_registers")(window, ctypes.byref(result))
        assert (result.major, result.status, integers(result)) == (major, status, row)


def test_registers_stand_as_the_bus_has_them() -> None:
    """The window of a design with a bus, its time stamps after the columns."""
    hardware = {"bus": {"result": "axi-lite", "time_stamps": True}}
    design = Design.parse({"preset": "stim300", "name": "bused", "hardware": hardware})
    header = host_texts(design)["bused_host.h"]
    said = dict(re.findall(r"#define BUSED_HOST_(\w+) (\w+)", header))
    columns = ResultWindow(design).entries[: len(design.columns)]
    assert int(said["REGISTERS"].rstrip("u")) == sum(entry.words for entry in columns)
    assert int(said["REGISTERS_PER_COLUMN"].rstrip("u")) == columns[0].words
    assert [entry.name for entry in columns] == list(design.columns)
    assert int(said["SCALES"].rstrip("u"), 16) == scales_hash(design)


def test_a_stream_finds_its_beginning_again() -> None:
    design = DESIGNS["stim300"]
    words = HostInC(design).words(block_of(design, 4))
    take = HostInC(design).functions.stim300_4x5_host_take_word
    take.restype, take.argtypes = ctypes.c_bool, None

    def whole(sent: list[int], *lasts: int) -> list[int]:
        """After which words a result is whole."""
        found = []
        for i, word in enumerate(sent):
            if take(stream, ctypes.c_uint16(word), ctypes.c_bool(i in lasts)):
                assert list(stream)[:n] == sent[i - n + 1 : i + 1]
                found.append(i)
        return found

    n = len(words[0])
    sent = words.ravel().tolist()
    lasts = [n - 1, 2 * n - 1, 3 * n - 1, 4 * n - 1]
    stream = (ctypes.c_uint16 * (n + 16))()
    assert whole(sent, *lasts) == lasts
    # three words lost of the second result, one twice in the third
    hurt = [*sent[: n + 5], *sent[n + 8 : 2 * n + 9], sent[2 * n + 8], *sent[2 * n + 9 :]]
    assert whole(hurt, n - 1, 2 * n - 4, 3 * n - 3, 4 * n - 3) == [n - 1, 4 * n - 3]


def test_integers_become_the_nearest_doubles() -> None:
    to_double = HostInC(DESIGNS["stim300"]).functions.sculler_integer_to_real
    to_double.restype = ctypes.c_double
    random = np.random.default_rng(3)
    numbers = [0, 1, -1, 2**53 + 1, 2**53 + 3, 2**64 - 1, 2**64, 2**63, -(2**63), 2**128 - 1]
    for bits in (54, 63, 64, 65, 90, 117, 128, 129, 180):
        for _ in range(30):
            top = int(random.integers(2**52, 2**53))
            half = (2 * top + 1) << (bits - 54)  # in the middle of two doubles
            numbers += [half, half - 1, half + 1, top << (bits - 53)]
    for number in numbers:
        for signed in (number, -number):
            for limbs in (3, 4) if abs(signed) >= 2**63 else (1, 2, 3):
                data = signed.to_bytes(8 * limbs, "little", signed=True)
                array = (ctypes.c_uint64 * limbs).from_buffer_copy(data)
                assert to_double(array, ctypes.c_size_t(limbs)) == float(signed), signed


def increments(count: int, fine: bool, seed: int = 4) -> MajorIncrements:
    random = np.random.default_rng(seed)
    phi, dv = 2e-3 * random.normal(size=(count, 3)), 0.02 * random.normal(size=(count, 3))
    phi[::50] *= 100  # rotations that no series serves
    dv[:, 2] -= 0.0981
    return MajorIncrements(phi, phi, dv, 0.005 * dv if fine else None)


@pytest.mark.parametrize("fine", [False, True])
@pytest.mark.parametrize("gravity", [NORMAL, constant_gravity(9.8), TABLE], ids=str)
@pytest.mark.parametrize("position_every", [1, 4])
@pytest.mark.parametrize("damping", [None, HeightDamping(450.0, 20.0)])
def test_navigation(
    fine: bool, gravity: Gravity, position_every: int, damping: HeightDamping | None
) -> None:
    moved = increments(300, fine)
    options = {"position_every": position_every, "height_damping": damping, "gravity": gravity}
    expected = Navigator(START, 0.01, **options)  # type: ignore[arg-type]
    found = NavigatorInC(HostInC(DESIGNS["stim300"]), START, **options)  # type: ignore[arg-type]
    whole = expected.run(moved, compiled=False)
    parts = NavHistory.concatenate([found.run(moved[:1]), found.run(moved[1:])])
    assert np.array_equal(parts.to_numpy(), whole.to_numpy())
    assert found.state == expected.state


@pytest.mark.parametrize("reference", [None, 450.0])
def test_a_measured_height(reference: float | None) -> None:
    """At its own rate, late, missing for a while; then nothing but the last one, growing old."""
    moved = increments(300, False)
    times = 0.01 * np.arange(300)
    stamps = np.concatenate((np.arange(0.05, 1.0, 0.03), [2.0]))
    heights = HeightReference(stamps, 470 + 10 * np.sin(stamps), lag=0.21).at(times)
    damping = HeightDamping(reference, 20.0, hold=0.5)
    expected = Navigator(START, 0.01, height_damping=damping)
    found = NavigatorInC(HostInC(DESIGNS["stim300"]), START, height_damping=damping)
    for part in (replace(moved, heights=heights), moved, moved[:40]):
        whole = expected.run(part, compiled=False)
        assert np.array_equal(found.run(part).to_numpy(), whole.to_numpy())
    free = NavigatorInC(HostInC(DESIGNS["stim300"]), START).run(moved)
    assert np.abs(free.h - expected.run(moved).h).max() > 0.01
    with pytest.raises(InputError, match="a height to hold to is not allowed"):
        NavigatorInC(HostInC(DESIGNS["stim300"]), START).run(replace(moved, heights=heights))


@pytest.mark.parametrize("name", MOTIONS)
def test_every_motion(name: str) -> None:
    fly(name, DESIGNS["stim300"], 4.0)


@pytest.mark.deep
@pytest.mark.parametrize("design", ["one minor", "high-resolution"])
@pytest.mark.parametrize("name", MOTIONS)
def test_every_motion_for_an_hour(name: str, design: str) -> None:
    """The height is held, for in an hour a free vertical channel may run away in either host."""
    fly(name, DESIGNS[design], 3600.0, damped=True)


def fly(name: str, design: Design, seconds: float, damped: bool = False) -> None:
    """A motion's counts through the core, and both hosts."""
    motion = motions.motion(name)
    log = motions.record(design, motion, seconds)
    block = FastModel(design).feed(log.counts)
    expected = major_increments(design, block)
    host = HostInC(design)
    found = host.increments(block)
    assert same(found, expected)
    first = expected.leading_short
    start = motion.state(np.array([first * design.major_interval])).state(0)
    damping = HeightDamping(start.h) if damped else None
    one = Navigator(start, design.major_interval, height_damping=damping)
    other = NavigatorInC(host, start, height_damping=damping)
    assert np.array_equal(other.run(found[first:]).to_numpy(), one.run(expected[first:]).to_numpy())


@pytest.mark.parametrize("lat", [0.8, 1.5707963267948966, -1.5707963267948966, -0.1, 0.0])
def test_places(lat: float) -> None:
    """At the poles, on the equator, west of Greenwich, and on from there."""
    start = START._replace(lat=lat, lon=3.0, wander=-2.5)
    host = HostInC(DESIGNS["stim300"])
    moved = increments(50, False)
    whole = Navigator(start, 0.01).run(moved, compiled=False)
    assert np.array_equal(NavigatorInC(host, start).run(moved).to_numpy(), whole.to_numpy())
    for seconds in (0.0, 0.3, 5000.0):
        assert host.coasted(start, seconds) == coasted(start, seconds)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"q": (1.0, 0.1, 0.0, 0.0)}, "the initial state is not allowed"),
        ({"lat": 1.6}, "the initial state is not allowed"),
        ({"lon": -3.2}, "the initial state is not allowed"),
        ({"v": (0.0, float("nan"), 0.0)}, "the initial state is not allowed"),
        ({"h": 1.1e6}, "the initial state is not allowed"),
        ({"lat": 0.1}, "outside the gravity table"),
    ],
)
def test_what_cannot_be_navigated_from_is_refused(change: dict[str, object], message: str) -> None:
    host, state = HostInC(DESIGNS["stim300"]), START._replace(**change)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=message):
        NavigatorInC(host, state, gravity=TABLE)


def test_settings_out_of_range_are_refused() -> None:
    host = HostInC(DESIGNS["stim300"])
    for options in ({"position_every": 0}, {"height_damping": HeightDamping(0.0, 0.09)}):
        with pytest.raises(InputError, match="a setting is not allowed"):
            NavigatorInC(host, START, **options)  # type: ignore[arg-type]


def test_what_stops_a_run_stops_it_where_python_does() -> None:
    host, moved = HostInC(DESIGNS["stim300"]), increments(20, False)
    for dv_down, message in ((1.2e7, "the height has run away"), (np.nan, "not finite")):
        moved.dv_sf[7, 2] = dv_down
        told = []
        for navigator in (Navigator(START, 0.01), NavigatorInC(host, START)):
            with pytest.raises(InputError, match=message) as error:
                [navigator.run(moved[row : row + 1]) for row in range(20)]
            told.append((str(error.value), navigator.state))
        assert told[0] == told[1]
    short = replace(moved, status=np.full(20, STATUS_SHORT_HISTORY))
    with pytest.raises(InputError, match="reaches before the first sample"):
        NavigatorInC(host, START).run(short)


def test_wide_integers_are_tested() -> None:
    assert isinstance(block_of(DESIGNS["wide"], 2).components, WideIntegers)

"""A design's host in C, loaded into this process: increments, navigation, coasting, telemetry."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.host_c.build import Precision, build
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock, limbs_of
from sculler_model.frames import AxisMap
from sculler_model.golden import words_per_column, words_per_result
from sculler_model.host import MajorIncrements
from sculler_model.navigation import (
    NORMAL,
    Gravity,
    HeightDamping,
    NavHistory,
    NavState,
    refuse_outside,
    told_times,
)

Array = NDArray[np.float64]

SENSOR_AXES = AxisMap.parse("x,y,z")
TELEMETRY_BYTES = 116

_OK, _BAD_STATE, _BAD_SETTING, _NOT_FINITE, _OUTSIDE = range(5)  # of sculler_error


class HostInC:
    """The functions of a compiled host.

    Args:
        design: whose host it is; it is compiled, or found in the cache.
        flags: more flags of the compiler.
        precision: of all its numbers; arrays that go in and out are doubles.

    Raises:
        InputError: there is no C compiler, or it fails.
    """

    def __init__(self, design: Design, *flags: str, precision: Precision = "double") -> None:
        self.design = design
        self._library = ctypes.CDLL(str(build(design, *flags, precision=precision)))
        for name in ("size", "run", "align_size", "align_steps", "third_order_size"):
            getattr(self._library, f"engine_{name}").restype = ctypes.c_size_t

    @property
    def functions(self) -> Any:
        """What engine.c.in declares."""
        return self._library

    def third_order(self) -> ctypes.Array[ctypes.c_char]:
        """Memory of the third-order correction, at its beginning."""
        return ctypes.create_string_buffer(self._library.engine_third_order_size())

    def third_order_count(self, memory: ctypes.Array[ctypes.c_char]) -> tuple[int, int]:
        """How many intervals that memory's correction has changed, and left as they are."""
        count = (ctypes.c_uint32 * 2)()
        self._library.engine_third_order_count(memory, count)
        return count[0], count[1]

    def increments(
        self,
        block: VectorBlock,
        axes: AxisMap = SENSOR_AXES,
        third_order: ctypes.Array[ctypes.c_char] | None = None,
    ) -> MajorIncrements:
        """φ, α, ΔV_SF and ΔR_SF of a block, from the words that the core's stream has of it.

        Args:
            block: consecutive major intervals.
            axes: of the body.
            third_order: memory of the correction; None for none.

        Returns:
            The increments, with the block's status and times.
        """
        words, rows = self.words(block), len(block)
        status = np.ascontiguousarray(block.status, np.int64)
        phi, alpha, dv_sf, dr_sf = (np.empty((rows, 3)) for _ in range(4))
        self._library.engine_increments(
            address(words),
            ctypes.c_size_t(rows),
            address(status),
            (ctypes.c_uint32 * 3)(*axes.axes),
            (ctypes.c_double * 3)(*axes.signs),
            third_order,
            *map(address, (phi, alpha, dv_sf, dr_sf)),
        )
        fine = dr_sf if self.design.high_resolution else None
        return MajorIncrements(phi, alpha, dv_sf, fine, block.status, block.times)

    def words(self, block: VectorBlock) -> NDArray[np.uint16]:
        """(R, words of a result) uint16, as the core's stream hands results over."""
        size = words_per_column(self.design)
        limbs = -(-size // 4)
        columns = np.empty((len(block), len(self.design.columns), limbs), "<i8")
        columns[..., 1:] = 0
        columns[:, 0, 0], columns[:, 1, 0] = block.major, block.status
        found = limbs_of(block.components)
        sign = found[..., -1:] >> 63
        for limb in range(limbs):
            columns[:, 2:, limb] = found[..., limb] if limb < found.shape[-1] else sign[..., 0]
        words = columns.view("<u2").reshape(*columns.shape[:2], -1)[..., :size]
        return np.ascontiguousarray(words, np.uint16).reshape(-1, words_per_result(self.design))

    def coasted(self, state: NavState, seconds: float) -> NavState:
        """The state so much later if attitude and velocity stay as they are."""
        numbers = _numbers(state)
        self._library.engine_coast(address(numbers), ctypes.c_double(seconds))
        return _state(numbers.tolist())

    def telemetry(self, history: NavHistory, status: NDArray[np.int64], first: int) -> bytes:
        """Frames of states (docs/reference/telemetry.md).

        Args:
            history: (N,) states.
            status: (N,) status bits.
            first: number of the first frame.
        """
        states = np.ascontiguousarray(
            np.column_stack((history.time, history.q, history.v, history.lat, history.lon,
                             history.h, history.wander))
        )  # fmt: skip
        frames = np.empty(TELEMETRY_BYTES * len(history), np.uint8)
        marks = np.ascontiguousarray(status, np.int64)
        self._library.engine_telemetry(
            address(states),
            address(marks),
            ctypes.c_size_t(len(states)),
            ctypes.c_uint64(first),
            address(frames),
        )
        return frames.tobytes()


class NavigatorInC:
    """`Navigator`, carried by the compiled host.

    Args:
        host: the host.
        state: at the start of the first interval.
        position_every, height_damping, gravity: as of `Navigator`.

    Attributes:
        carried: the `engine` of engine.c.in.

    Raises:
        InputError: as `Navigator`.
    """

    def __init__(
        self,
        host: HostInC,
        state: NavState,
        *,
        position_every: int = 1,
        height_damping: HeightDamping | None = None,
        gravity: Gravity = NORMAL,
    ) -> None:
        self._host, self._gravity, self._state = host, gravity, state
        self._interval = host.design.major_interval
        self._start, self._since = state.time, 0
        self.carried = ctypes.create_string_buffer(host.functions.engine_size())
        loop = height_damping
        waits = loop is not None and loop.reference is None
        damping = loop and (loop.reference or 0.0, loop.seconds, loop.hold)
        value, table = gravity.value, gravity.table
        self._table = [np.ascontiguousarray(array) for array in table or ()]  # C points to them
        lats, heights, excess = self._table or [np.zeros(0)] * 3
        error = host.functions.engine_begin(
            self.carried,
            ctypes.c_double(self._interval),
            ctypes.c_uint32(position_every),
            (ctypes.c_double * 3)(*damping) if damping else None,
            ctypes.c_int(waits),
            None if value is None else ctypes.byref(ctypes.c_double(value)),
            *(
                address(lats),
                ctypes.c_size_t(len(lats)),
                address(heights),
                ctypes.c_size_t(len(heights)),
            ),
            None if table is None else address(excess),
            address(_numbers(state)),
        )
        if error == _OUTSIDE:
            refuse_outside(gravity, state.time, state.lat, state.h)
        if error != _OK:
            what = "the initial state" if error == _BAD_STATE else "a setting"
            raise InputError(f"host in C: {what} is not allowed (error {error})")

    @property
    def state(self) -> NavState:
        """The state at the end of the last major interval."""
        return self._state

    def run(self, increments: MajorIncrements) -> NavHistory:
        """Carry the state over consecutive major intervals; the states at their ends.

        Raises:
            InputError: an interval is of short history, an increment is not finite, the height has
                run away, or the gravity table ends.
        """
        increments.require_whole("navigation")
        rows, times = len(increments), told_times(increments)
        if times is None:
            times = self._start + (self._since + np.arange(1.0, rows + 1)) * self._interval
        vectors = (increments.phi, increments.dv_sf, increments.dr_sf)
        phi, dv, dr = (a if a is None else np.ascontiguousarray(a, np.float64) for a in vectors)
        assert phi is not None
        assert dv is not None
        heights = increments.heights
        if heights is not None:
            heights = np.ascontiguousarray(heights, np.float64)
        table, error = np.empty((rows, 11)), ctypes.c_int(_OK)
        done = self._host.functions.engine_run(
            self.carried,
            *(address(phi), address(dv), None if dr is None else address(dr)),
            None if heights is None else address(heights),
            ctypes.c_size_t(rows),
            *(address(table), ctypes.byref(error)),
        )
        if error.value == _BAD_SETTING:
            raise InputError(
                "host in C: a height to hold to is not allowed, or nothing holds to it"
            )
        if error.value == _NOT_FINITE:
            before = self._state.time if done < 2 else times[done - 2]
            raise InputError(f"after {before:.3f} s: an increment is not finite, mend the vectors")
        history = NavHistory.from_table(times, table)
        if done:
            self._state = history.state(done - 1)
        if increments.times is None:
            self._since += rows
        elif rows:
            self._start, self._since = float(times[-1]), 0
        if error.value == _OUTSIDE:
            refuse_outside(self._gravity, self._state.time, self._state.lat, self._state.h)
        return history


def _numbers(state: NavState) -> Array:
    return np.array(
        (state.time, *state.q, *state.v, state.lat, state.lon, state.h, state.wander), np.float64
    )


def _state(n: list[float]) -> NavState:
    return NavState(n[0], (n[1], n[2], n[3], n[4]), (n[5], n[6], n[7]), n[8], n[9], n[10], n[11])


def address(array: NDArray[Any]) -> ctypes.c_void_p:
    """Where an array lies."""
    return ctypes.c_void_p(array.ctypes.data)

"""What a run computes with: the host in Python, or the host in C that is generated and compiled."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sculler.formats.telemetry import frames_of
from sculler.runs.navigation.plan import Plan
from sculler_model.fast import VectorBlock
from sculler_model.host import MajorIncrements, ThirdOrder, calibrated, major_increments
from sculler_model.navigation import (
    Alignment,
    AttitudeNavigator,
    FineAlignment,
    Mechanisation,
    NavHistory,
    NavState,
    align,
    align_finely,
    coasted,
)


class Host(Protocol):
    """From a design's results to states."""

    def begin(self) -> None:
        """A new stretch of consecutive intervals."""

    def increments(self, block: VectorBlock) -> MajorIncrements:
        """φ, α, ΔV_SF and ΔR_SF of the next results, in body axes."""

    def third_order_count(self) -> tuple[int, int]:
        """Intervals since `begin` that the third order corrected, and those it left as they are."""

    def navigator(self, start: NavState, reference_height: float) -> Mechanisation:
        """What carries a state on; a damped height without a measured one is held to that (m)."""

    def coasted(self, state: NavState, seconds: float) -> NavState:
        """The state after a break."""

    def aligned(self, window: MajorIncrements, lat: float, h: float) -> Alignment:
        """The attitude at the end of a window at rest, of latitude (rad) and height (m)."""

    def finely_aligned(self, window: MajorIncrements, lat: float, h: float) -> FineAlignment:
        """The same, refined."""

    def telemetry(self, history: NavHistory, status: NDArray[np.int64], first: int) -> bytes:
        """Frames of states, with their results' status bits and the first frame's number."""


class HostInPython:
    """`sculler_model.host` and `sculler_model.navigation`.

    Args:
        plan: the run's.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self.begin()

    def begin(self) -> None:
        """See `Host`."""
        self._third_order = ThirdOrder() if self._plan.third_order else None

    def increments(self, block: VectorBlock) -> MajorIncrements:
        """See `Host`."""
        plan = self._plan
        found = major_increments(plan.design, block, rotation=plan.rotation)
        if plan.calibration is not None:
            found = calibrated(plan.design, block, found, plan.calibration)
        found = found.in_axes(plan.axes)
        return found if self._third_order is None else self._third_order(found)

    def third_order_count(self) -> tuple[int, int]:
        """See `Host`."""
        found = self._third_order
        return (0, 0) if found is None else (found.corrected, found.left + found.waiting)

    def navigator(self, start: NavState, reference_height: float) -> Mechanisation:
        """See `Host`."""
        plan = self._plan
        if plan.attitude_only:
            return AttitudeNavigator(start, plan.design.major_interval)
        damping = plan.damping(reference_height)
        return plan.carrier.begin(start, plan.design.major_interval, damping, plan.gravity)

    def coasted(self, state: NavState, seconds: float) -> NavState:
        """See `Host`."""
        if self._plan.attitude_only:  # over the turning Earth if its rate is known, else still
            return state._replace(time=state.time + seconds)
        return coasted(state, seconds)

    def aligned(self, window: MajorIncrements, lat: float, h: float) -> Alignment:
        """See `Host`."""
        plan = self._plan
        return align(window, plan.design.major_interval, lat, h, plan.noise, plan.gravity)

    def finely_aligned(self, window: MajorIncrements, lat: float, h: float) -> FineAlignment:
        """See `Host`."""
        plan = self._plan
        return align_finely(window, plan.design.major_interval, lat, h, plan.noise, plan.gravity)

    def telemetry(self, history: NavHistory, status: NDArray[np.int64], first: int) -> bytes:
        """See `Host`."""
        return frames_of(history, status, first)


class CompiledHost:
    """The design's host in C, loaded into this process.

    Args:
        plan: the run's.

    Raises:
        InputError: there is no C compiler, or it fails.
    """

    def __init__(self, plan: Plan) -> None:
        from sculler.host_c import HostInC

        self._plan, self._host = plan, HostInC(plan.design)
        self.begin()

    def begin(self) -> None:
        """See `Host`."""
        self._third_order = self._host.third_order() if self._plan.third_order else None

    def increments(self, block: VectorBlock) -> MajorIncrements:
        """See `Host`."""
        return self._host.increments(block, self._plan.axes, self._third_order)

    def third_order_count(self) -> tuple[int, int]:
        """See `Host`."""
        memory = self._third_order
        return (0, 0) if memory is None else self._host.third_order_count(memory)

    def navigator(self, start: NavState, reference_height: float) -> Mechanisation:
        """See `Host`."""
        from sculler.host_c import NavigatorInC

        plan = self._plan
        return NavigatorInC(
            self._host,
            start,
            position_every=plan.carrier.position_every,
            height_damping=plan.damping(reference_height),
            gravity=plan.gravity,
        )

    def coasted(self, state: NavState, seconds: float) -> NavState:
        """See `Host`."""
        return self._host.coasted(state, seconds)

    def aligned(self, window: MajorIncrements, lat: float, h: float) -> Alignment:
        """See `Host`."""
        from sculler.host_c import align_in_c

        return align_in_c(self._host, window, lat, h, self._plan.noise, self._plan.gravity)

    def finely_aligned(self, window: MajorIncrements, lat: float, h: float) -> FineAlignment:
        """See `Host`."""
        from sculler.host_c import align_finely_in_c

        return align_finely_in_c(self._host, window, lat, h, self._plan.noise, self._plan.gravity)

    def telemetry(self, history: NavHistory, status: NDArray[np.int64], first: int) -> bytes:
        """See `Host`."""
        return self._host.telemetry(history, status, first)


def host_of(plan: Plan) -> Host:
    """The host that a plan asks for.

    Raises:
        InputError: the one in C cannot be compiled.
    """
    return CompiledHost(plan) if plan.engine == "c" else HostInPython(plan)

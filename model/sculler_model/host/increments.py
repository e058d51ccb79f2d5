"""`MajorIncrements`: what the navigator takes, rotation vector, velocity and displacement."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.design import STATUS_SHORT_HISTORY
from sculler_model.errors import InputError
from sculler_model.frames import AxisMap
from sculler_model.tables import Table, vector_columns

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MajorIncrements(Table):
    """Increments over R consecutive major intervals.

    Attributes:
        phi: (R, 3) rotation vector over the interval, rad: the body's attitude at the end against
            its attitude at the start, relative to inertial space.
        alpha: (R, 3) integral of the angular rate over the interval, rad.
        dv_sf: (R, 3) integral of the specific force, m/s, in the body frame at the START of the
            interval, held fixed in inertial space.
        dr_sf: (R, 3) running integral of that over the interval, m, in the same frame: how far
            the specific force has moved the body by the interval's END.  None where the design
            has no high-resolution position.
        status: (R,) status bits of the results they come from (`sculler_model.design`); None for
            none set.  Nobody navigates or aligns with an interval of short history (bit 0): its
            sums and corrections lack the samples before the first one (`require_whole`).
        times: (R,) s, the instant of each interval's END (`sculler_model.samples`); None where
            it is not told.
        heights: (R, 2) a measured height (m) to hold to in each interval, and its age (s) at the
            interval's START, below 0 where there is none (`HeightReference.at`); None for no such.

    Examples:
        >>> import numpy as np, sculler
        >>> design = sculler.Design.preset("stim300")
        >>> vectors = sculler.FastModel(design).feed(np.full((40, 6), 3))
        >>> found = sculler.increments(design, vectors)
        >>> found.phi.shape, bool(np.allclose(found.phi, 60 * design.gyro_scale))
        ((2, 3), True)
    """

    phi: Array
    alpha: Array
    dv_sf: Array
    dr_sf: Array | None = None
    status: NDArray[np.int64] | None = None
    times: Array | None = None
    heights: Array | None = None

    def __len__(self) -> int:
        return len(self.phi)

    def named_columns(self) -> dict[str, NDArray[Any]]:
        """`time_s`, `status`, and `phi_x` to `dr_sf_z`, of what is there."""
        columns: dict[str, NDArray[Any]] = {}
        if self.times is not None:
            columns["time_s"] = self.times
        if self.status is not None:
            columns["status"] = self.status
        for name in ("phi", "alpha", "dv_sf", "dr_sf"):
            vectors = getattr(self, name)
            if vectors is not None:
                columns |= vector_columns((f"{name}_x", f"{name}_y", f"{name}_z"), vectors)
        return columns

    def __getitem__(self, part: slice) -> MajorIncrements:
        """Consecutive intervals."""
        cut = self._each(lambda vectors: vectors[part])
        return replace(
            cut,
            status=None if self.status is None else self.status[part],
            times=None if self.times is None else self.times[part],
            heights=None if self.heights is None else self.heights[part],
        )

    def in_axes(self, axes: AxisMap) -> MajorIncrements:
        """The same increments in body axes, from the sensor's."""
        return self._each(axes.apply)

    @property
    def short(self) -> NDArray[np.bool_]:
        """(R,) whether the interval's history is short (status bit 0)."""
        if self.status is None:
            return np.zeros(len(self), np.bool_)
        short: NDArray[np.bool_] = (np.asarray(self.status) & STATUS_SHORT_HISTORY) != 0
        return short

    @property
    def leading_short(self) -> int:
        """How many intervals to leave out so that none of short history is left.

        The state to navigate on from is then that at the END of the last one left out.
        """
        found = np.flatnonzero(self.short)
        return int(found[-1]) + 1 if len(found) else 0

    def require_whole(self, what: str) -> None:
        """Refuse intervals of short history.

        Args:
            what: is to be done with them, for the message.

        Raises:
            InputError: there is such an interval.
        """
        short = self.short
        if not short.any():
            return
        row = int(np.argmax(short))
        at = "" if self.times is None else f", which ends at {float(self.times[row]):.9g} s,"
        raise InputError(
            f"{what}: interval {row} of these{at} reaches before the first sample (status bit 0),"
            " so its sums or corrections are not whole; begin after it, with the state at its end"
            " (increments[increments.leading_short:]), or take it as it is (accepted_as_whole())"
        )

    def without_bias(self, bias: ArrayLike, interval: float) -> MajorIncrements:
        """The same increments with the gyros' bias taken out of φ and α; ΔV_SF stays as it is.

        Args:
            bias: (3,) rad/s, in body axes.
            interval: length of a major interval, s.
        """
        turned = interval * np.asarray(bias)
        return replace(self, phi=self.phi - turned, alpha=self.alpha - turned)

    def accepted_as_whole(self) -> MajorIncrements:
        """The same increments with status bit 0 cleared: what is missing is known to do no harm."""
        status = self.status
        if status is not None:
            status = np.asarray(status, np.int64) & ~STATUS_SHORT_HISTORY
        return replace(self, status=status)

    def _each(self, change: Callable[[Array], Array]) -> MajorIncrements:
        return replace(
            self,
            phi=change(self.phi),
            alpha=change(self.alpha),
            dv_sf=change(self.dv_sf),
            dr_sf=None if self.dr_sf is None else change(self.dr_sf),
        )

    @classmethod
    def concatenate(cls, parts: list[MajorIncrements]) -> MajorIncrements:
        """Join in order; parts without a status count as whole.

        Raises:
            ValueError: there is no part, or only some have ΔR_SF, times or heights.
        """
        status = None
        if any(part.status is not None for part in parts):
            none = [np.zeros(len(part), np.int64) for part in parts]
            pairs = zip(parts, none, strict=True)
            status = np.concatenate([n if p.status is None else p.status for p, n in pairs])
        return cls(
            np.concatenate([part.phi for part in parts]),
            np.concatenate([part.alpha for part in parts]),
            np.concatenate([part.dv_sf for part in parts]),
            _all_or_none("dr_sf", [part.dr_sf for part in parts]),
            status,
            _all_or_none("times", [part.times for part in parts]),
            _all_or_none("heights", [part.heights for part in parts]),
        )


def _all_or_none(name: str, parts: list[Array | None]) -> Array | None:
    """Arrays that all parts have joined, or None if none has."""
    there = [part for part in parts if part is not None]
    if len(there) not in (0, len(parts)):
        raise ValueError(f"{len(there)} of {len(parts)} parts have {name}")
    return np.concatenate(there) if there else None

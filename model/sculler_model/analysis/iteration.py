"""What the samples themselves allow: the motion iterated to convergence on a polynomial of them.

No algorithm of coning coefficients gets more out of samples of a smooth rate than this: a
polynomial through as many of them as one likes, and the attitude equation solved on it until
nothing changes any more (functional iteration, Picard's).  So it is the yardstick beside an
algorithm's error: where the algorithm leaves more, the algorithm limits; where it leaves the same,
the sampling does.  It looks ahead as far as back, which a navigator cannot.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.analysis.integer_path import running_attitude
from sculler_model.design import Design
from sculler_model.errors import InputError

Array = NDArray[np.float64]

DEGREE = 10
"""Of the polynomial, if nothing else is said."""

MOST = 30
"""Degree at most: beyond, doubles say nothing of samples at equal distances."""

PART = 2048
"""Blocks solved at a time."""

ENOUGH = 100
"""Iterations at most; each gains a factor of half the angle over its own number."""


def iterated(
    increments: ArrayLike,
    step: int = 1,
    *,
    degree: int = DEGREE,
    ahead: float = 0.0,
    edge: int = 0,
) -> Array:
    """Rotation vectors, and velocities, of blocks of samples, by iteration to convergence.

    Through the `degree` + 1 samples about each block goes the polynomial of the rate that has
    their integrals (nearest the ends of the record: the first or last so many).  On it

        q = q₀ + ½ ∫ q∘ω dt

    is iterated from q = 1 on, at Gauss and Legendre's points, until it stands still: the
    functional iteration of the literature, of the quaternion.  With it the polynomial of the
    specific force is turned and integrated.

    Args:
        increments: (N, 3) integrals of the rate over consecutive sample intervals, rad; of a rate
            sensor its samples times the interval, which are means about their instants.  Or (N, 6):
            with those of the specific force, m/s, after them.
        step: samples of a block, of the N a whole number less 2 `edge`.
        degree: of the polynomial of the rate, 1 to `MOST`; less than N.
        ahead: sample intervals from a block's begin to its first sample's; ½ where a sample is the
            mean about its instant at the end of its interval (a rate sensor), 0 where it is the
            integral (increments).
        edge: samples at each end that help the polynomials and are in no block.

    Returns:
        (R, 3) rad: of each block, the body's attitude at its end against that at its start; or
        (R, 6): with the specific force's integral, m/s, in the body's axes at the start, after it.

    Raises:
        InputError: an argument is out of its range.

    Examples:
        >>> import numpy as np, sculler
        >>> steady = np.full((40, 3), [0.01, 0.0, 0.02])
        >>> bool(np.allclose(sculler.iterated(steady, 4), 4 * steady[:10], atol=1e-15))
        True
    """
    samples = np.asarray(increments, np.float64)
    blocks, left = divmod(max(len(samples) - 2 * edge, 0), max(step, 1))
    if samples.ndim != 2 or samples.shape[1] not in (3, 6) or step < 1 or left or edge < 0:
        raise InputError(
            f"iteration: {samples.shape} samples do not make whole blocks of {step} with {edge} at"
            " each end, give (N, 3) or (N, 6) and other lengths"
        )
    if not 1 <= degree <= MOST or degree >= len(samples):
        raise InputError(
            f"iteration: degree {degree} is not allowed for {len(samples)} samples, give 1 to"
            f" {min(MOST, len(samples) - 1)}"
        )
    begin = edge + step * np.arange(blocks)
    middle = begin + 0.5 * (step - degree - 1) - ahead
    window = np.clip(np.rint(middle - 1e-9).astype(int), 0, len(samples) - degree - 1)
    found = np.empty((blocks, samples.shape[1]))
    for offset in np.unique(begin - window).tolist():
        rows = np.flatnonzero(begin - window == offset)
        rates = _rates_of(degree, step, offset - ahead)
        for first in range(0, len(rows), PART):
            some = rows[first : first + PART]
            near = samples[window[some, None] + np.arange(degree + 1)]
            felt = np.einsum("kd,rda->rka", rates, near)
            q = _converged(felt[..., :3])
            found[some, :3] = _rotation(q, felt[..., :3])
            if samples.shape[1] == 6:
                found[some, 3:] = _velocity(q, felt[..., 3:])
    return found


def blocks_of(design: Design, samples: Array, *, degree: int = DEGREE, edge: int = 0) -> Array:
    """`iterated` on samples of a design's sensor, in its minor intervals or one by one.

    Args:
        design: its sensor and intervals; its coefficients do not matter.
        samples: (N, 3) or (N, 6) as `Quantiser` takes them, those of the gyros first: whole major
            intervals with `edge` samples at each end.
        degree, edge: as for `iterated`.

    Returns:
        (R, 3) or (R, 6), as `iterated`.

    Raises:
        InputError: as `iterated`.
    """
    rate, n = design.sensor.kind == "rate", design.table.samples
    # blocks no longer than their polynomial's samples
    step = n if n <= degree + 1 else 1
    increments = samples * (design.sample_interval if rate else 1.0)
    return iterated(increments, step, degree=degree, ahead=0.5 if rate else 0.0, edge=edge)


def attitude_on(design: Design, samples: Array, *, degree: int = DEGREE, edge: int = 0) -> Array:
    """The attitude that samples of a design's sensor allow, after each major interval.

    Args:
        design, samples, degree, edge: as for `blocks_of`.

    Returns:
        (R, 4) quaternions, from the frame after each major interval to that at the first's start.

    Raises:
        InputError: as `iterated`.
    """
    found = blocks_of(design, samples[:, :3], degree=degree, edge=edge)
    majors = (len(samples) - 2 * edge) // design.samples_per_major
    every = len(found) // majors
    return running_attitude(found)[every - 1 :: every]


def _converged(rates: Array) -> Array:
    """(R, nodes, 4) quaternions of (R, nodes, 3) rates times half a block's length."""
    integrals, _ = _integrals(rates.shape[1])
    q = np.zeros((*rates.shape[:2], 4))
    q[..., 0] = 1.0
    before = np.inf
    for _ in range(ENOUGH):
        vector = 0.5 * _product(q, rates)
        after = np.einsum("ik,rkc->ric", integrals, vector)
        after[..., 0] += 1.0
        change = float(np.abs(after - q).max(initial=0.0))
        q = after
        if change < 1e-17 or (change < 1e-13 and change >= before):
            break
        before = change
    return q


def _rotation(q: Array, rates: Array) -> Array:
    """(R, 3) rotation vectors of whole blocks."""
    _, weights = _integrals(rates.shape[1])
    end = np.einsum("k,rkc->rc", weights, 0.5 * _product(q, rates))
    sine = np.sqrt(np.sum(end[:, 1:] ** 2, axis=1))
    small = sine < 1e-9
    angle = 2 * np.arctan2(sine, 1.0 + end[:, 0])
    scale = np.where(small, 2.0, angle / np.where(small, 1.0, sine))
    vectors: Array = scale[:, None] * end[:, 1:]
    return vectors


def _velocity(q: Array, force: Array) -> Array:
    """(R, 3) integrals of (R, nodes, 3) specific forces times half a block's length, turned."""
    _, weights = _integrals(force.shape[1])
    w, vector = q[..., :1], q[..., 1:]
    once = 2 * np.cross(vector, force)
    turned: Array = np.einsum("k,rkc->rc", weights, force + w * once + np.cross(vector, once))
    return turned


def _product(q: Array, rate: Array) -> Array:
    """q∘ω, of (..., 4) and (..., 3)."""
    w, vector = q[..., :1], q[..., 1:]
    real = -np.sum(vector * rate, axis=-1, keepdims=True)
    return np.concatenate((real, w * rate + np.cross(vector, rate)), axis=-1)


@lru_cache(maxsize=256)
def _rates_of(degree: int, step: int, offset: float) -> Array:
    """(nodes, degree + 1): from samples to rates at the nodes, times half a block's length.

    The sums of the samples are a polynomial through degree + 2 points 0, 1, 2, ..., of which this
    is the derivative, in Lagrange's form.
    """
    nodes, _ = np.polynomial.legendre.leggauss(8 + degree * step // (2 * (degree + 1)))
    at = offset + 0.5 * step * (nodes + 1)
    points = np.arange(degree + 2.0)
    slopes = np.zeros((len(at), degree + 2))
    for j in range(degree + 2):
        others = np.delete(points, j)
        for k in range(degree + 1):
            product = np.ones(len(at))
            for i, other in enumerate(others):
                product *= 1.0 if i == k else at - other
                product /= j - other
            slopes[:, j] += product
    # a sample counts in every sum after it
    found: Array = 0.5 * step * (np.cumsum(slopes[:, ::-1], axis=1)[:, ::-1][:, 1:])
    return found


@lru_cache(maxsize=64)
def _integrals(nodes: int) -> tuple[Array, Array]:
    """From values at Gauss's points on -1..1 to the integrals up to each, and to the whole one."""
    x, weights = np.polynomial.legendre.leggauss(nodes)
    values = np.polynomial.legendre.legvander(x, nodes - 1)
    whole = np.stack(
        [np.polynomial.legendre.Legendre.basis(k).integ(lbnd=-1)(x) for k in range(nodes)], axis=1
    )
    return whole @ np.linalg.inv(values), weights

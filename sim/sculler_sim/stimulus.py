"""Which clocks count, offer a sample, take a result or hold reset: the same for every engine."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError

Levels8 = NDArray[np.uint8]

_BLOCK = 1 << 14  # clocks drawn from one random generator, so that any clock can be reached
_DENSITIES = (0.0, 0.15, 0.5, 0.85, 1.0)  # share of busy clocks in a stretch
_LONGEST_PAUSE = 64  # of a clock enable that is low, or as often as not
_IMPATIENCE = 0.6  # share of busy clocks in which a sensor gives up


class Levels(NamedTuple):
    """Input levels of consecutive clocks, each (clocks,) of 0 and 1."""

    offer: Levels8
    """The sensor has a sample to offer, which stays offered until it is taken or given up."""
    take: Levels8
    """Level of `result_ready`."""
    rst: Levels8
    """Level of `rst`."""
    give_up: Levels8
    """A sample that is offered and not taken in this clock is lost: its offer is withdrawn."""
    enable: Levels8
    """Level of `clk_en`, where the core has it: only such clocks count."""


@dataclass(frozen=True)
class Stimulus:
    """The levels on the handshakes and the reset, for any clock from 0 on.

    Two equal objects give the same levels, however the clocks are cut into chunks.

    Attributes:
        seed: None for no stalls, else the seed of random stalls on both handshakes and, where the
            core has one, of its clock enable.
        longest: longest stretch of clocks with one density of busy clocks.  Stretches are short
            and long alike (log-uniform) and some are wholly idle; several major intervals long,
            they make `sample_ready` fall.
        resets: clocks in which `rst` is high.
        gives_up: whether the sensor gives samples up that are not taken, at random; it never does
            without stalls.
    """

    seed: int | None = None
    longest: int = 256
    resets: tuple[int, ...] = ()
    gives_up: bool = False

    def __post_init__(self) -> None:
        if self.seed is not None and self.seed < 0:
            raise InputError(f"stall seed: {self.seed} is not allowed, give a whole number >= 0")
        if self.longest < 1:
            raise ValueError(f"longest: {self.longest} is not allowed, give a whole number >= 1")

    @classmethod
    def always(cls) -> Stimulus:
        """Offer and take on every clock."""
        return cls()

    @classmethod
    def stalls(cls, seed: int, longest: int = 256) -> Stimulus:
        """Random stalls on both handshakes, reproducible from the seed (>= 0).

        Raises:
            InputError: the seed is negative.
        """
        return cls(seed, longest)

    def with_resets(self, *clocks: int) -> Stimulus:
        """The same, with `rst` high in the given clocks."""
        return replace(self, resets=clocks)

    def giving_up(self) -> Stimulus:
        """The same, with a sensor that gives samples up."""
        return replace(self, gives_up=True)

    def levels(self, start: int, clocks: int) -> Levels:
        """Levels of `clocks` clocks from clock `start` on."""
        end = start + clocks
        if self.seed is None:
            offer = take = enable = np.ones(clocks, np.uint8)
            give_up = np.zeros(clocks, np.uint8)
        else:
            blocks = [
                _random_block(self.seed, self.longest, index)
                for index in range(start // _BLOCK, -(-end // _BLOCK))
            ]
            first = start // _BLOCK * _BLOCK
            drawn = np.concatenate(blocks, axis=1) if blocks else np.zeros((4, 0), np.uint8)
            offer, take, give_up, enable = drawn[:, start - first : end - first]
            if not self.gives_up:
                give_up = np.zeros(clocks, np.uint8)
        rst = np.zeros(clocks, np.uint8)
        rst[[clock - start for clock in self.resets if start <= clock < end]] = 1
        return Levels(*map(np.ascontiguousarray, (offer, take, rst, give_up, enable)))


@lru_cache(maxsize=4)
def _random_block(seed: int, longest: int, index: int) -> Levels8:
    """Offer, take, give up and enable, (4, _BLOCK), of the block's clocks."""
    rng = np.random.default_rng([seed, longest, index])
    offer, take, give_up = (_stretches(rng, longest) for _ in range(3))
    give_up &= rng.random(_BLOCK) < _IMPATIENCE
    return np.stack([offer, take, give_up, _stretches(rng, _LONGEST_PAUSE)])


def _stretches(rng: np.random.Generator, longest: int) -> Levels8:
    """_BLOCK clocks in stretches of log-uniform length, each of one density of busy clocks."""
    lengths: list[int] = []
    total = 0
    while total < _BLOCK:
        more = np.floor(np.exp(rng.uniform(0.0, np.log(longest + 1), 256))).astype(int)
        lengths += more.clip(1, longest).tolist()
        total += int(more.sum())
    density = np.repeat(rng.choice(_DENSITIES, len(lengths)), lengths)[:_BLOCK]
    return (rng.random(_BLOCK) < density).astype(np.uint8)

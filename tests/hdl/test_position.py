"""High-resolution position of the pipelined core: ranges of its operands, and exact at them."""

import itertools
import random

import pytest
from amaranth.hdl import Module

from amaranth_runs import drive
from sculler_hdl import TARGETS
from sculler_hdl.pipelined.position import Position
from sculler_hdl.plan.arrival import Limbs, spans
from sculler_hdl.plan.cross_array import FOLDINGS
from sculler_hdl.plan.position import PositionPlan, most_ahead
from sculler_model.algorithms import high_resolution
from sculler_model.design import word_lengths
from strategies import make_design


def weights_ahead(samples):
    """For each sample the weights of T, U, C and D, from the recursions of the part's page."""
    zero = [0] * (samples + 1)  # of the sample before the interval and of those in it

    def add(*terms):
        return [sum(factor * vector[i] for factor, vector in terms) for i in range(samples + 1)]

    T = U = total = zero
    for newest in range(1, samples + 1):
        q = samples - newest
        s, s1, s0 = ([int(i == j) for i in range(samples + 1)] for j in (newest, newest - 1, 0))
        last = q == 0
        C = add((120, T), (60 * (q + 1) - 33, s1), (-10, s0))
        C = add((1, C), *([(-50, total), (-7, s)] if last else [(120 * q + 36, s)]))
        D = add((120, U), (60 * (q + 1) - 57, s1), (10, s0), (-10 * last, total))
        yield T, U, C, D
        T = add((1, T), (4 * q - 3, s), (-5, total))
        U = add((1, U), (2 * q, s), (-1, total))
        total = add((1, total), (1, s))


@pytest.mark.parametrize("samples", [1, 2, 3, 4, 5, 20, 33])
def test_ranges_of_the_operands(samples):
    """Neither more nor less than the weights demand."""
    magnitudes = [
        max(sum(map(abs, weights)) for weights in each)
        for each in zip(*weights_ahead(samples), strict=True)
    ]
    most = most_ahead(samples)
    assert [most.gyro[0], most.accel[0], most.gyro[1], most.accel[1]] == magnitudes


@pytest.mark.parametrize(
    ("samples", "folding", "limb", "target"),
    [
        (1, 0, Limbs(64), "generic"),
        (2, 1, Limbs(20), "ecp5"),
        (5, 0, Limbs(7, 2), "ecp5"),
        (4, 2, Limbs(9), "ice40"),
        (3, 4, Limbs(20, 2), "ecp5"),
        (7, 5, Limbs(11), "xilinx"),
    ],
)
def test_position_is_the_pages(samples, folding, limb, target):
    """Samples as close as they may be, then apart; full-scale counts; each bit at its own clock."""
    table = make_design("any", samples, 1, 1, (9, 12)).table
    words = word_lengths(9, 12, 1, table, high_resolution=True)
    plan = PositionPlan(words, samples, FOLDINGS[folding], TARGETS[target], limb, 8)
    part, rng, majors = Position(plan, primitive=False), random.Random(samples), 6
    boxes = [words.gyro] * 3 + [words.accel] * 3
    counts = [
        [rng.choice((box.lo, box.hi, rng.randint(box.lo, box.hi))) for box in boxes]
        for _ in range(majors * samples)
    ]
    expected = list(high_resolution([(tuple(c[:3]), tuple(c[3:])) for c in counts], samples))
    gaps = [
        FOLDINGS[folding].steps + (rng.choice((0, 0, 3)) if i > len(counts) // 2 else 0)
        for i in range(len(counts))
    ]
    taken = dict(zip(itertools.accumulate(gaps), range(len(counts)), strict=True))
    ports = {
        (name, i): getattr(part, name)[plan.lanes[i] if name == "scrolling" else i]
        for name in plan.arrivals
        for i in range(3)
    }
    shown = []

    async def bench(ctx):
        for now in range(max(taken) + 80):
            number = taken.get(now)
            sample = [rng.randint(box.lo, box.hi) for box in boxes]
            if number is not None:
                sample = counts[number]
            for i in range(3):
                ctx.set(part.gyro[i], sample[i])
                ctx.set(part.accel[i], sample[3 + i])
            ctx.set(part.step, int(number is not None))
            ctx.set(part.first, int(number is not None and number % samples == 0))
            ctx.set(part.last, int(number is not None and number % samples == samples - 1))
            _, _, *values = await ctx.tick().sample(*ports.values())
            shown.append(dict(zip(ports, values, strict=True)))

    top = Module()
    top.submodules.part = part
    drive(top, bench)
    for end, number in taken.items():
        if number % samples < samples - 1:
            continue
        for name, i in ports:
            value = sum(
                shown[end + clock][name, i] & ((1 << hi) - (1 << lo))
                for lo, hi, clock in spans(plan.arrivals[name][i])
            )
            bits = plan.ranges[name].bits
            value -= (value >> (bits - 1)) << bits
            assert value == getattr(expected[number // samples], name)[i], (name, i, number)

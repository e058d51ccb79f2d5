"""Instructions in an order in which none waits for a word longer than it must."""

from __future__ import annotations

from collections.abc import Sequence

from sculler_hdl.plan.compact.instructions import Block, Instruction, MemoryWord


def schedule(blocks: Sequence[Block], delay: int, idle: Instruction) -> tuple[Instruction, ...]:
    """Blocks one after another such that none reads a word less than `delay` after its store.

    A block may overtake an earlier one unless it reads what that writes or writes what that reads.
    Where no block can begin at once, `idle` instructions wait for the one that can soonest.
    """
    order: list[Instruction] = []
    stored: dict[MemoryWord, int] = {}  # when each word was last written
    behind = _precedence(blocks)
    waiting = list(range(len(blocks)))
    while waiting:
        stalls = {
            i: max(0, *(stored.get(word, -delay) + delay - len(order) - at for at, word in reads))
            for i in waiting
            if behind[i].isdisjoint(waiting)
            for reads in [[(at, word) for at, one in enumerate(blocks[i]) for word in one.reads]]
        }
        best = min(stalls, key=lambda i: (stalls[i], i))
        waiting.remove(best)
        order += [idle] * stalls[best]
        for instruction in blocks[best]:
            stored |= dict.fromkeys(instruction.writes, len(order))
            order.append(instruction)
    return tuple(order)


def _precedence(blocks: Sequence[Block]) -> list[set[int]]:
    """For each block, the numbers of the earlier ones that it must stay behind."""
    reads = [{word for instruction in block for word in instruction.reads} for block in blocks]
    writes = [{word for instruction in block for word in instruction.writes} for block in blocks]
    return [
        {
            earlier
            for earlier in range(later)
            if writes[earlier] & (reads[later] | writes[later]) or reads[earlier] & writes[later]
        }
        for later in range(len(blocks))
    ]

"""When the vector engine does what, in slots: a slot is a step of a task, or nothing.

A task's steps follow each other, for there is one running total.  What a task makes is stored some
slots after its last step and can be read some slots after that, so that tasks which do not need it
go on meanwhile: of those that can start, the one with the longest way to the end goes first.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

from sculler_hdl.plan.vector.page import Page, Step, Task


class Slots(NamedTuple):
    """The clocks of an engine, in slots.

    Attributes:
        store: from a task's last step to when it is stored.
        ready: from a task's last step to the first step that can use it.
        loaded: at which each vector that is loaded can be used first.
    """

    store: int
    ready: int
    loaded: Mapping[str, int]


@dataclass(frozen=True)
class Row:
    """What happens in a slot.

    Attributes:
        step: of a task.
        task: of the step.
        first, last: it is the task's first, last.
        stored: the task that is stored in this slot.
    """

    step: Step | None = None
    task: Task | None = None
    first: bool = False
    last: bool = False
    stored: Task | None = None


class Program:
    """The tasks of a page in their slots.

    Args:
        page: the tasks.
        slots: how long they take.

    Attributes:
        starts: the slot of each task's first step, by its target.
    """

    def __init__(self, page: Page, slots: Slots) -> None:
        self.page, self.slots = page, slots
        self._makers = {task.target: task for task in page.tasks}
        self._waits = {task.target: list(self._waits_for(task)) for task in page.tasks}
        self._length: dict[str, int] = {}
        self.starts: dict[str, int] = {}
        self._place()

    def ends(self, target: str) -> int:
        """The slot of a task's last step."""
        return self.starts[target] + len(self._makers[target].steps) - 1

    @cached_property
    def rows(self) -> list[Row]:
        """Slot by slot, to when the last task is stored."""
        steps: dict[int, Row] = {}
        stored: dict[int, Task] = {}
        for task in self.page.tasks:
            start, last = self.starts[task.target], len(task.steps) - 1
            for i, step in enumerate(task.steps):
                steps[start + i] = Row(step, task, i == 0, i == last)
            stored[start + last + self.slots.store] = task
        rows = []
        for slot in range(max(stored) + 1):
            rows.append(replace(steps.get(slot, Row()), stored=stored.get(slot)))
        return rows

    def _waits_for(self, task: Task) -> Iterator[tuple[int, str, bool]]:
        """(step, task, whether its new vector is needed) that a task has to wait for.

        Where the new vector is not needed, the old one is: the task must have read it.
        """
        for i, step in enumerate(task.steps):
            for name in (step.left, step.right):
                if isinstance(name, str) and name in self._makers and not step.old:
                    yield i, name, True
        for other in self._makers.values():
            if any(step.old and step.left == task.target for step in other.steps):
                yield 0, other.target, False

    def _way(self, target: str) -> int:
        """Slots from a task's first step to the end, at least."""
        if target not in self._length:
            behind = [
                self._way(other) + (self.slots.ready if needed else 0)
                for other, waits in self._waits.items()
                for _, name, needed in waits
                if name == target
            ]
            self._length[target] = len(self._makers[target].steps) + max(behind, default=0)
        return self._length[target]

    def _earliest(self, task: Task) -> int | None:
        """The slot in which a task can start at the earliest; None if that is not known yet."""
        slot = 0
        for i, name, needed in self._waits[task.target]:
            if name not in self.starts:
                return None
            slot = max(slot, self.ends(name) + (self.slots.ready - i if needed else 1))
        for i, step in enumerate(task.steps):
            for factor in (step.left, step.right):
                slot = max(slot, self.slots.loaded.get(str(factor), 0) - i)
        return slot

    def _place(self) -> None:
        slot = 0
        waiting = sorted(self.page.tasks, key=lambda task: -self._way(task.target))
        while waiting:
            earliest = {task: self._earliest(task) for task in waiting}
            known = [task for task in waiting if earliest[task] is not None]
            can = [task for task in known if (earliest[task] or 0) <= slot]
            if not can:
                slot = min(each for each in earliest.values() if each is not None)
                continue
            self.starts[can[0].target] = slot
            slot += len(can[0].steps)
            waiting.remove(can[0])

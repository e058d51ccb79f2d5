"""What was placed before, kept beside this: only a design that has changed is placed again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from pydantic import TypeAdapter

from sculler.words import Advance
from sculler_model.design import Design
from sculler_model.outputs import replacing
from sculler_sim.place.devices import find_device
from sculler_sim.place.placement import Placement, Placer, place

FILE = Path("studies/hardware/kept.json")


@dataclass(frozen=True)
class _Row:
    """A placement, and a hash of all that the tools were given for it."""

    of: str
    found: Placement


_ROWS = TypeAdapter(list[_Row])


class Kept:
    """Placements of the same Verilog in the same device by the same tools.

    Args:
        path: of the file; written anew after each placement.
        again: whether to place anew what is asked for.
    """

    def __init__(self, path: Path, *, again: bool = False) -> None:
        self.path = path
        rows = _ROWS.validate_json(path.read_bytes()) if path.is_file() else []
        self._found = {row.of: row.found for row in rows}
        self._known = set() if again else set(self._found)
        self._asked: set[str] = set()

    def place(
        self, design: Design, device: str, speed: int | None, seeds: Sequence[int], advance: Advance
    ) -> Placement:
        """The placement that is kept, or a new one.

        Args:
            design: the design.
            device, speed: where, as `find_device` takes them.
            seeds: the placer's seeds.
            advance: told 1 after each step: synthesis with packing, and each seed.

        Raises:
            InputError: a tool is missing, the design is for another family or does not fit.
            ToolError: a tool fails.
        """
        placer = Placer(design, *find_device(device, speed))
        of = sha256("\0".join([*placer.made_of, *map(str, seeds)]).encode()).hexdigest()[:24]
        self._asked.add(of)
        if of in self._known:
            advance(1 + len(self._found[of].seeds))
            return self._found[of]
        found = place(design, placer.device, placer.speed, seeds, placer=placer, done=advance)
        self._found[of] = found
        self._known.add(of)
        self._write()
        return found

    def drop_others(self) -> None:
        """Keep what was asked for since this began, and nothing else."""
        self._found = {of: self._found[of] for of in self._asked}
        self._write()

    def _write(self) -> None:
        rows = [_Row(*pair) for pair in self._found.items()]
        rows.sort(key=lambda row: (row.found.design, row.found.device, row.of))
        with replacing(self.path) as temporary:
            temporary.write_bytes(_ROWS.dump_json(rows, indent=1) + b"\n")

"""The stack that the host's functions take at most, read off the compiler's call graph.

gcc's `-fcallgraph-info=su` tells of each function its frame and whom it calls.  Nothing recurses,
no frame's size depends on data and no function is called by a pointer, so the deepest path is the
bound; all of this is seen to.  Functions of the mathematical and the compiler's libraries have no
such files: their frames are not in it.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable

from sculler_model.errors import InputError

_NODE = re.compile(r'node: \{ title: "([^"]+)" label: "[^"]*?(\d+) bytes \(([^)]*)\)')
_EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"')
_POINTER = "__indirect_call"


class CallGraph:
    """Frames and calls of all functions of some files.

    Args:
        texts: of .ci files.

    Raises:
        InputError: a frame's size depends on data, or a function is called by a pointer.
    """

    def __init__(self, texts: Iterable[str]) -> None:
        self.frames: dict[str, int] = {}
        self._calls: defaultdict[str, set[str]] = defaultdict(set)
        for text in texts:
            for name, size, kind in _NODE.findall(text):
                if "static" not in kind:
                    raise InputError(f"{name}: its frame is {kind}, no bound can be told")
                self.frames[name] = int(size)
            for caller, callee in _EDGE.findall(text):
                if callee == _POINTER:
                    raise InputError(f"{caller} calls by a pointer, no bound can be told")
                self._calls[caller].add(callee)

    def deepest(self, entries: Iterable[str]) -> int:
        """Bytes that a call of any of these functions takes at most.

        Raises:
            InputError: one is not there, or a function calls itself, by others too.
        """
        known: dict[str, int] = {}

        def depth(name: str, above: tuple[str, ...]) -> int:
            if name in above:
                raise InputError(f"{name} calls itself, no bound can be told")
            if name not in known:
                below = (depth(callee, (*above, name)) for callee in self._calls[name])
                known[name] = self.frames.get(name, 0) + max(below, default=0)
            return known[name]

        asked = list(entries)
        for name in asked:
            if name not in self.frames:
                raise InputError(f"{name} is in no call graph")
        return max(depth(name, ()) for name in asked)

"""Frames in a stream of bytes: found by how they begin, how long they are, and their check."""

from __future__ import annotations

from collections.abc import Iterator

from sculler_model.front.layout import Kind, Layout


class Receiver:
    """Takes bytes one by one and gives whole frames.

    The rule: of the bytes not yet dealt with, the first is dropped if no kind of frame begins so,
    or if the frame that would begin there has a wrong check; else the frame is taken with all its
    bytes.  So what a damaged frame holds is looked through again from its second byte, and a whole
    frame after any garbage is found: at the latest when as many bytes have come after it as the
    longest kind has.  Where the wire tells where frames begin, a broken one is dropped as a whole.

    A wrong check counts once for all the bytes that the broken frame would have had: what else may
    seem to begin among them counts for nothing.

    Args:
        layout: of the frames.

    Attributes:
        broken: frames with a wrong check.
    """

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.broken = 0
        self._held = bytearray()
        self._counted = 0  # bytes from the first held one on that belong to a counted broken frame

    def take(self, byte: int) -> Iterator[tuple[Kind, bytes]]:
        """The frames that a byte makes whole, in order."""
        self._held.append(byte)
        while self._held:
            kind = self.layout.kind_of(self._held)
            if kind is None:
                self._drop(1)
                continue
            if len(self._held) < kind.length:
                return
            frame = bytes(self._held[: kind.length])
            if self.layout.is_whole(frame, kind):
                self._drop(kind.length)
                self._counted = 0
                yield kind, frame
                continue
            if not self._counted:
                self.broken += 1
                self._counted = kind.length
            self._drop(kind.length if self.layout.aligned else 1)

    def _drop(self, count: int) -> None:
        del self._held[:count]
        self._counted = max(0, self._counted - count)

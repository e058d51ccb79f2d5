"""The other end of `sculler.readers.apart`: loads a file of arrays, lists them, and sends some.

It is run as a script, on its own, and imports nothing of this package.  Its words are the parent's
`sys.path`, the file, the names of the variables that are enough, and bytes of memory and seconds of
processor that it may use.  Each answer is a line of JSON; after one with "bytes" follow these.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from typing import Any, BinaryIO

MOST_NAMES, MOST_ELEMENTS, DEEPEST = 2000, 100, 16


def main() -> None:
    """List, then send what is asked for, name by name."""
    paths, path, only, memory, seconds = sys.argv[1:]
    sys.path[:] = json.loads(paths)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # a library that prints does not get between
    try:
        load = _hdf5 if _is_hdf5(path) else _mat
        arrays = load(path, json.loads(only), int(memory), int(seconds))
        _answer(answers, {"arrays": {name: _shown(array) for name, array in arrays.items()}})
        for line in sys.stdin:
            _send(answers, arrays[json.loads(line)])
    except BaseException as error:
        known = {"NotImplementedError": "version", "MemoryError": "memory", "ImportError": "import"}
        kind = known.get(type(error).__name__, "damaged")
        if isinstance(error, ModuleNotFoundError):
            kind = "import"
        text = " ".join(str(error).split())[:200] or type(error).__name__
        if isinstance(error, OSError) and error.strerror is not None:
            kind, text = "unreadable", error.strerror
        _answer(answers, {"error": kind, "text": text})


def _answer(answers: BinaryIO, what: dict[str, Any]) -> None:
    answers.write(json.dumps(what).encode() + b"\n")
    answers.flush()


def _send(answers: BinaryIO, array: Any) -> None:
    import numpy as np

    given = np.asarray(array[()] if hasattr(array, "dataset") else array)
    given = given.astype(given.dtype.newbyteorder("="), order="C")
    _answer(answers, {"shape": given.shape, "kind": given.dtype.str, "bytes": given.nbytes})
    answers.write(given.tobytes())
    answers.flush()


def _shown(array: Any) -> dict[str, Any]:
    shown = {"shape": array.shape, "kind": array.dtype.str}
    if array.dtype.kind == "U" and array.size == 1:
        shown["text"] = str(array.reshape(-1)[0])[:200]
    return shown


def _bound(memory: int, seconds: int) -> None:
    """Bound what this process may use from now on; where the system can."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
    try:
        with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123
            used = int(file.read().split()[0]) * resource.getpagesize()
    except OSError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (used + memory, used + memory))


def _is_hdf5(path: str) -> bool:
    with open(path, "rb") as file:  # noqa: PTH123
        head = file.read(520)
    return head.startswith(b"MATLAB 7.3") or b"\x89HDF\r\n\x1a\n" in (head[:8], head[512:])


def _mat(path: str, only: list[str], memory: int, seconds: int) -> dict[str, Any]:
    from scipy.io import loadmat

    _bound(memory, seconds)
    found = loadmat(path, variable_names=only or None)
    if not set(only) <= found.keys():
        found = loadmat(path)
    arrays: dict[str, Any] = {}
    for name, value in found.items():
        if not name.startswith("__"):
            for inner, array in _inside(name, value, 0):
                if len(arrays) < MOST_NAMES:
                    arrays[inner] = array
    return arrays


def _inside(name: str, value: Any, depth: int) -> Iterator[tuple[str, Any]]:
    """The arrays in a variable: itself, or the fields of a structure."""
    if not hasattr(value, "dtype") or depth > DEEPEST:
        return
    fields = value.dtype.names
    if fields is None and value.dtype.kind != "O":
        yield name, value
        return
    if value.size > MOST_ELEMENTS:
        return
    for number, element in enumerate(value.reshape(-1)):
        one = name if value.size == 1 else f"{name}({number + 1})"
        if fields is None:
            yield from _inside(one, element, depth + 1)
        else:
            for field in fields:
                yield from _inside(f"{one}.{field}", element[field], depth + 1)


class _Dataset:
    """A data set, read when it is asked for; MATLAB's have their axes the other way round."""

    def __init__(self, dataset: Any, turned: bool) -> None:
        self.dataset, self._turned = dataset, turned
        self.dtype = dataset.dtype
        self.shape = dataset.shape[::-1] if turned else dataset.shape

    def __getitem__(self, _: Any) -> Any:
        values = self.dataset[()]
        return values.T if self._turned else values


def _hdf5(path: str, only: list[str], memory: int, seconds: int) -> dict[str, Any]:
    import h5py
    import numpy as np

    _bound(memory, seconds)
    file = h5py.File(path, "r")
    arrays: dict[str, Any] = {}

    def visit(name: str, thing: Any) -> None:
        if name.startswith("#") or not isinstance(thing, h5py.Dataset) or len(arrays) >= MOST_NAMES:
            return
        kind = thing.attrs.get("MATLAB_class")
        if "MATLAB_empty" in thing.attrs or thing.dtype.kind not in "iufbSO":
            return
        dotted = name.replace("/", ".")
        if kind is not None and bytes(kind) == b"char":
            codes = thing[()].reshape(-1)[:200].tolist()
            arrays[dotted] = np.array("".join(map(chr, codes)))
        elif h5py.check_string_dtype(thing.dtype) is not None:
            if thing.shape == ():
                arrays[dotted] = np.array(thing.asstr()[()])
        elif thing.dtype.kind in "iufb":
            arrays[dotted] = _Dataset(thing, kind is not None)

    file.visititems(visit)
    return arrays


if __name__ == "__main__":
    main()

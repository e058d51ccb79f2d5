"""Runs cases in forked children of a warm process and judges how they end."""

from __future__ import annotations

import gc
import os
import random
import resource
import shlex
import shutil
import signal
import sys
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from fuzz.corruptions import NUMBERS, PIECES, spoilt, spoilt_arrays
from fuzz.targets import CONTAINERS, TARGETS, Target, arrays_of, examples
from sculler.main import main

SECONDS = 20
MEMORY = 1 << 30
"""What a case may take on top of the warm process."""

FILE = 32 << 20
"""Bytes of a file that a case may write: an input may ask for more, and is told so."""

_TEXT = (".csv", ".toml", ".txt", ".imu")
_TRACEBACK = 70


class Case(NamedTuple):
    """One corrupted input and the command that reads it."""

    seed: int
    number: int
    target: Target
    words: list[str]
    content: bytes | None


class Finding(NamedTuple):
    """A case that did not end as it should."""

    case: Case
    what: str
    said: str


class Bench:
    """The examples in a folder, and cases run on them.

    Args:
        folder: to work in; emptied.
        targets: that cases come of.
    """

    def __init__(self, folder: Path, targets: Iterable[Target] = TARGETS) -> None:
        shutil.rmtree(folder, ignore_errors=True)
        self._ours = folder
        self._work = folder / "in" / "here"
        self._work.mkdir(parents=True)
        self._quietly(lambda: self._make_examples())
        self._arrays = {
            name: arrays_of(self._work / name)
            for name in self._examples
            if Path(name).suffix[1:] in CONTAINERS
        }
        self.ran: Counter[str] = Counter()
        for target in targets:  # what is imported and compiled here is there in every child
            finding = self._judge(Case(0, 0, target, self._words(target), None), warming=True)
            assert finding is None, f"{target.name}: {finding}"
        gc.collect()
        gc.freeze()

    def _make_examples(self) -> None:
        self._examples = examples(self._work)

    def case(self, seed: int, number: int) -> Case | None:
        """Case `number` of a seed; None where it is a slow target's and not its turn."""
        round_, at = divmod(number, len(TARGETS))
        target = TARGETS[at]
        if round_ % target.every:
            return None
        rng = random.Random(f"{seed}:{number}")
        words = self._words(target)
        if not target.file:
            return Case(seed, number, target, _spoilt_words(rng, words), None)
        return Case(seed, number, target, words, self._spoilt(rng, target.file))

    def run(self, cases: Iterable[Case]) -> Iterator[Finding]:
        """Run cases; yields those that did not end well."""
        for case in cases:
            self.ran[case.target.name] += 1
            finding = self._judge(case)
            if finding is not None:
                yield finding

    @staticmethod
    def _words(target: Target) -> list[str]:
        return shlex.split(target.words.format(target.file))

    def _spoilt(self, rng: random.Random, name: str) -> bytes:
        if name in self._arrays and rng.random() < 0.5:
            path = self._ours / name
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                try:
                    CONTAINERS[path.suffix[1:]](path, spoilt_arrays(rng, self._arrays[name]))
                    return path.read_bytes()
                except Exception:  # no such file can be made
                    pass
        return spoilt(rng, self._examples[name], Path(name).suffix in _TEXT)

    def _judge(self, case: Case, warming: bool = False) -> Finding | None:
        changed = self._work / case.target.file if case.content is not None else None
        if changed is not None:
            changed.write_bytes(case.content or b"")
        if warming:
            status, taken = self._quietly(lambda: self._main(case.words)), 0.0
        else:
            status, taken = self._child(case)
        out, err = ((self._ours / name).read_text("utf-8", "replace") for name in ("out", "err"))
        what = verdict(status, err, taken)
        if warming and status != 0:
            what = f"status {status} of a valid example"
        left = self._tidy(case, status)
        if what is None and left:
            what = f"leaves {left}"
        return None if what is None else Finding(case, what, f"{out[-2000:]}\n{err[-4000:]}")

    def _tidy(self, case: Case, status: int) -> str:
        """Put the folder back as it was; what was there that should not be."""
        wrong = []
        for path in sorted(self._work.rglob("*"), reverse=True):
            name = str(path.relative_to(self._work))
            if name not in self._examples:
                if path.name.startswith(".") or status not in (0, 1):
                    wrong.append(name)
                path.rmdir() if path.is_dir() and not path.is_symlink() else path.unlink()
        for name, content in self._examples.items():
            path, expected = self._work / name, content
            if name == case.target.file and case.content is not None:
                expected = case.content
            found = path.read_bytes() if path.exists() else None
            if found != expected:
                wrong.append(f"{name} changed")
            if found != content:
                path.write_bytes(content)
        return ", ".join(wrong)

    def _main(self, words: list[str]) -> int:
        before = Path.cwd()
        os.chdir(self._work)
        try:
            return main(words)
        finally:
            os.chdir(before)

    def _quietly(self, run):  # type: ignore[no-untyped-def]
        """Run in this process, what it says going to the files `out` and `err`."""
        sys.stdout.flush()
        sys.stderr.flush()
        before = sys.stdout, sys.stderr
        with (self._ours / "out").open("w") as out, (self._ours / "err").open("w") as err:
            sys.stdout, sys.stderr = out, err
            try:
                return run()
            finally:
                sys.stdout, sys.stderr = before

    def _child(self, case: Case) -> tuple[int, float]:
        """Exit status of a forked child that runs a case, minus the signal that killed it; CPU s.

        One that sleeps is killed after a time that no other takes, however busy the machine is.
        """
        sys.stdout.flush()
        sys.stderr.flush()
        child = os.fork()
        if child == 0:
            self._be(case)
        deadline = time.monotonic() + 10 * SECONDS
        pause = 0.0005
        while True:
            ended, status, used = os.wait4(child, os.WNOHANG)
            if ended:
                return os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime
            if time.monotonic() > deadline:
                os.kill(child, signal.SIGKILL)
            time.sleep(pause)
            pause = min(2 * pause, 0.01)

    def _be(self, case: Case) -> None:
        """In the child: run and end, never to return."""
        status = _TRACEBACK
        try:
            for number, name in ((1, "out"), (2, "err")):
                file = os.open(self._ours / name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
                os.dup2(file, number)
                os.close(file)
            sys.stdout, sys.stderr = (
                os.fdopen(number, "w", encoding="utf-8", closefd=False) for number in (1, 2)
            )
            size = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
            if not case.target.programs:
                resource.setrlimit(resource.RLIMIT_AS, (size + MEMORY, size + MEMORY))
            resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            resource.setrlimit(resource.RLIMIT_FSIZE, (FILE, FILE))
            warnings.simplefilter("default")
            os.chdir(self._work)
            status = main(case.words)
        except BaseException:
            traceback.print_exc()
        finally:
            try:
                sys.stdout.flush()
                sys.stderr.flush()
            finally:
                os._exit(status)


def verdict(status: int, err: str, taken: float) -> str | None:
    """What is wrong with how a case ended; None: nothing."""
    if taken > SECONDS:
        return f"takes {taken:.0f} s"
    if "Traceback (most recent call last)" in err:
        return "a traceback"
    if status < 0:
        return f"killed by signal {-status}"
    if "more memory than there is" in err:
        return "more than 1 GB"
    if status not in (0, 1, 2):
        return f"status {status}"
    if status == 2:
        lines = err.splitlines()
        if len(lines) != 1 or not lines[0].startswith("sculler: ") or err[-1:] != "\n":
            return "status 2 without a line, or with more than one"
    elif err:
        return f"status {status}, and words on stderr"
    return None


def _spoilt_words(rng: random.Random, words: list[str]) -> list[str]:
    words = list(words)
    for _ in range(rng.choice((1, 1, 2))):
        free = [at for at in range(1, len(words)) if "=" not in words[at]]
        if not free:
            break
        at, kind = rng.choice(free), rng.randrange(8)
        if kind < 4:
            words[at] = rng.choice(NUMBERS)
        elif kind == 4:
            words[at] = rng.choice(PIECES) + words[at]
        elif kind == 5:
            words[at] = words[rng.choice(free)]
        elif kind == 6:
            del words[at]
        else:
            words.insert(at, words[at])
    return [word.replace("\0", "") for word in words]

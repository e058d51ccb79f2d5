"""`python -m fuzz --seed 1 --cases 5000`: status 1 if there are findings, each saved."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
import tempfile
import time
from pathlib import Path

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[threads] = "1"  # a forked child has none of its parent's

SAVED = Path(__file__).parents[2] / "build" / "fuzz"


def main() -> int:
    """Run, tell, save."""
    parser = argparse.ArgumentParser(prog="python -m fuzz", description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=5000, help="how many to run")
    parser.add_argument("--case", type=int, help="run this one only, as a finding names it")
    parser.add_argument("--target", help="only targets whose name begins so")
    parser.add_argument("--save", type=Path, default=SAVED, help="folder for findings")
    options = parser.parse_args()

    with tempfile.TemporaryDirectory(prefix="sculler-fuzz-") as folder:
        os.environ["SCULLER_CACHE"] = f"{folder}/cache"
        from fuzz.running import Bench, Case, Finding
        from fuzz.targets import TARGETS

        # the first cases are one of each target in turn
        if options.case is not None:
            reached = TARGETS
        elif options.target is not None:
            reached = tuple(each for each in TARGETS if each.name.startswith(options.target))
        else:
            reached = TARGETS[: options.cases]
        bench = Bench(Path(folder) / "bench", reached)

        def cases():  # type: ignore[no-untyped-def]
            number = count = 0
            while count < options.cases:
                case: Case | None = bench.case(options.seed, number)
                number += 1
                if case and case.target.name.startswith(options.target or ""):
                    count += 1
                    yield case

        def save(finding: Finding) -> None:
            case = finding.case
            home: Path = options.save / f"{case.target.name}_{case.seed}_{case.number}"
            home.mkdir(parents=True, exist_ok=True)
            if case.content is not None:
                (home / case.target.file).write_bytes(case.content)
            (home / "command.txt").write_text(
                f"sculler {shlex.join(case.words)}\n"
                f"again: cd tests && python -m fuzz --seed {case.seed} --case {case.number}\n"
                f"{finding.what}\n{finding.said}",
                errors="backslashreplace",
            )
            last = (finding.said.strip().splitlines() or [""])[-1][:150]
            print(
                f"{case.target.name} {case.seed}:{case.number}: {finding.what}: {last}", flush=True
            )

        one = None if options.case is None else [bench.case(options.seed, options.case)]
        began, found = time.monotonic(), 0
        for finding in bench.run(cases() if one is None else one):
            save(finding)
            found += 1
        total = sum(bench.ran.values())
        taken = time.monotonic() - began
        for name, count in bench.ran.items():
            print(f"  {name}: {count}")
        print(f"seed {options.seed}: {total} cases, {found} findings, {taken:.0f} s")
    return int(found > 0)


if __name__ == "__main__":
    sys.exit(main())

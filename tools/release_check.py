"""Builds the wheel and the sdist and tries them as a stranger would: `make release-check`.

What is built stays in build/release, for `twine upload`.  Everything else happens in a folder
outside the tree, in fresh environments that hold the wheel and nothing of this checkout.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Mapping
from email import message_from_bytes
from email.message import Message
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NoReturn

from readme_renderer import markdown

ROOT = Path(__file__).resolve().parents[1]
OUTPUT = ROOT / "build" / "release"
SOURCES = ("cli/", "hdl/", "model/", "sim/")
EXTRAS = "sim,plots,formats,campaign,fast,frames,place"
TESTERS = ("pytest>=8.2,<10", "pytest-xdist>=3.5,<4", "hypothesis>=6.100,<7")


def main() -> None:
    """Every check in turn; the first that fails ends it."""
    tracked = set(run("git", "ls-files", cwd=ROOT).split("\n")) - {""}
    for old in OUTPUT.glob("sculler-*"):
        old.unlink()
    run(sys.executable, "-m", "build", "--outdir", OUTPUT, ROOT)
    (sdist,), (wheel,) = OUTPUT.glob("*.tar.gz"), OUTPUT.glob("*.whl")
    run(sys.executable, "-m", "twine", "check", "--strict", sdist, wheel)
    check_sdist(sdist, tracked)
    metadata = check_wheel(wheel, tracked)
    check_readme(metadata, tracked)
    with TemporaryDirectory(prefix="sculler-release-") as name:
        folder = Path(name)
        with tarfile.open(sdist) as archive:
            archive.extractall(folder, filter="data")
        unpacked = folder / sdist.name.removesuffix(".tar.gz")
        check_base(folder, wheel, unpacked, metadata["Version"])
        check_full(folder, wheel, unpacked)
    told(f"ready: {OUTPUT.relative_to(ROOT)}/{wheel.name} and {sdist.name}")


def check_sdist(sdist: Path, tracked: set[str]) -> None:
    """The sdist holds what git tracks: sources, tests, examples, docs."""
    with tarfile.open(sdist) as archive:
        held = {name.partition("/")[2] for name in archive.getnames()}
    wanted = {name for name in tracked if not name.startswith(".ci/")}
    same(f"{sdist.name}: files", held - {"PKG-INFO"}, wanted)


def check_wheel(wheel: Path, tracked: set[str]) -> Message:
    """The wheel holds the packages whole, and the examples; gives its metadata."""
    with zipfile.ZipFile(wheel) as archive:
        held = set(archive.namelist())
        (path,) = (name for name in held if name.endswith(".dist-info/METADATA"))
        metadata = message_from_bytes(archive.read(path))
    wanted = {name.partition("/")[2] for name in tracked if name.startswith(SOURCES)}
    data = path.replace(".dist-info/METADATA", ".data/data/share/sculler/")
    wanted |= {data + name for name in tracked if name.startswith("examples/")}
    same(f"{wheel.name}: files", {name for name in held if ".dist-info/" not in name}, wanted)
    for field in ("License-Expression", "License-File", "Project-URL", "Classifier", "Author"):
        if field not in metadata:
            fail(f"{wheel.name}: no {field} in its metadata, mend pyproject.toml")
    return metadata


def check_readme(metadata: Message, tracked: set[str]) -> None:
    """The README shows away from the repository: it renders, and each address is a whole one."""
    text = metadata.get_payload()
    page = markdown.render(text)
    if page is None:
        fail("README.md does not render")
    addresses = re.findall(r'(?:src|href)="([^"]*)"', page)
    ours = re.compile(rf"https://[\w.]+/sculler/sculler/(?:blob/)?v{metadata['Version']}/(.*)")
    for address in addresses:
        if not address.startswith(("https://", "#")):
            fail(f"README.md: {address} is relative, and nothing off the repository")
        found = ours.fullmatch(address)
        if found is not None and found[1].partition("#")[0] not in tracked:
            fail(f"README.md: there is no {found[1]}")
    told(f"README.md renders, with {len(addresses)} whole addresses")


def check_base(folder: Path, wheel: Path, unpacked: Path, version: str) -> None:
    """The wheel alone: every verb works, and says what an absent extra would bring."""
    here = install(folder / "base", wheel)
    if version not in run(here / "sculler", "--version", cwd=folder):
        fail(f"sculler --version does not say {version}")
    run(here / "pip", "install", "--quiet", *TESTERS)
    require_installed(here, unpacked)
    told(tried(here, unpacked, "tests/cli/test_base_install.py", SCULLER_BASE="1"))


def check_full(folder: Path, wheel: Path, unpacked: Path) -> None:
    """The wheel with all its extras: every verb without anything left out; the demo; the tests."""
    here = install(folder / "full", f"{wheel}[{EXTRAS}]")
    sys.path.insert(0, str(unpacked / "tests"))
    from every_verb import COMMANDS

    work = folder / "work"
    work.mkdir()
    prepare = "import every_verb, pathlib; every_verb.prepare(pathlib.Path())"
    run(here / "python", "-c", prepare, cwd=work, PYTHONPATH=str(unpacked / "tests"))
    for command in [*COMMANDS.values(), "demo"]:
        if "pip install" in run(here / "sculler", *command.split(), cwd=work):
            fail(f"sculler {command}: something is left out, with all extras")
    run(here / "pip", "install", "--quiet", *TESTERS, "pandas>=2,<4", "python-ins>=1.0,<2")
    require_installed(here, unpacked)
    told(tried(here, unpacked, "--collect-only", "tests"))


def install(place: Path, what: Path | str) -> Path:
    """A fresh environment with the wheel; gives the folder of its programs."""
    run(sys.executable, "-m", "venv", place)
    run(place / "bin" / "pip", "install", "--quiet", what)
    return place / "bin"


def require_installed(here: Path, unpacked: Path) -> None:
    """Whether tests in the unpacked sdist use the wheel."""
    where = run(here / "python", "-c", "import sculler; print(sculler.__file__)", cwd=unpacked)
    if not where.startswith(str(here.parent)):
        fail(f"tests would use {where.strip()}, not the wheel")


def tried(here: Path, unpacked: Path, *words: str, **environment: str) -> str:
    """What pytest says last."""
    said = run(here / "pytest", "-q", "-p", "no:cacheprovider", *words, cwd=unpacked, **environment)
    return f"{words[-1]}: {said.strip().splitlines()[-1].strip('= ')}"


def same(what: str, held: set[str], wanted: set[str]) -> None:
    """Whether two sets of files are one."""
    faults = {"missing": wanted - held, "too much": held - wanted}
    for fault, names in faults.items():
        if names:
            fail(f"{what} {fault}: {', '.join(sorted(names)[:20])}")
    told(f"{what}: {len(held)}, as they should be")


def run(*words: str | Path, cwd: Path | None = None, **environment: str) -> str:
    """What a command says; its failure ends the check."""
    print("+", *words, flush=True)
    clean: Mapping[str, str] = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    done = subprocess.run(
        [str(word) for word in words],
        cwd=cwd,
        env={**clean, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode:
        fail(f"{done.stdout}\nfailed with status {done.returncode}: {' '.join(map(str, words))}")
    return done.stdout


def told(text: str) -> None:
    """Say what holds."""
    print(f"  {text}", flush=True)


def fail(text: str) -> NoReturn:
    """End with status 1."""
    raise SystemExit(text)


if __name__ == "__main__":
    main()

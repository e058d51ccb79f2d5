"""What is corrupted: valid examples of every input, and the verbs that read them."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from shutil import which
from typing import Any, NamedTuple

import numpy as np

from fuzz.recordings import write_recordings
from sculler.main import main


class Target(NamedTuple):
    """An input of a verb.

    Attributes:
        name: of the target.
        file: the example that is corrupted; "" for the words of the command.
        words: the command, with {} for the corrupted file; examples by their names.
        every: run only each so many rounds, because it is slow.
        programs: it runs programs, whose memory has no bounds here.
    """

    name: str
    file: str
    words: str
    every: int = 1
    programs: bool = False


CONVERT = "convert {} -o out.csv --design inc.toml"
RATES = CONVERT + " --gyro-unit rad/s --accel-unit m/s2 --time-column t"
COUNTS = CONVERT + " --gyro-unit counts --accel-unit counts"
MATRIX = CONVERT + " --variable imu --gyro-unit rad --accel-unit m/s --time-column 7"
RAW = "convert {} -o out.csv --design wide.toml"
FAST = RAW.replace("wide.toml", "fast.toml")
HDF5 = RAW + " --gyro-unit rad/s --accel-unit m/s2"
PLACE = " --lat 47 --lon 8 --height 400"
NAVIGATE = "navigate inc.toml {} -o out.csv --no-plots" + PLACE
ATTITUDE = "navigate inc.toml {} -o out.csv --no-plots --attitude-only --lat 47 --rest 2:9"
CALIBRATED = COUNTS.format("log.csv") + " --calibration {}"
RESULTS = NAVIGATE.format("vectors.csv") + " --calibration {}"
TRUTH = "navigate inc.toml vectors.csv -o out.csv --no-plots --truth {}"
MOTION = "motion {} -o out.csv --truth t.csv --duration=1"
ADVISE = "advise inc.toml --spectrum {} --drift 0.01 -o out.toml"
SIMULATE = "simulate tiny.toml {} -o out.csv --engine amaranth"
TURNED = " --gyro-bias 1,2,3 --axes y,x,-z --max-gap 1 --gaps bridge --misalignment 0.1,0,0"
GIVEN = " --heading 3 --vn 2 --start 0.08 --axes x,y,z --height-damping 100 --position-every 2"
SHAKEN = " --lat 4 --half-angle 1 --frequency 9 --vibration 0.1 --vibration-band 5-20"
FAMILY = "--family time-taylor --samples 3 --history 0 --minors 2 --rate 100 --half-angle 0.1"

NEEDED_FOR_CHIPS = (which("riscv64-unknown-elf-gcc"), find_spec("pythondata_cpu_vexriscv"))
"""A compiler, and a package of a processor's Verilog."""

ALIGNED = " --align 60 --gyro-noise 0.15 --accel-noise 0.07 --fine --memory 256"
CHIPS = (
    Target("soc", "chip.toml", f"soc {{}} -o out{PLACE}", 20, programs=True),
    Target("soc-truth", "truth.csv", "soc chip.toml -o out --truth {}", 20, programs=True),
    Target("options-soc", "", f"soc chip.toml -o out{PLACE}{ALIGNED}", 20, programs=True),
)

TARGETS = (
    Target("design", "inc.toml", "model {} log.csv -o out.csv"),
    Target("design-rate", "rate.toml", "coefficients --design {}"),
    Target("design-table", "table.toml", "coefficients --design {} --json"),
    Target("design-tuned", "tuned.toml", "coefficients --design {}", 2),
    Target("design-sinc", "sinc.toml", "coefficients --design {}"),
    Target("design-band", "band.toml", "coefficients --design {}", 2),
    Target("design-motion", "hires.toml", MOTION.format("turn --design {}"), 2),
    Target("design-analyze", "inc.toml", "analyze coning {} --points 20 --integer-points 2", 4),
    Target("design-generate", "tiny.toml", "generate {} -o out", 20, programs=True),
    Target("points", "truth.csv", "motion --from {} --design inc.toml -o out.csv --truth t.csv", 4),
    Target("campaign", "campaign.toml", "campaign {} -o out --dry-run", 2),
    Target("response", "response.csv", "coefficients --design tuned.toml", 2),
    Target("spectrum", "psd.csv", "analyze vibration inc.toml --spectrum {}", 4),
    Target("spectrum-advise", "psd.csv", ADVISE, 10),
    Target("manoeuvre", "roll.csv", "advise inc.toml --manoeuvre {} --angle 1 --host-rate 1", 10),
    Target("log", "log.csv", "model inc.toml {} -o out.csv"),
    Target("log-fault", "faulty.csv", "model rate.toml {} -o out.csv --engine reference"),
    Target("log-simulate", "short.csv", SIMULATE, 10),
    Target("log-npz", "counts.npz", "model inc.toml {} -o out.parquet"),
    Target("log-parquet", "counts.parquet", "model inc.toml {} -o out.npz"),
    Target("vectors", "vectors.csv", NAVIGATE),
    Target("vectors-npz", "hires.npz", NAVIGATE.replace("inc.toml", "hires.toml")),
    Target("vectors-parquet", "vectors.parquet", NAVIGATE.replace("out.csv", "out.npz")),
    Target("vectors-align", "rest.csv", NAVIGATE + " --align 11 --fine", 2),
    Target("calibration", "calibration.toml", CALIBRATED, 4),
    Target("calibration-results", "linear.toml", RESULTS, 4),
    Target("vectors-attitude", "rest.csv", ATTITUDE, 4),
    Target("vectors-hires", "hires.csv", NAVIGATE.replace("inc.toml", "hires.toml")),
    Target("vectors-report", "vectors.csv", NAVIGATE.replace("--no-plots", "--report r.html"), 20),
    Target("compare-a", "vectors.csv", "compare {} vectors2.csv"),
    Target("compare-b", "vectors.csv", "compare vectors2.csv {} --json"),
    Target("compare-npz", "vectors.npz", "compare {} vectors2.csv"),
    Target("compare-parquet", "vectors.parquet", "compare vectors2.csv {}"),
    Target("truth", "truth.csv", TRUTH),
    Target("truth-euler", "euler.csv", TRUTH),
    Target("truth-npz", "truth.npz", TRUTH),
    Target("truth-mat", "truth.mat", TRUTH, 4, programs=True),
    Target("truth-parquet", "truth.parquet", TRUTH),
    Target("truth-frames", "truth.frames", TRUTH),
    Target("convert-csv", "rates.csv", RATES),
    Target("convert-resample", "rates.csv", RATES + " --steps resample --axes RFU"),
    Target("convert-bridge", "rates.csv", RATES + " --gaps bridge --start 0.1"),
    Target("convert-counts", "log.csv", COUNTS),
    Target("convert-euroc", "euroc.csv", CONVERT),
    Target("convert-ros", "ros.csv", CONVERT),
    Target("convert-kfgins", "kfgins.txt", CONVERT),
    Target("convert-kfgins-binary", "kfgins.bin", CONVERT + " --format kfgins-binary"),
    Target("convert-auto-binary", "kfgins.bin", CONVERT),
    Target("convert-psins", "log.imu", CONVERT),
    Target("convert-npz", "log.npz", CONVERT),
    Target("convert-mat", "log.mat", MATRIX, 4, programs=True),
    Target("convert-hdf5", "imu.h5", HDF5, 4, programs=True),
    Target("convert-parquet", "log.parquet", RATES),
    Target("convert-stim300", "stim300.bin", FAST + " --gyro-unit counts --accel-unit counts"),
    Target("convert-novatel", "novatel.bin", RAW),
    Target("convert-vectornav", "vectornav.bin", RAW),
    Target("convert-xsens", "xsens.bin", RAW),
    Target("convert-adis16495", "adis16495.bin", RAW + " --gyro-unit counts --accel-unit counts"),
    Target("convert-adis16470", "adis16470.bin", RAW + " --gyro-unit counts --accel-unit counts"),
    Target("convert-hg4930", "hg4930.bin", RAW + " --gaps ignore"),
    Target("convert-bag", "imu.bag", RAW, 2),
    Target("convert-mcap", "imu.mcap", RAW, 2),
    Target("convert-db3", "imu.db3", RAW, 2),
    Target("options-convert", "", RATES.format("rates.csv") + TURNED),
    Target("options-navigate", "", NAVIGATE.format("vectors.csv") + GIVEN),
    Target("options-motion", "", MOTION.format("coning --design inc.toml") + SHAKEN),
    Target("options-analyze", "", f"analyze coning inc.toml {FAMILY} --points 20", 4),
    Target("options-coefficients", "", "coefficients --family time-taylor --samples 3 --history 1"),
    Target("options-simulate", "", SIMULATE.format("short.csv") + " --stall 1 --wave w.vcd", 10),
    *(CHIPS if all(there is not None for there in NEEDED_FOR_CHIPS) else ()),
)
"""A new format is a line here, and its example in `examples`."""


CHIP = """preset = "stim300"
name = "chip"
[sensor]
sample_rate_hz = 125.0
[hardware]
core = "compact"
[hardware.bus]
result = "wishbone"
[hardware.front]
sensor = "stim300"
clock_hz = 1843200.0
baud = 115200.0
"""

DESIGN = """name = "{name}"
[sensor]
kind = "{kind}"
sample_rate_hz = 100.0
gyro = {{ bits = 24, lsb = 1e-7 }}
accel = {{ bits = 24, lsb = 1e-5 }}
[algorithm]
family = "{family}"
samples = 2
minors = {minors}
{more}
"""


def _designs() -> dict[str, str]:
    def design(
        name: str, more: str = "", kind: str = "increment", family: str = "frequency-taylor"
    ) -> str:
        return DESIGN.format(name=name, kind=kind, family=family, minors=2, more=more)

    tiny = design("tiny").replace("bits = 24", "bits = 8").replace("minors = 2", "minors = 1")
    sinc = 'filter = { kind = "sinc", width_samples = 1.0 }\ndenominator_bits = 12'
    return {
        "inc": design("inc", "history = 1"),
        "rate": design("rate", kind="rate", family="filtered-rate"),
        "table": design(
            "own_table",
            "[algorithm.table]\ndenominator = 3\ntaps = [[], [2, -1]]\nsum_denominator = 1\n"
            "weights = [1, 1]",
            family="table",
        ),
        "tuned": design(
            "tuned",
            'filter = { kind = "measured", file = "response.csv" }\n'
            "band = { low_hz = 1.0, high_hz = 40.0 }\ndenominator_bits = 16\n"
            'match = "least-squares"',
            kind="rate",
            family="tuned",
        ),
        "band": design(
            "band",
            "band = { low_hz = 1.0, high_hz = 20.0, psd = [[1.0, 1.0], [20.0, 2.0]] }\n"
            "denominator_bits = 20\n",
            family="least-squares",
        ),
        "sinc": design("sinc", sinc, kind="rate", family="tuned"),
        "hires": design("hires", 'position = "high-resolution"'),
        "wide": design("wider").replace("bits = 24", "bits = 32").replace("e-7", "e-9").replace(
            "e-5", "e-7"
        ),
        "fast": design("fast").replace("= 100.0", "= 2000.0"),
        "tiny": tiny + '[hardware]\ncore = "compact"\nmultipliers = 0\n',
    }  # fmt: skip


def examples(folder: Path) -> dict[str, bytes]:
    """Write a valid example of every input into a folder; their contents by name."""
    for name, text in _designs().items():
        (folder / f"{name}.toml").write_text(text)
    (folder / "response.csv").write_text(
        "freq_hz,gain\n" + "".join(f"{f},{1 / (1 + (f / 60) ** 2):.6f}\n" for f in range(0, 60, 5))
    )
    (folder / "chip.toml").write_text(CHIP)
    linear = "[gyro]\nbias = [1.0, 2.0, -3.0]\nmisalignment = [1, 2, 3, 4, 5, 6]\n"
    (folder / "linear.toml").write_text(linear + "[accel]\nscale_factor = 100.0\n")
    (folder / "calibration.toml").write_text("delay_samples = 0.5\n" + linear)
    (folder / "campaign.toml").write_text(
        'runs = 2\nseconds = 0.5\n[motion]\nname = "turn"\n[[design]]\nfile = "inc.toml"\n'
        "errors = { gyro = { random_walk = 0.1, bias = { sigma = 2 } } }\n"
    )
    rolled = "0,0,0,0,0,0,-1\n0.2,40,5,0,0.1,0.5,-1.2\n0.4,0,0,0,0,0,-1\n"
    (folder / "roll.csv").write_text(
        f"time_s,rate_x,rate_y,rate_z,force_x,force_y,force_z\n{rolled}"
    )
    (folder / "psd.csv").write_text("freq_hz,psd_g2_per_hz\n2,0.01\n10,0.04\n40,0.001\n")
    rng = np.random.default_rng(1)
    header = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"
    counts = rng.integers(-3000, 3000, (240, 6)) + np.array([0, 0, 0, 0, 0, -9800])
    _rows(folder / "log.csv", header, counts)
    _rows(
        folder / "faulty.csv", header + ",fault", np.column_stack([counts, rng.integers(0, 2, 240)])
    )
    _rows(folder / "short.csv", header, rng.integers(-128, 128, (7, 6)))

    def run(*words: str) -> None:
        assert main(words) == 0, words

    run(*f"motion turn --design {folder}/inc.toml -o {folder}/turn.csv --truth {folder}/truth.csv"
        " --duration 4".split())  # fmt: skip
    run("model", f"{folder}/inc.toml", f"{folder}/turn.csv", "-o", f"{folder}/vectors.csv")
    run(*f"motion rest --design {folder}/inc.toml -o {folder}/s.csv --truth {folder}/st.csv"
        " --duration 12".split())  # fmt: skip
    run("model", f"{folder}/inc.toml", f"{folder}/s.csv", "-o", f"{folder}/rest.csv")
    (folder / "vectors2.csv").write_bytes((folder / "vectors.csv").read_bytes())
    run("model", f"{folder}/hires.toml", f"{folder}/turn.csv", "-o", f"{folder}/hires.csv")
    for kind in ("npz", "parquet"):
        design, turn = f"{folder}/inc.toml", f"{folder}/turn.csv"
        run("model", design, turn, "-o", f"{folder}/vectors.{kind}")
        run("model", f"{folder}/hires.toml", turn, "-o", f"{folder}/hires.{kind}")
        arrays = dict(zip(header.split(","), counts.T.copy(), strict=True))
        CONTAINERS[kind](folder / f"counts.{kind}", arrays)
    _truths(folder)
    run(*f"navigate {folder}/inc.toml {folder}/vectors.csv -o {folder}/n.csv --no-plots"
        f" --truth {folder}/truth.csv --telemetry {folder}/truth.frames".split())  # fmt: skip
    _logs(folder, rng)
    write_recordings(folder)
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def _rows(path: Path, header: str, table: Any) -> None:
    lines = [",".join(map(str, row)) for row in table.tolist()]
    path.write_text("\n".join([header, *lines, ""] if header else [*lines, ""]))


def _truths(folder: Path) -> None:
    lines = (folder / "truth.csv").read_text().splitlines()
    names = lines[0].split(",")
    table = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    truth = {name: table[:, at].copy() for at, name in enumerate(names)}
    euler = [name for name in names if not name.startswith("q_")]
    _rows(folder / "euler.csv", ",".join(euler), np.column_stack([truth[name] for name in euler]))
    for suffix, save in CONTAINERS.items():
        save(folder / f"truth.{suffix}", truth)


def _logs(folder: Path, rng: np.random.Generator) -> None:
    time = np.arange(120) / 100
    gyro = 0.1 * rng.standard_normal((120, 3))
    accel = rng.standard_normal((120, 3)) + np.array([0, 0, -9.8])
    rates = np.column_stack([time, gyro, accel]).round(6)
    _rows(folder / "rates.csv", "t," + "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z", rates)
    stamps = 1_403_636_579_758_555_392 + 10_000_000 * np.arange(120)
    cells = np.column_stack([stamps.astype(object), rates[:, 1:].astype(object)])
    euroc = ("#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
             "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]")  # fmt: skip
    _rows(folder / "euroc.csv", euroc, cells)
    ros = "%time," + ",".join(
        f"field.{part}.{axis}"
        for part in ("angular_velocity", "linear_acceleration")
        for axis in "xyz"
    )
    _rows(folder / "ros.csv", ros, cells)
    increments = np.column_stack([time + 0.01, 0.01 * gyro, 0.01 * accel])
    (folder / "kfgins.txt").write_text(
        "".join("  ".join(f"{x:.9f}" for x in row) + "\n" for row in increments.tolist())
    )
    (folder / "kfgins.bin").write_bytes(increments.astype("<f8").tobytes())
    head = "% PSINS log\n0 0 0 0 0 0\n34.2 108.9 380 0 10 9.797\n0.1 0.1 0.1 125 125 125\n"
    body = rng.integers(-2000, 2000, (120, 6)).tolist()
    (folder / "log.imu").write_text(head + "".join(" ".join(map(str, row)) + "\n" for row in body))
    CONTAINERS["npz"](folder / "log.npz", _npz_log(time, gyro, accel))
    CONTAINERS["mat"](folder / "log.mat", {"imu": np.column_stack([increments[:, 1:], time])})
    names = ("t", "gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")
    CONTAINERS["parquet"](folder / "log.parquet", dict(zip(names, rates.T.copy(), strict=True)))


def _npz_log(time: Any, gyro: Any, accel: Any) -> dict[str, Any]:
    return {
        "time": time, "gyro": gyro, "accel": accel, "fault": np.zeros(len(time), np.uint8),
        "gyro_unit": np.array("rad/s"), "accel_unit": np.array("m/s2"), "time_unit": np.array("s"),
    }  # fmt: skip


def _save_npz(path: Path, arrays: dict[str, Any]) -> None:
    np.savez_compressed(path, **arrays)


def _save_mat(path: Path, arrays: dict[str, Any]) -> None:
    from scipy.io import savemat

    savemat(
        path, {name[:31]: array for name, array in arrays.items()}, do_compression=len(arrays) > 3
    )


def _save_parquet(path: Path, arrays: dict[str, Any]) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = {name: pa.array(np.asarray(a).ravel().tolist()) for name, a in arrays.items()}
    pq.write_table(pa.table(columns), path)


CONTAINERS: dict[str, Callable[[Path, dict[str, Any]], None]] = {
    "npz": _save_npz,
    "mat": _save_mat,
    "parquet": _save_parquet,
}
"""Files of named arrays: how to write them."""


def arrays_of(path: Path) -> dict[str, Any]:
    """The arrays of such a file."""
    if path.suffix == ".npz":
        with np.load(path) as arrays:
            return dict(arrays)
    if path.suffix == ".mat":
        from scipy.io import loadmat

        return {name: array for name, array in loadmat(path).items() if name[0] != "_"}
    import pyarrow.parquet as pq

    return {
        name: column.to_numpy() for name, column in zip(*_columns(pq.read_table(path)), strict=True)
    }


def _columns(table: Any) -> tuple[list[str], list[Any]]:
    return table.column_names, table.columns

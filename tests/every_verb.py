"""A command of every verb on a handful of small files, for tests of what all verbs must bear."""

from __future__ import annotations

from pathlib import Path

from sculler.main import main

DESIGN = """
name = "little"
[sensor]
kind = "increment"
sample_rate_hz = 100.0
gyro = { bits = 16, lsb = 1e-5 }
accel = { bits = 16, lsb = 1e-4 }
[algorithm]
family = "frequency-taylor"
samples = 2
minors = 2
"""

SMALL = """
[hardware]
core = "compact"
target = "ice40"
"""
"""A core of the design that has room in the device that `place` names."""

COMMANDS = {
    "coefficients": "coefficients --design little.toml",
    "generate": "generate little.toml -o core",
    "model": "model little.toml log.csv -o m.csv",
    "simulate": "simulate little.toml log.csv -o rtl.csv --engine amaranth",
    "compare": "compare v.csv v.csv",
    "convert": "convert rates.csv -o c.csv --design little.toml --time-column t --gyro-unit rad/s"
    " --accel-unit m/s2 --axes RFU",
    "motion": "motion turn --design little.toml -o imu.csv --truth t.csv --duration 1",
    "navigate": "navigate little.toml v.csv -o nav.csv --report nav.html --truth truth.csv",
    "campaign": "campaign campaign.toml -o campaign --workers 1",
    "align": "navigate little.toml v.csv -o nav.csv --lat 47 --lon 8 --height 1 --align 20",
    "coning": "analyze coning little.toml --points 20 --integer-points 2",
    "sculling": "analyze sculling little.toml --points 20 --integer-points 2",
    "manoeuvre": "analyze manoeuvre little.toml",
    "vibration": "analyze vibration little.toml --spectrum flat:5-40:0.01",
    "quantisation": "analyze quantisation little.toml --frequency 10",
    "third-order": "analyze third-order little.toml --frequency 10",
    "orders": "analyze orders little.toml --frequency 3 --seconds 1",
    "position": "analyze position little.toml --vibration 1 20 --over 1",
    "advise": "advise little.toml --coning 0.01 5 --drift 1 -o best.toml",
    "place": "place small.toml --device iCE40UP5K --seeds 1",
    "demo": "demo -o demo --seconds 1",
}


CAMPAIGN = """
runs = 2
seconds = 1.0
[motion]
name = "turn"
[[design]]
file = "little.toml"
"""


def prepare(folder: Path) -> None:
    """Write what the commands read into a folder."""
    (folder / "little.toml").write_text(DESIGN)
    (folder / "campaign.toml").write_text(CAMPAIGN)
    (folder / "small.toml").write_text(DESIGN + SMALL)
    rows = ["0,0,0,0,0,-980"] * 24
    header = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"
    (folder / "log.csv").write_text("\n".join([header, *rows, ""]))
    rates = [f"{k / 100:.2f},0.001,0,0,0,0,9.8" for k in range(100)]
    (folder / "rates.csv").write_text("\n".join([f"t,{header}", *rates, ""]))
    little = f"{folder}/little.toml"
    for words in (
        f"motion rest --design {little} -o {folder}/rest.csv --truth {folder}/truth.csv"
        " --duration 30",
        f"model {little} {folder}/rest.csv -o {folder}/v.csv",
    ):
        assert main(words.split()) == 0

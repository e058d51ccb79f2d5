"""Vibration through the mount, against Newton's law for four springs, brute force, a paper."""

from __future__ import annotations

from math import log, pi, sqrt
from pathlib import Path

import numpy as np
import pytest

from sculler_model.algorithms import filtered_rate, frequency_taylor
from sculler_model.analysis.vibration import (
    PROFILES,
    G,
    Mount,
    MountResponse,
    Plane,
    Spectrum,
    relative_error,
    respond,
    step_for,
    trial,
)
from sculler_model.design import Design
from sculler_model.errors import InputError

PAIR = Plane(stiffness=0.05, spread=0.05, offset=-0.014)


# spectra


def test_power_is_the_integral_of_straight_lines_on_log_log_paper() -> None:
    """0.04 flat, then 0.04 (1000/f)²: 39.2 + 20 g²."""
    profile = PROFILES["savage-98"]
    power = profile.power(np.array([1.0, 1000.0, 2000.0, 5000.0]))
    assert power == pytest.approx([0.04 * 980, 40_000 * (1 / 1000 - 1 / 2000), 0], rel=1e-12)
    assert profile.rms == pytest.approx(sqrt(59.2), rel=1e-12)
    assert profile.density(np.array([10.0, 500.0, 1000 * sqrt(2)])) == pytest.approx(
        [0, 0.04, 0.02]
    )


def test_power_of_a_slope_of_minus_one_is_a_logarithm() -> None:
    pink = Spectrum((10.0, 1000.0), (1.0, 0.01))
    assert pink.power(np.array([10.0, 1000.0])) == pytest.approx([10 * log(100)], rel=1e-12)


def test_bands_sum_to_the_whole_at_any_step() -> None:
    for step in (0.3, 7.0):
        response = respond(PROFILES["do160-like"], Mount(), step)
        assert response.input_rms / G == pytest.approx(PROFILES["do160-like"].rms, rel=1e-12)


def test_a_repeated_frequency_is_a_step() -> None:
    steps = Spectrum((10.0, 20.0, 20.0, 30.0), (1.0, 1.0, 2.0, 2.0))
    assert steps.power(np.array([0.0, 20.0, 40.0])) == pytest.approx([10, 20])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: the header must be freq_hz,psd_g2_per_hz"),
        ("f,psd\n1,1\n", "line 1"),
        ("freq_hz,psd_g2_per_hz\n10,0.1\n", "two points or more"),
        ("freq_hz,psd_g2_per_hz\n10,0.1\n20,many\n", "line 3: '20,many' is not two numbers"),
        ("freq_hz,psd_g2_per_hz\n10,0.1\n20,0.1,3\n", "line 3"),
        ("freq_hz,psd_g2_per_hz\n10,0.1\n5,0.1\n", "5 Hz follows 10 Hz"),
        ("freq_hz,psd_g2_per_hz\n10,0.1\n20,-1\n", "point 2"),
        ("freq_hz,psd_g2_per_hz\n0,0.1\n20,1\n", "point 1"),
        ("freq_hz,psd_g2_per_hz\n10,0.1\n20,nan\n", "point 2"),
        ("freq_hz,psd_g2_per_hz\n10,0.1\n10,1\n", "give a band"),
    ],
)
def test_malformed_spectra_are_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "psd.csv"
    path.write_text(text)
    with pytest.raises(InputError) as refused:
        Spectrum.load(path)
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


# the mount


def _springs(mount: Mount, frequency: np.ndarray) -> np.ndarray:
    """x'', θ_y, θ_z per unit of base acceleration from Newton's law for four isolators; (N, 3)."""
    m, L = 3.0, mount.spacing
    omega = 2 * pi * mount.hz
    k, c = m * omega**2, 2 * m * mount.damping * omega
    rows = []
    for f in frequency:
        s = 2j * pi * f
        matrix, right = np.zeros((3, 3), complex), np.zeros(3, complex)
        inertia = {}
        for name, plane in (("y", mount.y), ("z", mount.z)):
            ratio = plane.hz / mount.hz
            inertia[name] = k * L * L / 4 / (omega * ratio) ** 2
        matrix += np.diag([m, inertia["y"], inertia["z"]]) * s * s
        for sign_y in (1, -1):
            for sign_z in (1, -1):
                # along y lies the pair that turns it about z, and the other way round
                stiff = k / 4 * (1 + sign_y * mount.z.stiffness) * (1 + sign_z * mount.y.stiffness)
                damp = c / 4 * (1 + sign_y * mount.z.spread) * (1 + sign_z * mount.y.spread)
                y = sign_y * L / 2 - mount.z.offset * L
                z = sign_z * L / 2 - mount.y.offset * L
                # stretch e = x - X - θ_z y + θ_y z; the force -Z e acts on x, θ_y by z, θ_z by -y
                arm = np.array([1.0, z, -y])
                Z = stiff + damp * s
                matrix += Z * np.outer(arm, arm)
                right += Z * arm / (s * s)  # X = A/s²
        x, theta_y, theta_z = np.linalg.solve(matrix, right)
        rows.append((s * s * x, theta_y, theta_z))
    return np.array(rows)


def test_transfer_is_newtons_law_for_four_isolators() -> None:
    """To first order in the imbalances; damping of the rotary modes as the isolators give it."""
    hz, damping = 50.0, 0.125
    scale = 1e-4

    def plane(rotary: float, *values: float) -> Plane:
        return Plane(rotary, damping * rotary / hz, *(scale * value for value in values))

    mount = Mount(hz, damping, 0.3, plane(64.0, 2.0, -1.0, 0.5), plane(71.0, 1.0, 3.0, -0.7))
    frequency = np.array([5.0, 35.0, 50.0, 66.0, 80.0, 300.0, 1500.0])
    found = np.stack(mount.transfer(frequency), axis=1)
    assert found == pytest.approx(_springs(mount, frequency), rel=2e-3)


def test_coupling_takes_from_the_linear_mode_what_newtons_law_takes() -> None:
    """Second order, seen where nothing else of second order is: stiffness alone, one plane."""
    mount = Mount(z=Plane(100.0, 0.25, 0.3, 0.3, 0.0))
    frequency = np.array([30.0, 50.0, 90.0])
    assert np.stack(mount.transfer(frequency), 1) == pytest.approx(
        _springs(mount, frequency), rel=1e-9
    )


def test_white_noise_through_the_linear_mode() -> None:
    """π/2 f S (1 + 4ζ²)/(2ζ) from 0 Hz to far above (transmissibility of one mode)."""
    f, zeta, density = 50.0, 0.125, 0.04
    response = respond(Spectrum.flat(0.01, 20_000.0, density), Mount(f, zeta), 0.1)
    expected = sqrt(pi / 2 * f * density * (1 + 4 * zeta**2) / (2 * zeta))
    assert response.force_rms / G == pytest.approx(expected, rel=2e-3)
    assert response.angle_rms == (0.0, 0.0)


# rectification


def _tone(hertz: float, power: float, force: complex, y: complex, z: complex) -> MountResponse:
    values = (np.array([value]) for value in (force, y, z))
    return MountResponse(np.array([hertz]), 1.0, np.array([power]), *values)


def test_rectified_is_the_mean_of_the_cross_products() -> None:
    force, y, z = 1.3 - 0.4j, 0.02 + 0.01j, -0.03 + 0.02j
    hertz, power = 37.0, 2.0
    omega, amplitude = 2 * pi * hertz, sqrt(2 * power)
    t = np.arange(1000) / 1000 / hertz
    wave = amplitude * np.exp(1j * omega * t)
    zero = np.zeros_like(t)
    theta = np.stack((zero, np.real(y * wave), np.real(z * wave)), 1)
    rate = np.stack((zero, np.real(1j * omega * y * wave), np.real(1j * omega * z * wave)), 1)
    acceleration = np.stack((np.real(force * wave), zero, zero), 1)
    found = _tone(hertz, power, force, y, z).rectified
    assert found.sculling_force == pytest.approx(np.cross(theta, acceleration).mean(0), abs=1e-15)
    coning = 0.5 * np.cross(theta, rate).mean(0)
    assert [found.coning_rate, 0, 0] == pytest.approx(coning, abs=1e-15)


def test_worst_phase_is_reached_and_never_passed() -> None:
    for turn in np.linspace(0, 2 * pi, 9):
        response = _tone(40.0, 1.0, 2.0 + 0j, 0.01 + 0j, 0.02 * np.exp(1j * turn))
        worst, found = response.worst_phase, response.rectified
        assert abs(found.coning_rate) <= worst.coning_rate * (1 + 1e-12)
        assert np.all(np.abs(found.sculling_force) <= worst.sculling_force * (1 + 1e-12))
    reached = _tone(40.0, 1.0, 2.0 + 0j, 0.01 + 0j, -0.02j)
    assert reached.rectified.coning_rate == pytest.approx(reached.worst_phase.coning_rate)


def test_share_of_the_recursion_is_a_thirtieth() -> None:
    """λ⁴/30 of the true rate (Savage-98 Eq. 61)."""
    phase = np.array([0.01, 0.02])
    share = relative_error(frequency_taylor(1, 1), phase)
    assert share == pytest.approx(-(phase**4) / 30, rel=1e-3)


def test_poles_of_rate_sums_cancel_between_the_bands_beside_them() -> None:
    """The principal value hardly depends on the step, though λ = 2π/n is inside the band."""
    spectrum, mount = PROFILES["savage-98"], Mount.worst(0.05, 0.014)
    step = step_for(2, 2000.0)
    assert (1000.0 / step) == pytest.approx(round(1000.0 / step))
    table = filtered_rate(2, 0)
    found = [
        respond(spectrum, mount, s).rectified.errors(table, 1 / 2000, "rate").coning
        for s in (step, step / 2)
    ]
    assert found[0] == pytest.approx(found[1], rel=1e-3)


# Savage-98 section VI


def test_published_figures() -> None:
    """7.6 g, 3.6 g, 0.00038 rad, 1300 µg, 0.044 µg: the last two in the worst phase."""
    response = respond(PROFILES["savage-98"], Mount(z=PAIR))
    assert response.input_rms / G == pytest.approx(7.6, rel=0.02)
    assert response.force_rms / G == pytest.approx(3.6, rel=0.03)
    assert response.angle_rms[1] == pytest.approx(0.00038, rel=0.01)
    worst = response.worst_phase
    assert worst.sculling_force[1] / G * 1e6 == pytest.approx(1300, rel=0.01)
    error = worst.errors(frequency_taylor(1, 1), 1 / 2000).sculling[1]
    assert error / G * 1e6 == pytest.approx(0.044, rel=0.03)


def test_in_a_cascade_the_linear_mode_feels_no_imbalance() -> None:
    """And the paper's figures come out nearer: the back-reaction is all that is left out."""
    frequency = np.array([5.0, 50.0, 71.0, 300.0])
    balanced, _, _ = Mount().transfer(frequency)
    force, _, turned = Mount(z=PAIR, cascade=True).transfer(frequency)
    assert force == pytest.approx(balanced, rel=1e-14)
    coupled, _, other = Mount(z=PAIR).transfer(frequency)
    # e is the same share of both, for θ and for x - X: (θ/e) has no denominator D
    moved = 1 - coupled, 1 - force
    assert other / moved[0] == pytest.approx(turned / moved[1], rel=1e-12)

    worst = respond(PROFILES["savage-98"], Mount(z=PAIR, cascade=True)).worst_phase
    error = worst.errors(frequency_taylor(1, 1), 1 / 2000).sculling[1]
    assert error / G * 1e6 == pytest.approx(0.044, rel=5e-3)


# in time, through the integer path


def _fine(family: str, n: int, p: int, kind: str, rate: float) -> Design:
    scale = rate if kind == "rate" else 1.0
    return Design.parse(
        {
            "name": "fine",
            "sensor": {
                "kind": kind,
                "sample_rate_hz": rate,
                "gyro": {"bits": 32, "lsb": 1e-12 * scale},
                "accel": {"bits": 32, "lsb": 1e-9 * scale},
            },
            "algorithm": {"family": family, "samples": n, "history": p, "minors": 5},
        }
    )


@pytest.mark.parametrize(
    ("family", "n", "p", "kind"),
    [("frequency-taylor", 1, 1, "increment"), ("filtered-rate", 1, 0, "rate")],
)
def test_random_vibration_through_counts_core_and_host(
    family: str, n: int, p: int, kind: str
) -> None:
    spectrum, mount = PROFILES["savage-98"], Mount.worst(0.05, 0.014)
    design = _fine(family, n, p, kind, 2000.0)
    predicted = respond(spectrum, mount, step_for(n, 2000.0)).rectified
    left = predicted.errors(design.table, design.sample_interval, design.sensor.kind)
    found = [trial(design, spectrum, mount, 6.0, seed) for seed in range(10)]
    for values, expected in (
        ([t.coning for t in found], predicted.coning_rate),
        ([t.sculling[1] for t in found], predicted.sculling_force[1]),
        ([t.sculling[2] for t in found], predicted.sculling_force[2]),
        ([t.coning - t.true_coning for t in found], left.coning),
        ([t.sculling[1] - t.true_sculling[1] for t in found], left.sculling[1]),
        ([t.sculling[2] - t.true_sculling[2] for t in found], left.sculling[2]),
    ):
        sigma = float(np.std(values, ddof=1)) / sqrt(len(values))
        assert abs(np.mean(values) - expected) < 4 * sigma
    # the errors are seen well enough for the comparison to mean something
    errors = [t.coning - t.true_coning for t in found]
    assert np.std(errors, ddof=1) / sqrt(len(errors)) < 0.1 * abs(left.coning)


def test_a_trials_lines_lie_where_the_spectrum_does() -> None:
    """A narrow band on the mount's steep slope."""
    spectrum, mount = Spectrum.flat(100.0, 102.0, 1.0), Mount.worst(0.05, 0.014)
    expected = respond(spectrum, mount).rectified.sculling_force[1]
    design = _fine("frequency-taylor", 2, 0, "increment", 2000.0)
    found = [trial(design, spectrum, mount, 2.0, seed).true_sculling[1] for seed in range(60)]
    assert np.mean(found) == pytest.approx(expected, rel=0.3)


def test_a_trial_is_its_seed() -> None:
    design = Design.preset("stim300")
    a, b, c = (
        trial(design, PROFILES["savage-98"], Mount.worst(0.05, 0.014), 0.5, seed)
        for seed in (3, 3, 4)
    )
    assert a.coning == b.coning
    assert a.coning != c.coning

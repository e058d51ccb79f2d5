"""Rectified coning and sculling under random vibration through an isolator mount.

The vehicle shakes the mount along x with acceleration A (a power spectral density); the sensor
assembly hangs in isolators and answers with a motion x along the same axis and, because nothing is
perfectly balanced, with rotations θ_y and θ_z (rad, small).  Four isolators stand at (±L/2, ±L/2)
in the y-z plane and act along x with stiffness and damping Z_j = k_j + c_j s.  With the centre of
mass at (y_c, z_c) and X the vehicle's displacement, isolator j is stretched by

    e_j = x - X - θ_z (y_j - y_c) + θ_y (z_j - z_c)

and Newton's law for the mass m and the moment of inertia J gives

    m x'' = -Σ Z_j e_j,    J θ_z'' = Σ Z_j (y_j - y_c) e_j,    J θ_y'' = -Σ Z_j (z_j - z_c) e_j.

Let d = ω² + 2ζω s be the linear mode's spring and damper per mass, d_y and d_z those of the rotary
modes, and write the imbalance that couples the modes as

    κ_z = L⁻¹ Σ Z_j (y_j - y_c)/m = (ε_k/2 - δ) ω² + (ε_c/2 - δ) 2ζω s   (V1)

ε_k = (k_+ - k_-)/(k_+ + k_-) the stiffness imbalance of the isolators at +L/2 and -L/2, ε_c that of
their damping, δ = y_c/L the centre of mass's offset; κ_y likewise along z.  Four equal isolators
have Σ k_j y_j² = k L²/4, which ties the inertia to the modes: m L²/J = μ = 4 ω_r²/ω².  Then, with
e = x - X (products of two imbalances other than the coupling's own are left out),

    e/A = -1/D,      D = s² + d - μ_z κ_z²/(s² + d_z) - μ_y κ_y²/(s² + d_y)   (V2)
    a/A = 1 - s²/D                              acceleration of the centre of mass
    θ_z/A = -(μ_z/L) κ_z/((s² + d_z) D),   θ_y/A = +(μ_y/L) κ_y/((s² + d_y) D).

Savage-98 section VI and Savage-20 give frequencies, damping, imbalance and offset, but not their
model (Savage-98 Ref. 8) and not L.  (V1-V2) is the plainest model that has their parameters.

A vibration of mean square P at frequency Ω rectifies to (Savage-98 Eq. 38, Savage-20 Eq. 2)

    sculling  E[θ × a] = P (0, Re θ_z a*, -Re θ_y a*)                             m/s²
    coning  ½ E[θ × ω] = P (Ω Im θ_y θ_z*, 0, 0)                                  rad/s   (V3)

and an algorithm gets it wrong by the share 2 residual(λ)/(nλ), λ = ΩT, of `closed_form`, since
both are, frequency by frequency, the classical motions with a·b Ω/2 as their rate.  Different
frequencies do not correlate, so everything is a sum over frequency.

The phases between the motions are the most uncertain part of any mount model.  Whatever they are,

    |sculling| <= Σ P |θ| |a|,    |coning| <= Σ P Ω |θ_y| |θ_z|   (V4)

which `Response.worst_phase` gives; it is what Savage's published figures agree with
(docs/accuracy.md).
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, log, sqrt
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.algorithms import Response as Filter
from sculler_model.algorithms import SensorKind, TapTable
from sculler_model.analysis import closed_form, drift
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel
from sculler_model.host import second_order_corrections
from sculler_model.inputs import read_small
from sculler_model.samples import Quantiser

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

G = 9.80665
"""Standard gravity, m/s²: vibration is specified in multiples of it."""

STEP = 0.05
"""Widest step of the sums over frequency, Hz."""

HIGHEST = 1e5
"""Highest frequency of a spectrum, Hz: the sums have a term each `STEP`."""

DENSEST = 1e6
"""Largest density of a spectrum, g²/Hz, far above any vibration."""

COLUMNS = ("freq_hz", "psd_g2_per_hz")
"""Header of a spectrum file."""


@dataclass(frozen=True)
class Spectrum:
    """One-sided power spectral density, straight lines between points on log-log paper.

    Outside the points it is zero; a frequency given twice is a step.

    Attributes:
        frequencies: Hz, > 0, not falling.
        densities: g²/Hz, > 0.
        name: what it is.

    Raises:
        InputError: fewer than two points, or one that is not of this form.
    """

    frequencies: tuple[float, ...]
    densities: tuple[float, ...]
    name: str = "spectrum"

    def __post_init__(self) -> None:
        if len(self.frequencies) < 2 or len(self.frequencies) != len(self.densities):
            raise InputError(f"{self.name}: a vibration spectrum needs two points or more")
        for number, (frequency, density) in enumerate(
            zip(self.frequencies, self.densities, strict=True), start=1
        ):
            if not (0 < frequency <= HIGHEST and 0 < density <= DENSEST):
                raise InputError(
                    f"{self.name}: point {number}: {frequency:g} Hz, {density:g} g²/Hz is not"
                    f" allowed, give frequencies > 0 and <= {HIGHEST:,.0f} Hz and densities > 0 and"
                    f" <= {DENSEST:g} g²/Hz (outside its points a spectrum is zero)"
                )
        for before, after in pairwise(self.frequencies):
            if after < before:
                raise InputError(
                    f"{self.name}: {after:g} Hz follows {before:g} Hz, sort the points by frequency"
                )
        if self.frequencies[0] == self.frequencies[-1]:
            raise InputError(f"{self.name}: all points are at one frequency, give a band")

    @classmethod
    def flat(cls, low: float, high: float, density: float) -> Spectrum:
        """A flat band from low to high (Hz) of a density (g²/Hz)."""
        name = f"flat {density:g} g²/Hz, {low:g} to {high:g} Hz"
        return cls((low, high), (density, density), name)

    @classmethod
    def load(cls, path: str | Path) -> Spectrum:
        """Read a CSV with the header `freq_hz,psd_g2_per_hz`.

        Raises:
            InputError: it cannot be read or is not of this form; says the line.
        """
        text = read_small(path, "spectrum", f"a CSV {','.join(COLUMNS)}")
        try:
            lines = list(csv.reader(io.StringIO(text, newline="")))
        except csv.Error as error:
            raise InputError(f"{path}: not a CSV ({error}), give {','.join(COLUMNS)}") from error
        header = tuple(word.strip() for word in lines[0]) if lines else ()
        if header != COLUMNS:
            raise InputError(f"{path}: line 1: the header must be {','.join(COLUMNS)}")
        points = []
        for number, words in enumerate(lines[1:], start=2):
            if not any(word.strip() for word in words):
                continue
            try:
                frequency, density = map(float, words)
            except ValueError:
                raise InputError(
                    f"{path}: line {number}: {','.join(words)!r} is not two numbers, give a"
                    " frequency in Hz and a density in g²/Hz"
                ) from None
            points.append((frequency, density))
        frequencies, densities = zip(*points, strict=True) if points else ((), ())
        return cls(frequencies, densities, str(path))

    @classmethod
    def parse(cls, text: str) -> Spectrum:
        """A built-in profile's name, `flat:LOW-HIGH:DENSITY`, or a CSV file.

        Raises:
            InputError: it is none of these.
        """
        if text in PROFILES:
            return PROFILES[text]
        if text.startswith("flat:"):
            try:
                band, density = text.removeprefix("flat:").split(":")
                low, high = band.split("-")
                return cls.flat(float(low), float(high), float(density))
            except ValueError as error:
                if isinstance(error, InputError):
                    raise
                raise InputError(
                    f"{text}: not a flat band, give flat:LOW-HIGH:DENSITY in Hz and g²/Hz, such as"
                    " flat:20-2000:0.04"
                ) from None
        if Path(text).exists():
            return cls.load(text)
        raise InputError(
            f"{text}: no such spectrum, give a CSV file ({','.join(COLUMNS)}),"
            f" flat:LOW-HIGH:DENSITY, or one of {', '.join(PROFILES)}"
        )

    @property
    def highest(self) -> float:
        """The highest frequency, Hz."""
        return self.frequencies[-1]

    @property
    def rms(self) -> float:
        """Root mean square of all of it, g."""
        return sqrt(float(self.power(np.array([self.frequencies[0], self.highest]))[0]))

    def density(self, frequency: ArrayLike) -> Array:
        """g²/Hz at frequencies (Hz)."""
        frequency = np.asarray(frequency, np.float64)
        inside = (frequency >= self.frequencies[0]) & (frequency <= self.highest)
        value = np.exp(
            np.interp(
                np.log(np.where(inside, frequency, self.highest)),
                np.log(self.frequencies),
                np.log(self.densities),
            )
        )
        result: Array = np.where(inside, value, 0.0)
        return result

    def power(self, edges: Array) -> Array:
        """Mean square (g²) in each band between consecutive edges (Hz): the exact integral."""
        power: Array = np.diff(self._power_below(edges))
        return power

    def _power_below(self, frequency: Array) -> Array:
        """∫ of the density up to frequency, line by line: density = S (f/f0)^m."""
        total = np.zeros_like(frequency)
        for (f0, s0), (f1, s1) in pairwise(zip(self.frequencies, self.densities, strict=True)):
            if f1 == f0:
                continue
            slope = log(s1 / s0) / log(f1 / f0)
            x = np.log(np.clip(frequency, f0, f1) / f0)
            # ∫ = s0 f0 (e^((m+1)x) - 1)/(m+1), which is x where m = -1
            m1 = slope + 1
            total += s0 * f0 * (np.expm1(m1 * x) / m1 if abs(m1) > 1e-9 else x)
        return total


PROFILES: dict[str, Spectrum] = {
    # Savage-98 section VI, Savage-20: 0.04 g²/Hz to 1 kHz, falling to 0.01 g²/Hz at 2 kHz
    "savage-98": Spectrum((20.0, 1000.0, 2000.0), (0.04, 0.04, 0.01), "savage-98"),
    # the shape and level (4.1 g rms) of jet-fuselage curves of DO-160 section 8; not its letter
    "do160-like": Spectrum(
        (10.0, 28.0, 40.0, 500.0, 2000.0), (0.012, 0.012, 0.02, 0.02, 0.00125), "do160-like"
    ),
    # road and rail, unpaved: much of it below the isolators' resonance
    "vehicle-like": Spectrum(
        (5.0, 10.0, 40.0, 500.0), (0.015, 0.015, 0.002, 0.0001), "vehicle-like"
    ),
}


@dataclass(frozen=True)
class Plane:
    """A rotary mode and the imbalance that excites it.

    Attributes:
        hz, damping: undamped natural frequency (Hz) and damping ratio.
        stiffness, spread: ε_k and ε_c of (V1), imbalance of stiffness and of damping.
        offset: δ of (V1), the centre of mass's offset as a share of the isolators' distance.
    """

    hz: float = 71.0
    damping: float = 0.18
    stiffness: float = 0.0
    spread: float = 0.0
    offset: float = 0.0


@dataclass(frozen=True)
class Mount:
    """A sensor assembly in isolators, (V1-V2).

    Attributes:
        hz, damping: of the linear mode.
        spacing: L, m.
        y, z: the rotary modes about y and z.
    """

    hz: float = 50.0
    damping: float = 0.125
    spacing: float = 0.254
    y: Plane = Plane()
    z: Plane = Plane()

    @classmethod
    def worst(
        cls,
        imbalance: float,
        offset: float,
        *,
        hz: float = 50.0,
        damping: float = 0.125,
        rotary_hz: float = 71.0,
        rotary_damping: float = 0.18,
        spacing: float = 0.254,
    ) -> Mount:
        """The signs of given sizes of imbalance and offset that rectify most.

        About z everything adds up, which gives the most sculling; about y stiffness and damping
        are unbalanced in opposite senses, so that the two rotations differ most in phase, which
        gives the most coning.
        """
        y = Plane(rotary_hz, rotary_damping, imbalance, -imbalance, -offset)
        z = Plane(rotary_hz, rotary_damping, imbalance, imbalance, -offset)
        return cls(hz, damping, spacing, y, z)

    def transfer(self, frequency: Array) -> tuple[Complex, Complex, Complex]:
        """Responses to 1 m/s² of the vehicle, (V2).

        Args:
            frequency: (N,) Hz.

        Returns:
            Acceleration along x (m/s²), rotations about y and z (rad); (N,) each.
        """
        s = 2j * np.pi * frequency
        omega = 2 * np.pi * self.hz
        spring, damper = omega**2, 2 * self.damping * omega * s
        denominator = s * s + spring + damper
        rotations = []
        for plane, sign in ((self.y, 1.0), (self.z, -1.0)):
            rotary = 2 * np.pi * plane.hz
            coupling = (plane.spread / 2 - plane.offset) * damper
            coupling = coupling + (plane.stiffness / 2 - plane.offset) * spring
            compliance = 1 / (s * s + rotary**2 + 2 * plane.damping * rotary * s)
            gain = 4 * (plane.hz / self.hz) ** 2 * coupling * compliance
            denominator = denominator - gain * coupling
            rotations.append(sign / self.spacing * gain)
        force, y, z = (
            np.asarray(numerator / denominator, np.complex128)
            for numerator in (denominator - s * s, *rotations)
        )
        return force, y, z


@dataclass(frozen=True)
class Errors:
    """What an algorithm leaves of rectified vibration, computed minus true.

    Attributes:
        coning: about x, rad/s.
        sculling: (3,) m/s².
    """

    coning: float
    sculling: Array


@dataclass(frozen=True)
class Rectified:
    """Rectified vibration, band by band (V3).

    Attributes:
        frequency: (N,) band centres, Hz.
        coning: (N,) about x, rad/s.
        sculling: (N, 3) m/s².
        bound: whether these are bounds (V4), so that errors must not cancel between bands either.
    """

    frequency: Array
    coning: Array
    sculling: Array
    bound: bool = False

    @property
    def coning_rate(self) -> float:
        """Of all bands, rad/s."""
        return float(self.coning.sum())

    @property
    def sculling_force(self) -> Array:
        """(3,) of all bands, m/s²."""
        total: Array = self.sculling.sum(axis=0)
        return total

    def errors(
        self,
        table: TapTable,
        interval: float,
        kind: SensorKind = "increment",
        passed: Filter | None = None,
    ) -> Errors:
        """What a tap table leaves of it.

        Args:
            table: the tap table.
            interval: T, s.
            kind: what the samples are; for rates take a response of `step_for`.
            passed: the filter they passed; None: increments none, rates sinc(ΩT/2).
        """
        share = relative_error(table, 2 * np.pi * self.frequency * interval, kind, passed)
        if self.bound:
            share = np.abs(share)
        return Errors(float(self.coning @ share), share @ self.sculling)


@dataclass(frozen=True)
class Response:
    """The sensor assembly under a spectrum, in narrow bands of equal width.

    Attributes:
        frequency: (N,) band centres, Hz.
        step: their distance, Hz.
        power: (N,) mean square of the vehicle's acceleration in each band, (m/s²)².
        force, y, z: (N,) transfer functions of `Mount.transfer`.
    """

    frequency: Array
    step: float
    power: Array
    force: Complex
    y: Complex
    z: Complex

    @property
    def input_rms(self) -> float:
        """m/s²."""
        return sqrt(float(self.power.sum()))

    @property
    def force_rms(self) -> float:
        """Acceleration of the sensor assembly, m/s²."""
        return self._rms(self.force)

    @property
    def angle_rms(self) -> tuple[float, float]:
        """Rotations about y and z, rad."""
        return self._rms(self.y), self._rms(self.z)

    def _rms(self, transfer: Complex) -> float:
        return sqrt(float(np.sum(self.power * np.abs(transfer) ** 2)))

    @property
    def rectified(self) -> Rectified:
        """As the model's phases have it (V3)."""
        return self._rectified(
            np.imag(self.y * np.conj(self.z)),
            np.real(self.z * np.conj(self.force)),
            -np.real(self.y * np.conj(self.force)),
        )

    @property
    def worst_phase(self) -> Rectified:
        """The bound with every pair of motions in its worst phase (V4)."""
        y, z, force = np.abs(self.y), np.abs(self.z), np.abs(self.force)
        return self._rectified(y * z, z * force, y * force, bound=True)

    def _rectified(
        self, x: Array, along_y: Array, along_z: Array, bound: bool = False
    ) -> Rectified:
        omega = 2 * np.pi * self.frequency
        sculling = np.stack((np.zeros_like(along_y), along_y, along_z), axis=1)
        return Rectified(
            self.frequency, self.power * omega * x, self.power[:, None] * sculling, bound
        )


def relative_error(
    table: TapTable, phase: Array, kind: SensorKind = "increment", passed: Filter | None = None
) -> Array:
    """Computed minus true rate over true rate of classical motion: 2 residual(λ)/(nλ).

    Args:
        table: the tap table.
        phase: λ > 0.
        kind, passed: as for `Rectified.errors`.

    Raises:
        InputError: the filter's response is not known at one of the frequencies.
    """
    if passed is None:
        left = closed_form.residual(table, phase, kind)
    else:
        left = drift.filtered_residual(table, phase, kind, passed)
        if np.isnan(left).any():
            raise InputError(
                "the vibration reaches above the sensor's measured response, give the response to"
                " higher frequencies or a lower spectrum"
            )
    share: Array = 2 * left / (table.samples * phase)
    return share


def sensor_filter(design: Design) -> Filter | None:
    """The filter that a design's family is tuned to, as `Rectified.errors` takes it."""
    if design.algorithm.family in ("table", "filtered-rate"):
        return None
    passed = design.made.balance.response
    return passed if passed.stages else None


def step_for(samples: int, sample_rate: float) -> float:
    """A step (Hz) that places the bands' edges on the multiples of 1/(nT).

    There a rate sensor's sums alias to a constant rate and the residual has poles, odd ones, which
    cancel between the bands on their two sides (the principal value of the integral).
    """
    period = sample_rate / samples
    return period / ceil(period / STEP)


def respond(spectrum: Spectrum, mount: Mount, step: float = STEP) -> Response:
    """The mount under a spectrum.

    Args:
        spectrum: the vehicle's vibration.
        mount: the mount.
        step: width of a band, Hz; the spectrum's power in each is exact.
    """
    count = ceil(spectrum.highest / step)
    edges = step * np.arange(count + 1, dtype=np.float64)
    frequency = edges[:-1] + step / 2
    power = G * G * spectrum.power(edges)
    used = power > 0
    frequency, power = frequency[used], power[used]
    return Response(frequency, step, power, *mount.transfer(frequency))


@dataclass(frozen=True)
class Trial:
    """One random vibration through the integer path, and its own truth.

    Attributes:
        coning, sculling: what counts, core and host made of it: rad/s about x, (3,) m/s².
        true_coning, true_sculling: of this very vibration, analytic.
    """

    coning: float
    sculling: Array
    true_coning: float
    true_sculling: Array


def trial(design: Design, spectrum: Spectrum, mount: Mount, seconds: float, seed: int) -> Trial:
    """A random vibration in time: quantised counts, `FastModel`, host.

    The vibration is Gaussian and periodic: lines at multiples of 1/P, P the length, with random
    phases and Rayleigh amplitudes.  So samples at t = jT are exact sums however high a line lies
    (it folds), and so is the truth (V3).  The major intervals are put together to second order, as
    (V3) is; over a whole period nothing else is left.

    Args:
        design: sensor and algorithm.
        spectrum, mount: the vibration.
        seconds: P, rounded to whole major intervals.
        seed: of the random numbers.

    Raises:
        InputError: a count does not fit the sensor's word.
    """
    T, span = design.sample_interval, design.samples_per_major
    samples = span * max(1, round(seconds / (span * T)))
    period = samples * T
    line = np.arange(1, ceil(spectrum.highest * period) + 1)
    frequency = line.astype(np.float64) / period
    edges = (np.arange(len(line) + 1, dtype=np.float64) + 0.5) / period
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal((2, len(line)))
    # the mean square of Re(c e^iΩt) is |c|²/2
    amplitude = np.sqrt(G * G * spectrum.power(edges)) * (noise[0] + 1j * noise[1])
    power = np.abs(amplitude) ** 2 / 2
    truth = Response(frequency, 1 / period, power, *mount.transfer(frequency))

    omega = 2 * np.pi * frequency
    passed = sensor_filter(design)
    if passed is not None:
        gain = np.array([passed.value(phase) for phase in (omega * T).tolist()])
    elif design.sensor.kind == "rate":
        gain = np.sinc(frequency * T) + 0j
    else:
        gain = np.ones_like(omega, complex)
    if design.sensor.kind == "increment":  # integrals, to be differenced
        scale_angle, scale_force = gain, gain / (1j * omega)
    else:
        scale_angle, scale_force = gain * (1j * omega), gain

    def in_time(transfer: Complex) -> Array:
        folded = np.zeros(samples, complex)
        np.add.at(folded, line % samples, amplitude * transfer)
        series: Array = np.real(np.fft.ifft(folded)) * samples
        return series

    values = np.zeros((samples, 6))
    values[:, 1] = in_time(truth.y * scale_angle)
    values[:, 2] = in_time(truth.z * scale_angle)
    values[:, 3] = in_time(truth.force * scale_force)
    if design.sensor.kind == "increment":
        values -= np.roll(values, 1, axis=0)
    # the end of the period comes first too, so that the history is filled
    lead = span * -(-design.table.history // span)
    counts = Quantiser(design)(np.concatenate([values[samples - lead :], values]))
    model = FastModel(design)
    model.feed(counts[:lead])
    coning, sculling = second_order_corrections(design, model.feed(counts[lead:]))
    true = truth.rectified
    return Trial(
        float(coning[0]) / period, sculling / period, true.coning_rate, true.sculling_force
    )

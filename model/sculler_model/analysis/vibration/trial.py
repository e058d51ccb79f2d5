"""A random vibration in time through counts, core and host, held against its own truth."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from sculler_model.analysis.vibration.mount import Mount
from sculler_model.analysis.vibration.rectified import G, MountResponse
from sculler_model.analysis.vibration.spectrum import Spectrum
from sculler_model.design import Design
from sculler_model.fast import FastModel
from sculler_model.host import second_order_corrections
from sculler_model.samples import Quantiser

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


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
    truth = MountResponse(frequency, 1 / period, power, *mount.transfer(frequency))

    values = _samples_in_time(design, truth, line, amplitude, samples)
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


def _samples_in_time(
    design: Design,
    truth: MountResponse,
    line: NDArray[np.int64],
    amplitude: Complex,
    samples: int,
) -> Array:
    """(N, 6) what the sensors deliver over a period, SI units.

    Args:
        design: the design.
        truth: at each line's frequency.
        line: (L,) numbers of the lines, in periods.
        amplitude: (L,) of the vehicle's acceleration, m/s².
        samples: N.
    """
    increments = design.sensor.kind == "increment"
    omega = 2 * np.pi * truth.frequency
    gain = _sensor_gain(design, truth.frequency)
    if increments:  # integrals, to be differenced
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
    if increments:
        values -= np.roll(values, 1, axis=0)
    return values


def _sensor_gain(design: Design, frequency: Array) -> Complex:
    """(L,) what the samples have passed at frequencies (Hz): the design's filter, rates sinc."""
    omega = 2 * np.pi * frequency
    T, passed = design.sample_interval, design.sensor_response
    if passed is not None:
        return np.array([passed.value(phase) for phase in (omega * T).tolist()])
    if design.sensor.kind == "rate":
        return np.asarray(np.sinc(frequency * T) + 0j)
    return np.ones_like(omega, complex)

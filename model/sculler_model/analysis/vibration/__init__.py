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

which `MountResponse.worst_phase` gives; it is what Savage's published figures agree with
(docs/explanation/accuracy.md).
"""

from sculler_model.analysis.vibration.mount import Mount, Plane
from sculler_model.analysis.vibration.rectified import (
    STEP,
    Errors,
    G,
    MountResponse,
    Rectified,
    relative_error,
    respond,
    step_for,
)
from sculler_model.analysis.vibration.spectrum import PROFILES, SPECTRUM_COLUMNS, Spectrum
from sculler_model.analysis.vibration.trial import Trial, trial

__all__ = [
    "PROFILES",
    "SPECTRUM_COLUMNS",
    "STEP",
    "Errors",
    "G",
    "Mount",
    "MountResponse",
    "Plane",
    "Rectified",
    "Spectrum",
    "Trial",
    "relative_error",
    "respond",
    "step_for",
    "trial",
]

"""Savage-98, section VI, its second half: position by trapezoid and at high resolution."""

from __future__ import annotations

from math import sqrt

from sculler_model.analysis.position import Conditions, Error, Left, Term, left, selection
from sculler_model.analysis.vibration import G
from studies.accuracy.coning import fine_design
from studies.accuracy.section import Section, number

T, SECONDS, LIMIT = 0.02, 10.0, 1e-4
SHAKEN = 3.6 * G, 50.0
HOW = "`sculler analyze position`"


def position() -> Section:
    """The paper's selection, and what scrolling leaves."""
    section = Section(
        "Savage-98, section VI: position",
        "Position updates at 50 Hz; 0.01 cm may be wrong over 10 s. Manoeuvres of 3 g, 3 g/s and"
        " 1 rad/s; a vibration of 3.6 g rms at 50 Hz. `sculler analyze position` has these"
        " conditions if nothing else is said, and makes the paper's selection for yours.",
    )
    chosen = selection(Conditions(3 * G, 3 * G, 1.0, 0.0, *SHAKEN, 0.0, LIMIT, SECONDS), T)
    terms = {term.name: term for term in chosen.trapezoid + chosen.terms}
    speed = f"{number(100 * chosen.velocity_rms, 3)} cm/s rms"
    section.add("velocity of the vibration", "11.2 cm/s rms", speed, HOW)
    for name, paper, random in _PAPER:
        section.add(name, paper, _told(terms[name], random), HOW)
    chosen_word = "high resolution" if chosen.high_resolution else "trapezoid"
    section.add(
        "chosen", "high resolution, all terms", f"{chosen_word}, {_needed(chosen.terms)}", HOW
    )
    turning = Conditions(0, 0, 1.0, 0, *SHAKEN, 0.0, LIMIT, SECONDS)
    shaken = _left_rows(section, "the vibration in the turn", turning)
    _left_rows(section, "3 g, 3 g/s in a turn of 1 rad/s", Conditions(3 * G, 3 * G, 1.0))
    rocked = _rocked(section)
    each = shaken.exact_integrals.each
    section.after = (
        "**Agrees.** Every figure. (The paper's aliasing of the sampled vibration stands on a line"
        " that our copy of it lacks.) ΔR_scrl is what cancels ΔR_rot at the paper's phase of the"
        f" sine; in its worst phase it is {_times(terms)} times as large.",
        "**What scrolling leaves.** The core's ΔR_scrl (Eq. 105) has taps of its own. So what is"
        " left of position does not know the family. Two things are left. One is the second order"
        " of the method: Eq. 84 is of first order in the angle, but for the rotation, which is"
        f" exact. In the turn that is {number(100 * each)} cm an interval, and it falls with the"
        " square of the turn; neither samples nor family mend it, a shorter major interval does."
        " The other is Eq. 103-105 for straight lines of time, when the vibration is fast for the"
        " samples.",
        f"It shows where the body rocks with the vibration: {rocked}.",
    )
    return section


_PAPER = (
    ("trapezoid, ramp of the force", "0.00196 cm, 0.098 cm/s", False),
    ("trapezoid, force in a turn", "0.00196 cm, 0.098 cm/s", False),
    ("trapezoid, vibration aliased", "unacceptable", True),
    ("S_υ, force", "0.59 cm, 29.4 cm/s", False),
    ("S_υ, ramp of the force", "0.0039 cm, 0.20 cm/s", False),
    ("ΔR_rot, force in a turn", "0.0039 cm, 0.20 cm/s", False),
    ("S_υ, vibration", "0.32 cm", False),
    ("ΔR_rot, vibration in a turn", "0.0011 cm, 0.053 cm/s, 0.024 cm over 10 s at random", True),
    ("ΔR_scrl, vibration in a turn (Eq. 109)", "0.053 cm/s, 0.024 cm over 10 s at random", True),
)


def _told(term: Term, random: bool) -> str:
    words = f"{number(100 * term.each, 3)} cm, {number(100 * term.a_second, 3)} cm/s"
    return words + (f", {number(100 * term.random)} cm over 10 s at random" if random else "")


def _needed(terms: tuple[Term, ...]) -> str:
    needed = sum(term.over for term in terms)
    return "all terms" if needed == len(terms) else f"{needed} of {len(terms)} terms"


def _times(terms: dict[str, Term]) -> str:
    worst = terms["ΔR_scrl, the same in its worst phase"].each
    return number(worst / terms["ΔR_scrl, vibration in a turn (Eq. 109)"].each)


def _cm(error: Error | None) -> str:
    assert error is not None
    return f"{number(100 * error.largest)} cm"


def _left_rows(section: Section, name: str, conditions: Conditions) -> Left:
    """What is left over 10 s: trapezoid, core."""
    design = fine_design("frequency-taylor", 4, 0, 10, 2000.0)
    found = left(design, conditions)
    section.add(
        f"{name}, {SECONDS:g} s: trapezoid; high resolution, exact integrals; core at 2 kHz",
        "0.01 cm allowed",
        f"{_cm(found.trapezoid)}; {_cm(found.exact_integrals)}; {_cm(found.core)}",
        HOW,
    )
    return found


def _rocked(section: Section) -> str:
    """The core at several sample rates where the body rocks 0.00038 rad rms with the vibration."""
    conditions = Conditions(0, 0, 1.0, 0, *SHAKEN, sqrt(2) * 0.00038, LIMIT, SECONDS)
    found = {}
    for rate in (500.0, 1000.0, 2000.0):
        minors = round(rate * T / 2)
        for family in ("frequency-taylor", "time-taylor"):
            errors = left(fine_design(family, 2, 0, minors, rate), conditions)
            found[rate, family] = errors
    alike = all(found[r, "frequency-taylor"].core == found[r, "time-taylor"].core for r, _ in found)
    section.add(
        "the same, rocking 0.00038 rad rms in phase: core at 500, 1000, 2000 Hz",
        "0.01 cm allowed",
        "; ".join(_cm(found[r, "frequency-taylor"].core) for r in (500.0, 1000.0, 2000.0)),
        HOW,
    )
    exact = found[2000.0, "frequency-taylor"].exact_integrals
    return (
        f"exact integrals would leave {_cm(exact)}, the core at 500 Hz leaves"
        f" {_cm(found[500.0, 'frequency-taylor'].core)}"
        + (", frequency-taylor and time-taylor alike" if alike else "")
    )

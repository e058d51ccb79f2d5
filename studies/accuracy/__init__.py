"""The papers' figures beside ours: `python -m studies.accuracy` (or `make accuracy`).

Writes the page accuracy.md and its pictures.  Nothing in it is typed in but the papers' own figures
and the words; the same program gives the same page.
"""

from studies.accuracy.page import command, document
from studies.accuracy.recursion import float32_recursion_drift
from studies.accuracy.section import number
from studies.accuracy.zeng import runge_kutta_drift

__all__ = ["command", "document", "float32_recursion_drift", "number", "runge_kutta_drift"]

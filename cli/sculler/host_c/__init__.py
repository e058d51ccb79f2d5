"""The host in C: what a design's files are, and a library of them that this process runs.

`host_texts` writes a design's NAME_host.h and .c beside the library that serves all designs; they
are freestanding C99, and C++11 where numbers are pairs of floats (sculler_real.h).  `HostInC`
compiles them and does with them what `sculler_model.host` and `sculler_model.navigation` do.  It
imports the model, and of `sculler_sim` the cache of compiled things.
"""

from sculler.host_c.aligning import align_finely_in_c, align_in_c
from sculler.host_c.build import PRECISIONS, Precision, compiler
from sculler.host_c.emit import host_texts, library_texts
from sculler.host_c.engine import HostInC, NavigatorInC

__all__ = [
    "PRECISIONS",
    "HostInC",
    "NavigatorInC",
    "Precision",
    "align_finely_in_c",
    "align_in_c",
    "compiler",
    "host_texts",
    "library_texts",
]

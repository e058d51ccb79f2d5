"""NAME_bus: results from the core to a host, samples to the core.

sample ─▶ SampleGate ─▶ core          core ─▶ ResultStore ─▶ RegisterFile ─▶ AXI4-Lite, ...
              │           TimeStamps ─────────────┘      └──▶ PacketSender ─▶ AXI4-Stream
"""

from __future__ import annotations

from amaranth import C, Cat, Module, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.bus.apb import Apb
from sculler_hdl.bus.axi_lite import AxiLite
from sculler_hdl.bus.packets import PacketSender, SampleReceiver
from sculler_hdl.bus.registers import ANSWER_BITS, REQUEST_BITS, RegisterFile, bits_of
from sculler_hdl.bus.result_store import ResultStore
from sculler_hdl.bus.sample_gate import SampleGate
from sculler_hdl.bus.time_stamps import TimeStamps
from sculler_hdl.bus.wishbone import Wishbone
from sculler_hdl.lib.crossing import CrossingQueue, Synchroniser
from sculler_hdl.lib.layout import shape_of
from sculler_hdl.plan.bus_ports import (
    BUS_PREFIXES,
    CORE,
    bus_ports,
    has_front,
    packet_sample_ports,
    takes_packets,
    the_bus,
)
from sculler_hdl.plan.ports import Port, reset_name, sample_ports
from sculler_hdl.plan.registers import FRONT_COUNTERS, RegisterMap, status_faults
from sculler_hdl.plan.timing import timing
from sculler_model.design import Design

_CLOCKS = ("clk", "rst", "rst_n", "bus_clk", "bus_rst", "bus_rst_n")

PACKET_CROSSING = 16
"""Words that a crossing of packets holds."""


class ResultBus(wiring.Component):
    """What stands between a core and a host's bus.

    Ports: `sculler_hdl.plan.bus_ports`.  Clock domains: `sync`, the core's; and `bus`, where the
    design has a separate clock for it.  A clock enable is the core's alone: the bus answers in
    every clock, and takes from the core and gives to it in those that are enabled.

    Args:
        design: the design, which has a bus.
    """

    def __init__(self, design: Design) -> None:
        self.design = design
        self.bus = the_bus(design)
        self.table = RegisterMap(design)
        self.domain = "bus" if self.bus.clock == "separate" else "sync"
        super().__init__(
            {
                port.name: (Out if port.output else In)(shape_of(port))
                for port in bus_ports(design)
                if port.name not in _CLOCKS
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.store = store = ResultStore(self.table.window, self.bus.depth)
        m.submodules.gate = gate = SampleGate(sum(port.bits for port in self._sample))
        core_rst = Signal(init=1)  # after reset the core's goes on for a clock
        resets = [core_rst]
        if self.design.hardware.resets_at_once:  # what acts at once is read by no logic
            resets.append(Signal(init=1, name="core_rst_sent"))
        self._reset(m, f"{CORE}rst", resets[-1])
        m.d.comb += [
            store.restart.eq(core_rst),
            gate.hold.eq(core_rst),
            store.core_valid.eq(self._enabled(self.core_result_valid)),
            store.core_data.eq(self.core_result_data),
            store.core_last.eq(self.core_result_last),
            self.core_result_ready.eq(store.core_ready),
            self.core_sample_valid.eq(gate.core_valid),
            gate.core_ready.eq(self._enabled(self.core_sample_ready)),
            Cat(getattr(self, f"{CORE}{port.name}") for port in self._sample).eq(gate.core),
        ]
        self._samples(m, gate)
        stamps = self._stamps(m, gate, store, core_rst) if self.bus.time_stamps else None
        if self.bus.has_registers:
            self._registers(m, gate, store, stamps, resets)
        else:
            m.d.sync += [each.eq(0) for each in resets]
            m.d.comb += gate.enable.eq(1)
            if has_front(self.design):
                self._reset(m, "front_rst", resets[-1])
            self._packets(m, store)
        return m

    def _enabled(self, level: Value) -> Value:
        """What the core shows, in the clocks that count for it."""
        return level & self.clk_en if self.design.hardware.clock_enable else level

    def _reset(self, m: Module, name: str, active: Signal) -> None:
        """Drive the reset of another part, at the level that the design asks for."""
        low = self.design.hardware.reset_active == "low"
        m.d.comb += getattr(self, reset_name(self.design, name)).eq(~active if low else active)

    @property
    def _sample(self) -> list[Port]:
        return sample_ports(self.design)

    def _samples(self, m: Module, gate: SampleGate) -> None:
        """From the sample's ports, or from packets."""
        if not takes_packets(self.design):
            m.d.comb += [
                gate.sample_valid.eq(self.sample_valid),
                self.sample_ready.eq(gate.sample_ready),
                gate.sample.eq(Cat(getattr(self, port.name) for port in self._sample)),
            ]
            return
        bits = tuple(port.bits for port in self._sample if port.name != "sample_fault")
        m.submodules.receiver = receiver = SampleReceiver(bits)
        ports = packet_sample_ports(self.bus.sample or "")
        valid, ready, *given = (getattr(self, port.name) for port in ports.values())
        m.d.comb += [
            gate.sample_valid.eq(receiver.sample_valid),
            receiver.sample_ready.eq(gate.sample_ready),
            gate.sample.eq(receiver.sample),
            self.packets_bad.eq(receiver.bad),
        ]
        taken = Cat(receiver.word, receiver.last, receiver.fault)
        if self.domain == "sync":
            m.d.comb += [
                receiver.valid.eq(valid),
                ready.eq(receiver.ready),
                taken.eq(Cat(*given)),
            ]
            return
        queue = CrossingQueue(32 + 2, PACKET_CROSSING, "bus", "sync")
        m.submodules.sample_crossing = queue
        m.d.comb += [
            queue.valid_in.eq(valid),
            ready.eq(queue.ready_in),
            queue.data_in.eq(Cat(*given)),
            receiver.valid.eq(queue.valid_out),
            queue.ready_out.eq(receiver.ready),
            taken.eq(queue.data_out),
        ]

    def _stamps(
        self, m: Module, gate: SampleGate, store: ResultStore, core_rst: Signal
    ) -> TimeStamps:
        m.submodules.time_stamps = stamps = TimeStamps(self.design, timing(self.design))
        m.d.comb += [
            stamps.restart.eq(core_rst),
            stamps.taken.eq(gate.taken),
            stamps.begins.eq(store.begins),
            stamps.number.eq(store.number),
            stamps.result.eq(store.core_valid & store.core_ready & store.core_last),
            stamps.pulse.eq(self.pulse),
            store.stamps.eq(stamps.stamps),
        ]
        if has_front(self.design):
            m.d.comb += [
                stamps.instant.eq(self.sample_instant),
                stamps.from_instant.eq(~gate.inject),
            ]
        return stamps

    def _registers(
        self,
        m: Module,
        gate: SampleGate,
        store: ResultStore,
        stamps: TimeStamps | None,
        resets: list[Signal],
    ) -> None:
        m.submodules.registers = registers = RegisterFile(self.table)
        m.d.sync += [each.eq(registers.control_reset_core) for each in resets]
        counts = [getattr(registers, f"inject_{p.name[7:]}_value") for p in self._sample[:-1]]
        fault = Signal()  # of the sample that is pushed
        with m.If(registers.inject_push_push):
            m.d.sync += fault.eq(registers.inject_push_fault)
        samples = Signal(32)
        results = Signal(32)
        m.d.sync += [samples.eq(samples + gate.taken), results.eq(results + store.stored)]
        with m.If(registers.control_clear):
            m.d.sync += [samples.eq(0), results.eq(0)]
        m.d.comb += [
            gate.enable.eq(registers.control_enable),
            gate.inject.eq(registers.control_inject),
            gate.push.eq(registers.inject_push_push),
            gate.pushed.eq(Cat(*counts, fault)),
            registers.results_wait.eq(store.waiting != 0),
            registers.window_data.eq(store.data),
            store.address.eq(registers.window_address),
            store.read.eq(registers.window_read),
            store.pop.eq(registers.pop_pop),
            registers.status_full.eq(store.waiting == self.bus.depth),
            registers.status_injecting.eq(gate.waits),
            registers.status_waiting.eq(store.waiting),
            registers.faults_injection.eq(registers.inject_push_push & gate.waits),
            registers.samples_value.eq(samples),
            registers.results_value.eq(results),
            registers.samples_lost_value.eq(self.core_samples_lost),
        ]
        for bit, name in enumerate(status_faults(self.design)):
            told = getattr(registers, f"faults_{name}")
            m.d.comb += told.eq(store.stored & store.status[bit])
        if self.design.drops_results:
            m.d.comb += registers.results_dropped_value.eq(self.core_results_dropped)
        if has_front(self.design):
            front_rst = Signal(init=1)
            m.d.sync += front_rst.eq(registers.control_reset_front)
            self._reset(m, "front_rst", front_rst)
            for name, _ in FRONT_COUNTERS:
                m.d.comb += getattr(registers, f"{name}_value").eq(getattr(self, name))
        if stamps is not None:
            m.d.comb += [
                Cat(registers.time_low_value, registers.time_high_value).eq(stamps.now),
                Cat(registers.pulse_low_value, registers.pulse_high_value).eq(stamps.pulse_time),
                registers.pulses_value.eq(stamps.pulses),
                registers.interrupt_pulse.eq(stamps.pulse_came),
            ]
        self._adapter(m, registers)

    def _adapter(self, m: Module, registers: RegisterFile) -> None:
        """The bus's protocol, in its clock, and the way from there to the registers."""
        kind, domain = self.bus.result, self.domain
        adapter: AxiLite | Wishbone | Apb
        if kind == "axi-lite":
            adapter = AxiLite(domain)
        elif kind == "apb":
            adapter = Apb(domain)
        else:
            adapter = Wishbone(pipelined=kind == "wishbone-pipelined", domain=domain)
        m.submodules.adapter = adapter
        prefix = BUS_PREFIXES[kind]
        for name, member in adapter.signature.members.items():
            if name in ("request", "answer"):
                continue
            inner, outer = getattr(adapter, name), getattr(self, prefix + name)
            m.d.comb += outer.eq(inner) if member.flow == Out else inner.eq(outer)
        if domain == "sync":
            wiring.connect(m, adapter.request, registers.request)
            wiring.connect(m, registers.answer, adapter.answer)
            m.d.comb += self.irq.eq(registers.irq)
            return
        requests = CrossingQueue(REQUEST_BITS, 2, "bus", "sync")
        answers = CrossingQueue(ANSWER_BITS, 2, "sync", "bus")
        m.submodules.request_crossing, m.submodules.answer_crossing = requests, answers
        for source, queue, target in (
            (adapter.request, requests, registers.request),
            (registers.answer, answers, adapter.answer),
        ):
            m.d.comb += [
                queue.valid_in.eq(source.valid),
                queue.data_in.eq(bits_of(source)),
                source.ready.eq(queue.ready_in),
                target.valid.eq(queue.valid_out),
                bits_of(target).eq(queue.data_out),
                queue.ready_out.eq(target.ready),
            ]
        m.submodules.interrupt_crossing = line = Synchroniser(1, "bus")
        m.d.comb += [line.data_in.eq(registers.irq), self.irq.eq(line.data_out)]

    def _packets(self, m: Module, store: ResultStore) -> None:
        """Results as packets, at the bus's clock."""
        m.submodules.sender = sender = PacketSender(self.table.window)
        prefix = BUS_PREFIXES[self.bus.result]
        axi = self.bus.result == "axi-stream"
        m.d.comb += [
            sender.waits.eq(store.waiting != 0),
            store.pop.eq(sender.pop),
            store.address.eq(sender.address),
            store.read.eq(sender.read),
            sender.data.eq(store.data),
        ]
        payload = Cat(sender.word, sender.last, sender.status)
        status = getattr(self, prefix + ("user" if axi else "status"))
        word, last = getattr(self, f"{prefix}data"), getattr(self, f"{prefix}last")
        valid, ready = getattr(self, f"{prefix}valid"), getattr(self, f"{prefix}ready")
        if axi:
            m.d.comb += self.m_axis_tkeep.eq(C(0b1111, 4))
        if self.domain == "sync":
            m.d.comb += [
                valid.eq(sender.valid),
                sender.ready.eq(ready),
                Cat(word, last, status).eq(payload),
            ]
            return
        queue = CrossingQueue(32 + 1 + len(sender.status), PACKET_CROSSING, "sync", "bus")
        m.submodules.packet_crossing = queue
        m.d.comb += [
            queue.valid_in.eq(sender.valid),
            sender.ready.eq(queue.ready_in),
            queue.data_in.eq(payload),
            valid.eq(queue.valid_out),
            queue.ready_out.eq(ready),
            Cat(word, last, status).eq(queue.data_out),
        ]

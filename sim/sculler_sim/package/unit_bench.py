"""NAME_unit_tb.v: a self-checking test bench of the whole unit, for Icarus and Verilator.

Samples come by the sensor's serial line where the unit has a front end on a UART, else at the
unit's sample port; results leave as packets, or are read from the registers by a master of
AXI4-Lite.  Units of other kinds have no bench.
"""

from __future__ import annotations

import random

from sculler_hdl import sample_ports, unit_ports
from sculler_model.design import Design
from sculler_model.front import Uart, frame_of
from sculler_model.golden import GoldenModel, Sample
from sculler_sim.package.contents import Contents
from sculler_sim.package.master import (
    Text,
    column_words,
    master_instance,
    master_module,
    master_nets,
    result_words,
)

_RESULTS = 2
_SEED = 1601
_PACKET_PORTS = {"axi-stream": "m_axis_t", "stream": "packet_"}


def has_bench(design: Design) -> bool:
    """Whether there is a bench for the design's unit."""
    bus, link = design.hardware.bus, design.front
    if bus is None or bus.sample == "axi-stream":
        return False
    from_the_wire = link is None or isinstance(link.wire, Uart)
    return from_the_wire and bus.result in ("axi-lite", *_PACKET_PORTS)


def bench_files(design: Design) -> tuple[str, ...]:
    """Names of the bench and its vectors; none where there is no bench."""
    parts = ("tb.v", "sensor.hex", "expected.hex") if has_bench(design) else ()
    return tuple(f"{design.name}_unit_{part}" for part in parts)


def unit_bench_texts(contents: Contents) -> dict[str, str]:
    """The bench and its vectors: texts by the name of their file; none where there is no bench."""
    design = contents.design
    if not has_bench(design):
        return {}
    samples = _samples(design)
    results = GoldenModel(design).run(samples)
    words = [word for result in results for word in _words(design, result.row())]
    texts = (
        _bench(contents, samples),
        "".join(f"{line}\n" for line in _sensor_lines(design, samples)),
        "".join(f"{word:08x}\n" for word in words),
    )
    return dict(zip(bench_files(design), texts, strict=True))


def _samples(design: Design) -> list[Sample]:
    """Random samples of two major intervals, in the sensor's range and that of its frames."""
    rng, link = random.Random(_SEED), design.front

    def three(sensor: str) -> tuple[int, int, int]:
        allowed = getattr(design.words, sensor)
        lo, hi = allowed.lo, allowed.hi
        for number in getattr(link.layout, sensor) if link is not None else ():
            half = 1 << number.bits - 1
            lo = max(lo, -half if number.signed else 0)
            hi = min(hi, half - 1 if number.signed else 2 * half - 1)
        x, y, z = (rng.randint(lo, hi) for _ in range(3))
        return x, y, z

    count = _RESULTS * design.samples_per_major
    return [(three("gyro"), three("accel"), False) for _ in range(count)]


def _words(design: Design, row: tuple[int, ...]) -> list[int]:
    """A result's words of 32 bits, the least significant of each column first."""
    each = column_words(design)
    return [value >> 32 * place & 0xFFFF_FFFF for value in row for place in range(each)]


def _sensor_lines(design: Design, samples: list[Sample]) -> list[str]:
    """What the sensor sends: bytes of its frames; or six counts of 32 bits a sample."""
    if design.front is not None:
        frames = (
            frame_of(design.front.layout, gyro, accel, number)
            for number, (gyro, accel, _) in enumerate(samples)
        )
        return [f"{byte:02x}" for frame in frames for byte in frame]
    return [
        "".join(f"{count & 0xFFFF_FFFF:08x}" for count in (*gyro, *accel))
        for gyro, accel, _ in samples
    ]


def _bench(contents: Contents, samples: list[Sample]) -> str:
    design = contents.design
    bus = design.hardware.bus
    assert bus is not None
    compared = column_words(design) * len(design.columns)
    halves = [round(5e5 / clock.mhz) for clock in contents.clocks]
    source, nets, sensor, longest = _source(design, samples, halves[0])
    side, top = contents.clocks[-1].port, contents.top
    wires, modules = "  wire ready = 1'b1;", ""
    if bus.result == "axi-lite":
        host = "A master of AXI4-Lite reads the results from the registers."
        wires = f"{wires}\n{master_instance(f'{top}_tb', side)}"
        modules = master_module(f"{top}_tb", design)
        nets |= master_nets()
    else:
        host = "Results come as packets; the bench is always ready."
        prefix = _PACKET_PORTS[bus.result]
        nets |= {f"{prefix}{name}": name for name in ("valid", "ready", "data", "last")}
    for reset in contents.resets:
        nets[reset.port] = "rst" if reset.active_high else "!rst"
    nets |= {clock.port: clock.port for clock in contents.clocks} | {"clk_en": "1'b1"}
    ports = unit_ports(design)
    open_or_zero = {port.name: "" if port.output else f"{port.bits}'d0" for port in ports}
    nets = open_or_zero | nets
    separate = f"  reg bus_clk = 1'b0;\n  always #{halves[-1]} bus_clk = !bus_clk;"
    return Text.of("unit_bench.v.in").substitute(
        top=top,
        sensor=sensor,
        host=host,
        results=_RESULTS,
        words=result_words(design),
        compared=compared,
        half=halves[0],
        slower=2 * max(halves),
        bus_clock=separate if len(halves) > 1 else "",
        source=source,
        wires=wires,
        connections=",\n".join(f"    .{port.name}({nets[port.name]})" for port in ports),
        side=side,
        longest=longest,
        modules=modules,
    )


def _source(
    design: Design, samples: list[Sample], half: int
) -> tuple[str, dict[str, str], str, int]:
    """The sensor's side of the bench, its nets by port, what it is, and how long the run may be."""
    if design.front is not None:
        return _line(design, samples)
    ports = [port for port in sample_ports(design) if port.name != "sample_fault"]
    nets = {"sample_valid": "offered", "sample_ready": "sample_ready", "sample_fault": "1'b0"}
    for place, port in enumerate(ports):
        high = 32 * (5 - place) + port.bits - 1
        nets[port.name] = f"sample[{high}:{32 * (5 - place)}]"
    text = f"""  reg [191:0] samples [0:{len(samples) - 1}];
  initial $readmemh("{design.name}_unit_sensor.hex", samples);
  integer taken = 0;
  wire offered = taken < {len(samples)} && !rst;
  wire [191:0] sample = samples[offered ? taken : 0];
  wire sample_ready;
  always @(posedge clk) if (offered && sample_ready) taken <= taken + 1;
"""
    clocks = len(samples) * 40_000 + 100_000
    told = "Samples are offered at the sample port until they are taken."
    return text, nets, told, 2 * half * clocks


def _line(design: Design, samples: list[Sample]) -> tuple[str, dict[str, str], str, int]:
    """A serial line that sends frames, one in each sample interval."""
    link = design.front
    assert link is not None
    assert isinstance(link.wire, Uart)
    length = len(frame_of(link.layout, *samples[0][:2], 0))
    interval = round(1e12 / link.sample_rate_hz)
    parity = {"none": "", "even": "^sent", "odd": "~^sent"}[link.wire.parity]
    parity_bit = f"        rx = {parity};\n        #BIT;\n" if parity else ""
    text = f"""  localparam [63:0] BIT = 64'd{round(1e12 / link.wire.baud)};
  localparam [63:0] INTERVAL = 64'd{interval};
  reg [7:0] bytes [0:{length * len(samples) - 1}];
  initial $readmemh("{design.name}_unit_sensor.hex", bytes);
  reg rx = 1'b1;
  reg [7:0] sent;
  integer frame, place, number;
  initial begin
    #(INTERVAL / 64'd2);
    for (frame = 0; frame < {len(samples)}; frame = frame + 1) begin
      for (place = 0; place < {length}; place = place + 1) begin
        sent = bytes[frame*{length}+place];
        rx = 1'b0;
        #BIT;
        for (number = 0; number < 8; number = number + 1) begin
          rx = sent[number];
          #BIT;
        end
{parity_bit}        rx = 1'b1;
        #BIT;
      end
      #(INTERVAL - 64'd{length * link.wire.bits_per_byte} * BIT);
    end
  end
"""
    told = f"The sensor's line brings {len(samples)} frames of {length} bytes."
    return text, {"rx": "rx"}, told, interval * (len(samples) + 2)

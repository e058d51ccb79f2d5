"""Where the samples of the unit's test bench come from: a sensor on its wire, or the sample port.

A source is Verilog: what stands in the bench, and to which of its nets the unit's ports go.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from sculler_hdl import packet_sample_ports, sample_ports
from sculler_model.design import Design
from sculler_model.front import Link, Spi, Uart, frame_of
from sculler_model.golden import Sample


class Source(NamedTuple):
    """What gives the samples.

    Attributes:
        told: what it is, in a sentence.
        text: of the bench.
        nets: by port of the unit.
        lines: of the file that it reads.
        longest: picoseconds that the run may take.
    """

    told: str
    text: str
    nets: dict[str, str]
    lines: list[str]
    longest: int


def source(design: Design, samples: list[Sample], period: int, side: str) -> Source:
    """What gives these samples to the design's unit.

    Args:
        design: the design, which has a bus.
        samples: without fault marks.
        period: of the core's clock, in picoseconds.
        side: the bus's clock.
    """
    link, bus = design.front, design.hardware.bus
    assert bus is not None
    if link is not None:
        return _sensor(design, link, samples, period)
    longest = period * (len(samples) * 40_000 + 100_000)
    of = _packets if bus.takes_packets else _ports
    return of(design, samples, longest, side)


def _words(sample: Sample) -> list[str]:
    gyro, accel, _ = sample
    return [f"{count & 0xFFFF_FFFF:08x}" for count in (*gyro, *accel)]


def _ports(design: Design, samples: list[Sample], longest: int, side: str) -> Source:
    """The unit's sample port, in the core's clock."""
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
    lines = ["".join(_words(sample)) for sample in samples]
    told = "Samples are offered at the sample port until they are taken."
    return Source(told, text, nets, lines, longest)


def _packets(design: Design, samples: list[Sample], longest: int, side: str) -> Source:
    """Packets of six words, in the bus's clock."""
    bus = design.hardware.bus
    assert bus is not None
    ports = packet_sample_ports(bus.sample or "")
    nets = {port.name: f"sample_{name}" for name, port in ports.items()}
    nets[ports["user"].name] = "1'b0"
    text = f"""  reg [31:0] samples [0:{6 * len(samples) - 1}];
  initial $readmemh("{design.name}_unit_sensor.hex", samples);
  integer taken = 0;
  wire sample_valid = taken < {6 * len(samples)} && !rst;
  wire [31:0] sample_data = samples[sample_valid ? taken : 0];
  wire sample_last = taken % 6 == 5;
  wire sample_ready;
  always @(posedge {side}) if (sample_valid && sample_ready) taken <= taken + 1;
"""
    lines = [word for sample in samples for word in _words(sample)]
    told = "Samples come as packets, a word of them as soon as the one before is taken."
    return Source(told, text, nets, lines, longest)


def _sensor(design: Design, link: Link, samples: list[Sample], period: int) -> Source:
    """A sensor that gives a frame in each sample interval."""
    frames = [
        frame_of(link.layout, gyro, accel, number)
        for number, (gyro, accel, _) in enumerate(samples)
    ]
    length = len(frames[0])
    interval = round(1e12 / link.sample_rate_hz)
    of: Callable[[Link, int, int, int], tuple[str, str, dict[str, str]]] = (
        _line if isinstance(link.wire, Uart) else _spi
    )
    told, text, nets = of(link, len(samples), length, period)
    head = f"""  localparam [63:0] INTERVAL = 64'd{interval};
  reg [7:0] bytes [0:{length * len(samples) - 1}];
  initial $readmemh("{design.name}_unit_sensor.hex", bytes);
"""
    lines = [f"{byte:02x}" for frame in frames for byte in frame]
    return Source(told, head + text, nets, lines, interval * (len(samples) + 2))


def _line(link: Link, count: int, length: int, period: int) -> tuple[str, str, dict[str, str]]:
    """A serial line that sends frames."""
    assert isinstance(link.wire, Uart)
    parity = {"none": "", "even": "^sent", "odd": "~^sent"}[link.wire.parity]
    parity_bit = f"        rx = {parity};\n        #BIT;\n" if parity else ""
    text = f"""  localparam [63:0] BIT = 64'd{round(1e12 / link.wire.baud)};
  reg rx = 1'b1;
  reg [7:0] sent;
  integer frame, place, number;
  initial begin
    #(INTERVAL / 64'd2);
    for (frame = 0; frame < {count}; frame = frame + 1) begin
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
    return f"The sensor's line brings {count} frames of {length} bytes.", text, {"rx": "rx"}


def _spi(link: Link, count: int, length: int, period: int) -> tuple[str, str, dict[str, str]]:
    """A sensor that is read over SPI, mode 3, at each edge of data-ready.

    While the first word goes out it shows zeros, then the frame; it looks at each word it is sent.
    """
    assert isinstance(link.wire, Spi)
    asked = "\n".join(
        f"        {number}: request = 16'h{word:04x};"
        for number, word in enumerate(link.wire.requests)
    )
    text = f"""  reg data_ready = 1'b0;
  reg miso = 1'b0;
  wire sck;
  wire cs_n;
  wire mosi;
  reg [15:0] sent;  // to the sensor
  integer frame;
  integer place = 0;  // bits of the frame's exchange that are over
  initial begin
    #(INTERVAL / 64'd2);
    for (frame = 0; frame < {count}; frame = frame + 1) begin
      place = 0;
      data_ready = 1'b1;
      #(INTERVAL / 64'd4);
      data_ready = 1'b0;
      #(INTERVAL - INTERVAL / 64'd4);
    end
  end
  always @(negedge sck) if (!cs_n) begin
    #{period};
    miso = place < 16 ? 1'b0 : bytes[frame*{length}+(place-16)/8][7-place%8];
  end
  always @(posedge sck) if (!cs_n) begin
    sent = {{sent[14:0], mosi}};
    place = place + 1;
    if (place % 16 == 0 && sent !== request(place / 16 - 1)) begin
      $display("FAIL: word %0d to the sensor is %h, expected %h", place / 16 - 1, sent,
          request(place / 16 - 1));
      fail;
    end
  end
  function [15:0] request(input integer word);
    begin
      case (word)
{asked}
        default: request = 16'h0000;
      endcase
    end
  endfunction
"""
    nets = {name: name for name in ("sck", "cs_n", "mosi", "miso", "data_ready")}
    told = f"The sensor on SPI brings {count} frames of {length} bytes, and knows what it is sent."
    return told, text, nets

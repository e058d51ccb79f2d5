"""The port contract of a core as SystemVerilog assertions, to bind to it: NAME_properties.sv.

What `sculler_model.golden.cycles` says of the ports, in counters that are just as wide as they need
to be, so that a model checker can take it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib import resources
from string import Template

from sculler_hdl.plan.ports import (
    Port,
    clock_ports,
    core_ports,
    result_ports,
    sample_ports,
)
from sculler_hdl.plan.timing import timing
from sculler_model.design import STATUS_BITS, Design
from sculler_model.errors import InputError
from sculler_model.golden import (
    PORT_MAJOR_BITS,
    WORD_BITS,
    Timing,
    words_per_column,
    words_per_result,
)

PROPERTIES: dict[str, str] = {
    "ready_as_due": "sample_ready is high when the contract says so, and only then",
    "valid_as_due": "result_valid is high when the contract says so, and only then",
    "waits_unchanged": "what is shown and not taken stays, to the last bit",
    "last_as_due": "result_last marks a result's last word",
    "major_as_due": "major is the number of the result's interval, dropped ones counted",
    "short_as_due": "status bit 0 is that of the result's interval",
    "fault_as_due": "status bit 1 is that of the result's interval",
    "rail_as_due": "status bit 2 is that of the result's interval",
    "mark_as_due": "status bit 3 is that of the result's interval",
    "lost_as_due": "samples_lost counts samples that were offered and withdrawn",
    "dropped_as_due": "results_dropped counts results that gave way",
    "goes_on": "if samples are offered and results taken, something is taken in time",
}
"""What each property says, by its label; a core without the port has not the property."""

_STATUS = ("short_as_due", "fault_as_due", "rail_as_due", "mark_as_due")


class _Template(Template):
    delimiter = "%%"  # SystemVerilog has it nowhere


def properties(design: Design) -> str:
    """The text of NAME_properties.sv: module NAME_properties, and its bind to NAME.

    Args:
        design: the design.

    Raises:
        InputError: `hardware.multipliers` are too few, or the design has another reset than the
            usual, a clock enable, compensation, or channels.
    """
    if why := _why_none(design):
        raise InputError(why)
    clocks = timing(design)
    numbers = {**_samples(design, clocks), **_results(design, clocks)}
    held = list(_conditions(design, clocks))
    values = {
        "name": design.name,
        "ports": ",\n".join(map(_declared, [*clock_ports(design), *core_ports(design)])),
        **numbers,
        "properties": "\n".join(
            f"  wire holds_{name} = {condition};  // {PROPERTIES[name]}" for name, condition in held
        ),
        "assumptions": "\n".join(f"          {name}: assume (holds_{name});" for name, _ in held),
        "assertions": "\n".join(f"          {name}: assert (holds_{name});" for name, _ in held),
        **{
            f"{name.removesuffix('_bits')}_top": bits - 1
            for name, bits in numbers.items()
            if name.endswith("_bits") and isinstance(bits, int)
        },
    }
    text = _template().substitute({**values, "initial": ""})
    initial = _initial(text, clocks.startup, known=design.has_initial_values)
    return _template().substitute({**values, "initial": initial})


def property_file(design: Design) -> dict[str, str]:
    """The same by its file's name; none where `properties` has none."""
    return {} if _why_none(design) else {f"{design.name}_properties.sv": properties(design)}


def _why_none(design: Design) -> str | None:
    """Why a design has no properties; None where it has."""
    if design.compensation is not None:
        return "compensation: the properties are those of a core without, leave it out"
    if not design.hardware.clocked_plainly:
        return (
            "hardware.reset, reset_active, clock_enable: the properties are those of a core with"
            " the usual reset and no clock enable, leave them out"
        )
    if design.channels > 1:
        return "hardware.channels: properties are those of a core with one, leave it out"
    return None


def _template() -> _Template:
    text = resources.files("sculler_hdl.export").joinpath("properties.sv.in")
    return _Template(text.read_text(encoding="ascii"))


_COMBINATIONAL = ("work", "reaches_back", "shown")  # or of no account before it is written
_REGISTER = re.compile(r"^  reg (?:\[(\d+):0\] )?(\w+(?:, \w+)*);", re.M)


def _initial(text: str, startup: int, *, known: bool) -> str:
    """What the registers hold at power-up."""
    lines = []
    for top, names in _REGISTER.findall(text):
        for name in names.split(", "):
            value = {"pause": startup, "live": int(known)}.get(name, 0)
            if name not in _COMBINATIONAL:
                lines.append(f"    {name} = {int(top or 0) + 1}'d{value};")
    return "\n".join(lines)


def _bits(largest: int) -> int:
    return max(largest.bit_length(), 1)


def _declared(port: Port) -> str:
    kind = "signed " if port.declared_signed else ""
    size = "" if port.bits == 1 else f"[{port.bits - 1}:0] "
    return f"  input wire {kind}{size}{port.name}"


def _samples(design: Design, clocks: Timing) -> dict[str, object]:
    """What the sample port goes by."""
    n, minors = design.algorithm.samples, design.algorithm.minors
    work, short = clocks.work or (0,) * n, design.short_samples
    pause, engine = _bits(max(clocks.startup, clocks.spacing - 1)), _bits(max(work))
    phase, minor, age = _bits(n - 1), _bits(minors - 1), _bits(len(short))
    return {
        "pause_bits": pause,
        "startup": f"{pause}'d{clocks.startup}",
        "spacing": f"{pause}'d{clocks.spacing - 1}",
        "engine_bits": engine,
        "work": "\n".join(
            f"    {phase}'d{k}: work = {engine}'d{clocks};"
            for k, clocks in enumerate(work)
            if clocks
        ),
        "phase_bits": phase,
        "last_phase": f"{phase}'d{n - 1}",
        "minor_bits": minor,
        "last_minor": f"{minor}'d{minors - 1}",
        "age_bits": age,
        "age_max": f"{age}'d{len(short)}",
        "short": "\n".join(
            f"    {age}'d{t}: reaches_back = 1'b1;" for t, uses in enumerate(short) if uses
        ),
        "rails": " ||\n".join(
            f"    {port.name} == {port.bits}'h{end:x}"
            for port in sample_ports(design)[:-1]
            for end in (1 << port.bits - 1, (1 << port.bits - 1) - 1)
        ),
    }


def _results(design: Design, clocks: Timing) -> dict[str, object]:
    """What the result port goes by."""
    stream = design.hardware.handover == "stream"
    claim = clocks.dropping.claim if clocks.dropping else 0
    refill = clocks.dropping.refill if clocks.dropping else clocks.handover_spacing
    wait, idle = _bits(clocks.latency), clocks.longest_wait + 1
    port, part = _bits(max(refill, clocks.handover_spacing) - 1), _bits(_parts(design) - 1)
    ports = result_ports(design)
    number = WORD_BITS * words_per_column(design) if stream else PORT_MAJOR_BITS
    return {
        "wait_bits": wait,
        "claimed_wait": f"{wait}'d{clocks.latency - claim - 1}",
        "number_bits": number,
        "numbers": (_NUMBERS_DROPPING if clocks.dropping else _NUMBERS).format(top=number - 1),
        "port_bits": port,
        "refill": f"{port}'d{refill - 1}",
        "handover": f"{port}'d{clocks.handover_spacing - 1}",
        "part_bits": part,
        "last_part": f"{part}'d{_parts(design) - 1}",
        "flight": _flight(claim),
        "drops": "1'b1" if clocks.dropping else "1'b0",
        "full": "1'b0" if clocks.dropping else ("first", "first && second")[clocks.results - 1],
        "payload_bits": sum(port.bits for port in ports),
        "payload": ",\n".join(f"    {port.name}" for port in ports),
        "idle_bits": _bits(idle),
        "longest_wait": f"{_bits(idle)}'d{idle}",
    }


def _parts(design: Design) -> int:
    return words_per_result(design) if design.hardware.handover == "stream" else 1


_NUMBERS = """\
  always @(posedge clk)
    if (rst) first_number <= 0;
    else if (whole) first_number <= first_number + 1'b1;"""

_NUMBERS_DROPPING = """\
  reg [{top}:0] number, second_number;
  always @(posedge clk)
    if (rst) number <= 0;
    else begin
      if (claims) number <= number + 1'b1;
      if (takes_second) second_number <= number;
      if (claims && (!first || whole)) first_number <= number;
      else if (whole) first_number <= second_number;
    end"""


def _flight(claim: int) -> str:
    """Intervals that have ended and have not claimed their place yet."""
    if claim == 0:
        return "  wire claims = last_taken;\n  wire [3:0] claimed_status = status;"
    top = STATUS_BITS * claim - 1
    return f"""\
  // intervals that have ended, and their status, on the way to where they claim their place
  reg [{claim - 1}:0] flight;
  reg [{top}:0] flight_status;
  always @(posedge clk) begin
    flight <= rst ? {claim}'d0 : {{flight[{claim - 2}:0], last_taken}};
    flight_status <= {{flight_status[{top - STATUS_BITS}:0], status}};
  end
  wire claims = flight[{claim - 1}];
  wire [3:0] claimed_status = flight_status[{top}:{top - STATUS_BITS + 1}];"""


def _conditions(design: Design, clocks: Timing) -> Iterator[tuple[str, str]]:
    """Each property that the core has, and its condition."""
    yield "ready_as_due", "sample_ready == want_ready"
    yield "valid_as_due", "result_valid == want_valid"
    yield "waits_unchanged", "!waited || (result_valid && payload == shown)"
    if design.hardware.handover == "stream":
        yield from _stream_conditions(design)
    else:
        yield "major_as_due", "!want_valid || result_major == first_number"
        for bit, name in enumerate(_STATUS):
            yield name, f"!want_valid || result_status[{bit}] == first_status[{bit}]"
    yield "lost_as_due", "samples_lost == lost"
    if clocks.dropping:
        yield "dropped_as_due", "results_dropped == dropped"
    idle = clocks.longest_wait + 1
    yield "goes_on", f"idle != {_bits(idle)}'d{idle}"


def _stream_conditions(design: Design) -> Iterator[tuple[str, str]]:
    """Those of the words: first the number's, then the status's."""
    count, bits = words_per_column(design), _bits(_parts(design) - 1)
    yield "last_as_due", f"!want_valid || result_last == (part == {bits}'d{_parts(design) - 1})"
    words = (
        f"(part != {bits}'d{i} || result_data == first_number[{low + WORD_BITS - 1}:{low}])"
        for i, low in enumerate(range(0, count * WORD_BITS, WORD_BITS))
    )
    yield "major_as_due", f"!want_valid || ({' && '.join(words)})"
    for bit, name in enumerate(_STATUS):
        same = f"result_data[{bit}] == first_status[{bit}]"
        yield name, f"!want_valid || part != {bits}'d{count} || {same}"

"""A shift register around the core, so that its many ports need no pins.

Where nextpnr cannot place a core alone (all but ECP5), this is how it gets in: a core has hundreds
of port bits, pins on every one would not fit, and their distance would be measured instead of the
core.  So each input comes from a register and each output goes to one, as in a user's design.  The
input
registers are one long shift register; the output registers are folded into another, so that nothing
can be optimised away.  All of it has the core's clock, and its area is not counted: the core's own
is measured without it.
"""

from __future__ import annotations

from collections.abc import Iterable

from sculler_hdl import Port

TOP = "sculler__harness"
"""The harness' module; no design can be called so, for its name has no two _ in a row."""
CORE = "core"
"""Instance of the core in the harness: its signals are `core.` and their own name."""


_PIN = """module {top} (clk, scan_in, scan_out);
  input clk, scan_in;
"""
_OSCILLATOR = """module {top} (scan_in, scan_out);
  input scan_in;
  wire clk;
  OSCA #(.HF_CLK_DIV("1"), .HF_OSC_EN("ENABLED")) oscillator (
    .HFOUTEN(1'b1), .HFSDSCEN(1'b0), .HFCLKOUT(clk)
  );
"""


def harness(core: str, ports: Iterable[Port], *, oscillator: bool = False) -> str:
    """Verilog of the harness, and of the core as a black box.

    Args:
        core: name of the core's module.
        ports: its ports (`Manifest.ports`).
        oscillator: the clock comes from the oscillator of a Nexus instead of a pin, for nextpnr
            finds no way from a pin to a clock net there.
    """
    head = (_OSCILLATOR if oscillator else _PIN).format(top=TOP)
    inputs, outputs, declarations, connections = 0, 0, [], [".clk(clk)"]
    for port in ports:
        name, width = port.name, port.bits
        declarations.append(f"  {port.direction} [{width - 1}:0] {name};")
        if name == "clk":
            continue
        if not port.output:
            connections.append(f".{name}(fed[{inputs + width - 1}:{inputs}])")
            inputs += width
        else:
            connections.append(f".{name}(shown[{outputs + width - 1}:{outputs}])")
            outputs += width
    names = ", ".join(port.name for port in ports)
    text_declarations = "\n".join(declarations)
    text_connections = ",\n    ".join(connections)
    return f"""(* blackbox *)
module {core} ({names});
{text_declarations}
endmodule

{head}  output scan_out;
  reg [{inputs - 1}:0] fed;
  wire [{outputs - 1}:0] shown;
  reg [{outputs - 1}:0] caught, folded;
  always @(posedge clk) begin
    fed <= {{fed, scan_in}};
    caught <= shown;
    folded <= {{folded, 1'b0}} ^ caught;
  end
  assign scan_out = folded[{outputs - 1}];
  {core} {CORE} (
    {text_connections}
  );
endmodule
"""

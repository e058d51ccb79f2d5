"""Which names a design may have: those that every tool downstream takes for a module's.

The name becomes a Verilog module, `NAME_tb` beside it, and what a VHDL project instantiates.
"""

from __future__ import annotations

import keyword
import re

from sculler_model.design.vendor_blocks import BLOCKS

LONGEST = 64
"""Characters of a name."""

SYSTEM_VERILOG = frozenset(
    "accept_on alias always always_comb always_ff always_latch and assert assign assume automatic "
    "before begin bind bins binsof bit break buf bufif0 bufif1 byte case casex casez cell chandle "
    "checker class clocking cmos config const constraint context continue cover covergroup "
    "coverpoint cross deassign default defparam design disable dist do edge else end endcase "
    "endchecker endclass endclocking endconfig endfunction endgenerate endgroup endinterface "
    "endmodule endpackage endprimitive endprogram endproperty endsequence endspecify endtable "
    "endtask enum event eventually expect export extends extern final first_match for force "
    "foreach forever fork forkjoin function generate genvar global highz0 highz1 if iff ifnone "
    "ignore_bins illegal_bins implements implies import incdir include initial inout input inside "
    "instance int integer interconnect interface intersect join join_any join_none large let "
    "liblist library local localparam logic longint macromodule matches medium modport module nand "
    "negedge nettype new nexttime nmos nor noshowcancelled not notif0 notif1 null or output "
    "package packed parameter pmos posedge primitive priority program property protected pull0 "
    "pull1 pulldown pullup pulsestyle_ondetect pulsestyle_onevent pure rand randc randcase "
    "randsequence rcmos real realtime ref reg reject_on release repeat restrict return rnmos rpmos "
    "rtran rtranif0 rtranif1 s_always s_eventually s_nexttime s_until s_until_with scalared "
    "sequence shortint shortreal showcancelled signed small soft solve specify specparam static "
    "string strong strong0 strong1 struct super supply0 supply1 sync_accept_on sync_reject_on "
    "table tagged task this throughout time timeprecision timeunit tran tranif0 tranif1 tri tri0 "
    "tri1 triand trior trireg type typedef union unique unique0 unsigned until until_with untyped "
    "use uwire var vectored virtual void wait wait_order wand weak weak0 weak1 while wildcard wire "
    "with within wor xnor xor".split()
)
"""Reserved words of IEEE 1800-2017, Annex B, which holds those of Verilog too."""

VHDL = frozenset(
    "abs access after alias all and architecture array assert assume assume_guarantee attribute "
    "begin block body buffer bus case component configuration constant context cover default "
    "disconnect downto else elsif end entity exit fairness file for force function generate "
    "generic group guarded if impure in inertial inout is label library linkage literal loop map "
    "mod nand new next nor not null of on open or others out package parameter port postponed "
    "procedure process property protected pure range record register reject release rem report "
    "restrict restrict_guarantee return rol ror select sequence severity shared signal sla sll sra "
    "srl strong subtype then to transport type unaffected units until use variable vmode vprop "
    "vunit wait when while with xnor xor".split()
)
"""Reserved words of IEEE 1076-2008, clause 15.10."""

RESERVED_WORDS = SYSTEM_VERILOG | VHDL
"""What no signal or module of the emitted Verilog is called."""

_VHDL_LIBRARIES = frozenset(("work", "std", "ieee"))
_VERILATORS = frozenset(("std", "randomize"))  # its own package, and a function it parses anywhere
_PORTS = frozenset(("clk", "rst", "rst_n", "clk_en"))


def name_fault(name: str) -> str | None:
    """Why a design cannot have a name, in words that follow it; None: it can.

    VHDL knows no case, so case makes no difference, but for Python's words and Verilator's TOP.
    """
    if not re.fullmatch(rf"[A-Za-z][A-Za-z0-9_]{{0,{LONGEST - 1}}}", name) or "__" in name:
        return (
            f"is not allowed, give a letter, then up to {LONGEST - 1} letters, digits or single _"
        )
    lower = name.lower()
    if lower.endswith("_tb"):
        return "is not allowed, names that end with _tb are those of test benches"
    for language, taken in (
        ("SystemVerilog", lower in SYSTEM_VERILOG),
        ("VHDL", lower in VHDL),
        ("Python", keyword.iskeyword(name)),
    ):
        if taken:
            return f"is a reserved word of {language}, give another name"
    for family, blocks in BLOCKS.items():
        if name.upper() in blocks:
            return f"is the name of a block of {family} devices, give another name"
    if lower in _VHDL_LIBRARIES:
        return "is the name of a library of VHDL, give another name"
    if lower in _VERILATORS or name == "TOP":
        return "is a name of Verilator's own, give another name"
    if lower in _PORTS:
        return "is the name of a port, give another name"
    return None

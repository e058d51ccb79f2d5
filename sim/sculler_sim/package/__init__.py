"""A generated core as an IP package: what FPGA tools need to take it in.

    contents        what is handed out: modules, files, ports, clocks, interfaces
    fusesoc         NAME.core, for FuseSoC
    ipxact          NAME_ipxact_2014.xml, NAME_ipxact_2022.xml
    constraints     NAME.sdc, .xdc, .pdc, .lpf: the clocks, and paths that are not timed
    vendors         NAME_vivado.tcl, NAME_hw.tcl, for Vivado and Platform Designer
    cocotb_bench    test_NAME.py, a bench for pytest and cocotb
    unit_cocotb     test_NAME_unit.py, the same for the unit
    boards          NAME_BOARD.v, pins and Makefile: example top levels
    files           all of them

Nothing here builds hardware; it describes what `sculler_hdl` generated.
"""

// Wishbone B4, 3.1.4 (pipelined): as many answers as accesses, also where the master ends the
// cycle at any time; then what is under way is not answered.
module top (
  input clk, input rst, input cyc, input stb, input we, input [11:0] adr, input [31:0] dat_w,
  input [3:0] sel, input result_valid, input [15:0] result_data, input result_last
);
  wire ack, err, stall;
  wire [31:0] dat_r;
  narrow_bus bus (
    .clk(clk), .rst(rst), .wb_cyc(cyc), .wb_stb(stb), .wb_we(we), .wb_adr(adr),
    .wb_dat_w(dat_w), .wb_sel(sel), .wb_ack(ack), .wb_err(err), .wb_dat_r(dat_r),
    .wb_stall(stall), .core_result_valid(result_valid), .core_result_data(result_data),
    .core_result_last(result_last)
  );
  reg [1:0] open = 0;  // accesses taken and not answered
  reg [2:0] clocks = 0;
  reg cyc_before = 0;
  always @(posedge clk) begin
    cyc_before <= cyc && !rst;
    open <= rst || !cyc ? 0 : open + (stb && !stall) - (ack || err);
    clocks <= !rst && cyc && stb && stall ? clocks + 1 : 0;
    assert (!(ack && err));
    if ((ack || err) && cyc && cyc_before && !rst) assert (open != 0);
    if ((ack || err) && !rst) assert (cyc_before);
    assert (open <= 1);
    assert (clocks <= 5);
  end
endmodule

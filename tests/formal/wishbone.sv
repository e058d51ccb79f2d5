// Wishbone B4, 3.1.3 (classic): the master holds an access until it is answered; ack and err
// never come together, never without an access, and soon.
module top (
  input clk, input rst, input cyc, input stb, input we, input [11:0] adr, input [31:0] dat_w,
  input [3:0] sel, input result_valid, input [15:0] result_data, input result_last
);
  wire ack, err;
  wire [31:0] dat_r;
  narrow_bus bus (
    .clk(clk), .rst(rst), .wb_cyc(cyc), .wb_stb(stb), .wb_we(we), .wb_adr(adr),
    .wb_dat_w(dat_w), .wb_sel(sel), .wb_ack(ack), .wb_err(err), .wb_dat_r(dat_r),
    .core_result_valid(result_valid), .core_result_data(result_data),
    .core_result_last(result_last)
  );
  reg waits = 0;
  reg [2:0] clocks = 0;
  always @(posedge clk) begin
    waits <= !rst && cyc && stb && !ack && !err;
    if (waits) assume (cyc && stb);
    clocks <= !rst && cyc && stb && !ack && !err ? clocks + 1 : 0;
    assert (!(ack && err));
    if ((ack || err) && !rst) assert (cyc && stb);
    assert (clocks <= 4);
  end
endmodule

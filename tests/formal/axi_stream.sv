// AXI4-Stream, IHI 0051: 2.2.1 (what is valid stays, unchanged, until ready); and packets have
// WORDS words, tkeep is all ones, and tuser is the same beside all of them.
module top (
  input clk, input rst, input tready,
  input result_valid, input [15:0] result_data, input result_last
);
  parameter WORDS = 27;
  wire tvalid, tlast;
  wire [31:0] tdata;
  wire [3:0] tkeep, tuser;
  narrow_bus bus (
    .clk(clk), .rst(rst), .m_axis_tvalid(tvalid), .m_axis_tready(tready), .m_axis_tdata(tdata),
    .m_axis_tkeep(tkeep), .m_axis_tlast(tlast), .m_axis_tuser(tuser),
    .core_result_valid(result_valid), .core_result_data(result_data),
    .core_result_last(result_last)
  );
  reg begun = 0, waits;
  reg [36:0] before;
  reg [3:0] user;
  reg [7:0] word = 0;
  always @(posedge clk) begin
    begun <= 1;
    waits <= tvalid && !tready && !rst;
    before <= {tuser, tlast, tdata};
    if (tvalid && tready) word <= tlast ? 0 : word + 1;
    if (rst) word <= 0;
    if (tvalid && word == 0) user <= tuser;
    if (begun && waits) assert (tvalid && before == {tuser, tlast, tdata});
    if (tvalid && !rst) begin
      assert (tkeep == 4'b1111);
      assert (tlast == (word == WORDS - 1));
      if (word != 0) assert (tuser == user);
    end
  end
endmodule

// AXI4-Lite, IHI 0022: A3.2.1 (what is valid stays, unchanged, until ready), A3.3.1 (an answer
// comes after its request); and at most two requests of a channel wait.
module top (
  input clk, input rst, input awvalid, input wvalid, input bready, input arvalid, input rready,
  input [11:0] awaddr, input [31:0] wdata, input [3:0] wstrb, input [11:0] araddr,
  input result_valid, input [15:0] result_data, input result_last
);
  wire awready, wready, bvalid, arready, rvalid;
  wire [1:0] bresp, rresp;
  wire [31:0] rdata;
  narrow_bus bus (
    .clk(clk), .rst(rst),
    .s_axi_awvalid(awvalid), .s_axi_awready(awready), .s_axi_awaddr(awaddr),
    .s_axi_wvalid(wvalid), .s_axi_wready(wready), .s_axi_wdata(wdata), .s_axi_wstrb(wstrb),
    .s_axi_bvalid(bvalid), .s_axi_bready(bready), .s_axi_bresp(bresp),
    .s_axi_arvalid(arvalid), .s_axi_arready(arready), .s_axi_araddr(araddr),
    .s_axi_rvalid(rvalid), .s_axi_rready(rready), .s_axi_rdata(rdata), .s_axi_rresp(rresp),
    .core_result_valid(result_valid), .core_result_data(result_data),
    .core_result_last(result_last)
  );
  reg begun = 0, b_waits, r_waits;
  reg [1:0] bresp_before, rresp_before;
  reg [31:0] rdata_before;
  reg [2:0] addresses = 0, data = 0, reads = 0;
  always @(posedge clk) begin
    begun <= 1;
    b_waits <= bvalid && !bready && !rst;
    r_waits <= rvalid && !rready && !rst;
    bresp_before <= bresp;
    rresp_before <= rresp;
    rdata_before <= rdata;
    addresses <= rst ? 0 : addresses + (awvalid && awready) - (bvalid && bready);
    data <= rst ? 0 : data + (wvalid && wready) - (bvalid && bready);
    reads <= rst ? 0 : reads + (arvalid && arready) - (rvalid && rready);
    if (begun && b_waits) assert (bvalid && bresp == bresp_before);
    if (begun && r_waits) assert (rvalid && rresp == rresp_before && rdata == rdata_before);
    if (!rst && bvalid) assert (addresses != 0 && data != 0);
    if (!rst && rvalid) assert (reads != 0);
    assert (addresses <= 2 && data <= 2 && reads <= 2);
  end
endmodule

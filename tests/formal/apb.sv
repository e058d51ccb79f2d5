// APB4, IHI 0024: the requester holds an access until pready; the completer is ready only within
// one, soon, and tells of an error with pready only.
module top (
  input clk, input rst, input psel, input penable, input pwrite, input [11:0] paddr,
  input [31:0] pwdata, input [3:0] pstrb,
  input result_valid, input [15:0] result_data, input result_last
);
  wire pready, pslverr;
  wire [31:0] prdata;
  narrow_bus bus (
    .clk(clk), .rst(rst), .s_apb_psel(psel), .s_apb_penable(penable), .s_apb_pwrite(pwrite),
    .s_apb_paddr(paddr), .s_apb_pwdata(pwdata), .s_apb_pstrb(pstrb), .s_apb_pready(pready),
    .s_apb_prdata(prdata), .s_apb_pslverr(pslverr),
    .core_result_valid(result_valid), .core_result_data(result_data),
    .core_result_last(result_last)
  );
  reg setup = 0, access = 0;  // the clock before was an access's first, or a later one that waits
  reg [2:0] clocks = 0;
  always @(posedge clk) begin
    setup <= !rst && psel && !penable;
    access <= !rst && psel && penable && !pready;
    assume (penable == (setup || access));
    if (setup || access) assume (psel);
    clocks <= !rst && psel && penable && !pready ? clocks + 1 : 0;
    if (pready && !rst) assert (psel && penable);
    if (pslverr) assert (pready);
    assert (clocks <= 4);
  end
endmodule

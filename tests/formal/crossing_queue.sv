// A queue between two clocks that have nothing to do with each other: the edges of either come at
// any time.  A bit that changes while it is looked at may be seen as it was (the test puts that
// into the synchronisers).  Words come out in their order, none twice, none lost, none made up.
module top (input w_clk, input r_clk, input [1:0] data_in, input valid_in, input ready_out);
  parameter DEPTH = 4;
  wire ready_in, valid_out;
  wire [1:0] data_out;
  queue queue (
    .w_clk(w_clk), .w_rst(1'b0), .r_clk(r_clk), .r_rst(1'b0), .data_in(data_in),
    .valid_in(valid_in), .ready_in(ready_in), .data_out(data_out), .valid_out(valid_out),
    .ready_out(ready_out)
  );
  wire put = valid_in && ready_in, take = valid_out && ready_out;
  reg [3:0] puts = 0, takes = 0;
  wire [3:0] fill = puts - takes;
  // one word, any, is looked for on the other side
  (* anyseq *) wire pick;
  reg watched = 0, found = 0;
  reg [1:0] word;
  reg [3:0] number;
  reg waits = 0;
  reg [1:0] shown;
  reg [2:0] late_word = 0, late_room = 0;
  always @(posedge w_clk) begin
    if (put) puts <= puts + 1;
    if (put && pick && !watched) begin
      watched <= 1;
      word <= data_in;
      number <= puts;
    end
    late_room <= fill != DEPTH && !ready_in ? late_room + 1 : 0;
  end
  always @(posedge r_clk) begin
    if (take) takes <= takes + 1;
    if (take && watched && takes == number) found <= 1;
    waits <= valid_out && !ready_out;
    shown <= data_out;
    late_word <= fill != 0 && !valid_out ? late_word + 1 : 0;
  end
  always @* begin
    assert (fill <= DEPTH);
    if (valid_out) assert (fill != 0);
    if (valid_out && watched && !found && takes == number) assert (data_out == word);
    if (waits) assert (valid_out && data_out == shown);
    assert (late_word <= 3);
    assert (late_room <= 3);
  end
endmodule

// A sensor front end, whatever comes by its wire and however long the core waits: a sample that is
// offered stays, unchanged, until it is taken; sample_valid is low for a clock between samples, so
// that none looks like one that waits; counts change only as a sample is offered; counters do not
// go round; nothing is offered before something was counted.
`ifdef SPI
`define PINS input miso, input data_ready,
`define WIRE .miso(miso), .data_ready(data_ready), .sck(sck), .cs_n(cs_n), .mosi(mosi),
`else
`define PINS input rx,
`define WIRE .rx(rx),
`endif
module top (input clk, input rst, `PINS input sample_ready);
  wire sck, cs_n, mosi;
  wire valid, fault;
  wire [`BITS-1:0] gx, gy, gz, ax, ay, az;
  wire [31:0] taken, bad, missed, late, faults;
  front front (
    .clk(clk), .rst(rst), `WIRE .sample_ready(sample_ready), .sample_valid(valid),
    .sample_gyro_x(gx), .sample_gyro_y(gy), .sample_gyro_z(gz),
    .sample_accel_x(ax), .sample_accel_y(ay), .sample_accel_z(az), .sample_fault(fault),
    .frames_taken(taken), .frames_bad(bad), .frames_missed(missed), .frames_late(late),
    .sensor_faults(faults)
  );
  wire [6*`BITS-1:0] counts = {gx, gy, gz, ax, ay, az};
  reg begun = 0, waits = 0, went = 0, was = 0;
  reg [6*`BITS-1:0] before;
  reg marked;
  reg [4:0] high;
  wire [4:0] tops = {taken[31], bad[31], missed[31], late[31], faults[31]};
  always @(posedge clk) begin
    begun <= 1;
    was <= begun && !rst;
    waits <= begun && valid && !sample_ready && !rst;
    went <= begun && valid && sample_ready && !rst;
    before <= counts;
    marked <= fault;
    high <= tops;
    if (waits) stays: assert (valid && counts == before && fault == marked);
    if (went) falls: assert (!valid);
    if (was && counts != before) offers: assert (valid);
    if (was) whole: assert ((high & ~tops) == 0);
    if (was && valid && !waits && !went) counted: assert (taken != 0 || missed != 0 || late != 0);
  end
`ifdef SPI
  // mode 3: sck is high while the sensor is not selected; mosi changes only as sck falls, and
  // stands while sck rises; sck stays for half a period
  reg sck_was, cs_was, mosi_was;
  reg [7:0] held = 0;
  always @(posedge clk) begin
    {sck_was, cs_was, mosi_was} <= {sck, cs_n, mosi};
    held <= rst || !begun || sck != sck_was || cs_n != cs_was ? 0 : held + (held != 255);
    if (was) mode_3: assert ((sck || !cs_n) && (mosi == mosi_was || !sck || sck_was));
    if (was && mosi != mosi_was) moves: assert (sck_was && (!sck || cs_n));
    if (was && sck != sck_was) half: assert (!cs_n && !cs_was && held + 1 >= `HALF);
  end
`endif
endmodule

"""What the generated test bench knows of compensation.

A sample of the sensor is taken when none is under way, and the core behind takes the compensated
one (`sculler_model.golden.cycles`).
"""

from __future__ import annotations

from sculler_model.golden import Timing

_CORE_READY = """\
clock >= next_sample_from
                    && !(now_work != 0 && clock < engine_free_from)
                    && !(last_is_next && full);"""


def compensation_texts(timing: Timing, clocking: dict[str, object]) -> dict[str, object]:
    """The texts of the bench that depend on it.

    Args:
        timing: the core's clocks.
        clocking: the texts that depend on reset and clock enable.
    """
    not_in_reset, in_reset = clocking["not_in_reset"], clocking["in_reset"]
    if timing.compensation is None:
        return {
            "ready": f"  wire want_ready = {not_in_reset}{_CORE_READY}\n",
            "taken": "sample_taken",
            "then_taken": "",
            "untold": "loss || (untold && !last_taken)",
            "told_loss": "untold",
            "compensating": "",
        }
    return {
        "ready": f"""\
  // a sample is taken when none is under way, and compensated before the core takes it
  localparam COMPENSATION = {timing.compensation};  // clocks until it is offered to the core
  reg under_way;
  reg marked;  // a sample was lost before it
  reg lost_before;  // and since the last one that was taken
  integer offered_from;
  wire want_ready = {not_in_reset}!under_way;
  wire core_ready = {_CORE_READY}
  wire core_taken = under_way && clock >= offered_from && core_ready && !{in_reset};
""",
        "taken": "core_taken",
        "then_taken": "      end\n      if (core_taken) begin\n",
        "untold": "(untold || (core_taken && marked)) && !last_taken",
        "told_loss": "untold || marked",
        "compensating": f"""\
  // ---- compensation: one sample of the sensor at a time ------------------------------------
  always @(posedge clk) {clocking["when_counted"]}begin
    if ({in_reset}) begin
      under_way <= 1'b0;
      lost_before <= 1'b0;
    end else begin
      lost_before <= loss || (lost_before && !sample_taken);
      if (core_taken) under_way <= 1'b0;
      if (sample_taken) begin
        under_way <= 1'b1;
        marked <= lost_before;
        offered_from <= clock + COMPENSATION;
      end
    end
  end

  initial begin
    under_way = 1'b0;
    marked = 1'b0;
    lost_before = 1'b0;
    offered_from = 0;
  end

""",
    }

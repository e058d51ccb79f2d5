"""What the generated test bench does about results that a core drops.

Now and then samples wait for the host, as if the core dropped nothing, so that what these intervals
are made for is seen at the ports: in the second run, of every so many intervals the first ones, in
which each rail is touched alone; and after a reset until the first result was taken, which would
tell of anything that was left of what went before.
"""

from __future__ import annotations

from collections.abc import Sequence

from sculler_model.design import Design
from sculler_sim.bench_runs import ROUND, Kind, Run

_WAITS = """\
  // None of the results of these intervals is dropped: at most one waits when the next begins.
  localparam SHOWN = %(shown)d;  // in the second run, of every
  localparam ROUND = %(round)d;
  wire shows = SHOWN != 0 && run == 1 && intervals %% ROUND <= SHOWN;
  // And the first after a reset is taken whole, before others come one after another; but not in
  // the run in which all are to come so.
  wire begins = run > 2 && kind < HELD && results == results_from;
  wire waits = begins ? last_taken || made != results
               : shows && made - results + (last_taken ? 1 : 0) > 1;
"""

_SEEN = """\
  localparam FIRSTS = %(firsts)d;  // runs in which the first result is to be taken whole
  integer firsts;  // in which it was
  reg [11:0] touched;  // rails that samples of the present interval have touched
  reg [11:0] touched_by [0:RESULTS-1];  // those of each result
  reg [11:0] alone;  // rails that all other counts of a result kept off, which the host took whole
  wire [11:0] touches = touched | {at_low, at_high};
  wire [11:0] shown = touched_by[results < RESULTS ? results : 0];

  always @(posedge clk) %(when_counted)sbegin
    if (rst) touched <= 0;
    else if (sample_taken) touched <= last_taken ? 0 : touches;
    if (last_taken && made < RESULTS) touched_by[made] <= touches;
    if (result_taken && (shown & (shown - 1'b1)) == 0) alone <= alone | shown;
    if (result_taken && begins) firsts <= firsts + 1;
  end

  initial begin
    firsts = 0;
    touched = 0;
    alone = 0;
  end

"""


def dropping_texts(
    design: Design, runs: Sequence[Run], clocking: dict[str, object]
) -> dict[str, object]:
    """The texts of the bench that depend on it; they are empty where nothing is dropped.

    Args:
        design: the design.
        runs: those of the bench.
        clocking: the texts that depend on reset and clock enable.
    """
    if not design.drops_results:
        return {"waiting": "", "or_waits": "", "seen": ""}
    firsts = sum(run.kind in (Kind.QUICK, Kind.CUT) for run in runs[3:])
    return {
        "waiting": _WAITS % {"shown": runs[1].shown, "round": ROUND},
        "or_waits": " || waits",
        "seen": _SEEN % {"firsts": firsts, "when_counted": clocking["when_counted"]},
    }

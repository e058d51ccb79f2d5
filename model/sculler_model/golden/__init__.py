"""The golden model: the page in plain Python integers, and the core's ports clock by clock.

`GoldenModel` is the reference for every other way to the same integers; `CycleModel` says what each
output port does on every clock.  `ChannelModel` is the reference of a core with many sensors.
There is no numpy here.  It imports `algorithms` and `design`.
"""

from sculler_model.golden.channel_cycles import (
    ABSENT,
    AFTER_LAUNCH,
    ChannelCycleModel,
    ChannelTiming,
)
from sculler_model.golden.channels import ChannelModel, ChannelSample
from sculler_model.golden.compensation import Compensator
from sculler_model.golden.cycles import (
    COUNTER_BITS,
    COUNTER_MAX,
    PORT_MAJOR_BITS,
    RELEASE,
    CycleModel,
    Dropping,
    Ports,
    Timing,
    result_ports,
)
from sculler_model.golden.pipelined_channels import (
    PipelinedChannelModel,
    PipelinedChannelTiming,
)
from sculler_model.golden.reference import GoldenModel, Sample, check_widths
from sculler_model.golden.stream import (
    WORD_BITS,
    from_words,
    to_words,
    words_per_column,
    words_per_result,
)
from sculler_model.golden.throughput import clocks_per_major, clocks_per_minor

__all__ = [
    "ABSENT",
    "AFTER_LAUNCH",
    "COUNTER_BITS",
    "COUNTER_MAX",
    "PORT_MAJOR_BITS",
    "RELEASE",
    "WORD_BITS",
    "ChannelCycleModel",
    "ChannelModel",
    "ChannelSample",
    "ChannelTiming",
    "Compensator",
    "CycleModel",
    "Dropping",
    "GoldenModel",
    "PipelinedChannelModel",
    "PipelinedChannelTiming",
    "Ports",
    "Sample",
    "Timing",
    "check_widths",
    "clocks_per_major",
    "clocks_per_minor",
    "from_words",
    "result_ports",
    "to_words",
    "words_per_column",
    "words_per_result",
]

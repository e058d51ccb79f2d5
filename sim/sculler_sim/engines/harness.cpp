// Drives one verilated core by the rules of sculler_sim/engine.py, many clocks a call.
//
// Follows the model and, for each design, definitions that `verilator_build.py` writes:
//   SCULLER_SAMPLES(X)  X(member, bits) for each of the six counts, in the log's order
// and, where the hand-over is parallel,
//   SCULLER_RESULTS(X)  X(member, bits) for each of the components, in the vectors' order
// or, where it is a stream,
//   SCULLER_WORDS       words of a result
//   SCULLER_COLUMN      words of each of its columns
// and
//   SCULLER_LIMBS       64-bit words that a component takes in a row
// and, where the core drops results, has rst_n in place of rst, has clk_en,
//   SCULLER_DROPS, SCULLER_RESET_LOW, SCULLER_CLOCK_ENABLE
// and, where it has channels,
//   SCULLER_CHANNELS    how many

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <type_traits>

namespace {

#ifdef SCULLER_CHANNELS
constexpr int64_t CHANNELS = SCULLER_CHANNELS, TAGS = 1;
#else
constexpr int64_t CHANNELS = 1, TAGS = 0;
#endif

// A result: major, status, of each component the limbs, low to high, and its channel, if there are.
#ifdef SCULLER_WORDS
constexpr int64_t COMPONENTS = SCULLER_WORDS / SCULLER_COLUMN - 2;
constexpr int64_t SHOWN = 2 + TAGS;  // data, last
#else
#define SCULLER_ONE(member, bits) +1
constexpr int64_t COMPONENTS = 0 SCULLER_RESULTS(SCULLER_ONE);
constexpr int64_t SHOWN = 2 + COMPONENTS * SCULLER_LIMBS;
#endif
constexpr int64_t ROW = 2 + COMPONENTS * SCULLER_LIMBS + TAGS;

#ifdef SCULLER_VCD
// Remembers why a waveform could not be written; Verilator's own would end the process.
class WaveFile final : public VerilatedVcdFile {
public:
    int error = 0;

    ssize_t write(const char* data, ssize_t size) override {
        while (!error) {
            const ssize_t written = VerilatedVcdFile::write(data, size);
            if (written >= 0) return written;
            if (errno != EAGAIN && errno != EINTR) error = errno;
        }
        return size;
    }
};
#endif

struct Core {
    VerilatedContext context;
    Vcore top{start(context), ""};
#ifdef SCULLER_VCD
    WaveFile file;
    SCULLER_TRACE wave{&file};
#elif defined SCULLER_TRACE
    SCULLER_TRACE wave;
#endif
    bool held = false;  // a sample is offered and not yet taken
    bool pause = false;  // a sample was given up in the clock before
    int64_t words = 0;  // taken of the result under way
    uint64_t result[ROW];
    int64_t phase[CHANNELS] = {};  // samples taken of the present major interval
    uint64_t clocks = 0;

    static VerilatedContext* start(VerilatedContext& context) {
        context.randReset(2);  // whatever the design does not start itself starts at random
        context.randSeed(1);
#ifdef SCULLER_TRACE
        context.traceEverOn(true);
#endif
        return &context;
    }

    // The clock is low in the first half of each clock period, so that what the ports show at its
    // end is what the rising edge sees.
    void low() {
        top.clk = 0;
        top.eval();
        dump(0);
    }

    void rise() {
        top.clk = 1;
        top.eval();
        dump(5);
        ++clocks;
    }

    void dump(int half) {
#ifdef SCULLER_TRACE
        if (wave.isOpen()) wave.dump(10 * clocks + half);
#else
        (void)half;
#endif
    }
};

// In a clock with neither the core stands still.
void drive_clocking(Core& core, bool rst, bool enable) {
#ifdef SCULLER_RESET_LOW
    core.top.rst_n = !rst;
#else
    core.top.rst = rst;
#endif
#ifdef SCULLER_CLOCK_ENABLE
    core.top.clk_en = enable;
#else
    (void)enable;
#endif
}

bool stands_still(bool rst, bool enable) {
#ifdef SCULLER_CLOCK_ENABLE
    return !rst && !enable;
#else
    (void)rst, (void)enable;
    return false;
#endif
}

template <class Port>
void drive(Port& port, int64_t value, int bits) {
    port = static_cast<Port>(static_cast<uint64_t>(value) & (~uint64_t{0} >> (64 - bits)));
}

uint64_t sign_extended(uint64_t value, int bits) {
    const int unused = 64 - bits;
    return static_cast<uint64_t>(static_cast<int64_t>(value << unused) >> unused);
}

// What the host has when it has taken what the result ports show: a result or a part of one, or,
// where result_last is not where it belongs, nothing of use.
enum class Taken { whole, part, wrong };

#ifdef SCULLER_WORDS

void read_ports(const Core& core, uint64_t* shown) {
    shown[0] = core.top.result_data;
    shown[1] = core.top.result_last;
#ifdef SCULLER_CHANNELS
    shown[2] = core.top.result_channel;
#endif
}

// Puts a word of 16 bits where it belongs in the result; a component's last one extends its sign.
void put_word(Core& core, uint64_t data) {
    const int64_t column = core.words / SCULLER_COLUMN, place = core.words % SCULLER_COLUMN;
    const bool component = column >= 2;
    const int64_t limbs = component ? SCULLER_LIMBS : 1, limb = place / 4;
    uint64_t* const first = core.result + (component ? 2 + (column - 2) * SCULLER_LIMBS : column);
    if (limb >= limbs) return;  // of `major` only 64 bits are kept, as of all that is not wider
    if (place % 4 == 0) first[limb] = 0;
    first[limb] |= data << 16 * (place % 4);
    if (!component || place != SCULLER_COLUMN - 1) return;
    first[limb] = sign_extended(first[limb], 16 * static_cast<int>(place % 4 + 1));
    for (int64_t i = limb + 1; i < limbs; ++i) first[i] = first[limb] >> 63 ? ~uint64_t{0} : 0;
}

Taken take_result(Core& core) {
    put_word(core, core.top.result_data);
    const bool whole = ++core.words == SCULLER_WORDS;
    if (whole != core.top.result_last) return Taken::wrong;
    if (whole) core.words = 0;
#ifdef SCULLER_CHANNELS
    core.result[ROW - 1] = core.top.result_channel;
#endif
    return whole ? Taken::whole : Taken::part;
}

#else

template <class Port>
std::enable_if_t<std::is_integral_v<Port>> read(const Port& port, int bits, uint64_t* limbs) {
    limbs[0] = sign_extended(port, bits);
    for (int i = 1; i < SCULLER_LIMBS; ++i) limbs[i] = limbs[0] >> 63 ? ~uint64_t{0} : 0;
}

template <std::size_t Words>
void read(const VlWide<Words>& port, int bits, uint64_t* limbs) {
    uint64_t sign = 0;
    for (int i = 0; i < SCULLER_LIMBS; ++i) {
        const int left = bits - 64 * i;
        if (left <= 0) {
            limbs[i] = sign;
            continue;
        }
        const std::size_t word = 2 * static_cast<std::size_t>(i);
        limbs[i] = port[word];
        if (word + 1 < Words) limbs[i] |= static_cast<uint64_t>(port[word + 1]) << 32;
        if (left < 64) limbs[i] = sign_extended(limbs[i], left);
        sign = limbs[i] >> 63 ? ~uint64_t{0} : 0;
    }
}

void read_ports(const Core& core, uint64_t* row) {
    *row++ = core.top.result_major;
    *row++ = core.top.result_status;
#define READ(member, bits)              \
    read(core.top.member, bits, row);   \
    row += SCULLER_LIMBS;
    SCULLER_RESULTS(READ)
#undef READ
}

Taken take_result(Core& core) {
    read_ports(core, core.result);
    return Taken::whole;
}

#endif

// Major intervals up to the one whose result was taken last, when `told` were before.
int64_t intervals(const Core& core, int64_t told) {
#ifndef SCULLER_DROPS
    return told + 1;
#else
    return static_cast<int64_t>(core.result[0]) + 1;
#endif
}

uint16_t results_dropped(const Core& core) {
#ifdef SCULLER_DROPS
    return core.top.results_dropped;
#else
    (void)core;
    return 0;
#endif
}

void drive_tag(Core& core, int32_t tag, bool valid) {
#ifdef SCULLER_CHANNELS
    int bits = 1;
    while (CHANNELS - 1 >> bits) ++bits;
    drive(core.top.sample_channel, (tag >> 1) ^ (valid ? 0 : -1), bits);
    core.top.sample_restart = valid ? tag & 1 : 1;
#else
    (void)core, (void)tag, (void)valid;
#endif
}

// A sample is taken; whether it is the last of a major interval.
bool count_sample(Core& core, int32_t tag, int64_t interval) {
    int64_t& phase = core.phase[tag >> 1];
    if (tag & 1) phase = 0;
    if (++phase < interval) return false;
    phase = 0;
    return true;
}

void drive_sample(Core& core, const int32_t* counts, uint8_t fault, bool valid) {
    const int64_t flip = valid ? 0 : -1;  // what is not offered shows its complement
#define DRIVE(member, bits) drive(core.top.member, *counts++ ^ flip, bits);
    SCULLER_SAMPLES(DRIVE)
#undef DRIVE
    core.top.sample_fault = valid ? fault : 1;
}

}  // namespace

struct Levels {
    const uint8_t* offer;
    const uint8_t* take;
    const uint8_t* rst;
    const uint8_t* give_up;
    const uint8_t* enable;
};

// Counted on by each call; the fields of sculler_sim.run.Progress.
struct Progress {
    int64_t clocks, samples, lost, since_reset, results, intervals_told, idle, due;
};

#define EXPORT extern "C" __attribute__((visibility("default")))

EXPORT Core* sculler_create(const char* wave) {
    auto core = std::make_unique<Core>();
#ifdef SCULLER_RESET_FIRST
    // A core without initial values: one clock of reset, which is not counted.
    drive_clocking(*core, true, false);
    core->low();
    core->rise();
    drive_clocking(*core, false, false);
    core->clocks = 0;
#endif
#ifdef SCULLER_TRACE
    core->top.trace(&core->wave, 99);
    core->wave.set_time_unit("1ns");
    core->wave.set_time_resolution("1ns");
    core->wave.open(wave);
    if (!core->wave.isOpen()) return nullptr;
#else
    (void)wave;
#endif
    return core.release();
}

// Returns the system's error that a waveform met, or 0.
EXPORT int sculler_destroy(Core* core) {
    int error = 0;
    core->top.final();
#ifdef SCULLER_TRACE
    core->wave.close();
#endif
#ifdef SCULLER_VCD
    error = core->file.error;
#endif
    delete core;
    return error;
}

// Runs up to `clocks` clocks.
//   counts, faults: samples x 6 and samples
//   tags: channel * 2 + restart of each, or null where there are no channels
//   interval: samples in a major interval
//   rows, capacity: room for that many results taken, ROW words each
//   handshakes, shown, counters: null, or clocks x (sample_ready, result_valid), clocks x SHOWN and
//     clocks x (samples_lost, results_dropped)
// With `shown` it runs all the clocks and puts down the ports in each of them.  Otherwise it ends
// earlier: after the clock that takes the last sample or in which it is given up; if there are none, as soon as all complete
// intervals' results have been taken; or when `rows` is full.
// Returns 0; or, as soon as result_last is wrong, the words taken of that result.
EXPORT int64_t sculler_run(Core* core, const int32_t* counts, const uint8_t* faults,
                        const int32_t* tags, int64_t samples, int64_t interval, const Levels* levels, int64_t clocks, uint64_t* rows,
                        int64_t capacity, uint8_t* handshakes, uint64_t* shown,
                        uint16_t* counters, Progress* progress) {
    Progress p = *progress;
    Vcore& top = core->top;
    int64_t next = 0, taken = 0;
    int64_t driven = -1;  // 2 * sample + valid of what the sample ports show
    const auto ended = [&] {
        if (taken == capacity) return true;
        if (samples) return next == samples;
        return p.intervals_told >= p.due;
    };
    for (int64_t clock = 0; clock < clocks && (shown || !ended()); ++clock) {
        const bool valid = next < samples && (levels->offer[clock] || core->held) && !core->pause;
        const bool take = levels->take[clock], rst = levels->rst[clock];
        const bool enable = levels->enable[clock];
        top.sample_valid = valid;
        top.result_ready = take;
        drive_clocking(*core, rst, enable);
        if (next < samples && driven != 2 * next + valid) {
            drive_sample(*core, counts + 6 * next, faults[next], valid);
            drive_tag(*core, tags ? tags[next] : 0, valid);
            driven = 2 * next + valid;
        }
        core->low();
        if (shown) {
            *handshakes++ = top.sample_ready;
            *handshakes++ = top.result_valid;
            if (top.result_valid)
                read_ports(*core, shown);
            else
                std::fill_n(shown, SHOWN, 0);  // the result ports mean nothing
            shown += SHOWN;
            *counters++ = top.samples_lost;
            *counters++ = results_dropped(*core);
        }
        ++p.clocks;
        ++p.idle;
        if (stands_still(rst, enable)) {
            core->rise();
            continue;
        }
        core->held = valid;
        core->pause = valid && levels->give_up[clock] && (rst || !top.sample_ready);
        if (core->pause) {
            core->held = false;
            ++next;
            ++p.lost;
        }
        if (rst) {
            p.since_reset = p.intervals_told = p.due = 0;
            std::fill_n(core->phase, CHANNELS, 0);
            core->words = 0;
        } else {
            if (valid && top.sample_ready) {
                core->held = false;
                p.due += count_sample(*core, tags ? tags[next] : 0, interval);
                ++next;
                ++p.samples;
                ++p.since_reset;
                p.idle = 0;
            }
            if (take && top.result_valid) {
                p.idle = 0;
                const Taken what = take_result(*core);
                if (what == Taken::wrong) return core->words;
                if (what == Taken::whole) {
                    if (!shown) std::copy_n(core->result, ROW, rows + ROW * taken++);
                    ++p.results;
                    p.intervals_told = intervals(*core, p.intervals_told);
                }
            }
        }
        core->rise();
    }
    *progress = p;
    return 0;
}

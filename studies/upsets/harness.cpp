// Runs one verilated core again and again, each time with one bit turned over, and says what came of it.
//
// Follows the model and, for each design, definitions that `build.py` writes:
//   SCULLER_SAMPLES(X)  X(member, bits) for each of the six counts
//   SCULLER_OUTPUTS(X)  X(member, bits) for what belongs to a result: its ports and the counters
//   SCULLER_STATUS      number of the 64-bit word of a result in which its status stands
// and, where the hand-over is a stream,
//   SCULLER_WORDS       words of a result
// and, where the core has such a port,
//   SCULLER_UPSET

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "verilated_sym_props.h"
#include "verilated_syms.h"

namespace {

#ifdef SCULLER_UPSET
constexpr uint64_t UPSET = 16;  // of the status
#else
constexpr uint64_t UPSET = 0;
#endif
constexpr int LATE = 3;         // clocks after a result's last word in which `upset` still tells of it
constexpr int LIMIT = 3;        // times the clocks of an undisturbed run, after which a run hangs

struct Place {
    uint8_t* data;  // of the first word
    uint64_t stride;
    uint64_t size;  // bytes of it all
};

struct Result {
    std::vector<uint64_t> words;  // the status without the bit of upsets
    bool flagged = false;
    uint64_t status_clock = 0, end_clock = 0;
};

template <class Port>
std::enable_if_t<std::is_integral_v<Port>> put(std::vector<uint64_t>& to, const Port& port) {
    to.push_back(port);
}

template <std::size_t Words>
void put(std::vector<uint64_t>& to, const VlWide<Words>& port) {
    for (std::size_t i = 0; i < Words; ++i) to.push_back(port[i]);
}

// The numbers of the random clocks in which nothing is offered or taken.
uint64_t mixed(uint64_t value) {
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
    return value ^ (value >> 31);
}

// Where a run is, but for what the model holds.
struct Run {
    uint64_t clock = 0, offer_from = 0, take_from = 0, words = 0;
    int64_t sample = 0;
    Result now;
    std::vector<Result> results;
    std::vector<uint8_t> seen;  // the port `upset`, clock by clock
};

struct Kept {
    Run run;
    std::vector<uint8_t> model;
};

struct Campaign {
    VerilatedContext context;
    std::unique_ptr<Vcore> top;
    std::vector<Place> every;  // all that the model holds
    std::vector<uint8_t> first;
    std::vector<Place> targets;
    std::vector<Kept> kept;  // after the last sample of each interval
    std::vector<Result> reference;
    std::vector<uint64_t> ended;  // clocks that took the last sample of each interval
    uint64_t reference_clocks = 0;
    const int32_t* counts = nullptr;
    int64_t samples = 0, interval = 1, wanted = 1;

    Campaign() {
        context.randReset(0);
        top = std::make_unique<Vcore>(&context, "TOP");
        top->eval();
    }

    void keep_all() {
        for (const auto& scope : *context.scopeNameMap()) {
            if (!scope.second->varsp()) continue;
            for (auto& named : *scope.second->varsp()) {
                const VerilatedVar& var = named.second;
                if (var.isParam()) continue;
                every.push_back({static_cast<uint8_t*>(var.datap()), 0, var.totalSize()});
            }
        }
        first = model();
    }

    std::vector<uint8_t> model() const {
        std::vector<uint8_t> all;
        for (const Place& place : every)
            all.insert(all.end(), place.data, place.data + place.size);
        return all;
    }

    void restore(const std::vector<uint8_t>& all) {
        const uint8_t* from = all.data();
        for (const Place& place : every) {
            std::memcpy(place.data, from, place.size);
            from += place.size;
        }
    }

    bool find(const std::string& scope, const std::string& name) {
        const VerilatedScope* const found = context.scopeFind(scope.c_str());
        VerilatedVar* const var = found ? found->varFind(name.c_str()) : nullptr;
        if (!var) return false;
        targets.push_back({static_cast<uint8_t*>(var->datap()), var->entSize(), var->totalSize()});
        return true;
    }

    void drive(int64_t sample, bool valid) {
        const int32_t* from = counts + 6 * (sample % samples);
        const int64_t turned = valid ? 0 : -1;
#define DRIVE(member, bits) \
    top->member = static_cast<std::decay_t<decltype(top->member)>>((*from++ ^ turned) & (~uint64_t{0} >> (64 - bits)));
        SCULLER_SAMPLES(DRIVE)
#undef DRIVE
        top->sample_fault = !valid;
    }

    void rise() {
        top->clk = 1;
        top->eval();
    }

    void reset() {
        restore(first);
        top->rst = 1;
        top->sample_valid = 0;
        top->result_ready = 0;
        drive(0, false);
        for (int i = 0; i < 2; ++i) {
            top->clk = 0;
            top->eval();
            rise();
        }
        top->rst = 0;
    }

    // The undisturbed run, from a reset.
    void refer(uint64_t limit) {
        Run run;
        reset();
        while (run.clock < limit && !done(run)) {
            const int64_t before = run.sample;
            step(run);
            if (run.sample != before && run.sample % interval == 0) {
                ended.push_back(run.clock - 1);
                kept.push_back({run, model()});
            }
        }
        reference = run.results;
        reference_clocks = run.clock;
        for (const uint8_t high : run.seen)
            if (high) reference_clocks = 0;
    }

    // A run from the end of interval `from`, of which a bit is turned over after clock `when`.
    Run disturbed(int64_t from, int64_t target, int64_t word, int64_t bit, uint64_t when) {
        Run run = kept[from].run;
        restore(kept[from].model);
        while (run.clock < LIMIT * reference_clocks && !done(run)) {
            step(run);
            if (run.clock == when + 1) {
                const Place& place = targets[target];
                place.data[place.stride * word + bit / 8] ^= 1 << bit % 8;
                top->eval();
            }
        }
        return run;
    }

    bool done(const Run& run) const {
        return static_cast<int64_t>(run.results.size()) >= wanted &&
               run.clock > run.results.back().end_clock + LATE;
    }

    void step(Run& run) {
        const bool valid = run.clock >= run.offer_from, ready = run.clock >= run.take_from;
        top->clk = 0;
        top->sample_valid = valid;
        top->result_ready = ready;
        drive(run.sample, valid);
        top->eval();
#ifdef SCULLER_UPSET
        run.seen.push_back(top->upset);
#else
        run.seen.push_back(0);
#endif
        if (valid && top->sample_ready) {
            const uint64_t draw = mixed(++run.sample);
            run.offer_from = run.clock + 1 + (draw % 5 ? 0 : draw >> 32 & 7);
        }
        if (ready && top->result_valid) {
            const uint64_t draw = mixed(++run.words ^ 0x5555);
            run.take_from = run.clock + 1 + (draw % 7 ? 0 : draw >> 32 & 7);
            take(run.now, run.clock);
#ifdef SCULLER_WORDS
            const bool last = top->result_last || run.now.words.size() > 4 * SCULLER_WORDS;
#else
            const bool last = true;
#endif
            if (last) {
                run.now.words.push_back(top->samples_lost);
                run.now.end_clock = run.clock;
                if (static_cast<int64_t>(run.results.size()) < wanted) run.results.push_back(run.now);
                run.now = Result();
            }
        }
        rise();
        ++run.clock;
    }

    void take(Result& now, uint64_t clock) {
        const std::size_t before = now.words.size();
#define PUT(member, bits) put(now.words, top->member);
        SCULLER_OUTPUTS(PUT)
#undef PUT
        if (before <= SCULLER_STATUS && SCULLER_STATUS < now.words.size()) {
            uint64_t& status = now.words[SCULLER_STATUS];
            now.flagged = status & UPSET;
            status &= ~UPSET;
            now.status_clock = clock;
        }
    }
};

}  // namespace

// What came of a flip; the fields of `campaign.Outcome`, in their order.
struct Outcome {
    int64_t interval;  // in which it was: intervals that had ended before
    int64_t results;   // handed over, of those wanted
    int64_t wrong, own, late, silent;  // of the wrong ones: flagged by their own status, later, never
    int64_t last_wrong;  // number of the last wrong one, or -1
    int64_t last_flagged;  // of the last flagged one, or -1
    int64_t told, told_at_end;  // whether the port told of it, and does in the last clock
};

#define EXPORT extern "C" __attribute__((visibility("default")))

EXPORT Campaign* upsets_create(const int32_t* counts, int64_t samples, int64_t interval, int64_t wanted) {
    auto made = std::make_unique<Campaign>();
    made->counts = counts;
    made->samples = samples;
    made->interval = interval;
    made->wanted = wanted;
    made->keep_all();
    return made.release();
}

EXPORT void upsets_destroy(Campaign* campaign) {
    campaign->top->final();
    delete campaign;
}

EXPORT int upsets_target(Campaign* campaign, const char* scope, const char* name) {
    return campaign->find(scope, name);
}

// The undisturbed run: returns its clocks, or 0 if it hands over less than is wanted or tells of an upset.
EXPORT uint64_t upsets_reference(Campaign* campaign, uint64_t limit, uint64_t* ends) {
    campaign->refer(limit);
    if (static_cast<int64_t>(campaign->reference.size()) < campaign->wanted) return 0;
    for (int64_t i = 0; i < campaign->wanted; ++i) ends[i] = campaign->ended[i];
    return campaign->reference_clocks;
}

// The 64-bit words of a result of the undisturbed run; returns how many.
EXPORT int64_t upsets_words(const Campaign* campaign, int64_t result, uint64_t* words) {
    const std::vector<uint64_t>& from = campaign->reference[result].words;
    if (words) std::copy(from.begin(), from.end(), words);
    return static_cast<int64_t>(from.size());
}

EXPORT void upsets_flip(Campaign* campaign, int64_t target, int64_t word, int64_t bit, uint64_t when,
                        Outcome* outcome) {
    int64_t from = 0;
    while (campaign->ended[from] <= when) ++from;  // intervals that have ended
    const Run run = campaign->disturbed(from - 1, target, word, bit, when);
    const std::vector<Result>& results = run.results;
    const std::vector<uint8_t>& seen = run.seen;
    Outcome made{from, static_cast<int64_t>(results.size()), 0, 0, 0, 0, -1, -1, 0, seen.back()};
    for (const uint8_t high : seen) made.told |= high;
    for (std::size_t i = 0; i < results.size(); ++i) {
        const Result& result = results[i];
        if (result.flagged) made.last_flagged = static_cast<int64_t>(i);
        if (result.words == campaign->reference[i].words) continue;
        ++made.wrong;
        made.last_wrong = static_cast<int64_t>(i);
        bool told = i + 1 < results.size() && results[i + 1].flagged;
        for (uint64_t c = result.status_clock; c <= result.end_clock + LATE && c < seen.size(); ++c)
            told |= seen[c];
        ++(result.flagged ? made.own : told ? made.late : made.silent);
    }
    *outcome = made;
}

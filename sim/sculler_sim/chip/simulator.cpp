// A chip's clock, its sensor's line and its telemetry's, in Verilator.
//
//   chip LINE OUT CLOCKS
//
// LINE has a row a byte: the clock in which its start bit begins, and the byte.  OUT gets a row for
// each byte that the chip sends: the clock in which its start bit began, and the byte; -1 where its
// stop bit was not high.
//
// Defined by the build: SENSOR_PIN, TELEMETRY_PIN, CLOCKS_A_SENSOR_BIT (a double), SENSOR_PARITY
// (0 none, 1 odd, 2 even), CLOCKS_A_TELEMETRY_BIT, RESET_CLOCKS.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "Vchip.h"

namespace {

// The sensor's end of its line.
class Sender {
  public:
    explicit Sender(std::FILE *file) : file_(file) { next(); }

    int level(uint64_t clock) {
        while (bit_ < bits_ && clock >= edge_) {
            level_ = bit_ == 0 ? 0 : bit_ <= 8 ? byte_ >> (bit_ - 1) & 1 : bit_ < bits_ - 1 ? parity() : 1;
            bit_++;
            edge_ = begin_ + (uint64_t)std::llround(bit_ * CLOCKS_A_SENSOR_BIT);
            if (bit_ == bits_) next();
        }
        return level_;
    }

  private:
    int parity() const { return __builtin_parity((unsigned)byte_) ^ (SENSOR_PARITY == 1); }

    void next() {
        unsigned long long begin = 0;
        unsigned byte = 0;
        if (std::fscanf(file_, "%llu %u", &begin, &byte) != 2) {
            bits_ = bit_ = 0;
            return;
        }
        begin_ = edge_ = begin;
        byte_ = (int)byte;
        bits_ = SENSOR_PARITY ? 11 : 10;
        bit_ = 0;
    }

    std::FILE *file_;
    uint64_t begin_ = 0, edge_ = 0;
    int byte_ = 0, bits_ = 0, bit_ = 0, level_ = 1;
};

// The other end of the telemetry's.
class Receiver {
  public:
    explicit Receiver(std::FILE *file) : file_(file) {}

    void take(uint64_t clock, int level) {
        if (!busy_) {
            if (level) return;
            busy_ = true;
            begin_ = clock;
            look_ = clock + CLOCKS_A_TELEMETRY_BIT / 2;
            bit_ = 0;
            byte_ = 0;
        }
        if (clock != look_) return;
        look_ += CLOCKS_A_TELEMETRY_BIT;
        if (bit_ >= 1 && bit_ <= 8) byte_ |= level << (bit_ - 1);
        if (bit_++ == 9) {
            std::fprintf(file_, "%llu %d\n", (unsigned long long)begin_, level ? byte_ : -1);
            busy_ = false;
        }
    }

  private:
    std::FILE *file_;
    bool busy_ = false;
    uint64_t begin_ = 0, look_ = 0;
    int bit_ = 0, byte_ = 0;
};

}  // namespace

int main(int count, char **words) {
    if (count != 4) return 2;
    std::FILE *line = std::fopen(words[1], "r"), *out = std::fopen(words[2], "w");
    if (!line || !out) return 2;
    const uint64_t clocks = std::strtoull(words[3], nullptr, 10);
    VerilatedContext context;
    Vchip chip{&context};
    Sender sender(line);
    Receiver receiver(out);
    for (uint64_t clock = 0; clock < clocks; clock++) {
        chip.rst = clock < RESET_CLOCKS;
        chip.SENSOR_PIN = sender.level(clock);
        chip.clk = 0;
        chip.eval();
        chip.clk = 1;
        chip.eval();
        receiver.take(clock, chip.TELEMETRY_PIN);
    }
    chip.final();
    return std::fclose(out) ? 1 : 0;
}

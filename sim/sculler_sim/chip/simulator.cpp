// A chip's clock, its sensor's line and its telemetry's, in Verilator.
//
//   chip LINE OUT CLOCKS
//
// LINE has what the sensor sends.  On an asynchronous line a row a byte: the clock in which its start
// bit begins, and the byte.  Over SPI a row a sample: the clock in which data-ready rises, how many
// bytes the sensor has then, and these.  OUT gets a row for each byte that the chip sends: the clock
// in which its start bit began, and the byte; -1 where its stop bit was not high.
//
// Defined by the build: TELEMETRY_PIN, CLOCKS_A_TELEMETRY_BIT, RESET_CLOCKS; of an asynchronous line
// SENSOR_PIN, CLOCKS_A_SENSOR_BIT (a double), SENSOR_PARITY (0 none, 1 odd, 2 even); of SPI
// SENSOR_REQUESTS (words of 16 bits, separated by commas), READY_CLOCKS (how long data-ready is high).
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "Vchip.h"

namespace {

#ifdef SENSOR_REQUESTS
// A sensor on SPI in mode 3: while it takes the first word it shows zeros, then the sample's bytes,
// as long as it has been asked for them in the right words.
class Sensor {
  public:
    explicit Sensor(std::FILE *file) : file_(file) { next(); }

    void drive(Vchip &chip, uint64_t clock) {
        if (there_ && clock == ready_) {
            shown_ = bytes_;
            bit_ = 0;
            asked_ = true;
            low_at_ = clock + READY_CLOCKS;
            chip.data_ready = 1;
            next();
        }
        if (clock == low_at_) chip.data_ready = 0;
        if (!chip.cs_n && sck_ && !chip.sck) {
            const size_t place = bit_ / 8;
            const bool in_frame = place >= 2 && place < shown_.size() + 2;
            miso_ = in_frame && asked_ ? shown_[place - 2] >> (7 - bit_ % 8) & 1 : 0;
        }
        if (!chip.cs_n && !sck_ && chip.sck) {
            word_ = (word_ << 1 | chip.mosi) & 0xFFFFu;
            if (++bit_ % 16 == 0) {
                const size_t number = bit_ / 16 - 1;
                asked_ = asked_ && word_ == (number < requests_.size() ? requests_[number] : 0u);
            }
        }
        sck_ = chip.sck;
        chip.miso = (uint8_t)miso_;
    }

  private:
    void next() {
        unsigned long long ready = 0;
        unsigned count = 0;
        there_ = std::fscanf(file_, "%llu %u", &ready, &count) == 2;
        ready_ = ready;
        bytes_.assign(there_ ? count : 0u, 0u);
        for (unsigned &byte : bytes_) {
            if (std::fscanf(file_, "%u", &byte) != 1) there_ = false;
        }
    }

    const std::vector<unsigned> requests_{SENSOR_REQUESTS};
    std::FILE *file_;
    std::vector<unsigned> bytes_, shown_;
    uint64_t ready_ = 0, low_at_ = 0;
    size_t bit_ = 0;
    unsigned word_ = 0;
    int miso_ = 0;
    bool there_ = false, asked_ = false, sck_ = true;
};
#else
// The sensor's end of its line.
class Sensor {
  public:
    explicit Sensor(std::FILE *file) : file_(file) { next(); }

    void drive(Vchip &chip, uint64_t clock) { chip.SENSOR_PIN = (uint8_t)level(clock); }

  private:

    int level(uint64_t clock) {
        while (bit_ < bits_ && clock >= edge_) {
            level_ = bit_ == 0 ? 0 : bit_ <= 8 ? byte_ >> (bit_ - 1) & 1 : bit_ < bits_ - 1 ? parity() : 1;
            bit_++;
            edge_ = begin_ + (uint64_t)std::llround(bit_ * CLOCKS_A_SENSOR_BIT);
            if (bit_ == bits_) next();
        }
        return level_;
    }

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
#endif

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
    Sensor sensor(line);
    Receiver receiver(out);
    for (uint64_t clock = 0; clock < clocks; clock++) {
        chip.rst = clock < RESET_CLOCKS;
        sensor.drive(chip, clock);
        chip.clk = 0;
        chip.eval();
        chip.clk = 1;
        chip.eval();
        receiver.take(clock, chip.TELEMETRY_PIN);
    }
    chip.final();
    return std::fclose(out) ? 1 : 0;
}

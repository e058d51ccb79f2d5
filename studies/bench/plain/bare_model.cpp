// Bare evaluation of a verilated core: drives every sample of a file, toggles the clock, evaluates.
// Nothing is checked and no result is read.  Usage: bare COUNTS (int32, six a sample).

#include <cstdint>
#include <cstdio>
#include <vector>

int main(int count, char** words) {
    if (count != 2) return 2;
    std::FILE* file = std::fopen(words[1], "rb");
    if (!file) return 2;
    std::vector<int32_t> counts;
    std::vector<int32_t> block(6 << 12);
    while (std::size_t got = std::fread(block.data(), 4, block.size(), file))
        counts.insert(counts.end(), block.begin(), block.begin() + static_cast<long>(got));
    std::fclose(file);

    VerilatedContext context;
    Vcore top{&context, ""};
    top.rst = 0;
    top.result_ready = 1;
    top.sample_fault = 0;
    top.sample_valid = 1;
    const auto bits = [](int32_t value, int width) {
        return static_cast<uint32_t>(value) & (~uint32_t{0} >> (32 - width));
    };
    for (std::size_t next = 0; next + 6 <= counts.size();) {
        const int32_t* sample = counts.data() + next;
        top.sample_gyro_x = bits(sample[0], GYRO_BITS);
        top.sample_gyro_y = bits(sample[1], GYRO_BITS);
        top.sample_gyro_z = bits(sample[2], GYRO_BITS);
        top.sample_accel_x = bits(sample[3], ACCEL_BITS);
        top.sample_accel_y = bits(sample[4], ACCEL_BITS);
        top.sample_accel_z = bits(sample[5], ACCEL_BITS);
        top.clk = 0;
        top.eval();
        if (top.sample_ready) next += 6;
        top.clk = 1;
        top.eval();
    }
}

/* A log in CSV to the vectors of the preset stim300 in CSV, the way one writes it by hand in C: the
   other side of a contest (studies/bench/files.py).  It reads and writes the files in large blocks,
   trusts its input, and computes with the numbers of this one design written into it: n = 4 samples
   a minor interval, M = 5 minor intervals, taps 214, 92, 54.

   usage: csv_vectors LOG.csv VECTORS.csv */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { BLOCK = 1 << 20, LONGEST = 4096, SAMPLES = 4, MINORS = 5, BITS = 24 };

typedef struct { int64_t x, y, z; } vec;

static vec plus(vec a, vec b) { return (vec){a.x + b.x, a.y + b.y, a.z + b.z}; }

static vec cross(vec a, vec b)
{
    return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* the weighted sum of the three samples before the last one */
static vec weighted(const vec *s)
{
    return (vec){214 * s[2].x + 92 * s[1].x + 54 * s[0].x,
                 214 * s[2].y + 92 * s[1].y + 54 * s[0].y,
                 214 * s[2].z + 92 * s[1].z + 54 * s[0].z};
}

static char in[LONGEST + BLOCK], out[BLOCK + LONGEST];
static size_t written;

static inline const char *read_number(const char *at, int64_t *value)
{
    int negative = *at == '-';
    at += negative;
    int64_t number = 0;
    for (unsigned figure; (figure = (unsigned)(*at - '0')) < 10; at++)
        number = 10 * number + figure;
    *value = negative ? -number : number;
    return at + 1; /* past the comma or the line end */
}

static inline void write_number(int64_t value, char end)
{
    char digits[24];
    int count = 0;
    uint64_t size = value < 0 ? -(uint64_t)value : (uint64_t)value;
    do
        digits[count++] = (char)('0' + size % 10);
    while (size /= 10);
    if (value < 0)
        digits[count++] = '-';
    while (count)
        out[written++] = digits[--count];
    out[written++] = end;
}

static void write_vector(vec v, char end)
{
    write_number(v.x, ',');
    write_number(v.y, ',');
    write_number(v.z, end);
}

int main(int count, char **arguments)
{
    static const char header[] =
        "major,status,alpha_x,alpha_y,alpha_z,coning_within_x,coning_within_y,coning_within_z,"
        "coning_between_x,coning_between_y,coning_between_z,nu_x,nu_y,nu_z,"
        "sculling_within_x,sculling_within_y,sculling_within_z,"
        "sculling_between_x,sculling_between_y,sculling_between_z\n";
    FILE *log = count == 3 ? fopen(arguments[1], "rb") : NULL;
    FILE *vectors = log ? fopen(arguments[2], "wb") : NULL;
    if (!vectors || !fgets(in, LONGEST, log))
        return 1;
    fwrite(header, 1, sizeof header - 1, vectors);

    const vec zero = {0, 0, 0};
    const int64_t low = -(1 << (BITS - 1)), high = (1 << (BITS - 1)) - 1;
    vec alpha = zero, coning_within = zero, coning_between = zero;
    vec nu = zero, sculling_within = zero, sculling_between = zero;
    vec s[SAMPLES], r[SAMPLES];
    int64_t major = 0, status = 0;
    int sample = 0, minor = 0;
    size_t kept = 0, got;
    while ((got = fread(in + kept, 1, BLOCK, log)) > 0) {
        const char *at = in, *end = in + kept + got;
        while (end > in && end[-1] != '\n')
            end--;
        while (at < end) {
            int64_t c[6];
            for (int i = 0; i < 6; i++) {
                at = read_number(at, &c[i]);
                if (c[i] == low || c[i] == high)
                    status |= 4;
            }
            s[sample] = (vec){c[0], c[1], c[2]};
            r[sample] = (vec){c[3], c[4], c[5]};
            if (++sample < SAMPLES)
                continue;
            sample = 0;
            vec A = weighted(s), B = weighted(r);
            coning_within = plus(coning_within, cross(A, s[3]));
            sculling_within = plus(sculling_within, plus(cross(A, r[3]), cross(B, s[3])));
            vec theta = plus(plus(s[0], s[1]), plus(s[2], s[3]));
            vec v = plus(plus(r[0], r[1]), plus(r[2], r[3]));
            coning_between = plus(coning_between, cross(alpha, theta));
            sculling_between = plus(sculling_between, plus(cross(alpha, v), cross(nu, theta)));
            alpha = plus(alpha, theta);
            nu = plus(nu, v);
            if (++minor < MINORS)
                continue;
            minor = 0;
            write_number(major++, ',');
            write_number(status, ',');
            write_vector(alpha, ',');
            write_vector(coning_within, ',');
            write_vector(coning_between, ',');
            write_vector(nu, ',');
            write_vector(sculling_within, ',');
            write_vector(sculling_between, '\n');
            if (written >= BLOCK) {
                fwrite(out, 1, written, vectors);
                written = 0;
            }
            alpha = coning_within = coning_between = zero;
            nu = sculling_within = sculling_between = zero;
            status = 0;
        }
        kept = (size_t)(in + kept + got - end);
        memmove(in, end, kept);
    }
    fwrite(out, 1, written, vectors);
    return fclose(vectors) != 0;
}

/* Exact coning and sculling sums of one design, the table as constants of the compiler.

   The header TABLE defines
     N, M              samples in a minor interval, minor intervals in a major one
     COUNT             type of the counts
     WIDE, WIDE_SUMS   whether the components, and the weighted sums, pass 64 bits
     POSITION          whether the nine components of high-resolution position follow
     TAPS_k(T)         T(distance, tap) for each tap of phase k
     PHASES(P)         P(k, TAPS_k) for each phase that has taps
     WEIGHTS(T)        T(distance, weight) for each weight */

#include <stdint.h>
#include TABLE

#if WIDE
typedef __int128 total;
#else
typedef int64_t total;
#endif
#if WIDE_SUMS
typedef __int128 sum;
#else
typedef int64_t sum;
#endif

#if POSITION
enum { COLUMNS = 27 };

/* S_alpha and S_nu over 12, and scrolling: the sums of docs/explanation/theory.md, sample by sample. */
static void position(const COUNT (*restrict s)[6], total *restrict out)
{
    for (int x = 0; x < 3; x++) {
        total scrolling = 0;
        for (int turn = 0; turn < 2; turn++) {
            int y = (x + 1 + turn) % 3, z = (x + 2 - turn) % 3;
            total alpha = 0, nu = 0, S_alpha = 0, S_nu = 0, sum = 0;
            for (int m = 0; m < N * M; m++) {
                int64_t r = N * M - 1 - m, more = r > 0;
                total a = s[m][y], b = s[m - 1][y], u = s[m - 1][y + 3];
                total P = (2880 * r + 780 + 300 * more) * alpha + (360 * r + 102) * b
                        + (720 * r - 42 + 240 * more) * a - 60 * S_alpha;
                total Q = (1440 * r + 1020 + 60 * more) * nu + (360 * r + 78) * u + 60 * S_nu;
                sum += P * s[m][z + 3] + Q * s[m][z] + 18 * b * s[m - 1][z + 3];
                S_alpha += 12 * alpha + 5 * a + b;
                S_nu += 12 * nu + 5 * s[m][y + 3] + u;
                alpha += a;
                nu += s[m][y + 3];
            }
            scrolling += turn ? -sum : sum;
            out[y] = S_alpha;
            out[3 + y] = S_nu;
        }
        out[6 + x] = scrolling;
    }
}
#else
enum { COLUMNS = 18 };
#endif

void vectors(const COUNT (*restrict counts)[6], int64_t majors, total (*restrict out)[COLUMNS])
{
    for (int64_t major = 0; major < majors; major++, counts += N * M, out++) {
        total cw[3] = {0}, sw[3] = {0}, cb[3] = {0}, sb[3] = {0};
        sum alpha[3] = {0}, nu[3] = {0};
        for (int minor = 0; minor < M; minor++) {
            const COUNT(*t)[6] = counts + minor * N;
#define TAP(d, c) A[i] += (sum)(c) * s[-(d)][i], B[i] += (sum)(c) * s[-(d)][3 + i];
#define PHASE(k, TAPS) { \
            const COUNT(*s)[6] = t + (k) - 1; \
            sum A[3] = {0}, B[3] = {0}; \
            for (int i = 0; i < 3; i++) { TAPS(TAP) } \
            for (int x = 0; x < 3; x++) { \
                int y = (x + 1) % 3, z = (x + 2) % 3; \
                cw[x] += (total)A[y] * s[0][z] - (total)A[z] * s[0][y]; \
                sw[x] += (total)A[y] * s[0][3 + z] - (total)A[z] * s[0][3 + y] \
                       + (total)B[y] * s[0][z] - (total)B[z] * s[0][y]; \
            } }
            PHASES(PHASE)
            const COUNT(*s)[6] = t + N - 1;
            sum theta[3] = {0}, v[3] = {0};
#define WEIGHT(d, c) theta[i] += (sum)(c) * s[-(d)][i], v[i] += (sum)(c) * s[-(d)][3 + i];
            for (int i = 0; i < 3; i++) { WEIGHTS(WEIGHT) }
            if (minor)
                for (int x = 0; x < 3; x++) {
                    int y = (x + 1) % 3, z = (x + 2) % 3;
                    cb[x] += (total)alpha[y] * theta[z] - (total)alpha[z] * theta[y];
                    sb[x] += (total)alpha[y] * v[z] - (total)alpha[z] * v[y]
                           + (total)nu[y] * theta[z] - (total)nu[z] * theta[y];
                }
            for (int i = 0; i < 3; i++) alpha[i] += theta[i], nu[i] += v[i];
        }
        for (int i = 0; i < 3; i++) {
            out[0][i] = alpha[i];
            out[0][3 + i] = cw[i];
            out[0][6 + i] = cb[i];
            out[0][9 + i] = nu[i];
            out[0][12 + i] = sw[i];
            out[0][15 + i] = sb[i];
        }
#if POSITION
        position(counts, &out[0][18]);
#endif
    }
}

/* The sensors' noise as a window at rest shows it.
 *
 * At rest, resolved by attitudes that the gyros carry on, the direction of gravity seems to wander.
 * That wander, two series of tilts about north and east, is a sum of three kinds of noise: the
 * gyros' random walk, the accelerometers' white noise, and noise of the velocity at an instant,
 * differenced.  The variances are those of most likelihood, from the series' cosine transform, in
 * which a random walk and white noise fall apart into independent modes.  The gyros' angle by itself
 * shows the random walk more sharply but takes sway for noise, so the walk is the mean over what it
 * may be in the light of the tilts.
 */
#include "sculler_align.h"

#include "sculler_math.h"

#define ROUNDS 300
#define FEWER 40
#define POINTS 16u
#define LAST_POINT 15.0
#if defined(SCULLER_SINGLE) || defined(SCULLER_DOUBLE_SINGLE)
#define NOTHING 1e-30 /* rad^2, of a series without any noise */
#define LEAST 1e-35   /* to divide by */
#else
#define NOTHING 1e-40
#define LEAST 1e-300
#endif

typedef struct {
    sculler_real variance[3]; /* of walk, white, blue */
} variances;

/* The power of a series in a mode. */
static sculler_real power_of(const sculler_real *mode, const sculler_real *series, size_t count)
{
    sculler_real sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += mode[i] * series[i];
    }
    return sum * sum;
}

/* A cosine mode of a series, less its best straight line. */
static void make_mode(sculler_real *mode, size_t count, size_t order)
{
    sculler_real n = (sculler_real)count, middle = 0.5 * (n - 1.0);
    sculler_real norm = sqrt(n * (n * n - 1.0) / 12.0), mean = 0.0, slope = 0.0;
    for (size_t i = 0; i < count; i++) {
        mode[i] = sqrt(2.0 / n) * cos(SCULLER_PI / n * (sculler_real)order * ((sculler_real)i + 0.5));
        mean += mode[i] / n;
        slope += mode[i] * (((sculler_real)i - middle) / norm);
    }
    for (size_t i = 0; i < count; i++) {
        mode[i] -= mean + slope * (((sculler_real)i - middle) / norm);
    }
}

/* The power of a mode for each unit of variance: of a random walk's means over the steps, of white
 * noise, of differenced white noise. */
static void make_spectrum(const sculler_real *mode, size_t count, sculler_real spectrum[3])
{
    sculler_real squares = 0.0, neighbours = 0.0, above = 0.0, walk = 0.0;
    for (size_t left = count; left > 0u; left--) {
        size_t i = left - 1u;
        squares += mode[i] * mode[i];
        neighbours += i + 1u < count ? mode[i] * mode[i + 1u] : 0.0;
        above += mode[i]; /* of all from i on: min(i, j) is the number of l <= i, j */
        walk += i > 0u ? above * above : 0.0;
    }
    spectrum[0] = walk - squares / 6.0;
    spectrum[1] = squares;
    spectrum[2] = 2.0 * squares - 2.0 * neighbours;
}

static sculler_real expected_of(const sculler_real spectrum[3], const variances *v, size_t kinds)
{
    sculler_real sum = 0.0;
    for (size_t k = 0; k < kinds; k++) {
        sum += v->variance[k] * spectrum[k];
    }
    return sum;
}

/* Variances of most likelihood for the modes' powers: the rule of non-negative factorisation for
 * the Itakura-Saito divergence, which lifts the likelihood with every round.
 *
 * kinds: 2 without blue noise; first: the first variance where it is known, else negative; start:
 * variances to begin from, for fewer rounds, or null. */
static variances most_likely(
    const sculler_align *window, const sculler_real *power, size_t kinds, sculler_real first,
    const variances *start)
{
    size_t modes = window->part_count - 2u;
    variances found = {{0.0, 0.0, 0.0}};
    sculler_real total = 0.0;
    for (size_t p = 0; p < modes; p++) {
        total += power[p];
    }
    for (size_t k = 0; k < kinds; k++) {
        sculler_real sum = 0.0;
        for (size_t p = 0; p < modes; p++) {
            sum += window->spectra[p][k];
        }
        sculler_real even = total / sum, least = 1e-3 * even;
        found.variance[k] = even;
        if (start != NULL) {
            found.variance[k] = start->variance[k] > least ? start->variance[k] : least;
        }
    }
    int rounds = FEWER;
    if (start == NULL) {
        rounds = ROUNDS;
    }
    for (int round = 0; round < rounds; round++) {
        sculler_real above[3] = {0.0, 0.0, 0.0}, below[3] = {0.0, 0.0, 0.0};
        if (first >= 0.0) {
            found.variance[0] = first;
        }
        for (size_t p = 0; p < modes; p++) {
            sculler_real expected = expected_of(window->spectra[p], &found, kinds);
            expected = expected > LEAST ? expected : LEAST;
            for (size_t k = 0; k < kinds; k++) {
                above[k] += power[p] / (expected * expected) * window->spectra[p][k];
                below[k] += window->spectra[p][k] / expected;
            }
        }
        for (size_t k = 0; k < kinds; k++) {
            found.variance[k] *= sqrt(above[k] / below[k]);
        }
    }
    if (first >= 0.0) {
        found.variance[0] = first;
    }
    return found;
}

/* The logarithm of the likelihood, of two axes. */
static sculler_real fit_of(const sculler_align *window, const variances *v)
{
    sculler_real sum = 0.0;
    for (size_t p = 0; p + 2u < window->part_count; p++) {
        sculler_real expected = expected_of(window->spectra[p], v, 3u);
        sum += log(expected) + window->power[0][p] / expected;
    }
    return -sum;
}

/* How likely a walk (rad) is against the best variances. */
static sculler_real chance_of(
    const sculler_align *window, sculler_real walk, const variances *free, sculler_real best)
{
    variances with = most_likely(window, window->power[0], 3u, walk * walk, free);
    sculler_real excess = fit_of(window, &with) - best;
    return exp(excess < 0.0 ? excess : 0.0);
}

/* The walk's variance, its mean over what it may be: every walk up to a limit as likely as another.
 * Gets the sum of chances and of chances times squares. */
static void add_walks(
    const sculler_align *window, sculler_real limit, sculler_real weight, const variances *free, sculler_real best,
    sculler_real sums[2])
{
    sculler_real walks[POINTS + 1u], spreads[POINTS + 1u], spread_sum = 0.0;
    sculler_real between = sqrt(free->variance[0]), last = -1.0;
    size_t count = 0;
    between = between < limit ? between : limit;
    for (size_t i = 0; i < POINTS; i++) {
        sculler_real part = (sculler_real)i / LAST_POINT, walk = limit * (part * part);
        if (last < between && between < walk) {
            walks[count] = between;
            count++;
        }
        if (walk > last) {
            walks[count] = walk;
            last = walk;
            count++;
        }
    }
    if (count < 2u) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        size_t low = i > 0u ? i - 1u : 0u, high = i + 1u < count ? i + 1u : i;
        size_t apart = high - low;
        spreads[i] = (walks[high] - walks[low]) / (sculler_real)apart;
        spread_sum += spreads[i];
    }
    for (size_t i = 0; i < count; i++) {
        sculler_real chance = weight * chance_of(window, walks[i], free, best) * spreads[i] / spread_sum;
        sums[0] += chance;
        sums[1] += chance * (walks[i] * walks[i]);
    }
}

static sculler_real mean_walk(const sculler_align *window, sculler_real shown)
{
    const sculler_real as_shown = 4.0, less = 1.0, more = 0.1; /* the odds */
    variances free = most_likely(window, window->power[0], 3u, -1.0, NULL);
    sculler_real best = fit_of(window, &free), largest = 0.0, sums[2];
    for (size_t p = 0; p < 4u; p++) {
        sculler_real ratio = window->power[0][p] / window->spectra[p][0];
        largest = ratio > largest ? ratio : largest;
    }
    largest = 3.0 * sqrt(largest); /* more than the tilts at the lowest modes allow */
    sums[0] = as_shown * chance_of(window, shown, &free, best);
    sums[1] = sums[0] * (shown * shown);
    add_walks(window, shown, less, &free, best, sums);
    add_walks(window, largest, more, &free, best, sums);
    return sums[0] > 0.0 ? sums[1] / sums[0] : free.variance[0];
}

/* Fill in the series: tilts about north and east, and the gyros' angles. */
static void make_series(sculler_align *window, sculler_quaternion start)
{
    sculler_real scale = 1.0 / ((sculler_real)window->part_size * window->gravity);
    for (size_t i = 0; i < window->part_count; i++) {
        const sculler_align_part *part = &window->parts[i];
        /* psi turns gravity into the level: -g psi_E north, g psi_N east */
        sculler_vector level = sculler_align_level(window, start, part);
        window->series[0][i] = scale * level.y;
        window->series[1][i] = -scale * level.x;
        window->series[2][i] = part->angle.x;
        window->series[3][i] = part->angle.y;
        window->series[4][i] = part->angle.z;
    }
}

/* Fill in the modes' powers, means over the axes, and spectra. */
static void transform(sculler_align *window)
{
    size_t count = window->part_count;
    sculler_real mode[SCULLER_ALIGN_PARTS], power[5];
    for (size_t p = 0; p + 2u < count; p++) {
        make_mode(mode, count, p + 2u);
        make_spectrum(mode, count, window->spectra[p]);
        for (size_t axis = 0; axis < 5u; axis++) {
            power[axis] = power_of(mode, window->series[axis], count);
        }
        window->power[0][p] = (power[0] + power[1]) / 2.0 + NOTHING;
        window->power[1][p] = (power[2] + power[3] + power[4]) / 3.0 + NOTHING;
    }
}

sculler_noise sculler_noise_shown(sculler_align *window, sculler_quaternion start)
{
    sculler_real step = (sculler_real)window->part_size * window->interval, g = window->gravity;
    sculler_noise shown = sculler_unknown_noise();
    make_series(window, start);
    transform(window);
    /* counts are white in an angle */
    variances gyros = most_likely(window, window->power[1], 2u, -1.0, NULL);
    sculler_real known = mean_walk(window, sqrt(gyros.variance[0]));
    variances found = most_likely(window, window->power[0], 3u, known, NULL);
    shown.angle_random_walk = sqrt(found.variance[0] / step);
    shown.velocity_random_walk = g * sqrt(found.variance[1] * step);
    shown.velocity_noise = g * step * sqrt(found.variance[2]);
    if (shown.velocity_noise < 1e-12) {
        shown.velocity_noise = 1e-12;
    }
    return shown;
}

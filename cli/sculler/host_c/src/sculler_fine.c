/* Fine alignment at rest: a Kalman filter on the velocity that a level unit must not gain.
 *
 * The coarse attitude, carried on with the gyros, resolves the specific force; its sum with gravity
 * is the velocity that the unit seems to gain.  The states are the attitude error psi, this velocity
 * and the gyros' bias, in north-east-down:
 *
 *     psi' = -w_ie x psi + bias + noise     dv_N' = -g psi_E + noise     dv_E' = g psi_N + noise
 */
#include "sculler_align.h"

#include "sculler_math.h"

#define STATES 8u
#define TILT 0.01   /* rad, what a good coarse attitude surely keeps to */
#define HEADING 0.1 /* rad */
#define SURELY 10.0 /* sigmas of the coarse attitude, which is of the same data */
#define ANY_BIAS (10.0 * SCULLER_EARTH_RATE)
#define ROUNDING 1e-7 /* m/s */

typedef struct {
    sculler_real at[STATES][STATES];
} matrix8;

typedef struct {
    sculler_real x[STATES];
    matrix8 P, transition, spread;
    sculler_real surprise;
} filter;

static void set(matrix8 *m, sculler_real diagonal)
{
    for (size_t i = 0; i < STATES; i++) {
        for (size_t j = 0; j < STATES; j++) {
            m->at[i][j] = i == j ? diagonal : 0.0;
        }
    }
}

/* out = a b; out is neither of them */
static void multiply(matrix8 *out, const matrix8 *a, const matrix8 *b)
{
    for (size_t i = 0; i < STATES; i++) {
        for (size_t j = 0; j < STATES; j++) {
            sculler_real sum = 0.0;
            for (size_t k = 0; k < STATES; k++) {
                sum += a->at[i][k] * b->at[k][j];
            }
            out->at[i][j] = sum;
        }
    }
}

/* out = a b a^T; scratch is another */
static void surround(matrix8 *out, const matrix8 *a, const matrix8 *b, matrix8 *scratch)
{
    multiply(scratch, a, b);
    for (size_t i = 0; i < STATES; i++) {
        for (size_t j = 0; j < STATES; j++) {
            sculler_real sum = 0.0;
            for (size_t k = 0; k < STATES; k++) {
                sum += scratch->at[i][k] * a->at[j][k];
            }
            out->at[i][j] = sum;
        }
    }
}

/* F of x' = F x, times seconds. */
static void dynamics(matrix8 *F, sculler_real lat, sculler_real g, sculler_real seconds)
{
    sculler_real north = SCULLER_EARTH_RATE * cos(lat) * seconds;
    sculler_real down = -SCULLER_EARTH_RATE * sin(lat) * seconds;
    set(F, 0.0);
    F->at[0][1] = down;
    F->at[1][0] = -down;
    F->at[1][2] = north;
    F->at[2][1] = -north;
    for (size_t i = 0; i < 3u; i++) {
        F->at[i][i + 5u] = seconds;
    }
    F->at[3][1] = -g * seconds;
    F->at[4][0] = g * seconds;
}

/* e^A, by its series: the powers of a few seconds' dynamics die out at once. */
static void exponential(matrix8 *total, const matrix8 *A)
{
    matrix8 term, next;
    set(total, 1.0);
    set(&term, 1.0);
    for (int k = 1; k < 12; k++) {
        multiply(&next, &term, A);
        for (size_t i = 0; i < STATES; i++) {
            for (size_t j = 0; j < STATES; j++) {
                term.at[i][j] = next.at[i][j] / (sculler_real)k;
                total->at[i][j] += term.at[i][j];
            }
        }
    }
}

/* Transition over a step, and the covariance of the noise that comes in meanwhile, by Gauss's
 * points. */
static void discretise(
    filter *f, const sculler_align *window, const sculler_noise *noise, sculler_real seconds)
{
    static const sculler_real nodes[4] = {
        -0.86113631159405257, -0.33998104358485626, 0.33998104358485626, 0.86113631159405257};
    static const sculler_real weights[4] = {
        0.34785484513745385, 0.65214515486254614, 0.65214515486254614, 0.34785484513745385};
    sculler_real walk = noise->angle_random_walk, force = noise->velocity_random_walk;
    matrix8 F, to_end, rates, part, scratch;
    set(&rates, 0.0);
    for (size_t i = 0; i < 5u; i++) {
        rates.at[i][i] = i < 3u ? walk * walk : force * force;
    }
    set(&f->spread, 0.0);
    for (size_t n = 0; n < 4u; n++) {
        dynamics(&F, window->lat, window->gravity, (0.5 + 0.5 * nodes[n]) * seconds);
        exponential(&to_end, &F);
        surround(&part, &to_end, &rates, &scratch);
        for (size_t i = 0; i < STATES; i++) {
            for (size_t j = 0; j < STATES; j++) {
                f->spread.at[i][j] += 0.5 * weights[n] * seconds * part.at[i][j];
            }
        }
    }
    dynamics(&F, window->lat, window->gravity, seconds);
    exponential(&f->transition, &F);
}

static void begin_filter(filter *f, const sculler_alignment *coarse, sculler_real seen_at_once)
{
    const sculler_noise *noise = &coarse->noise;
    for (size_t i = 0; i < STATES; i++) {
        f->x[i] = 0.0;
    }
    set(&f->P, 0.0);
    for (size_t i = 0; i < 3u; i++) {
        sculler_real sure = SURELY * sqrt(coarse->covariance[i][i]);
        sculler_real least = i < 2u ? TILT : HEADING;
        sculler_real attitude = sure > least ? sure : least;
        sculler_real bias = i == 0u ? ANY_BIAS : 0.0;
        bias = noise->gyro_bias < 0.0 ? bias : noise->gyro_bias;
        f->P.at[i][i] = attitude * attitude;
        f->P.at[i + 5u][i + 5u] = bias * bias;
    }
    f->P.at[3][3] = seen_at_once * seen_at_once;
    f->P.at[4][4] = seen_at_once * seen_at_once;
    f->surprise = 0.0;
}

/* A step in time. */
static void predict(filter *f)
{
    sculler_real x[STATES];
    matrix8 scratch, P;
    for (size_t i = 0; i < STATES; i++) {
        x[i] = 0.0;
        for (size_t k = 0; k < STATES; k++) {
            x[i] += f->transition.at[i][k] * f->x[k];
        }
    }
    surround(&P, &f->transition, &f->P, &scratch);
    for (size_t i = 0; i < STATES; i++) {
        f->x[i] = x[i];
        for (size_t j = 0; j < STATES; j++) {
            f->P.at[i][j] = P.at[i][j] + f->spread.at[i][j];
        }
    }
}

/* Look at the velocity, of variance R; Joseph's form stays symmetric and positive. */
static void correct(filter *f, sculler_real north, sculler_real east, sculler_real R)
{
    const sculler_real strayed[2] = {north - f->x[3], east - f->x[4]};
    sculler_real gain[STATES][2];
    sculler_real a = f->P.at[3][3] + R, b = f->P.at[3][4], c = f->P.at[4][3], d = f->P.at[4][4] + R;
    sculler_real determinant = a * d - b * c;
    const sculler_real solved[2] = {
        (d * strayed[0] - b * strayed[1]) / determinant,
        (a * strayed[1] - c * strayed[0]) / determinant};
    matrix8 keep, scratch, P;
    f->surprise += strayed[0] * solved[0] + strayed[1] * solved[1];
    set(&keep, 1.0);
    for (size_t i = 0; i < STATES; i++) {
        sculler_real first = f->P.at[3][i], second = f->P.at[4][i];
        gain[i][0] = (d * first - b * second) / determinant;
        gain[i][1] = (a * second - c * first) / determinant;
        f->x[i] += gain[i][0] * strayed[0] + gain[i][1] * strayed[1];
        keep.at[i][3] -= gain[i][0];
        keep.at[i][4] -= gain[i][1];
    }
    surround(&P, &keep, &f->P, &scratch);
    for (size_t i = 0; i < STATES; i++) {
        for (size_t j = 0; j < STATES; j++) {
            f->P.at[i][j] =
                P.at[i][j] + R * (gain[i][0] * gain[j][0] + gain[i][1] * gain[j][1]);
        }
    }
}

/* q_nb at the start in north-east-down of the start, as the coarse attitude has it. */
static sculler_quaternion at_start(const sculler_align *window, const sculler_alignment *coarse)
{
    sculler_real half = -0.5 * SCULLER_EARTH_RATE * coarse->seconds;
    sculler_quaternion back = {
        cos(half), cos(window->lat) * sin(half), 0.0, -sin(window->lat) * sin(half)};
    sculler_quaternion unturned =
        sculler_product(coarse->q, sculler_conjugate(coarse->turned));
    return sculler_product(sculler_conjugate(back), unturned);
}

void sculler_align_refine(
    const sculler_align *window,
    const sculler_alignment *coarse,
    sculler_fine_alignment *found)
{
    const sculler_noise *noise = &coarse->noise;
    sculler_real T = window->interval, g = window->gravity;
    sculler_real seen_at_once = noise->velocity_noise > ROUNDING ? noise->velocity_noise : ROUNDING;
    sculler_real north = 0.0, east = 0.0;
    sculler_quaternion start = at_start(window, coarse);
    filter f;
    discretise(&f, window, noise, (sculler_real)window->step_size * T);
    begin_filter(&f, coarse, seen_at_once);
    for (size_t i = 0; i < window->step_count; i++) {
        sculler_vector level = sculler_align_level(window, start, &window->steps[i]);
        north += T * level.x + (sculler_real)window->step_size * (T * cos(window->lat) * window->lean);
        east += T * level.y;
        predict(&f);
        correct(&f, north, east, seen_at_once * seen_at_once);
    }
    sculler_vector error = {-f.x[0], -f.x[1], -f.x[2]}, bias = {f.x[5], f.x[6], f.x[7]};
    sculler_real tilt = noise->accel_bias > 0.0 ? noise->accel_bias / g : 0.0;
    found->q = sculler_product(sculler_from_rotation_vector(error), coarse->q);
    for (size_t i = 0; i < 3u; i++) {
        for (size_t j = 0; j < 3u; j++) {
            found->covariance[i][j] = f.P.at[i][j] + (i == j && i < 2u ? tilt * tilt : 0.0);
        }
    }
    found->gyro_bias = sculler_rotate(sculler_conjugate(found->q), bias);
    found->gyro_bias_sigma.x = sqrt(f.P.at[5][5]);
    found->gyro_bias_sigma.y = noise->gyro_bias < 0.0 ? -1.0 : sqrt(f.P.at[6][6]);
    found->gyro_bias_sigma.z = noise->gyro_bias < 0.0 ? -1.0 : sqrt(f.P.at[7][7]);
    found->surprise = f.surprise / (2.0 * (sculler_real)window->step_count);
}

void sculler_take_out_bias(
    sculler_vector gyro_bias, sculler_real interval, sculler_increments *increments)
{
    sculler_vector turned = sculler_times(interval, gyro_bias);
    increments->phi = sculler_plus(increments->phi, turned, -1.0);
    increments->alpha = sculler_plus(increments->alpha, turned, -1.0);
}

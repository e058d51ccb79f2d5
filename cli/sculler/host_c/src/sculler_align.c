/* Coarse alignment: sums over the window, and the attitude that they tell. */
#include "sculler_align.h"

#include "sculler_math.h"

#define MIN_SECONDS 10.0
#define FEWEST 10u /* intervals */

static sculler_align_part no_sums(void)
{
    sculler_align_part part;
    part.plain = sculler_nothing();
    part.cosine = sculler_nothing();
    part.sine = sculler_nothing();
    part.angle = sculler_nothing();
    return part;
}

/* The polar axis in north-east-down. */
static sculler_vector polar_axis(sculler_real lat)
{
    sculler_vector axis = {cos(lat), 0.0, -sin(lat)};
    return axis;
}

/* Earth's turn (rad), from north-east-down at the start to inertial space. */
static sculler_quaternion earth_turn(sculler_real lat, sculler_real angle)
{
    sculler_real sine = sin(0.5 * angle);
    sculler_quaternion q = {cos(0.5 * angle), cos(lat) * sine, 0.0, -sin(lat) * sine};
    return q;
}

/* ---- the window ----------------------------------------------------------------------------- */

sculler_noise sculler_unknown_noise(void)
{
    sculler_noise noise = {-1.0, -1.0, -1.0, -1.0, -1.0};
    return noise;
}

static size_t step_size(sculler_real interval)
{
    sculler_real each = 1.0 / interval + 0.5;
    return each < 1.0 ? 1u : (size_t)each;
}

size_t sculler_align_steps(sculler_real interval, size_t count)
{
    return count / step_size(interval);
}

sculler_error sculler_align_begin(
    sculler_align *window,
    sculler_real interval,
    size_t count,
    sculler_real lat,
    sculler_real h,
    const sculler_gravity *gravity,
    sculler_align_part *steps,
    size_t step_room)
{
    if (!(interval > 0.0) || count < FEWEST || (sculler_real)count * interval < MIN_SECONDS) {
        return SCULLER_TOO_SHORT;
    }
    if (steps != NULL && step_room < sculler_align_steps(interval, count)) {
        return SCULLER_TOO_SHORT;
    }
    if (SCULLER_EARTH_RATE * cos(lat) < 0.01 * SCULLER_EARTH_RATE) {
        return SCULLER_NEAR_POLE;
    }
    window->interval = interval;
    window->lat = lat;
    window->gravity = sculler_gravity_at(gravity, sin(lat), h, &window->lean);
    window->count = count;
    window->taken = 0;
    window->part_size = (count + SCULLER_ALIGN_PARTS - 1u) / SCULLER_ALIGN_PARTS;
    window->part_count = count / window->part_size;
    window->step_size = step_size(interval);
    window->step_count = steps == NULL ? 0u : sculler_align_steps(interval, count);
    window->chain.w = 1.0;
    window->chain.x = 0.0;
    window->chain.y = 0.0;
    window->chain.z = 0.0;
    window->turned = sculler_nothing();
    window->pushed = sculler_nothing();
    window->whole = no_sums();
    window->sloped = no_sums();
    for (size_t i = 0; i < 3u; i++) {
        for (size_t k = 0; k < 3u; k++) {
            window->down[i][k] = sculler_nothing();
        }
    }
    window->steps = steps;
    for (size_t i = 0; i < window->part_count; i++) {
        window->parts[i] = no_sums();
    }
    for (size_t i = 0; i < window->step_count; i++) {
        steps[i] = no_sums();
    }
    return SCULLER_OK;
}

static void add(
    sculler_align_part *part, sculler_vector force, sculler_real weight, sculler_real cosine, sculler_real sine)
{
    part->plain = sculler_plus(part->plain, force, weight);
    part->cosine = sculler_plus(part->cosine, force, weight * cosine);
    part->sine = sculler_plus(part->sine, force, weight * sine);
}

/* The part that an interval belongs to; the odd first ones belong to none. */
static sculler_align_part *part_of(
    sculler_align_part *parts, size_t part_count, size_t size, size_t count, size_t interval)
{
    size_t odd = count - part_count * size;
    return interval < odd || part_count == 0u ? NULL : &parts[(interval - odd) / size];
}

bool sculler_align_take(sculler_align *window, const sculler_increments *increments)
{
    static const sculler_vector axes[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    size_t k = window->taken, count = window->count;
    if (k >= count) {
        return true;
    }
    /* the specific force in the inertial frame that the body left, at the middle of the interval */
    sculler_real time = ((sculler_real)k + 0.5) * window->interval;
    sculler_real cosine = cos(SCULLER_EARTH_RATE * time), sine = sin(SCULLER_EARTH_RATE * time);
    sculler_vector force =
        sculler_rotate(window->chain, sculler_per(increments->dv_sf, window->interval));
    sculler_align_part *part =
        part_of(window->parts, window->part_count, window->part_size, count, k);
    sculler_align_part *step =
        part_of(window->steps, window->step_count, window->step_size, count, k);

    window->turned = sculler_plus(window->turned, increments->phi, 1.0);
    window->pushed = sculler_plus(window->pushed, increments->dv_sf, 1.0);
    add(&window->whole, force, 1.0, cosine, sine);
    add(&window->sloped, force, time - 0.5 * (sculler_real)count * window->interval, cosine, sine);
    for (size_t i = 0; i < 3u; i++) {
        sculler_vector axis = sculler_rotate(sculler_conjugate(window->chain), axes[i]);
        window->down[i][0] = sculler_plus(window->down[i][0], axis, 1.0);
        window->down[i][1] = sculler_plus(window->down[i][1], axis, cosine);
        window->down[i][2] = sculler_plus(window->down[i][2], axis, sine);
    }
    if (part != NULL) {
        add(part, force, 1.0, cosine, sine);
        part->angle = window->turned;
    }
    if (step != NULL) {
        add(step, force, 1.0, cosine, sine);
    }
    window->chain =
        sculler_product(window->chain, sculler_from_rotation_vector(increments->phi));
    window->taken += 1u;
    return window->taken == count;
}

/* ---- the attitude --------------------------------------------------------------------------- */

/* v(t) = C cos + p (p.v)(1 - cos) - p x v sin, the turn back about the polar axis, summed up. */
sculler_vector sculler_align_level(
    const sculler_align *window, sculler_quaternion start, const sculler_align_part *part)
{
    sculler_vector p = polar_axis(window->lat);
    sculler_vector plain = sculler_rotate(start, part->plain);
    sculler_vector cosine = sculler_rotate(start, part->cosine);
    sculler_vector sine = sculler_rotate(start, part->sine);
    sculler_real along = sculler_dot(p, sculler_plus(plain, cosine, -1.0));
    sculler_vector across = sculler_cross(p, sine);
    return sculler_plus(sculler_plus(cosine, p, along), across, -1.0);
}

/* The eigenvector of the largest eigenvalue of a symmetric matrix, by Jacobi's rotations. */
static sculler_quaternion largest(sculler_real K[4][4])
{
    sculler_real V[4][4] = {
        {1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}, {0.0, 0.0, 0.0, 1.0}};
    for (int sweep = 0; sweep < 12; sweep++) { /* it converges quadratically: five do */
        for (size_t i = 0; i < 3u; i++) {
            for (size_t j = i + 1u; j < 4u; j++) {
                sculler_real angle = 0.5 * atan2(2.0 * K[i][j], K[j][j] - K[i][i]);
                sculler_real c = cos(angle), s = sin(angle);
                for (size_t k = 0; k < 4u; k++) {
                    sculler_real a = K[k][i], b = K[k][j], v = V[k][i], w = V[k][j];
                    K[k][i] = c * a - s * b;
                    K[k][j] = s * a + c * b;
                    V[k][i] = c * v - s * w;
                    V[k][j] = s * v + c * w;
                }
                for (size_t k = 0; k < 4u; k++) {
                    sculler_real a = K[i][k], b = K[j][k];
                    K[i][k] = c * a - s * b;
                    K[j][k] = s * a + c * b;
                }
            }
        }
    }
    size_t best = 0;
    for (size_t i = 1; i < 4u; i++) {
        best = K[i][i] > K[best][best] ? i : best;
    }
    sculler_real sign = V[0][best] < 0.0 ? -1.0 : 1.0;
    sculler_quaternion q = {
        sign * V[0][best], sign * V[1][best], sign * V[2][best], sign * V[3][best]};
    return q;
}

/* q_nb at the start: lays the swing of the specific force best upon gravity's (Davenport). */
static sculler_quaternion attitude_at_start(const sculler_align *window)
{
    /* B = sum of up(t) f(t)^T with up(t) = u cos + p (p.u)(1 - cos) + p x u sin */
    sculler_vector p = polar_axis(window->lat);
    sculler_vector u = {-(cos(window->lat) * window->lean / window->gravity), 0.0, -1.0};
    sculler_vector along = sculler_times(sculler_dot(p, u), p);
    sculler_vector across = sculler_cross(p, u);
    const sculler_align_part *sum = &window->whole;
    sculler_vector rest = sculler_plus(sum->plain, sum->cosine, -1.0);
    const sculler_real up[3][3] = {{u.x, along.x, across.x}, {u.y, along.y, across.y},
                             {u.z, along.z, across.z}};
    const sculler_real f[3][3] = {{sum->cosine.x, sum->cosine.y, sum->cosine.z},
                            {rest.x, rest.y, rest.z},
                            {sum->sine.x, sum->sine.y, sum->sine.z}};
    sculler_real B[3][3], K[4][4];
    for (size_t i = 0; i < 3u; i++) {
        for (size_t j = 0; j < 3u; j++) {
            B[i][j] = up[i][0] * f[0][j] + up[i][1] * f[1][j] + up[i][2] * f[2][j];
        }
    }
    sculler_real trace = B[0][0] + B[1][1] + B[2][2];
    K[0][0] = trace;
    K[0][1] = B[2][1] - B[1][2];
    K[0][2] = B[0][2] - B[2][0];
    K[0][3] = B[1][0] - B[0][1];
    for (size_t i = 0; i < 3u; i++) {
        K[i + 1u][0] = K[0][i + 1u];
        for (size_t j = 0; j < 3u; j++) {
            K[i + 1u][j + 1u] = B[i][j] + B[j][i] - (i == j ? trace : 0.0);
        }
    }
    return largest(K);
}

/* The mean of the down axis in the body. */
static sculler_vector mean_down(const sculler_align *window, sculler_quaternion start)
{
    /* down in inertial space: z cos + p (p.z)(1 - cos) + p x z sin, from there into the body */
    sculler_quaternion back = sculler_conjugate(start);
    sculler_vector p = polar_axis(window->lat), z = {0.0, 0.0, 1.0};
    sculler_vector along = sculler_rotate(back, sculler_times(p.z, p));
    sculler_vector cosine = sculler_plus(sculler_rotate(back, z), along, -1.0);
    sculler_vector sine = sculler_rotate(back, sculler_cross(p, z));
    const sculler_real parts[3][3] = {{along.x, cosine.x, sine.x}, {along.y, cosine.y, sine.y},
                                {along.z, cosine.z, sine.z}};
    sculler_vector sum = sculler_nothing();
    for (size_t i = 0; i < 3u; i++) {
        for (size_t k = 0; k < 3u; k++) {
            sum = sculler_plus(sum, window->down[i][k], parts[i][k]);
        }
    }
    return sculler_per(sum, (sculler_real)window->count);
}

/* ---- covariance ----------------------------------------------------------------------------- */

typedef struct {
    sculler_real at[3][3];
} matrix;

static matrix dcm(sculler_quaternion q)
{
    sculler_real w = q.w, x = q.x, y = q.y, z = q.z;
    matrix m = {{{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
                 {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
                 {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}}};
    return m;
}

static matrix multiplied(const matrix *a, const matrix *b)
{
    matrix m;
    for (size_t i = 0; i < 3u; i++) {
        for (size_t j = 0; j < 3u; j++) {
            m.at[i][j] =
                a->at[i][0] * b->at[0][j] + a->at[i][1] * b->at[1][j] + a->at[i][2] * b->at[2][j];
        }
    }
    return m;
}

/* total += weight a a^T, of so many columns of a */
static void add_square(matrix *total, const matrix *a, sculler_real weight, size_t columns)
{
    for (size_t i = 0; i < 3u; i++) {
        for (size_t j = 0; j < 3u; j++) {
            for (size_t k = 0; k < columns; k++) {
                total->at[i][j] += weight * (a->at[i][k] * a->at[j][k]);
            }
        }
    }
}

static void add_matrix(matrix *total, const matrix *a, sculler_real weight)
{
    for (size_t i = 0; i < 3u; i++) {
        for (size_t j = 0; j < 3u; j++) {
            total->at[i][j] += weight * a->at[i][j];
        }
    }
}

static matrix inverse(const matrix *m)
{
    matrix found;
    for (size_t i = 0; i < 3u; i++) {
        size_t i1 = (i + 1u) % 3u, i2 = (i + 2u) % 3u;
        for (size_t j = 0; j < 3u; j++) {
            size_t j1 = (j + 1u) % 3u, j2 = (j + 2u) % 3u;
            found.at[j][i] = m->at[i1][j1] * m->at[i2][j2] - m->at[i1][j2] * m->at[i2][j1];
        }
    }
    sculler_real determinant = m->at[0][0] * found.at[0][0] + m->at[0][1] * found.at[1][0]
                  + m->at[0][2] * found.at[2][0];
    for (size_t i = 0; i < 3u; i++) {
        for (size_t j = 0; j < 3u; j++) {
            found.at[i][j] /= determinant;
        }
    }
    return found;
}

/* I - u u^T of where gravity points at the middle of a part; gets north-east-down there. */
static matrix seen_square(const sculler_align *window, size_t part, matrix *swing)
{
    sculler_real step = (sculler_real)window->part_size * window->interval;
    sculler_real seconds = (sculler_real)window->count * window->interval;
    size_t later = window->part_count - 1u - part;
    sculler_real time = seconds - step * ((sculler_real)later + 0.5);
    *swing = dcm(earth_turn(window->lat, SCULLER_EARTH_RATE * time));
    matrix P;
    for (size_t i = 0; i < 3u; i++) {
        for (size_t j = 0; j < 3u; j++) {
            P.at[i][j] = (i == j ? 1.0 : 0.0) - swing->at[i][2] * swing->at[j][2];
        }
    }
    return P;
}

/* Of the attitude at the end.  In the inertial frame that north-east-down left at the start the
 * least squares take -sum A_k (psi_k + eta_k), A_k = (sum P)^-1 P_k, for the attitude at the start
 * where the chain of the gyros has turned by psi_k and the tilt noise is eta_k; the attitude at the
 * end is off by that and the last psi. */
static void covariance_of(
    const sculler_align *window, const sculler_noise *noise, sculler_real covariance[3][3])
{
    const matrix zero = {{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}};
    const matrix one = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
    sculler_real step = (sculler_real)window->part_size * window->interval, g = window->gravity;
    sculler_real walk = noise->angle_random_walk > 0.0 ? noise->angle_random_walk : 0.0;
    sculler_real white = noise->velocity_random_walk > 0.0 ? noise->velocity_random_walk / g : 0.0;
    sculler_real blue = noise->velocity_noise > 0.0 ? noise->velocity_noise / g : 0.0;
    sculler_real bias = noise->gyro_bias > 0.0 ? noise->gyro_bias : 0.0;
    sculler_real tilt = noise->accel_bias > 0.0 ? noise->accel_bias / g : 0.0;
    matrix sum = zero, after = zero, last = zero, drift = zero, tilted = zero, total = zero, swing;
    for (size_t k = 0; k < window->part_count; k++) {
        matrix P = seen_square(window, k, &swing);
        add_matrix(&sum, &P, 1.0);
    }
    matrix per_sum = inverse(&sum);
    for (size_t left = window->part_count; left > 0u; left--) {
        size_t k = left - 1u;
        matrix P = seen_square(window, k, &swing);
        matrix A = multiplied(&per_sum, &P), G = one, edge = last;
        add_matrix(&after, &A, 1.0);
        /* what the gyros walk or drift in a step stays in psi from its middle on */
        add_matrix(&G, &after, -1.0);
        add_matrix(&G, &A, 0.5);
        add_matrix(&edge, &A, -1.0);
        last = A;
        matrix turned = multiplied(&G, &swing), leaned = multiplied(&A, &swing);
        add_matrix(&drift, &turned, step);
        add_matrix(&tilted, &leaned, 1.0);
        add_square(&total, &G, walk * walk * step, 3u);
        add_square(&total, &A, white * white / step, 3u);
        add_square(&total, &edge, (blue / step) * (blue / step), 3u);
    }
    add_square(&total, &last, (blue / step) * (blue / step), 3u);
    add_square(&total, &drift, bias * bias, 3u);
    add_square(&total, &tilted, tilt * tilt, 2u);
    matrix end = dcm(sculler_conjugate(earth_turn(
        window->lat, SCULLER_EARTH_RATE * ((sculler_real)window->count * window->interval))));
    matrix half = multiplied(&end, &total);
    for (size_t i = 0; i < 3u; i++) {
        for (size_t j = 0; j < 3u; j++) {
            covariance[i][j] = half.at[i][0] * end.at[j][0] + half.at[i][1] * end.at[j][1]
                               + half.at[i][2] * end.at[j][2];
        }
    }
}

/* ---- the coarse stage ----------------------------------------------------------------------- */

static sculler_real length(sculler_vector v)
{
    return sqrt(sculler_dot(v, v));
}

static sculler_error unfit(const sculler_align *window)
{
    sculler_real seconds = (sculler_real)window->count * window->interval;
    sculler_real rate = length(window->turned) / seconds, force = length(window->pushed) / seconds;
    if (window->taken < window->count) {
        return SCULLER_TOO_SHORT;
    }
    if (!isfinite(rate + force)) {
        return SCULLER_NOT_FINITE;
    }
    if (rate > 100.0 * SCULLER_EARTH_RATE) {
        return SCULLER_TURNING;
    }
    return fabs(force / window->gravity - 1.0) > 0.02 ? SCULLER_NOT_AT_REST : SCULLER_OK;
}

sculler_error sculler_align_finish(
    sculler_align *window, const sculler_noise *known, sculler_alignment *found)
{
    sculler_error error = unfit(window);
    if (error != SCULLER_OK) {
        return error;
    }
    sculler_real count = (sculler_real)window->count, T = window->interval, seconds = count * T;
    sculler_real horizontal = SCULLER_EARTH_RATE * cos(window->lat);
    sculler_quaternion start = attitude_at_start(window);
    sculler_vector turn = {
        -horizontal * seconds, 0.0, SCULLER_EARTH_RATE * sin(window->lat) * seconds};
    sculler_quaternion back = sculler_from_rotation_vector(turn);
    found->q = sculler_product(back, sculler_product(start, window->chain));
    found->turned = window->chain;
    found->seconds = seconds;
    found->gravity = window->gravity;
    found->specific_force =
        length(sculler_align_level(window, start, &window->whole)) / count;
    /* the slope of the force east; sum of (t - mean)^2 in closed form */
    sculler_real squares = T * T * count * (count * count - 1.0) / 12.0;
    sculler_real slope = sculler_align_level(window, start, &window->sloped).y / squares;
    found->horizontal_rate = horizontal + slope / window->gravity;
    found->down_rate = sculler_dot(window->turned, mean_down(window, start)) / count / T;
    found->noise = *known;
    if (known->angle_random_walk < 0.0 || known->velocity_random_walk < 0.0
        || known->velocity_noise < 0.0) {
        sculler_noise shown = sculler_noise_shown(window, start);
        found->noise.angle_random_walk = known->angle_random_walk < 0.0
                                             ? shown.angle_random_walk
                                             : known->angle_random_walk;
        found->noise.velocity_random_walk = known->velocity_random_walk < 0.0
                                                ? shown.velocity_random_walk
                                                : known->velocity_random_walk;
        found->noise.velocity_noise =
            known->velocity_noise < 0.0 ? shown.velocity_noise : known->velocity_noise;
    }
    covariance_of(window, &found->noise, found->covariance);
    return SCULLER_OK;
}

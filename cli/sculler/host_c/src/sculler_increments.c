/* Exact integers, and the increments they are worth. */
#include "sculler_increments.h"

#include "sculler_math.h"

#define INTERVALS 5u /* that the third order is taken from */
#define WINDOW 10u   /* of intervals, in which the rate is to be smooth */

/* ---- status --------------------------------------------------------------------------------- */

bool sculler_status_take(sculler_status_counts *counts, uint32_t status)
{
    counts->short_history += (status & SCULLER_SHORT_HISTORY) != 0u ? 1u : 0u;
    counts->fault += (status & SCULLER_FAULT) != 0u ? 1u : 0u;
    counts->rail += (status & SCULLER_RAIL) != 0u ? 1u : 0u;
    counts->lost += (status & SCULLER_LOST) != 0u ? 1u : 0u;
    return (status & SCULLER_SHORT_HISTORY) == 0u;
}

uint64_t sculler_results_missing(uint64_t last_major, uint64_t major, unsigned bits)
{
    uint64_t missing = major - last_major - 1u;
    return bits < 64u ? missing & ((UINT64_C(1) << bits) - 1u) : missing;
}

/* ---- integers ------------------------------------------------------------------------------- */

void sculler_integer_from_words(
    const uint16_t *words, size_t word_count, uint64_t *limbs, size_t limb_count)
{
    uint16_t above = words[word_count - 1u] > 0x7FFFu ? 0xFFFFu : 0u; /* the sign goes on */
    size_t place = 0;
    for (size_t i = 0; i < limb_count; i++) {
        uint32_t part[4];
        for (size_t k = 0; k < 4u; k++) {
            part[k] = place < word_count ? words[place] : above;
            place++;
        }
        uint32_t low = part[0] | part[1] << 16, high = part[2] | part[3] << 16;
        limbs[i] = (uint64_t)high << 32 | low;
    }
}

void sculler_integer_from_registers(
    const uint32_t *registers, size_t register_count, uint64_t *limbs, size_t limb_count)
{
    uint32_t above = registers[register_count - 1u] > 0x7FFFFFFFu ? 0xFFFFFFFFu : 0u;
    for (size_t i = 0; i < limb_count; i++) {
        size_t place = 2u * i;
        uint32_t low = place < register_count ? registers[place] : above;
        uint32_t high = place + 1u < register_count ? registers[place + 1u] : above;
        limbs[i] = (uint64_t)high << 32 | low;
    }
}

/* An integer of one limb converts as the compiler does it, rounded to nearest.  Of a longer one the
 * 64 bits from the highest set one on are taken, and their last bit is set where any bit below them
 * is, so that the one rounding of 64 bits is that of the whole integer. */
sculler_real sculler_integer_to_real(const uint64_t *limbs, size_t limb_count)
{
    if (limb_count == 1u) {
        bool below_zero = limbs[0] >> 63 != 0u;
        uint64_t magnitude = limbs[0];
        if (below_zero) {
            magnitude = ~magnitude + 1u;
        }
        return below_zero ? -(sculler_real)magnitude : (sculler_real)magnitude;
    }
    bool negative = limbs[limb_count - 1u] >> 63 != 0u;
    uint64_t flip = negative ? ~UINT64_C(0) : UINT64_C(0);
    uint64_t carry = negative ? UINT64_C(1) : UINT64_C(0); /* the size is the complement and one */
    uint64_t top = 0, below = 0, before = 0;
    bool rest = false, lower = false; /* whether any bit is set under `below`; under `before` */
    size_t place = 0;
    for (size_t i = 0; i < limb_count; i++) { /* the last limb that is not zero wins */
        uint64_t limb = (limbs[i] ^ flip) + carry;
        carry = carry != 0u && limb == 0u ? UINT64_C(1) : UINT64_C(0);
        if (limb != 0u) {
            top = limb;
            below = before;
            rest = lower;
            place = i;
        }
        lower = lower || before != 0u;
        before = limb;
    }
    sculler_real scale = 1.0;
    if (place > 0u) {
        unsigned bits = 0, rest_bits = 64;
        while (top >> 63 == 0u) {
            top <<= 1;
            bits++;
            rest_bits--;
            scale *= 0.5;
        }
        if (bits > 0u) {
            top |= below >> rest_bits;
            rest = rest || below << bits != 0u;
        } else {
            rest = rest || below != 0u;
        }
        top |= rest ? UINT64_C(1) : UINT64_C(0);
        for (; place > 0u; place--) {
            scale *= 18446744073709551616.0; /* 2^64 */
        }
    }
    sculler_real size = (sculler_real)top * scale;
    return negative ? -size : size;
}

/* ---- rotation compensation ------------------------------------------------------------------ */

/* 1/n! - x^2/(n+2)! + x^4/(n+4)! - ..., the last term's coefficient first; for |x| < 1. */
static sculler_real series(const sculler_real terms[10], sculler_real square)
{
    sculler_real sum = 0.0;
    for (int i = 0; i < 10; i++) {
        sum = terms[i] - square * sum;
    }
    return sum;
}

/* (1 - cos x)/x^2 */
static sculler_real one_minus_cosine(sculler_real x)
{
    static const sculler_real terms[10] = {
        1.0 / 2432902008176640000.0, 1.0 / 6402373705728000.0, 1.0 / 20922789888000.0,
        1.0 / 87178291200.0, 1.0 / 479001600.0, 1.0 / 3628800.0, 1.0 / 40320.0, 1.0 / 720.0,
        1.0 / 24.0, 1.0 / 2.0};
    if (x < 1.0) {
        return series(terms, x * x);
    }
    sculler_real half = SCULLER_PI * (x / (2.0 * SCULLER_PI)), part = sin(half) / half;
    return 0.5 * (part * part);
}

/* (1 - sin x/x)/x^2 (Savage-98 Eq. 52) */
static sculler_real one_minus_sine(sculler_real x)
{
    static const sculler_real terms[10] = {
        1.0 / 51090942171709440000.0, 1.0 / 121645100408832000.0, 1.0 / 355687428096000.0,
        1.0 / 1307674368000.0, 1.0 / 6227020800.0, 1.0 / 39916800.0, 1.0 / 362880.0, 1.0 / 5040.0,
        1.0 / 120.0, 1.0 / 6.0};
    return x < 1.0 ? series(terms, x * x) : (1.0 - sin(x) / x) / (x * x);
}

/* (1/2 - (1 - cos x)/x^2)/x^2 (Savage-98 Eq. 99) */
static sculler_real half_minus_cosine(sculler_real x)
{
    static const sculler_real terms[10] = {
        1.0 / 1124000727777607680000.0, 1.0 / 2432902008176640000.0, 1.0 / 6402373705728000.0,
        1.0 / 20922789888000.0, 1.0 / 87178291200.0, 1.0 / 479001600.0, 1.0 / 3628800.0,
        1.0 / 40320.0, 1.0 / 720.0, 1.0 / 24.0};
    return x < 1.0 ? series(terms, x * x) : (0.5 - one_minus_cosine(x)) / (x * x);
}

/* dV_rot, exact for constant rate and specific force (Savage-98 Eq. 51). */
static sculler_vector velocity_rotation(sculler_vector alpha, sculler_vector upsilon, sculler_real angle)
{
    sculler_vector first = sculler_cross(alpha, upsilon);
    sculler_vector second = sculler_cross(alpha, first);
    return sculler_plus(
        sculler_times(one_minus_cosine(angle), first), second, one_minus_sine(angle));
}

/* Cross product over a number. */
static sculler_vector cross_per(sculler_vector a, sculler_vector b, sculler_real divisor)
{
    return sculler_per(sculler_cross(a, b), divisor);
}

static sculler_vector less(sculler_vector a, sculler_vector b)
{
    return sculler_plus(a, b, -1.0);
}

static sculler_vector added(sculler_vector a, sculler_vector b)
{
    return sculler_plus(a, b, 1.0);
}

/* b T^2 of a straight line a + b t over an interval, of its integral and double integral. */
static sculler_vector slope_of(sculler_vector once, sculler_vector twice, sculler_real interval)
{
    return less(sculler_times(6.0, once), sculler_per(sculler_times(12.0, twice), interval));
}

/* What dV_SF lacks beyond second order: of straight lines of rate and force, whose slopes the double
 * integrals hold; what sculling and scrolling have beyond these is taken for a force that does as it
 * likes while the body turns steadily. */
static sculler_vector velocity_higher_orders(
    sculler_vector alpha,
    sculler_vector upsilon,
    sculler_vector alpha2,
    sculler_vector upsilon2,
    sculler_vector sculling,
    sculler_vector scrolled)
{
    sculler_vector av = sculler_cross(alpha, upsilon), au2 = sculler_cross(alpha, upsilon2);
    sculler_vector a2u = sculler_cross(alpha2, upsilon), a2u2 = sculler_cross(alpha2, upsilon2);
    sculler_vector sigma = less(sculling, sculler_per(less(au2, a2u), 12.0));
    sculler_vector lines = added(
        less(sculler_per(au2, 72.0), sculler_per(a2u, 36.0)), sculler_per(a2u2, 240.0));
    sculler_vector d = less(sculler_times(7.0 / 6.0, sigma), less(scrolled, lines));
    sculler_vector inner = added(sculler_per(au2, 80.0), sculler_per(a2u, 240.0));
    inner = less(added(inner, sculler_per(d, 4.0)), sculler_per(sigma, 10.0));
    sculler_vector first = added(sculler_per(au2, 24.0), sculler_per(a2u2, 240.0));
    first = added(added(first, sculler_per(d, 2.0)), sculler_cross(alpha, inner));
    first = less(first, cross_per(alpha2, av, 240.0));
    sculler_vector second = added(sculler_per(av, 24.0), sculler_per(au2, 120.0));
    second = added(less(second, sculler_per(a2u, 240.0)), cross_per(alpha, av, 80.0));
    return less(sculler_cross(alpha, first), sculler_cross(alpha2, second));
}

/* dR_rot, exact for constant rate and specific force (Savage-98 Eq. 99). */
static sculler_vector position_rotation(
    sculler_vector alpha,
    sculler_vector upsilon,
    sculler_vector s_alpha,
    sculler_vector s_upsilon,
    sculler_real angle)
{
    sculler_vector first = sculler_plus(
        sculler_cross(s_alpha, upsilon), sculler_cross(alpha, s_upsilon), 1.0);
    return sculler_plus(
        sculler_times(one_minus_sine(angle), first),
        sculler_cross(alpha, first),
        half_minus_cosine(angle));
}

/* ---- increments ----------------------------------------------------------------------------- */

/* Within plus between, in counts^2. */
static sculler_vector correction(
    const sculler_scales *scales, sculler_vector within, sculler_vector between)
{
    return sculler_plus(
        sculler_per(within, scales->within), sculler_per(between, scales->between), 1.0);
}

/* An angle and a velocity, with the cross product of rigid motions. */
typedef struct {
    sculler_vector angle, velocity;
} dual;

static dual dual_cross(dual a, dual b)
{
    dual found;
    found.angle = sculler_cross(a.angle, b.angle);
    found.velocity = sculler_plus(
        sculler_cross(a.angle, b.velocity), sculler_cross(a.velocity, b.angle), 1.0);
    return found;
}

static dual dual_times(sculler_real factor, dual a)
{
    dual found = {sculler_times(factor, a.angle), sculler_times(factor, a.velocity)};
    return found;
}

static dual dual_plus(dual a, dual b)
{
    dual found = {
        sculler_plus(a.angle, b.angle, 1.0), sculler_plus(a.velocity, b.velocity, 1.0)};
    return found;
}

void sculler_higher_orders(
    const sculler_scales *scales, const sculler_sums *sums, sculler_increments *increments)
{
    dual alpha = {increments->alpha, sculler_times(scales->nu, sums->nu)};
    dual beta = {
        sculler_times(
            scales->coning, correction(scales, sums->coning_within, sums->coning_between)),
        sculler_times(
            scales->sculling, correction(scales, sums->sculling_within, sums->sculling_between))};
    dual gamma = {
        sculler_times(scales->coning_third, sums->coning_third),
        sculler_times(scales->sculling_third, sums->sculling_third)};
    dual once = dual_cross(alpha, beta), twice = dual_cross(alpha, once);
    dual total = dual_plus(dual_plus(alpha, beta), gamma);
    if (scales->order > 3u) {
        dual delta = {
            sculler_times(scales->coning_fourth, sums->coning_fourth),
            sculler_times(scales->sculling_fourth, sums->sculling_fourth)};
        dual fifth = dual_times(-1.0 / 42.0, dual_cross(alpha, dual_cross(alpha, gamma)));
        dual turned = dual_times(-2.0 / 105.0, dual_cross(beta, once));
        dual sixth = dual_times(1.0 / 2520.0, dual_cross(alpha, dual_cross(alpha, twice)));
        total = dual_plus(dual_plus(total, delta), dual_plus(dual_plus(fifth, turned), sixth));
    } else {
        total = dual_plus(total, dual_times(-1.0 / 60.0, twice));
    }
    sculler_vector phi = total.angle, w = total.velocity;
    sculler_vector rotated = velocity_rotation(phi, w, sqrt(sculler_dot(phi, phi)));
    increments->phi = phi;
    increments->dv_sf = sculler_plus(w, rotated, 1.0);
}

void sculler_increments_of(
    const sculler_scales *scales, const sculler_sums *sums, sculler_increments *increments)
{
    sculler_vector alpha = sculler_times(scales->alpha, sums->alpha);
    sculler_vector upsilon = sculler_times(scales->nu, sums->nu);
    sculler_vector coning = correction(scales, sums->coning_within, sums->coning_between);
    sculler_vector sculling = sculler_times(
        scales->sculling, correction(scales, sums->sculling_within, sums->sculling_between));
    sculler_real angle = sqrt(sculler_dot(alpha, alpha));

    sculler_vector dv_sf =
        sculler_plus(upsilon, velocity_rotation(alpha, upsilon, angle), 1.0);
    increments->alpha = alpha;
    increments->phi = sculler_plus(alpha, coning, scales->coning);
    increments->dv_sf = sculler_plus(dv_sf, sculling, 1.0);
    increments->displaced = scales->high_resolution;
    increments->dr_sf = sculler_times(0.0, alpha);
    if (!scales->high_resolution) {
        return;
    }
    sculler_vector s_alpha = sculler_times(scales->s_alpha, sums->s_alpha);
    sculler_vector s_upsilon = sculler_times(scales->s_nu, sums->s_nu);
    sculler_vector scrolling = sculler_times(scales->scrolling, sums->scrolling);
    sculler_vector higher = velocity_higher_orders(
        alpha, upsilon, slope_of(alpha, s_alpha, scales->interval),
        slope_of(upsilon, s_upsilon, scales->interval), sculling,
        sculler_per(scrolling, scales->interval));
    sculler_vector turned = position_rotation(alpha, upsilon, s_alpha, s_upsilon, angle);
    increments->dv_sf = sculler_plus(increments->dv_sf, higher, 1.0);
    increments->dr_sf = sculler_plus(sculler_plus(s_upsilon, turned, 1.0), scrolling, 1.0);
}

static sculler_real axis_of(sculler_vector v, unsigned axis)
{
    return axis == 0u ? v.x : axis == 1u ? v.y : v.z;
}

static sculler_vector to_body(const sculler_axes *axes, sculler_vector v)
{
    sculler_vector found;
    found.x = axes->sign[0] * axis_of(v, axes->from[0]);
    found.y = axes->sign[1] * axis_of(v, axes->from[1]);
    found.z = axes->sign[2] * axis_of(v, axes->from[2]);
    return found;
}

void sculler_in_axes(const sculler_axes *axes, sculler_increments *increments)
{
    increments->phi = to_body(axes, increments->phi);
    increments->alpha = to_body(axes, increments->alpha);
    increments->dv_sf = to_body(axes, increments->dv_sf);
    increments->dr_sf = to_body(axes, increments->dr_sf);
}

/* aT, bT^2, cT^3, dT^4 and eT^5 of w = a + bt + ct^2 + dt^3 + et^4 about the middle of an interval T,
 * or integrals of w over five consecutive ones, the oldest first. */
typedef struct {
    sculler_vector of[INTERVALS];
} five;

/* About the middle of the last interval, of the integrals. */
static five slopes(const five *sums)
{
    static const sculler_real fit[INTERVALS][INTERVALS] = {
        {-71.0, 364.0, -746.0, 684.0, 1689.0},
        {9.0, -50.0, 120.0, -174.0, 95.0},
        {7.0, -36.0, 74.0, -68.0, 23.0},
        {3.0, -14.0, 24.0, -18.0, 5.0},
        {1.0, -4.0, 6.0, -4.0, 1.0},
    };
    static const sculler_real divisor[INTERVALS] = {1920.0, 48.0, 16.0, 12.0, 24.0};
    five found;
    for (unsigned k = 0; k < INTERVALS; k++) {
        sculler_vector total = sculler_times(0.0, sums->of[0]);
        for (unsigned i = 0; i < INTERVALS; i++) {
            total = sculler_plus(total, sums->of[i], fit[k][i]);
        }
        found.of[k] = sculler_per(total, divisor[k]);
    }
    return found;
}

/* The same polynomials about another middle and for another length, both in intervals. */
static five of_part(const five *rates, sculler_real middle, sculler_real length)
{
    static const sculler_real choose[INTERVALS][INTERVALS] = {
        {1.0, 1.0, 1.0, 1.0, 1.0}, {0.0, 1.0, 2.0, 3.0, 4.0}, {0.0, 0.0, 1.0, 3.0, 6.0},
        {0.0, 0.0, 0.0, 1.0, 4.0}, {0.0, 0.0, 0.0, 0.0, 1.0},
    };
    five found;
    sculler_real scale = 1.0;
    for (unsigned k = 0; k < INTERVALS; k++) {
        sculler_vector total = rates->of[k];
        sculler_real power = 1.0;
        for (unsigned j = k + 1u; j < INTERVALS; j++) {
            power *= middle;
            total = sculler_plus(total, rates->of[j], choose[k][j] * power);
        }
        scale *= length;
        found.of[k] = sculler_times(scale, total);
    }
    return found;
}

/* With a1 = aT, a2 = bT^2, a3 = cT^3,
 *
 *     phi - (alpha + 1/2 int alpha x w) = a1x(a1xa3)/360 - a2x(a1xa2)/240 - a1x(a1x(a1xa2))/720
 *
 * the third- and fourth-order terms of the Magnus series for a rate in body axes. */
static sculler_vector third_order_terms(const five *a)
{
    sculler_vector once = sculler_cross(a->of[0], a->of[1]);
    sculler_vector first = sculler_cross(a->of[0], sculler_cross(a->of[0], a->of[2]));
    sculler_vector second = sculler_cross(a->of[1], once);
    sculler_vector third = sculler_cross(a->of[0], sculler_cross(a->of[0], once));
    return less(
        less(sculler_per(first, 360.0), sculler_per(second, 240.0)), sculler_per(third, 720.0));
}

/* Of half an interval: its alpha, what phi has beyond it, and what of that is of third order on. */
typedef struct {
    sculler_vector alpha, small, terms;
} half;

static half half_of(const five *rates, sculler_real middle)
{
    five a = of_part(rates, middle, 0.5);
    half h;
    h.terms = third_order_terms(&a);
    h.alpha = added(
        added(a.of[0], sculler_per(a.of[2], 12.0)), sculler_per(a.of[4], 80.0));
    h.small = added(cross_per(a.of[0], a.of[1], 12.0), h.terms);
    return h;
}

/* What the second-order phi lacks: the terms of both halves of the interval, put together by Baker,
 * Campbell and Hausdorff without what the coning of the whole has (sculler_model.host). */
static sculler_vector rotation_terms(const five *rates)
{
    half one = half_of(rates, -0.25), other = half_of(rates, 0.25);
    sculler_vector left = added(one.alpha, one.small), right = added(other.alpha, other.small);
    sculler_vector w = sculler_cross(left, right);
    sculler_vector mixed =
        added(sculler_cross(one.small, right), sculler_cross(one.alpha, other.small));
    sculler_vector total = added(one.terms, other.terms);
    total = added(sculler_plus(total, mixed, 0.5), cross_per(less(left, right), w, 12.0));
    return less(total, cross_per(right, sculler_cross(left, w), 24.0));
}

/* The third and fourth order of int w x int w x ... f, less what Eq. 51 and sculling have of it, with
 * rate and force parabolas (sculler_model.host.velocity_terms). */
static sculler_vector velocity_terms(const five *a, const five *u)
{
    sculler_vector a1 = a->of[0], a2 = a->of[1], a3 = a->of[2];
    sculler_vector once = sculler_cross(a1, u->of[0]);
    sculler_vector slope = sculler_cross(a1, u->of[1]);
    sculler_vector turned = sculler_cross(a2, u->of[0]);
    sculler_vector inner = added(sculler_per(slope, 80.0), sculler_per(turned, 240.0));
    sculler_vector first = added(sculler_per(slope, 24.0), cross_per(a1, u->of[2], 360.0));
    first = added(first, cross_per(a2, u->of[1], 240.0));
    first = less(first, cross_per(a3, u->of[0], 180.0));
    first = less(added(first, sculler_cross(a1, inner)), cross_per(a2, once, 240.0));
    sculler_vector second = added(sculler_per(once, 24.0), sculler_per(slope, 120.0));
    second = added(less(second, sculler_per(turned, 240.0)), cross_per(a1, once, 80.0));
    return added(
        less(sculler_cross(a1, first), sculler_cross(a2, second)), cross_per(a3, once, 360.0));
}

/* What the first four intervals lack, for the fifth: of phi, or with forces of dV_SF. */
static sculler_vector of_the_first(const five *alpha, const five *rates, const five *forces)
{
    sculler_vector total = sculler_times(0.0, alpha->of[0]);
    for (unsigned k = 0; k + 1u < INTERVALS; k++) {
        five there = of_part(rates, (sculler_real)k - 4.0, 1.0);
        sculler_vector turn = sculler_times(forces == NULL ? 0.5 : 1.0, alpha->of[k]), lacking;
        for (unsigned between = k + 1u; between + 1u < INTERVALS; between++) {
            turn = added(turn, alpha->of[between]);
        }
        if (forces == NULL) {
            lacking = rotation_terms(&there);
            turn = sculler_plus(turn, alpha->of[INTERVALS - 1u], 0.5);
        } else {
            five forces_there = of_part(forces, (sculler_real)k - 4.0, 1.0);
            lacking = velocity_terms(&there, &forces_there);
        }
        sculler_vector across = sculler_cross(turn, lacking);
        lacking = sculler_plus(less(lacking, across), sculler_cross(turn, across), 0.5);
        total = added(total, lacking);
    }
    return total;
}

/* Whether the rate is smooth up to the last interval, by the last ten: third differences of alpha
 * against second ones, and no turn beyond a radian. */
static bool is_smooth(sculler_third_order *memory, const five *alpha)
{
    const sculler_vector *a = alpha->of;
    sculler_vector middle = less(a[3], a[2]);
    sculler_vector second = less(less(a[4], a[3]), middle);
    sculler_vector third = less(second, less(middle, less(a[2], a[1])));
    sculler_real seconds = 0.0, thirds = 0.0;
    for (unsigned i = 0; i + 1u < WINDOW; i++) {
        memory->second[i] = memory->second[i + 1u];
        memory->third[i] = memory->third[i + 1u];
    }
    memory->second[WINDOW - 1u] = sculler_dot(second, second);
    memory->third[WINDOW - 1u] = sculler_dot(third, third);
    for (unsigned i = 0; i < WINDOW; i++) {
        seconds += memory->second[i];
        thirds += memory->third[i];
    }
    return thirds <= 0.13 * seconds && sculler_dot(a[4], a[4]) <= 1.0;
}

void sculler_third_order_begin(sculler_third_order *memory)
{
    for (unsigned i = 0; i < WINDOW; i++) {
        memory->second[i] = 0.0;
        memory->third[i] = 0.0;
    }
    memory->left += memory->seen < INTERVALS ? memory->seen : 0u;
    memory->seen = 0;
}

void sculler_third_order_correct(sculler_third_order *memory, sculler_increments *increments)
{
    five alpha, upsilon;
    for (unsigned i = 0; i + 1u < INTERVALS; i++) {
        alpha.of[i] = memory->turns[i];
        upsilon.of[i] = memory->velocities[i];
    }
    alpha.of[INTERVALS - 1u] = increments->alpha;
    sculler_vector turned = sculler_cross(increments->alpha, increments->dv_sf);
    upsilon.of[INTERVALS - 1u] = less(increments->dv_sf, sculler_times(0.5, turned));
    for (unsigned i = 0; i + 1u < INTERVALS; i++) {
        memory->turns[i] = alpha.of[i + 1u];
        memory->velocities[i] = upsilon.of[i + 1u];
    }
    memory->seen += memory->seen < INTERVALS + 1u ? 1u : 0u;
    bool smooth = memory->seen > 3u && is_smooth(memory, &alpha);
    if (memory->seen < INTERVALS) {
        return;
    }
    bool starts = memory->seen == INTERVALS;
    *(smooth ? &memory->corrected : &memory->left) += starts ? INTERVALS : 1u;
    if (!smooth) {
        return;
    }
    five rates = slopes(&alpha), forces = slopes(&upsilon);
    increments->phi = added(increments->phi, rotation_terms(&rates));
    if (starts) {
        increments->phi = added(increments->phi, of_the_first(&alpha, &rates, NULL));
    }
    if (increments->displaced) { /* which has its higher orders already */
        return;
    }
    increments->dv_sf = added(increments->dv_sf, velocity_terms(&rates, &forces));
    if (starts) {
        increments->dv_sf = added(increments->dv_sf, of_the_first(&alpha, &rates, &forces));
    }
}

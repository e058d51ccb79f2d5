/* From a core's exact integers to what the navigator takes: phi, alpha, dV_SF and dR_SF.
 *
 * A generated NAME_host.c reads a result's words into integers and knows the scales; the arithmetic
 * is here, for every design alike.  Integers are two's complement in limbs of 64 bits, the lowest
 * limb first.
 */
#ifndef SCULLER_INCREMENTS_H
#define SCULLER_INCREMENTS_H

#include "sculler_nav.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Status bits of a result. */
#define SCULLER_SHORT_HISTORY 1u /* its sums lack samples before the first one: not to be used */
#define SCULLER_FAULT 2u         /* a sample was marked as faulty */
#define SCULLER_RAIL 4u          /* a count stood at its rail */
#define SCULLER_LOST 8u          /* a sample was offered and not taken before this interval */

/* Results by status bit, as many as were seen. */
typedef struct {
    uint32_t short_history, fault, rail, lost;
} sculler_status_counts;

/* Count a result's status bits.  Returns whether the result may be used: all but those of short
 * history are navigated with; begin at the end of the last one of these. */
bool sculler_status_take(sculler_status_counts *counts, uint32_t status);

/* Results that are missing between two consecutive ones, by their `major`.
 *
 * bits: of the counter as it is handed over, 64 at most; it counts modulo 2 to these bits.
 * A core that was reset begins at 0 again: that looks like very many. */
uint64_t sculler_results_missing(uint64_t last_major, uint64_t major, unsigned bits);

/* Read a column of 16-bit words, the least significant first, extended by its sign. */
void sculler_integer_from_words(
    const uint16_t *words, size_t word_count, uint64_t *limbs, size_t limb_count);

/* The same of 32-bit registers. */
void sculler_integer_from_registers(
    const uint32_t *registers, size_t register_count, uint64_t *limbs, size_t limb_count);

/* An integer of any size: the double nearest to it, ties to even.  Of another precision its leading
 * bits, to that precision; it must then be below 2^127 in size. */
sculler_real sculler_integer_to_real(const uint64_t *limbs, size_t limb_count);

/* A result's integers as the nearest doubles, in counts and counts^2, sensor axes. */
typedef struct {
    sculler_vector alpha, coning_within, coning_between;
    sculler_vector nu, sculling_within, sculling_between;
    sculler_vector s_alpha, s_nu, scrolling; /* of a design with high-resolution position */
    sculler_vector coning_third, sculling_third, coning_fourth, sculling_fourth; /* by its order */
} sculler_sums;

/* What a design's integers are worth. */
typedef struct {
    sculler_real alpha, nu;          /* rad and m/s a count */
    sculler_real within, between;    /* what the corrections stand over */
    sculler_real coning, sculling;   /* rad and m/s a count^2 */
    sculler_real s_alpha, s_nu;      /* rad s and m; scales of high-resolution position */
    sculler_real scrolling;          /* m */
    sculler_real interval;           /* of a result, s */
    bool high_resolution;      /* whether there are s_alpha, s_nu and scrolling */
    sculler_real coning_third, sculling_third;   /* rad and m/s; scales of third order */
    sculler_real coning_fourth, sculling_fourth; /* and of fourth */
    unsigned order;            /* of the sums: 2, 3 or 4 */
} sculler_scales;

/* phi, alpha, dV_SF and dR_SF of a result, in sensor axes (Savage-98 Eq. 37, 51, 84; Yang Eq. 14):
 *
 *     phi   = alpha + coning (within + between)
 *     dV_SF = nu + dV_rot(alpha, nu) + sculling (within + between)
 *
 * Of third or fourth order, with w = nu + sculling and what these orders, and the first terms of what
 * follows them, add to it and to phi, dV_SF = w + dV_rot(phi, w). */
void sculler_increments_of(
    const sculler_scales *scales, const sculler_sums *sums, sculler_increments *increments);

/* phi and dV_SF of a core of third or fourth order, in the place of those of second order that
 * sculler_increments_of has found of the same sums; and the first terms of what follows these (see
 * docs/explanation/higher-order.md). */
void sculler_higher_orders(
    const sculler_scales *scales, const sculler_sums *sums, sculler_increments *increments);

/* From sensor axes to body axes: body axis i is sensor axis from[i] (0..2) times sign[i] (+-1). */
typedef struct {
    unsigned from[3];
    sculler_real sign[3];
} sculler_axes;

void sculler_in_axes(const sculler_axes *axes, sculler_increments *increments);

/* The third-order terms of rotation vector and velocity, from five consecutive intervals, where the
 * rate is smooth.  All zero is its beginning; sculler_third_order_begin after a break or a result of
 * short history.  Begin it with the first interval that is navigated with: what the first four lack
 * is added to the fifth.  Not for results of order 3 or 4, which have these terms. */
typedef struct {
    sculler_vector turns[4];            /* integrals of the rate, rad, the oldest first */
    sculler_vector velocities[4];       /* of the specific force, body axes, m/s */
    sculler_real second[10], third[10]; /* squares of differences of the last intervals' turns */
    uint32_t seen;
    uint32_t corrected, left;           /* how many intervals were corrected, and left as they are */
} sculler_third_order;

void sculler_third_order_begin(sculler_third_order *memory);

/* Correct phi and, where there is no dR_SF, dV_SF. */
void sculler_third_order_correct(sculler_third_order *memory, sculler_increments *increments);

#ifdef __cplusplus
}
#endif
#endif

/* Initial attitude of a unit at rest: levelled by gravity, turned to north by Earth's rotation.
 *
 * The window goes by interval by interval; only sums are kept, so minutes at hundreds of intervals a
 * second fit a small memory.
 *
 *     static sculler_align window;               (24 KiB; free again after the alignment)
 *     static sculler_align_part steps[300];      (for the fine stage: one a second)
 *     sculler_align_begin(&window, interval, 30000, lat, h, &gravity, steps, 300);
 *     30000 times: sculler_align_take(&window, &increments);
 *     error = sculler_align_finish(&window, &noise, &coarse);
 *     sculler_align_refine(&window, &coarse, &fine);
 *
 * A constant gyro bias east turns the heading by bias/(Earth's horizontal rate), an accelerometer
 * bias tilts the level by bias/g: no alignment at rest can tell them from attitude.
 */
#ifndef SCULLER_ALIGN_H
#define SCULLER_ALIGN_H

#include "sculler_nav.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Parts of the window in which the noise's spectrum is seen, and its effect summed up, at most.  A
 * program that knows the noise may be compiled with fewer, 16u say: a window is smaller then, the
 * stated covariance quicker and coarser, by up to a tenth, and the attitude the same. */
#ifndef SCULLER_ALIGN_PARTS
#define SCULLER_ALIGN_PARTS 128u
#endif
#define SCULLER_ALIGN_MODES (SCULLER_ALIGN_PARTS - 2u)

/* What is known of the sensors' errors, one standard deviation, each axis; negative where nothing
 * is.  What is left out of the first three is estimated from the window; a bias cannot be. */
typedef struct {
    sculler_real angle_random_walk;    /* N, rad/sqrt(s) */
    sculler_real velocity_random_walk; /* K, m/s/sqrt(s) */
    sculler_real velocity_noise;       /* of the velocity at one instant, m/s, > 0 */
    sculler_real gyro_bias;            /* constant over the window, rad/s */
    sculler_real accel_bias;           /* constant over the window, m/s^2 */
} sculler_noise;

/* Sums of the specific force in the inertial frame that the body left, over some intervals. */
typedef struct {
    sculler_vector plain, cosine, sine; /* times 1, cos and sin of Earth's turn since the start */
    sculler_vector angle;               /* that the gyros have gone through at their end, rad */
} sculler_align_part;

/* A window.  The caller makes room for it; its members are the library's. */
typedef struct {
    sculler_real interval, lat, gravity, lean; /* s, rad, m/s^2, m/s^2 */
    size_t count, taken;                 /* intervals */
    size_t part_size, part_count;        /* intervals of a part; parts */
    size_t step_size, step_count;        /* the same of the fine stage's steps */
    sculler_quaternion chain;            /* of the body since the start, in inertial space */
    sculler_vector turned, pushed;       /* sums of phi and dV_SF */
    sculler_align_part whole, sloped;    /* sums over the window; and times the time from its middle */
    sculler_vector down[3][3];           /* axes of the inertial frame in the body, times 1, cos, sin */
    sculler_align_part *steps;
    sculler_align_part parts[SCULLER_ALIGN_PARTS];
    sculler_real series[5][SCULLER_ALIGN_PARTS];  /* two of tilts, three of angles, rad */
    sculler_real spectra[SCULLER_ALIGN_MODES][3]; /* of walk, white and blue noise of variance 1 */
    sculler_real power[2][SCULLER_ALIGN_MODES];   /* of the tilts; of the gyros' angles */
} sculler_align;

/* What the coarse stage found. */
typedef struct {
    sculler_quaternion q;      /* q_nb at the END of the window */
    sculler_real covariance[3][3];   /* of the attitude about north, east, down, rad^2 */
    sculler_real seconds;            /* length of the window */
    sculler_real horizontal_rate;    /* of the Earth as gravity's swing shows it, rad/s */
    sculler_real down_rate;          /* mean rate about the vertical, down, rad/s */
    sculler_real specific_force;     /* size of the mean, m/s^2 */
    sculler_real gravity;            /* of the model here, m/s^2 */
    sculler_noise noise;       /* as known, or as the window shows it */
    sculler_quaternion turned; /* of the body from start to end, in inertial space */
} sculler_alignment;

/* What the fine stage found. */
typedef struct {
    sculler_quaternion q;           /* q_nb at the END of the window */
    sculler_real covariance[3][3];        /* as above */
    sculler_vector gyro_bias;       /* rad/s, body axes: what the gyros show too much */
    sculler_vector gyro_bias_sigma; /* rad/s, north, east, down; negative where it cannot be seen */
    sculler_real surprise;                /* mean normalised innovation squared; about 1 or less */
} sculler_fine_alignment;

/* Nothing is known of the sensors. */
sculler_noise sculler_unknown_noise(void);

/* How many steps the fine stage of a window needs. */
size_t sculler_align_steps(sculler_real interval, size_t count);

/* Begin a window.
 *
 * interval: s; count: major intervals of the window, none of them of short history.
 * lat, h:   geodetic, rad and m.
 * gravity:  the model.
 * steps:    room for the fine stage, of so many elements; null for the coarse stage alone.
 *
 * SCULLER_TOO_SHORT: less than 10 s or 10 intervals, or too little room.  SCULLER_NEAR_POLE. */
sculler_error sculler_align_begin(
    sculler_align *window,
    sculler_real interval,
    size_t count,
    sculler_real lat,
    sculler_real h,
    const sculler_gravity *gravity,
    sculler_align_part *steps,
    size_t step_room);

/* Take the next interval, in body axes.  Returns whether the window is whole. */
bool sculler_align_take(sculler_align *window, const sculler_increments *increments);

/* The attitude, by the one rotation that lays the swing of the specific force best upon gravity's
 * (least squares, Wahba's problem).
 *
 * SCULLER_TOO_SHORT: intervals are missing.  SCULLER_NOT_FINITE.  SCULLER_TURNING: the mean rate is
 * over 100 times Earth's.  SCULLER_NOT_AT_REST: the specific force is more than 2 % off gravity. */
sculler_error sculler_align_finish(
    sculler_align *window, const sculler_noise *known, sculler_alignment *found);

/* The attitude by a Kalman filter on the velocity that a level unit must not gain; the window had
 * room for steps. */
void sculler_align_refine(
    const sculler_align *window,
    const sculler_alignment *coarse,
    sculler_fine_alignment *found);

/* Take a gyro bias (rad/s, body axes) out of an interval's increments. */
void sculler_take_out_bias(
    sculler_vector gyro_bias, sculler_real interval, sculler_increments *increments);

/* Internal: the sum of a part in north-east-down, of q_nb at the start; and the noise that a window
 * shows, of which parts and their length in s. */
sculler_vector sculler_align_level(
    const sculler_align *window, sculler_quaternion start, const sculler_align_part *part);
sculler_noise sculler_noise_shown(sculler_align *window, sculler_quaternion start);

#ifdef __cplusplus
}
#endif
#endif

/* The host's navigation: wander azimuth over WGS-84, in double precision or what sculler_real.h says.
 *
 * Freestanding C99: no allocation, no global state, nothing of the C library but the functions of
 * <math.h> that sculler_math.h lists.  Every object is the caller's; any number of navigators may
 * run side by side.  No function is to be called with a null pointer.
 *
 * Frames:
 *     b   body: x forward, y right, z down.
 *     n   north, east, down at the present geodetic position.
 *     w   local level: z down; x is turned from north by the wander angle, towards east.  Over the
 *         Earth it turns with the travel alone and not about the vertical, so it works at the poles.
 *     e   Earth: x through latitude and longitude 0, z through the north pole.
 * A quaternion q_nb takes body components to n components; angles are in rad, lengths in m.
 *
 * How to use it:
 *     sculler_nav nav;
 *     sculler_settings settings = sculler_defaults(0.01);
 *     if (sculler_nav_begin(&nav, &settings, &start) != SCULLER_OK) { ... }
 *     for each major interval:
 *         error = sculler_nav_update(&nav, &increments);
 *         sculler_nav_state(&nav, &state);
 */
#ifndef SCULLER_NAV_H
#define SCULLER_NAV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sculler_real.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a function came to.  Anything but SCULLER_OK says why nothing more was done. */
typedef enum {
    SCULLER_OK = 0,
    SCULLER_BAD_STATE,   /* the initial state is not one to navigate from */
    SCULLER_BAD_SETTING, /* a setting is out of its range */
    SCULLER_NOT_FINITE,  /* an increment is not a finite number; the state is as it was */
    SCULLER_OUTSIDE,     /* the height has run away, or the gravity table ends; the update is done */
    SCULLER_TOO_SHORT,   /* alignment: less than 10 s or 10 intervals, or no room for the window */
    SCULLER_NEAR_POLE,   /* alignment: too near a pole to find north by Earth's rotation */
    SCULLER_TURNING,     /* alignment: mean rate over 100 times Earth's */
    SCULLER_NOT_AT_REST, /* alignment: specific force more than 2 % off gravity */
    SCULLER_BAD_FRAME    /* telemetry: marks, length or CRC are wrong */
} sculler_error;

typedef struct {
    sculler_real x, y, z;
} sculler_vector;

/* w is the scalar part; of length 1. */
typedef struct {
    sculler_real w, x, y, z;
} sculler_quaternion;

/* What a major interval brings, in body axes. */
typedef struct {
    sculler_vector phi;   /* rotation vector over the interval, against inertial space, rad */
    sculler_vector alpha; /* integral of the angular rate, rad; the navigator does not look at it */
    sculler_vector dv_sf; /* integral of the specific force, m/s, in the body frame at the START of
                             the interval, held fixed in inertial space (Savage-98 Eq. 37) */
    sculler_vector dr_sf; /* running integral of that, m, same frame (Savage-98 Eq. 84) */
    bool displaced;       /* whether there is dr_sf: the position is then of high resolution */
} sculler_increments;

/* Where the body is at one instant. */
typedef struct {
    sculler_real time;          /* s */
    sculler_quaternion q; /* q_nb, body to north-east-down */
    sculler_vector v;     /* velocity over the Earth, north, east, down, m/s */
    sculler_real lat, lon;      /* geodetic, rad; lon in -pi..pi */
    sculler_real h;             /* height above the ellipsoid, m */
    sculler_real wander;        /* wander angle, from north to the x axis of w, towards east, rad */
} sculler_state;

/* A table of gravity, in doubles: what its points have more than normal gravity. */
typedef struct {
    const double *lats;    /* degrees, rising; a single one stands for all latitudes */
    const double *heights; /* m, rising; a single one stands for all heights */
    const double *excess;  /* m/s^2, a row for each latitude */
    size_t lat_count, height_count;
} sculler_gravity_table;

/* A model of plumb-bob gravity over the turning Earth. */
typedef struct {
    bool is_constant;                   /* `value` everywhere, square to the ellipsoid */
    sculler_real value;                       /* m/s^2 */
    const sculler_gravity_table *table; /* added to the normal field of WGS-84; null for nothing */
} sculler_gravity;

/* Gains of the loop that holds the unstable vertical channel to a known height; all 0 for none. */
typedef struct {
    sculler_real k1;        /* 1/s */
    sculler_real k2;        /* 1/s^2 */
    sculler_real k3;        /* 1/s^3 */
    sculler_real reference; /* height above the ellipsoid, m, as long as no other is measured */
    sculler_real hold;      /* s, the age at which a measured height is held to no longer */
    bool waits;       /* until a height is measured the loop rests, and does not look at reference */
} sculler_damping;

/* What does not change from interval to interval. */
typedef struct {
    sculler_real interval;         /* length of a major interval, s, > 0 */
    uint32_t position_every; /* j >= 1: position, gravity, Earth rate and curvature are worked out
                                every j-th interval and extrapolated in between */
    sculler_damping damping;
    sculler_gravity gravity;
} sculler_settings;

/* What the equations need of the Earth at one place, in w. */
typedef struct {
    sculler_vector rate;      /* of the Earth, rad/s */
    sculler_vector curvature; /* xx, xy, yy of the ellipsoid at the height, 1/m */
    sculler_vector gravity;   /* plumb-bob gravity, m/s^2 */
} sculler_earth;

/* A navigator.  The caller makes room for it; its members are the library's. */
typedef struct {
    sculler_settings settings;
    sculler_quaternion q;      /* q_wb at the end of the last interval */
    sculler_vector v, v_past;  /* in w, m/s; and one interval before */
    sculler_quaternion place;  /* q_ew at the last position update */
    sculler_real h;                  /* there, m */
    sculler_earth earth, past; /* there; and one position update before */
    uint32_t since;            /* major intervals since the last position update */
    sculler_vector travel;     /* rotation vector of w over the Earth since then, rad */
    sculler_real climb;              /* since then, m */
    sculler_real offset;             /* integral of the height loop, m/s^2 */
    sculler_real reference;          /* height to hold to, m */
    sculler_real age;                /* how old it is at the next interval's start, s; below 0: none */
    bool measured;             /* whether it is one that ages */
    sculler_real start;              /* time from which the intervals count, s */
    uint64_t updates;          /* since then */
    bool begun;                /* whether there was an update */
} sculler_nav;

/* Settings for intervals of this length (s): position every interval, normal gravity, no damping. */
sculler_settings sculler_defaults(sculler_real interval);

/* Gains that put all three poles of the height loop at -1/seconds.
 *
 * reference: m; seconds: many major intervals long, usually a minute or more.  A measured height is
 * held to for 10 s. */
sculler_damping sculler_height_damping(sculler_real reference, sculler_real seconds);

/* Begin at a state.
 *
 * nav:      is written.
 * settings: are copied; a gravity table they point to must outlive the navigator.
 * start:    at the start of the first interval; its wander angle is kept.
 *
 * SCULLER_BAD_STATE: a number is not finite, latitude outside +-90 degrees, longitude or wander
 * angle outside +-180 degrees, height outside -10 km..1000 km, or the quaternion is not of length 1
 * (to 1e-6).  SCULLER_BAD_SETTING: an interval or damping out of range.  SCULLER_OUTSIDE: the
 * gravity table does not reach there.  In all of these nav is not to be used. */
sculler_error sculler_nav_begin(
    sculler_nav *nav, const sculler_settings *settings, const sculler_state *start);

/* Carry the state over one major interval, in body axes.
 *
 * A result of short history (status bit 0) is not for this: begin after it.  The very first update
 * is worked out twice, for the extrapolations need a past. */
sculler_error sculler_nav_update(sculler_nav *nav, const sculler_increments *increments);

/* Hold the height to a measured one, of a barometer say, from the next update on.
 *
 * height: m above the ellipsoid.
 * age:    s, from the instant that it stands for to the next interval's start: its lag, and what it
 *         waited; below 0 for none.  It is held against the height that the navigator had then.
 *
 * Each update makes it an interval older; from settings.damping.hold on, or where there is none, the
 * loop rests.  SCULLER_BAD_SETTING: a number is not finite, the height outside -10 km..1000 km, or
 * there is no damping; nothing is done then. */
sculler_error sculler_nav_hold_height(sculler_nav *nav, sculler_real height, sculler_real age);

/* The state at the end of the last major interval.
 *
 * Within 6 um of a pole, where there is no north, the wander angle is 0 and the longitude goes with
 * it. */
void sculler_nav_state(const sculler_nav *nav, sculler_state *state);

/* Say the instant (s) of the end of the last interval, from which the next ones count. */
void sculler_nav_set_time(sculler_nav *nav, sculler_real time);

/* Over a break in the data: the state so many seconds later if attitude and velocity stay as they
 * are.  Begin anew from it. */
void sculler_coast(sculler_state *state, sculler_real seconds);

/* Plumb-bob gravity of a model.
 *
 * sin_lat: sine of geodetic latitude; height: m.
 * lean:    gets gravity's horizontal part over the horizontal part of the polar axis, m/s^2.
 * Returns its part down, m/s^2. */
sculler_real sculler_gravity_at(
    const sculler_gravity *model, sculler_real sin_lat, sculler_real height, sculler_real *lean);

/* Radii of curvature on the ellipsoid (m) at a sine of latitude. */
void sculler_radii(sculler_real sin_lat, sculler_real *meridian, sculler_real *prime_vertical);

/* Roll, pitch, heading (rad) of q_nb, as x, y, z: roll and heading in -pi..pi.  At a pitch of +-90
 * degrees roll is given as 0. */
sculler_vector sculler_euler(sculler_quaternion q);

#ifdef __cplusplus
}
#endif
#endif

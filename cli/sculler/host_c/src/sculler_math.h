/* Vectors and quaternions of the host library, and all that it takes of <math.h>.
 *
 * Internal to the library; a program includes sculler_nav.h and its neighbours.
 *
 * All that is called of <math.h>, here and in the .c files:
 *     the navigator    sqrt sin cos asin atan2 fabs copysign isfinite
 *     the increments   sqrt sin (sin where the body turns by 1 rad or more in an interval)
 *     the alignment    sqrt sin cos atan2 exp log fabs isfinite
 *     telemetry        nothing
 *
 * Every expression is the Python navigator's, operation by operation, so that both round alike.
 * No product may be fused with a sum (see below), and no compiler may be told that the order of
 * sums does not matter (-ffast-math).
 */
#ifndef SCULLER_MATH_H
#define SCULLER_MATH_H

#include <math.h>

#include "sculler_nav.h"

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF /* gcc does not know it: -std=c99, or -ffp-contract=off */
#endif

#define SCULLER_PI 3.14159265358979323846

/* WGS-84 */
#define SCULLER_SEMI_MAJOR_AXIS 6378137.0 /* m */
#define SCULLER_FLATTENING (1.0 / 298.257223563)
#define SCULLER_ECCENTRICITY_SQUARED (SCULLER_FLATTENING * (2.0 - SCULLER_FLATTENING))
#define SCULLER_EARTH_RATE 7.292115e-5 /* rad/s */
#define SCULLER_GM 3.986004418e14      /* m^3/s^2 */

static inline sculler_vector sculler_nothing(void)
{
    sculler_vector nothing = {0.0, 0.0, 0.0};
    return nothing;
}

/* a + factor b */
static inline sculler_vector sculler_plus(sculler_vector a, sculler_vector b, sculler_real factor)
{
    sculler_vector sum;
    sum.x = a.x + factor * b.x;
    sum.y = a.y + factor * b.y;
    sum.z = a.z + factor * b.z;
    return sum;
}

static inline sculler_vector sculler_times(sculler_real factor, sculler_vector a)
{
    sculler_vector product;
    product.x = factor * a.x;
    product.y = factor * a.y;
    product.z = factor * a.z;
    return product;
}

static inline sculler_vector sculler_per(sculler_vector a, sculler_real divisor)
{
    sculler_vector quotient;
    quotient.x = a.x / divisor;
    quotient.y = a.y / divisor;
    quotient.z = a.z / divisor;
    return quotient;
}

static inline sculler_real sculler_dot(sculler_vector a, sculler_vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline sculler_vector sculler_cross(sculler_vector a, sculler_vector b)
{
    sculler_vector product;
    product.x = a.y * b.z - a.z * b.y;
    product.y = a.z * b.x - a.x * b.z;
    product.z = a.x * b.y - a.y * b.x;
    return product;
}

/* Quaternion product: first rotates by q, then by p. */
static inline sculler_quaternion sculler_product(sculler_quaternion p, sculler_quaternion q)
{
    sculler_quaternion product;
    product.w = p.w * q.w - p.x * q.x - p.y * q.y - p.z * q.z;
    product.x = p.w * q.x + p.x * q.w + p.y * q.z - p.z * q.y;
    product.y = p.w * q.y - p.x * q.z + p.y * q.w + p.z * q.x;
    product.z = p.w * q.z + p.x * q.y - p.y * q.x + p.z * q.w;
    return product;
}

static inline sculler_quaternion sculler_conjugate(sculler_quaternion q)
{
    q.x = -q.x;
    q.y = -q.y;
    q.z = -q.z;
    return q;
}

/* v turned by q */
static inline sculler_vector sculler_rotate(sculler_quaternion q, sculler_vector v)
{
    sculler_vector axis = {q.x, q.y, q.z};
    sculler_vector t = sculler_cross(axis, v);
    t.x = t.x + t.x;
    t.y = t.y + t.y;
    t.z = t.z + t.z;
    sculler_vector turned;
    turned.x = v.x + q.w * t.x + q.y * t.z - q.z * t.y;
    turned.y = v.y + q.w * t.y + q.z * t.x - q.x * t.z;
    turned.z = v.z + q.w * t.z + q.x * t.y - q.y * t.x;
    return turned;
}

/* q brought back to length 1 from a rounding error away: 1 + e becomes 1 - 3/2 e^2. */
static inline sculler_quaternion sculler_normalised(sculler_quaternion q)
{
    sculler_real scale = 1.5 - 0.5 * (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    q.w = q.w * scale;
    q.x = q.x * scale;
    q.y = q.y * scale;
    q.z = q.z * scale;
    return q;
}

/* A turn about z, rad. */
static inline sculler_quaternion sculler_about_z(sculler_real angle)
{
    sculler_quaternion q = {cos(0.5 * angle), 0.0, 0.0, sin(0.5 * angle)};
    return q;
}

/* Quaternion of a rotation vector (rad) of any size, exact (Savage-20 Eq. 1). */
static inline sculler_quaternion sculler_from_rotation_vector(sculler_vector phi)
{
    sculler_real square = phi.x * phi.x + phi.y * phi.y + phi.z * phi.z;
    sculler_real half_sinc;
    sculler_quaternion q;
    if (square < 1e-4) { /* by series, the next terms are below 3e-17 */
        half_sinc = 0.5 - square * (1.0 / 48.0 - square * (1.0 / 3840.0));
        q.w = 1.0 - square * (1.0 / 8.0 - square * (1.0 / 384.0));
    } else {
        sculler_real angle = sqrt(square);
        half_sinc = sin(0.5 * angle) / angle;
        q.w = cos(0.5 * angle);
    }
    q.x = phi.x * half_sinc;
    q.y = phi.y * half_sinc;
    q.z = phi.z * half_sinc;
    return q;
}

/* The third row of the direction cosine matrix of q: of q_ew, the polar axis in w. */
static inline sculler_vector sculler_third_row(sculler_quaternion q)
{
    sculler_vector row;
    row.x = 2.0 * (q.x * q.z - q.w * q.y);
    row.y = 2.0 * (q.y * q.z + q.w * q.x);
    row.z = 1.0 - 2.0 * (q.x * q.x + q.y * q.y);
    return row;
}

#endif

/* Double-single arithmetic: a number is the sum of two floats, 48 bits together.
 *
 * For processors whose hardware has single precision alone.  With this header the library's .c
 * files, compiled as C++11, do every operation in pairs of floats, by the error-free sums and products
 * of Dekker, Knuth and Shewchuk.  Sums, products, quotients and roots are right to 2^-44 of their
 * size, functions to 2^-42; the range is that of a float.
 *
 * No compiler may fuse a product with a sum (-ffp-contract=off) or change the order of sums
 * (-ffast-math): the errors of sums would be lost.
 */
#ifndef SCULLER_DOUBLE_SINGLE_HPP
#define SCULLER_DOUBLE_SINGLE_HPP

#include <float.h>
#include <math.h>
#include <stdint.h>

#undef isfinite

#if defined(__FAST_MATH__)
#error "double-single needs sums in their order: compile without -ffast-math"
#endif
#if FLT_EVAL_METHOD != 0
#error "double-single needs sums that are rounded to floats: on x86, -msse2 -mfpmath=sse"
#endif

struct sculler_real {
    float high, low; /* worth high + low; high is the float nearest to it */

    sculler_real() = default;
    constexpr sculler_real(float high_, float low_) : high(high_), low(low_)
    {
    }
    constexpr sculler_real(double number)
        : high(static_cast<float>(number)),
          low(static_cast<float>(number - static_cast<double>(static_cast<float>(number))))
    {
    }

    /* Of an unsigned integer of up to 64 bits: three pieces of 24 bits and less, each a float. */
    template <typename Integer, typename = decltype(Integer() % 1)>
    explicit sculler_real(Integer integer)
    {
        uint64_t number = static_cast<uint64_t>(integer);
        float top = static_cast<float>(static_cast<uint32_t>(number >> 48)) * 281474976710656.0f;
        float middle =
            static_cast<float>(static_cast<uint32_t>(number >> 24) & 0xFFFFFFu) * 16777216.0f;
        float bottom = static_cast<float>(static_cast<uint32_t>(number) & 0xFFFFFFu);
        float sum = top + middle, rest = (middle - (sum - top)) + bottom;
        high = sum + rest;
        low = rest - (high - sum);
    }

    /* The integer below a number from 0 to 2^31. */
    template <typename Integer, typename = decltype(Integer() % 1)>
    explicit operator Integer() const
    {
        uint32_t whole = static_cast<uint32_t>(high);
        float rest = (high - static_cast<float>(whole)) + low;
        return static_cast<Integer>(rest < 0.0f ? whole - 1u : rest >= 1.0f ? whole + 1u : whole);
    }
};

inline sculler_real sculler_real_of(double number)
{
    return sculler_real(number);
}

inline double sculler_double_of(sculler_real number)
{
    return static_cast<double>(number.high) + static_cast<double>(number.low);
}

/* ---- error-free pieces ---------------------------------------------------------------------- */

/* a + b where a is not the smaller one; exact. */
static inline sculler_real sculler_quick_sum(float a, float b)
{
    float sum = a + b;
    return sculler_real(sum, b - (sum - a));
}

/* a + b, exact (Knuth). */
static inline sculler_real sculler_exact_sum(float a, float b)
{
    float sum = a + b, part = sum - a;
    return sculler_real(sum, (a - (sum - part)) + (b - part));
}

/* a b, exact: by one fused product, or by halves of 12 bits (Dekker). */
static inline sculler_real sculler_exact_product(float a, float b)
{
    float product = a * b;
#if defined(__FP_FAST_FMAF) || defined(__ARM_FEATURE_FMA)
    return sculler_real(product, __builtin_fmaf(a, b, -product));
#else
    float wide_a = 4097.0f * a, wide_b = 4097.0f * b;
    float a_high = wide_a - (wide_a - a), b_high = wide_b - (wide_b - b);
    float a_low = a - a_high, b_low = b - b_high;
    float error = ((a_high * b_high - product) + a_high * b_low) + a_low * b_high;
    return sculler_real(product, error + a_low * b_low);
#endif
}

/* ---- operators ------------------------------------------------------------------------------ */

static inline sculler_real operator-(sculler_real a)
{
    return sculler_real(-a.high, -a.low);
}

static inline sculler_real operator+(sculler_real a, sculler_real b)
{
    sculler_real high = sculler_exact_sum(a.high, b.high);
    sculler_real low = sculler_exact_sum(a.low, b.low);
    sculler_real sum = sculler_quick_sum(high.high, high.low + low.high);
    return sculler_quick_sum(sum.high, sum.low + low.low);
}

static inline sculler_real operator-(sculler_real a, sculler_real b)
{
    return a + -b;
}

static inline sculler_real operator*(sculler_real a, sculler_real b)
{
    sculler_real product = sculler_exact_product(a.high, b.high);
    return sculler_quick_sum(product.high, product.low + (a.high * b.low + a.low * b.high));
}

static inline sculler_real operator/(sculler_real a, sculler_real b)
{
    float first = a.high / b.high;
    sculler_real rest = a - b * sculler_real(first, 0.0f);
    float second = rest.high / b.high;
    rest = rest - b * sculler_real(second, 0.0f);
    return sculler_quick_sum(first, second) + sculler_real(rest.high / b.high, 0.0f);
}

static inline sculler_real &operator+=(sculler_real &a, sculler_real b)
{
    return a = a + b;
}

static inline sculler_real &operator-=(sculler_real &a, sculler_real b)
{
    return a = a - b;
}

static inline sculler_real &operator*=(sculler_real &a, sculler_real b)
{
    return a = a * b;
}

static inline sculler_real &operator/=(sculler_real &a, sculler_real b)
{
    return a = a / b;
}

static inline bool operator==(sculler_real a, sculler_real b)
{
    return a.high == b.high && a.low == b.low;
}

static inline bool operator!=(sculler_real a, sculler_real b)
{
    return !(a == b);
}

static inline bool operator<(sculler_real a, sculler_real b)
{
    return a.high < b.high || (a.high == b.high && a.low < b.low);
}

static inline bool operator>(sculler_real a, sculler_real b)
{
    return b < a;
}

static inline bool operator<=(sculler_real a, sculler_real b)
{
    return a.high < b.high || (a.high == b.high && a.low <= b.low);
}

static inline bool operator>=(sculler_real a, sculler_real b)
{
    return b <= a;
}

/* ---- functions ------------------------------------------------------------------------------ */

static inline bool isfinite(sculler_real x)
{
    return x.high - x.high == 0.0f;
}

static inline sculler_real fabs(sculler_real x)
{
    return x.high < 0.0f ? -x : x;
}

static inline sculler_real copysign(sculler_real size, sculler_real sign)
{
    sculler_real x = fabs(size);
    return copysignf(1.0f, sign.high) < 0.0f ? -x : x;
}

/* A step of Newton's from the float's root. */
static inline sculler_real sqrt(sculler_real x)
{
    float root = sqrtf(x.high);
    if (!(root > 0.0f) || !isfinite(x)) {
        return sculler_real(root, 0.0f);
    }
    sculler_real rest = x - sculler_exact_product(root, root);
    return sculler_quick_sum(root, rest.high / (root + root));
}

/* Sine and cosine of an angle (rad) of some turns: what a quarter turn leaves, by Taylor's series,
 * whose last terms need a float's precision only. */
static inline void sculler_sine_cosine(sculler_real x, sculler_real *sine, sculler_real *cosine)
{
    /* pi/2 in pieces of 12, 12 and 48 bits: products with small integers are exact */
    const float first = 1.5703125f, second = 4.83751296997070312e-4f;
    const sculler_real third(7.549789954891882e-8);
    float turns = x.high * 0.636619772f;
    int quarters = static_cast<int>(turns + (turns < 0.0f ? -0.5f : 0.5f));
    float k = static_cast<float>(quarters);
    sculler_real r = x - sculler_real(k * first, 0.0f);
    r = r - sculler_exact_product(k, second);
    r = r - third * sculler_real(k, 0.0f);

    sculler_real square = r * r;
    float q = square.high;
    float tail = 1.0f / 39916800.0f - q * (1.0f / 6227020800.0f - q / 1307674368000.0f);
    sculler_real sum = sculler_real(1.0 / 362880.0) - square * sculler_real(tail, 0.0f);
    sum = 1.0 / 5040.0 - square * sum;
    sum = 1.0 / 120.0 - square * sum;
    sum = 1.0 / 6.0 - square * sum;
    sculler_real s = r - r * (square * sum);

    tail = 1.0f / 479001600.0f - q * (1.0f / 87178291200.0f - q / 20922789888000.0f);
    sum = sculler_real(1.0 / 3628800.0) - square * sculler_real(tail, 0.0f);
    sum = 1.0 / 40320.0 - square * sum;
    sum = 1.0 / 720.0 - square * sum;
    sum = 1.0 / 24.0 - square * sum;
    sum = 0.5 - square * sum;
    sculler_real c = 1.0 - square * sum;

    bool swapped = (quarters & 1) != 0;
    sculler_real a = swapped ? c : s, b = swapped ? s : c;
    *sine = (quarters & 2) != 0 ? -a : a;
    *cosine = ((quarters + 1) & 2) != 0 ? -b : b;
}

static inline sculler_real sin(sculler_real x)
{
    sculler_real sine, cosine;
    sculler_sine_cosine(x, &sine, &cosine);
    return sine;
}

static inline sculler_real cos(sculler_real x)
{
    sculler_real sine, cosine;
    sculler_sine_cosine(x, &sine, &cosine);
    return cosine;
}

/* The float's angle, and the small one that is left when the vector is turned back by it. */
static inline sculler_real atan2(sculler_real y, sculler_real x)
{
    float angle = atan2f(y.high, x.high);
    if (y.high == 0.0f && x.high == 0.0f) {
        return sculler_real(angle, 0.0f);
    }
    sculler_real sine, cosine;
    sculler_sine_cosine(sculler_real(angle, 0.0f), &sine, &cosine);
    sculler_real across = y * cosine - x * sine, along = x * cosine + y * sine;
    return sculler_real(angle, 0.0f) + across / along;
}

static inline sculler_real asin(sculler_real x)
{
    return atan2(x, sqrt((1.0 - x) * (1.0 + x)));
}

static inline sculler_real exp(sculler_real x)
{
    if (x.high < -87.0f) { /* below what a float holds in full */
        return sculler_real(0.0f, 0.0f);
    }
    float turns = x.high * 1.442695041f;
    int doublings = static_cast<int>(turns + (turns < 0.0f ? -0.5f : 0.5f));
    sculler_real k(static_cast<float>(doublings), 0.0f);
    sculler_real r = x - k * sculler_real(0.693359375) + k * sculler_real(2.1219444005469058e-4);
    sculler_real sum(1.0), term(1.0);
    for (int n = 1; n <= 14; n++) {
        term = term * r / sculler_real(static_cast<float>(n), 0.0f);
        sum = sum + term;
    }
    return sculler_real(ldexpf(sum.high, doublings), ldexpf(sum.low, doublings));
}

static inline sculler_real log(sculler_real x)
{
    float first = logf(x.high);
    if (!(x.high > 0.0f) || !isfinite(x)) {
        return sculler_real(first, 0.0f);
    }
    sculler_real t = x * exp(sculler_real(-first, 0.0f)) - 1.0;
    return sculler_real(first, 0.0f) + (t - t * t * (0.5 - t * sculler_real(1.0 / 3.0)));
}

#endif

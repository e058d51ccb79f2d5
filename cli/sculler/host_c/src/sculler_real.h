/* What the numbers of the library are.
 *
 *     (nothing defined)          sculler_real is a double
 *     SCULLER_DOUBLE_SINGLE      two floats, 48 bits together, for processors whose hardware has
 *                                single precision alone; the library's .c files are then compiled as
 *                                C++11 (gcc -x c++), your program stays C or C++
 *     SCULLER_SINGLE             a float, 24 bits: a metre of position and a tenth of an arc second;
 *                                compile with -fsingle-precision-constant
 *
 * All files of a program are compiled alike.  docs/explanation/host-in-c-targets.md says what each
 * costs and leaves. */
#ifndef SCULLER_REAL_H
#define SCULLER_REAL_H

#if defined(SCULLER_DOUBLE_SINGLE) && defined(__cplusplus)

#include "sculler_double_single.hpp"

#elif defined(SCULLER_DOUBLE_SINGLE)

/* Worth high + low; high is the float nearest to it. */
typedef struct {
    float high, low;
} sculler_real;

static inline double sculler_double_of(sculler_real number)
{
    return (double)number.high + (double)number.low;
}

static inline sculler_real sculler_real_of(double number)
{
    sculler_real made;
    made.high = (float)number;
    made.low = (float)(number - (double)made.high);
    return made;
}

#else

#if defined(SCULLER_SINGLE)
typedef float sculler_real;
#else
typedef double sculler_real;
#endif

static inline double sculler_double_of(sculler_real number)
{
    return (double)number;
}

static inline sculler_real sculler_real_of(double number)
{
    return (sculler_real)number;
}

#endif
#endif

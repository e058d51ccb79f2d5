/* The library's numbers as pairs of floats, for programs in C and C++; see sculler_real.h. */
#ifndef SCULLER_DOUBLE_SINGLE_H
#define SCULLER_DOUBLE_SINGLE_H

#ifdef __cplusplus

#include "sculler_double_single.hpp"

#else

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

#endif
#endif

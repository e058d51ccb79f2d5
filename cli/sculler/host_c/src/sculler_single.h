/* The library's numbers as floats; see sculler_real.h. */
#ifndef SCULLER_SINGLE_H
#define SCULLER_SINGLE_H

#include <tgmath.h> /* sqrt and so on of floats */

typedef float sculler_real;

static inline double sculler_double_of(sculler_real number)
{
    return (double)number;
}

static inline sculler_real sculler_real_of(double number)
{
    return (sculler_real)number;
}

#endif

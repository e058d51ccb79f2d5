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

#if defined(SCULLER_DOUBLE_SINGLE)

#include "sculler_double_single.h"

#elif defined(SCULLER_SINGLE)

#include "sculler_single.h"

#else

typedef double sculler_real;

static inline double sculler_double_of(sculler_real number)
{
    return number;
}

static inline sculler_real sculler_real_of(double number)
{
    return number;
}

#endif
#endif

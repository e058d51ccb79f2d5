/* The alignment of a chip: a window at rest, result by result.  Made by `sculler soc`. */
#ifndef CHIP_ALIGN_H
#define CHIP_ALIGN_H

#include "sculler_align.h"

#define CHIP_ALIGNMENT_NUMBERS 25u

/* What it came to. */
typedef struct {
    sculler_error error;
    sculler_alignment coarse;
    sculler_fine_alignment fine; /* where it is asked for */
    sculler_vector gyro_bias;    /* rad/s, to be taken out; of the fine stage */
} chip_alignment;

/* Begin a window at a place; interval: s, of a result. */
sculler_error chip_align_begin(double interval, const sculler_state *place);

/* Take a result's increments; whether the window is whole. */
bool chip_align_take(const sculler_increments *increments);

/* The attitude at the end of a window that is whole, and all else that was found. */
void chip_align_finish(chip_alignment *found, sculler_quaternion *q);

/* What telemetry tells of it, in its order; zeros where there is an error. */
void chip_align_numbers(const chip_alignment *found, double numbers[CHIP_ALIGNMENT_NUMBERS]);

#endif

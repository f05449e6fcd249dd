/* C for the Taylor coefficients of the motion, by the recurrences of series.h. */
#ifndef EMIT_SERIES_H
#define EMIT_SERIES_H

#include "emitter.h"

/* Writes the function series(); returns how many rows of workspace it needs. */
size_t emit_series(struct Emitter *emitter);

/* Writes the function output_series(), for the outputs that are results; returns its rows of workspace. */
size_t emit_output_series(struct Emitter *emitter);

#endif

/* C for the Taylor coefficients of the motion, by the recurrences of series.h. */
#ifndef EMIT_SERIES_H
#define EMIT_SERIES_H

#include "write/recurrences.h"

/* Prepares series(); writer->is_unrolled then tells whether it gets code of its own for each order. */
struct SeriesWriter *series_writer_create(struct Emitter *emitter);
void series_writer_free(struct SeriesWriter *writer);

/* Writes the function series() and frees the writer; returns how many rows of workspace the function needs. */
size_t emit_series(struct Emitter *emitter, struct SeriesWriter *writer);

/* Writes the function output_series(), for the outputs that are results; returns its rows of workspace. */
size_t emit_output_series(struct Emitter *emitter);

#endif

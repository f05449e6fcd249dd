#include "read/space/vanishing.h"

#include <math.h>

#include "base/memory.h"

/* Samples that must all be 0; a nonzero analytic function is hardly ever 0 at one of them. */
enum { SAMPLES = 3 };

/* Values below this share count as 0: some thousand rounding errors. */
static const double digits = 1e-12;

/* Returns a value between 0.05 and 0.95, where most functions are defined, different for each sample and symbol. */
static double sample_of(size_t sample, size_t symbol) {
  return 0.5 + 0.45 * sin(1.0 + 2.7 * (double)(sample + 1) * (double)(symbol + 1));
}

static double scale_of(const double *values, const struct Vector *positions, size_t position_count) {
  double scale = position_count > 0 ? 0.0 : 1.0;
  for (size_t i = 0; i < position_count; i++)
    for (int axis = 0; axis < 3; axis++) scale = fmax(scale, fabs(values[positions[i].along[axis]]));
  return scale;
}

bool vanishes(const struct Graph *graph, Node node, const struct Vector *positions, size_t position_count) {
  double *symbols = allocate(graph->symbol_count, sizeof *symbols);
  bool is_zero = true;
  for (size_t sample = 0; sample < SAMPLES && is_zero; sample++) {
    for (size_t i = 0; i < graph->symbol_count; i++) symbols[i] = sample_of(sample, i);
    double *values = graph_evaluate(graph, symbols);
    is_zero = fabs(values[node]) <= digits * scale_of(values, positions, position_count);
    release(values);
  }
  release(symbols);
  return is_zero;
}

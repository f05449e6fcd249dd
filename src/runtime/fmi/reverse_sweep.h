/* Adjoint derivatives by the generated weighted_gradient(). Other FMUs do not link this. */
#pragma once

#include "instance/instance.h"

/* Derivatives in reverse mode. */
struct ReverseSweep {
  /*
   * True if the sweep gives the derivatives of these unknowns. It does not before the start, where states may follow
   * from parameters. Nor does it for outputs that depend on constraint forces, which may not be unique.
   */
  bool (*is_for)(const struct Instance *instance, const unsigned *unknown, size_t unknown_count);
  /* As adjoint_derivative(), at a cost independent of the number of knowns. */
  enum Status (*derivative)(struct Instance *instance, const unsigned *unknown, size_t unknown_count,
                            const unsigned *known, size_t known_count, const double *seed, double *value);
};

extern const struct ReverseSweep reverse_sweep;

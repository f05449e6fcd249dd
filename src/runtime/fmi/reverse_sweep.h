/* Adjoint derivatives of systems whose generated code has weighted_gradient(). Other FMUs do not hold it. */
#ifndef REVERSE_SWEEP_H
#define REVERSE_SWEEP_H

#include "instance/instance.h"

struct ReverseSweep {
  /*
   * Whether it gives the derivatives of these unknowns. It does not before the start, where states may follow from
   * parameters, and of outputs that depend on forces of constraints, of which there may be several with one motion.
   */
  bool (*is_for)(const struct Instance *instance, const unsigned *unknown, size_t unknown_count);
  /* As adjoint_derivative(), at a cost that does not depend on how many knowns there are. */
  enum Status (*derivative)(struct Instance *instance, const unsigned *unknown, size_t unknown_count,
                            const unsigned *known, size_t known_count, const double *seed, double *value);
};

extern const struct ReverseSweep reverse_sweep;

#endif

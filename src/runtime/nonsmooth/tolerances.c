#include "nonsmooth/tolerances.h"

#include <math.h>

#include "evaluation/evaluate.h"
#include "nonsmooth/continuity.h"
#include "nonsmooth/resolution.h"

struct Tolerances tolerances_of(const struct Resolution *resolution) {
  bool is_exchange = resolution->occasion == IN_EXCHANGE;
  double length = largest_scale(resolution->state, 0);
  double velocity = largest_scale(resolution->state, lagrangian.coordinate_count);
  return (struct Tolerances){.touching = (is_exchange ? 1e-9 : 1e-12) * length,
                             .penetration = 1e-9,
                             .drift = (is_exchange ? 1e-3 : 1e-6) * length,
                             .rounded = 1e-4 * length,
                             .rest = (is_exchange ? 1e-6 : 1e-9) * velocity,
                             .acceleration = 1e-9 * velocity,
                             .uncertain = 1e-6 * velocity,
                             .kink = continuity_allowed_share(resolution) * velocity};
}

double rounded_acceleration_of_gap(const struct Resolution *resolution, size_t contact) {
  double bound = resolution->error_bound[contact_slot(resolution->switches, contact, CONTACT_ACCELERATION)];
  return fmax(1e3 * bound, resolution->tolerances.acceleration);
}

#include "nonsmooth/planes/lines_at_rest.h"

#include <math.h>

#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/frictions/frictions.h"

/*
 * True if a friction along a line rests: it sticks, or acts at rest with its limit. Its force is found with those in
 * planes, unless its limits differ by direction.
 */
static bool line_rests(const struct Resolution *resolution, size_t friction) {
  if (!friction_is_even(resolution, friction)) return false;
  size_t reported = resolution->switches->frictions[friction].reported;
  return mode_of(resolution, reported) == 0.0 || friction_rests(resolution, friction);
}

void lines_choose(const struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->friction_count; i++) {
    if (is_in_plane(resolution->switches, i)) continue;
    bool rests = line_rests(resolution, i);
    *part_of_friction(resolution, i) = rests && friction_is_overcome(resolution, i) ? IS_OVERCOME
                                       : rests                                      ? TAKES_PART
                                                                                    : LEFT_OUT;
  }
}

static void set_line(struct Resolution *resolution, size_t friction, double mode, double share) {
  const struct FrictionMetadata *metadata = &resolution->switches->frictions[friction];
  resolution_set_mode(resolution, metadata->mode, mode);
  resolution_set_mode(resolution, metadata->reported, mode);
  resolution_set_mode(resolution, metadata->share, share);
}

void line_carry(struct Resolution *resolution, size_t friction, double share) {
  set_line(resolution, friction, 0.0, share);
}

void line_release(struct Resolution *resolution, size_t friction, double share) {
  set_line(resolution, friction, 1.0, share - 1.0);
}

void line_keep(struct Resolution *resolution, size_t friction) {
  const double *value = &resolution->value[friction_slot(resolution->switches, friction, 0)];
  const struct FrictionMetadata *metadata = &resolution->switches->frictions[friction];
  double share = force_on_line(resolution, friction) / value[FRICTION_FORCE],
         limit = metadata->has_static_limit ? value[FRICTION_STICTION] / value[FRICTION_FORCE] : 1.0;
  set_line(resolution, friction, 1.0, share - limit);
  resolution_set_mode(resolution, metadata->reported, 0.0);
}

void lines_stick(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->friction_count; i++) {
    if (is_in_plane(resolution->switches, i) || *part_of_friction(resolution, i) == LEFT_OUT) continue;
    if (*part_of_friction(resolution, i) == IS_OVERCOME)
      resolution->flips[friction_indicator(resolution->switches, i)]++;
    set_friction(resolution, i, 0.0);
  }
}

/* True if a friction along a line that sticks needs more than its stiction. */
static bool line_exceeds(const struct Resolution *resolution, size_t friction, double rounding) {
  enum Part part = *part_of_friction(resolution, friction);
  if (is_in_plane(resolution->switches, friction) || part == LEFT_OUT || !friction_sticks(resolution, friction))
    return false;
  double stiction = resolution->value[friction_slot(resolution->switches, friction, FRICTION_STICTION)];
  return fabs(force_on_line(resolution, friction)) > stiction + (part == IS_OVERCOME ? -rounding : rounding);
}

bool lines_exceed(const struct Resolution *resolution, double rounding) {
  bool any = false;
  for (size_t i = 0; i < resolution->switches->friction_count; i++) any |= line_exceeds(resolution, i, rounding);
  return any;
}

void lines_take(struct RestForces *forces) {
  for (size_t row = forces->lines; row < forces->n; row++) {
    double against = forces->force[row] != 0.0 ? -forces->force[row] : forces->behind[row];
    double mode = !rest_slips(forces, row) ? 0.0 : against < 0.0 ? -1.0 : 1.0;
    friction_switch(forces->resolution, forces->impulses.member[row], mode);
  }
}

bool lines_let_overcome_slip(struct RestForces *forces) {
  struct Resolution *resolution = forces->resolution;
  double rounding = share_at_limit * largest_stiction(resolution);
  bool any = false;
  for (size_t row = forces->lines; row < forces->n; row++) {
    size_t friction = forces->impulses.member[row];
    if (!line_exceeds(resolution, friction, rounding)) continue;
    friction_switch(resolution, friction, force_on_line(resolution, friction) < 0.0 ? -1.0 : 1.0);
    any = true;
  }
  return !any || plane_evaluate(resolution);
}

/* Modes. The constraint of a closed contact or a sticking friction is active; they may carry a force beside it. */
#pragma once

#include "instance/instance.h"

/* Returns the modes of the instance, of lagrangian.switches. */
static inline double *modes_of(const struct Instance *instance) {
  return instance->parameter + lagrangian.parameter_count - lagrangian.switches->mode_count;
}

/* True if the contact is closed. */
static inline bool contact_holds(const struct Instance *instance, size_t contact) {
  return instance->parameter[lagrangian.switches->contacts[contact].mode] > 0.0;
}

/* Returns the force that a contact carries beside its constraint. */
static inline double carried_force(const struct Instance *instance, size_t contact) {
  const struct ContactMetadata *metadata = &lagrangian.switches->contacts[contact];
  return metadata->carried != metadata->mode ? instance->parameter[metadata->carried] : 0.0;
}

/* Returns the share of its sliding force that a friction along a line carries beside its constraint. */
static inline double carried_share(const struct Instance *instance, size_t friction) {
  const struct FrictionMetadata *metadata = &lagrangian.switches->frictions[friction];
  return metadata->share != metadata->mode ? instance->parameter[metadata->share] : 0.0;
}

/* True if the friction sticks. */
static inline bool friction_holds(const struct Instance *instance, size_t friction) {
  return instance->parameter[lagrangian.switches->frictions[friction].mode] == 0.0;
}

/* Predicates: the constraint of a closed contact or a sticking friction is active. */
#pragma once

#include "instance/instance.h"

/* True if the contact is closed. */
static inline bool contact_holds(const struct Instance *instance, size_t contact) {
  return instance->parameter[lagrangian.switches->contacts[contact].mode] > 0.0;
}

/* True if the friction sticks. */
static inline bool friction_holds(const struct Instance *instance, size_t friction) {
  return instance->parameter[lagrangian.switches->frictions[friction].mode] == 0.0;
}

/*
 * <contact between="a" and="b">: what shapes do to each other where they touch. Compliant where a stiffness is given: a
 * force after Hunt and Crossley (ASME J. Appl. Mech. 42, 1975, equation 1 with n = 1) that pushes, and friction that
 * creeps; else rigid, by the contacts of switching_reader.h.
 */
#pragma once

#include "read/shapes/tangents.h"

/* Whether the contact is of shapes, and whether these are compliant, and have friction. */
bool is_of_shapes(xmlNodePtr node);
bool is_compliant(xmlNodePtr node);
bool has_shape_friction(xmlNodePtr node);

/* How many rigid contacts it is; 0 after reporting why there are none. */
size_t count_shape_contacts(struct Reader *reader, xmlNodePtr node);

struct RigidTouch {
  Node gap;
  struct Slip slip; /* where the contact has friction */
};

/* As many of them; NULL after reporting what is wrong. */
const struct RigidTouch *rigid_touches(struct Reader *reader, xmlNodePtr node);

/* The coefficients of the friction of a rigid contact, while it slides and at most while it sticks. */
struct Grip {
  Node friction, stiction;
};
struct Grip read_grip(struct Reader *reader, xmlNodePtr node);

/* Adds the forces of a compliant contact, and the variable NAME.force. */
void read_compliant_contact(struct Reader *reader, xmlNodePtr node);

/*
 * <contact between="a" and="b">: contacts of shapes. With a stiffness they are compliant: a normal force after Hunt and
 * Crossley (ASME J. Appl. Mech. 42, 1975), here linear in the depth, and regularized Coulomb friction. Otherwise they
 * are rigid, see switching_reader.h.
 */
#pragma once

#include "read/shapes/tangents.h"

/* True if the contact is of shapes; if it is compliant; if it has friction. */
bool is_of_shapes(xmlNodePtr node);
bool is_compliant(xmlNodePtr node);
bool has_shape_friction(xmlNodePtr node);

/* Returns the number of rigid contacts; 0 after reporting an error. */
size_t count_shape_contacts(struct Reader *reader, xmlNodePtr node);

/* A rigid contact at one point; gap in m. */
struct RigidContact {
  Node gap;
  struct Slip slip; /* if the contact has friction */
};

/* Returns the gap and slip of each of these contacts; NULL after reporting an error. */
const struct RigidContact *rigid_contacts(struct Reader *reader, xmlNodePtr node);

/* Coefficients of a rigid contact: of sliding friction, and of static friction (stiction). */
struct FrictionCoefficients {
  Node friction, stiction;
};
struct FrictionCoefficients read_grip(struct Reader *reader, xmlNodePtr node);

/* Adds the forces of a compliant contact, and the variable NAME.force. */
void read_compliant_contact(struct Reader *reader, xmlNodePtr node);

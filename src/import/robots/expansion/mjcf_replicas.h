/* Expands the <replicate> elements of MJCF. */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"

/* Euler angles of a file: their sequence, and rad per unit. */
struct EulerAngles {
  const char *sequence;
  double unit;
};

/* Angles in degrees, about the rotated axes x, y, z. */
extern const struct EulerAngles usual_angles;

/* Reads the unit and the sequence of angles from a <compiler>. Missing and wrong ones stay as they are. */
void mjcf_read_angles(xmlNodePtr compiler, struct EulerAngles *angles);

/*
 * Replaces each <replicate> in the tree by copies of its content. Elements of other sections that refer to names in it
 * are copied likewise. Reports wrong ones.
 */
void mjcf_replicate(xmlNodePtr root, struct Diagnostics *diagnostics);

/* Expands the <replicate> elements of MJCF. */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"

/* Euler angles of a file: their sequence, and rad per unit. */
struct EulerAngles {
  const char *sequence;
  double unit;
};

/*
 * Replaces each <replicate> in the tree by copies of its content. Elements of other sections that refer to names in it
 * are copied likewise. Reports wrong ones.
 */
void mjcf_replicate(xmlNodePtr root, const struct EulerAngles *angles, struct Diagnostics *diagnostics);

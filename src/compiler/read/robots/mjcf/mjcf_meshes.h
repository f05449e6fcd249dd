/* Meshes that a file names in its <asset>. */
#pragma once

#include "read/robots/mjcf/mjcf_values.h"

struct MjcfMesh {
  char *path;            /* relative to the robot's file */
  double scale[3];       /* m for each unit of the file */
  char *problem;         /* why it cannot be read; NULL where it can */
  bool is_flat;          /* it has no hull to touch with */
  bool is_weighed;       /* the body below is known: other kinds of inertia than "legacy" and "exact" are not */
  struct RigidBody body; /* filled with 1 kg/m3, in the mesh's own frame */
};

/* The mesh of this name; NULL after reporting that there is none for the element. */
const struct MjcfMesh *mjcf_mesh(struct Mjcf *mjcf, xmlNodePtr node, const char *name);

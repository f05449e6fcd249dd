/* Meshes in the <asset> of a file, and their mass properties. */
#pragma once

#include "robots/mjcf/values/mjcf_values.h"

/* A mesh of the <asset>. */
struct MjcfMesh {
  char *path;            /* relative to the robot's file */
  double scale[3];       /* m per unit of the file */
  char *problem;         /* why it cannot be read; NULL if it can */
  bool is_flat;          /* has no hull for contacts; set only if there is a ground */
  bool is_weighed;       /* `body` is set: the kind of inertia is "legacy" or "exact" */
  struct RigidBody body; /* at 1 kg/m3, in the mesh's own frame */
};

/* Returns the mesh of this name; NULL after reporting that there is none for the element. */
const struct MjcfMesh *mjcf_mesh(struct Mjcf *mjcf, xmlNodePtr node, const char *name);

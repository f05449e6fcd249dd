/* What there is to see of a system in space, from modelDescription.xml: see modelDescription/scene.h. */
#ifndef SCENE_H
#define SCENE_H

#include <stdbool.h>
#include <stddef.h>

#include "fmi2.h"

enum ThingKind { FRAME, BODY, PARTICLE, POINT };
enum { IN_BASE = -1 };

struct Thing {
  enum ThingKind kind;
  int frame; /* its place among the things, or IN_BASE */
  fmi2ValueReference position[3];
  fmi2ValueReference turn[9]; /* of a frame: rows of the matrix from its axes to the base's */
};

struct Scene {
  struct Thing *things; /* none where the system has no frames */
  int count;
  int up;         /* the axis that points upwards */
  double upwards; /* 1, or -1 where it points down */
};

/* False where memory is short. Free with scene_free(). */
bool scene_read(const char *path, struct Scene *scene);
void scene_free(struct Scene *scene);

#endif

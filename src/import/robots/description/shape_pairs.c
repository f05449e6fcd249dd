#include "robots/description/shape_pairs.h"

#include <string.h>

#include "base/memory.h"

static bool is_type(const struct Collision *shape, const char *type) {
  return strcmp(shape->type, type) == 0;
}

/* True if the first shape is a sphere, and the second one may touch it. */
static bool is_sphere_beside(const struct Collision *first, const struct Collision *second) {
  return is_type(first, "sphere") && (is_type(second, "sphere") || is_type(second, "capsule") ||
                                      is_type(second, "box") || is_type(second, "cylinder"));
}

bool shapes_can_touch(const struct Collision *first, const struct Collision *second) {
  return is_sphere_beside(first, second) || is_sphere_beside(second, first) ||
         (is_type(first, "capsule") && is_type(second, "capsule"));
}

void add_shape_pair(struct Robot *robot, const struct ShapePair *pair) {
  APPEND(robot->pairs, robot->pair_count, *pair);
}

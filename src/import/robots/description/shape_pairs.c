#include "robots/description/shape_pairs.h"

#include <string.h>

#include "base/memory.h"
#include "robots/description/robot_symbols.h"
#include "xml/nodes.h"

static bool is_type(const struct Collision *shape, const char *type) {
  return strcmp(shape->type, type) == 0;
}

/* True if the first shape is a sphere, and the second one may touch it. */
static bool is_sphere_beside(const struct Collision *first, const struct Collision *second) {
  return is_type(first, "sphere") && (is_type(second, "sphere") || is_type(second, "capsule") ||
                                      is_type(second, "box") || is_type(second, "cylinder"));
}

/* True if one shape is a plane, and the other one is not. */
static bool has_plane(const struct Collision *first, const struct Collision *second) {
  return is_type(first, "plane") != is_type(second, "plane");
}

bool shapes_can_touch(const struct Collision *first, const struct Collision *second) {
  return has_plane(first, second) || is_sphere_beside(first, second) || is_sphere_beside(second, first) ||
         (is_type(first, "capsule") && is_type(second, "capsule"));
}

/* True if a <contact> with stiffness between these shapes is possible: of two boxes, or of a capsule and a box. */
static bool is_costly(const struct Collision *first, const struct Collision *second) {
  return (is_type(first, "box") && (is_type(second, "box") || is_type(second, "capsule"))) ||
         (is_type(first, "capsule") && is_type(second, "box"));
}

/* Returns the name of a shape of the robot in the system that includes it. */
static char *name_in_system(const struct RobotOptions *options, const char *name) {
  const char *prefix = options->include != NULL ? attribute(options->include, "as") : NULL;
  return prefix != NULL ? format_text("%s.%s", prefix, name) : copy_text(name);
}

bool has_contact_between(const struct RobotOptions *options, const char *first, const char *second) {
  if (options->include == NULL) return false;
  const char *a = name_in_system(options, first), *b = name_in_system(options, second);
  for (xmlNodePtr node = options->include->parent->children; node != NULL; node = node->next)
    if (is_element(node, "contact") && ((attribute_is(node, "between", a) && attribute_is(node, "and", b)) ||
                                        (attribute_is(node, "between", b) && attribute_is(node, "and", a))))
      return true;
  return false;
}

char *collision_name(const struct RobotLink *link, size_t index) {
  return format_text("%s_collision%zu", robot_part_symbol(link->name), index + 1);
}

static char *name_in_pair(const struct ShapePair *pair, int k) {
  return collision_name(pair->links[k], pair->indices[k]);
}

bool touch_in_system(const struct RobotOptions *options, const struct ShapePair *pair) {
  return has_contact_between(options, name_in_pair(pair, 0), name_in_pair(pair, 1));
}

char *how_to_touch(const struct RobotOptions *options, const struct ShapePair *pair) {
  const struct Collision *shapes[2];
  for (int k = 0; k < 2; k++) shapes[k] = &pair->links[k]->collisions[pair->indices[k]];
  for (int k = 0; k < 2; k++)
    if (is_type(shapes[k], "mesh") || is_type(shapes[k], "ellipsoid"))
      return copy_text("a plane, or other types than mesh and ellipsoid");
  if (!is_costly(shapes[0], shapes[1])) return copy_text("a sphere or a plane as one of them");
  return format_text("<contact between=\"%s\" and=\"%s\" stiffness=\"...\"/> in a <system> that includes the robot",
                     name_in_system(options, name_in_pair(pair, 0)), name_in_system(options, name_in_pair(pair, 1)));
}

void add_shape_pair(struct Robot *robot, const struct ShapePair *pair) {
  APPEND(robot->pairs, robot->pair_count, *pair);
}

#include "robots/robot_pairs.h"

#include <math.h>

#include "base/memory.h"
#include "robots/description/shape_pairs.h"
#include "robots/robot_shapes.h"

/* Returns the link that carries the parent of this carrier; NULL for the root. */
static const struct RobotLink *carrier_before(const struct RobotLink *carrier) {
  return carrier->joint != NULL ? carrier->joint->parent->carrier : NULL;
}

/* True if the shapes of two links may meet. Shapes of links that a joint connects often overlap, and touch nothing. */
static bool may_meet(const struct RobotLink *first, const struct RobotLink *second) {
  const struct RobotLink *a = first->carrier, *b = second->carrier;
  return a != b && carrier_before(a) != b && carrier_before(b) != a;
}

void find_pairs(struct Robot *robot, const struct RobotOptions *options, const struct Diagnostics *diagnostics) {
  struct ShapePair other = {.links = {NULL}};
  size_t others = 0;
  for (struct RobotLink *first = options->has_self ? robot->root : NULL; first != NULL; first = first->next)
    for (struct RobotLink *second = first->next; second != NULL; second = second->next)
      for (size_t i = 0; i < first->collision_count && may_meet(first, second); i++)
        for (size_t j = 0; j < second->collision_count; j++) {
          struct ShapePair pair = {{first, second}, {i, j}, NAN, first->collisions[i].line};
          if (shapes_can_touch(&first->collisions[i], &second->collisions[j])) add_shape_pair(robot, &pair);
          else if (others++ == 0) other = pair;
        }
  if (others == 0) return;
  const char *types[2];
  for (int i = 0; i < 2; i++) types[i] = other.links[i]->collisions[other.indices[i]].type;
  report_warning(diagnostics, other.line,
                 "%zu pair%s of shapes do not touch, such as the %s of the link '%s' and the %s of '%s'; expected a "
                 "sphere and another shape, or two capsules",
                 others, others > 1 ? "s" : "", types[0], other.links[0]->name, types[1], other.links[1]->name);
}

/* Returns the coefficient that all pairs have; NAN if they differ. */
static double common_friction(const struct Robot *robot) {
  double common = shape_friction(robot->pairs[0].friction);
  for (size_t i = 1; i < robot->pair_count; i++)
    if (shape_friction(robot->pairs[i].friction) != common) return NAN;
  return common;
}

void write_pairs(struct Writer *writer, const struct Robot *robot) {
  if (robot->pair_count == 0) return;
  double friction = common_friction(robot);
  writer->line = robot->line;
  write_contact_parameters(writer, robot, "self", friction);
  for (size_t i = 0; i < robot->pair_count; i++) {
    const struct ShapePair *pair = &robot->pairs[i];
    char *names[2];
    for (int k = 0; k < 2; k++) names[k] = format_text("%s_collision%zu", pair->links[k]->symbol, pair->indices[k] + 1);
    writer->line = pair->line;
    write_shape_contact(writer, format_text("%s_on_%s", names[0], names[1]), names, "self",
                        isnan(friction) ? pair->friction : NAN);
  }
}

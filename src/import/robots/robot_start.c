#include "robots/robot_start.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "robots/description/robot_inertia.h"
#include "robots/description/robot_file.h"
#include "robots/robot_shapes.h"
#include "robots/robot_tree.h"
#include "xml/nodes.h"

char *robot_own_start(const struct RobotOptions *options, const char *coordinate) {
  xmlNodePtr node = options->include != NULL ? options->include->children : NULL;
  while (node != NULL && !(is_element(node, "coordinate") && attribute_is(node, "name", coordinate))) node = node->next;
  return node != NULL ? attribute(node, "start") : NULL;
}

/* Returns the start position of a joint: that of the <include> if it is a number, or what follows from its leader's. */
static double start_of(const struct RobotJoint *joint, const struct RobotOptions *options) {
  const struct RobotJoint *leader = joint->leader;
  const char *own = robot_own_start(options, leader->symbol);
  double start = leader->start.position[0], given;
  if (own != NULL && parse_numbers(own, 1, &given) == 1) start = given;
  return joint->ratio * start + joint->shift;
}

/* Returns the placements of all links in the frame of the root, by their index. */
static struct Placement *placements_of(const struct Robot *robot, const struct RobotOptions *options) {
  struct Placement *placements = allocate(robot->link_count, sizeof *placements);
  for (const struct RobotLink *link = robot->root; link != NULL; link = link->next) {
    struct Placement *placement = &placements[robot_link_index(robot, link->name)];
    *placement = no_displacement;
    if (link->joint == NULL) continue;
    struct RobotJoint moved = *link->joint;
    if (joint_is_single(&moved)) moved.start.position[0] = start_of(link->joint, options);
    else moved.type = FIXED; /* others start where they are placed */
    struct Placement inner = placement_at_start(&moved);
    *placement = placement_within(&placements[robot_link_index(robot, moved.parent->name)], &inner);
  }
  return placements;
}

/* Returns the height of the lowest point of a shape. link: the placement of its link. */
static double lowest_point(const struct Placement *link, const struct Collision *shape) {
  struct Placement placement = placement_within(link, &shape->placement);
  const double *up = placement.rotation.at[2], lean = fabs(up[2]), radius = shape->radius;
  double depth = radius;
  if (strcmp(shape->type, "capsule") == 0) depth += lean * shape->length / 2;
  if (strcmp(shape->type, "cylinder") == 0) depth = radius * sqrt(fmax(0, 1 - lean * lean)) + lean * shape->length / 2;
  for (int i = 0; i < 3; i++) depth += fabs(up[i]) * shape->size[i] / 2; /* 0 but for boxes */
  for (size_t i = 0; i < shape->corner_count; i++) {
    double height = 0;
    for (int axis = 0; axis < 3; axis++) height += up[axis] * shape->corners[i][axis];
    if (i == 0 || -height > depth) depth = -height;
  }
  return placement.translation[2] - depth;
}

/* The lowest point below the plane z = 0 of the links that touch it, with a floating base at 0; link: NULL for none. */
struct LowestPoint {
  const struct RobotLink *link;
  double height;
};

static struct LowestPoint lowest_of(const struct Robot *robot, const struct RobotOptions *options) {
  const struct Placement *placements = placements_of(robot, options);
  struct LowestPoint lowest = {NULL, 0};
  for (const struct RobotLink *link = robot->root; link != NULL; link = link->next)
    for (size_t i = 0; i < link->collision_count; i++) {
      const struct Collision *shape = &link->collisions[i];
      double height = lowest_point(&placements[robot_link_index(robot, link->name)], shape);
      bool touches = carrier_moves(link, options->floats) && meets_ground(options, link, shape);
      if (touches && height < lowest.height) lowest = (struct LowestPoint){link, height};
    }
  return lowest;
}

/* Warns of a link that is visibly below the ground at the start. */
static void warn_of_depth(const struct LowestPoint *lowest, double depth, const char *remedy,
                          const struct Diagnostics *diagnostics) {
  const double visible = 0.01; /* m */
  if (depth > visible)
    report_warning(diagnostics, lowest->link->line,
                   "the link '%s' is %.2g m below the ground at the start; expected %s", lowest->link->name, depth,
                   remedy);
}

double robot_start_height(const struct Robot *robot, const struct RobotOptions *options,
                          const struct Diagnostics *diagnostics) {
  const struct LowestPoint lowest = lowest_of(robot, options);
  double start = ceil(-1e4 * lowest.height) / 1e4, given;
  char *own = robot_own_start(options, "base_z");
  if (lowest.link == NULL) return 0;
  if (!options->floats)
    warn_of_depth(&lowest, -lowest.height, "other start values, or links without it in ground=\"...\"", diagnostics);
  else if (own != NULL && parse_numbers(own, 1, &given) == 1)
    warn_of_depth(&lowest, start - given, format_text("start=\"%g\" of base_z, or above", start), diagnostics);
  else if (own == NULL)
    report_note(diagnostics, robot->line,
                "the base starts at base_z = %g, where the link '%s' stands on the ground; another height is "
                "<coordinate name=\"base_z\" start=\"...\"/> in an <include>, or base_z=... on the command line",
                start, lowest.link->name);
  return options->floats ? start : 0;
}

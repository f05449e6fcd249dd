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
  return options->own_start != NULL ? options->own_start(options->context, coordinate) : NULL;
}

/* The starts that the <include> gives. uncounted: the coordinate of one that is no expression of numbers; NULL for none. */
struct Starts {
  const struct RobotOptions *options;
  const char *uncounted;
};

/* Sets the value to the start of a coordinate if the <include> gives one. */
static void take_start(struct Starts *starts, const char *coordinate, double *value) {
  char *own = robot_own_start(starts->options, coordinate);
  if (own != NULL && !starts->options->value_of(own, value)) starts->uncounted = copy_text(coordinate);
}

/* Returns the joint at its start, for placement_at_start(). */
static struct RobotJoint joint_at_start(const struct RobotJoint *joint, struct Starts *starts) {
  struct RobotJoint moved = *joint;
  double *start = moved.start.position;
  if (joint_is_single(joint)) {
    double leading = joint->leader->start.position[0];
    take_start(starts, joint->leader->symbol, &leading);
    start[0] = joint->ratio * leading + joint->shift;
  } else if ((joint->type == BALL || joint->type == FLOATING) && is_quaternion(&start[3])) moved.type = FLOATING;
  else if (joint->type != PRESCRIBED) moved.type = FIXED;
  return moved;
}

/* Returns the placement of a floating base at the height 0. */
static struct Placement base_placement(struct Starts *starts) {
  struct Placement placement = no_displacement;
  double quaternion[4] = {1, 0, 0, 0};
  static const char *const names[] = {"base_qw", "base_qx", "base_qy", "base_qz"};
  for (int i = 0; i < 4; i++) take_start(starts, names[i], &quaternion[i]);
  if (is_quaternion(quaternion)) placement.rotation = rotation_of_quaternion(quaternion);
  return placement;
}

/* Returns the placements of all links in the frame of the ground, by their index. */
static struct Placement *placements_of(const struct Robot *robot, struct Starts *starts) {
  struct Placement *placements = allocate(robot->link_count, sizeof *placements);
  const struct Placement *ground = robot->ground != NULL ? &robot->ground->placement : &no_displacement;
  const struct Placement base = starts->options->floats ? base_placement(starts) : no_displacement;
  for (const struct RobotLink *link = robot->root; link != NULL; link = link->next) {
    struct Placement *placement = &placements[robot_link_index(robot, link->name)];
    *placement = placement_between(ground, &base);
    if (link->joint == NULL) continue;
    struct RobotJoint joint = joint_at_start(link->joint, starts);
    struct Placement inner = placement_at_start(&joint);
    *placement = placement_within(&placements[robot_link_index(robot, joint.parent->name)], &inner);
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
  double box = 0, squares = 0; /* 0 for shapes without sides */
  for (int i = 0; i < 3; i++) {
    double side = up[i] * shape->size[i] / 2;
    box += fabs(side);
    squares += side * side;
  }
  depth += strcmp(shape->type, "ellipsoid") == 0 ? sqrt(squares) : box;
  for (size_t i = 0; i < shape->corner_count; i++) {
    double height = 0;
    for (int axis = 0; axis < 3; axis++) height += up[axis] * shape->corners[i][axis];
    if (i == 0 || -height > depth) depth = -height;
  }
  return placement.translation[2] - depth;
}

/* The lowest point above the ground of the links that touch it; link: NULL for none. */
struct LowestPoint {
  const struct RobotLink *link;
  double height;
};

static struct LowestPoint lowest_of(const struct Robot *robot, struct Starts *starts) {
  const struct Placement *placements = placements_of(robot, starts);
  struct LowestPoint lowest = {NULL, INFINITY};
  for (const struct RobotLink *link = robot->root; link != NULL; link = link->next) {
    const struct Placement *placement = &placements[robot_link_index(robot, link->name)];
    if (!carrier_moves(link, starts->options->floats)) continue;
    for (size_t i = 0; i < link->collision_count; i++) {
      const struct Collision *shape = &link->collisions[i];
      bool is_known = strcmp(shape->type, "plane") != 0 && (shape->file == NULL || shape->corner_count > 0);
      if (!is_known || !meets_ground(starts->options, link, shape)) continue;
      double height = lowest_point(placement, shape);
      if (height < lowest.height) lowest = (struct LowestPoint){link, height};
    }
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

/* Notes the height of a floating base. */
static void note_height(const struct Robot *robot, const struct LowestPoint *lowest, const struct Starts *starts,
                        double height, const struct Diagnostics *diagnostics) {
  const char *uncounted = starts->uncounted;
  report_note(diagnostics, robot->line,
              "the base starts at base_z = %g, where the link '%s' stands on the ground%s; for other starts of joints "
              "give <coordinate name=\"base_z\" start=\"...\"/> in an <include>, or base_z=... on the command line",
              height, lowest->link->name,
              uncounted != NULL ? format_text(" (the start of '%s' is no number, and not counted)", uncounted) : "");
}

/* True if a link that moves has shapes. */
static bool has_shapes(const struct Robot *robot, const struct RobotOptions *options) {
  bool has = false;
  for (const struct RobotLink *link = robot->root; link != NULL; link = link->next)
    has |= carrier_moves(link, options->floats) && link->collision_count > 0;
  return has;
}

double robot_start_height(const struct Robot *robot, const struct RobotOptions *options,
                          const struct Diagnostics *diagnostics) {
  struct Starts starts = {.options = options};
  const struct LowestPoint lowest = lowest_of(robot, &starts);
  char *own = robot_own_start(options, "base_z");
  double given;
  if (lowest.link == NULL && !has_shapes(robot, options))
    report_warning(diagnostics, robot->line,
                   "nothing of the robot touches the ground; expected a <collision> or <geom> of a link that moves");
  if (lowest.link == NULL) return 0;
  double height = options->floats ? ceil(-1e4 * lowest.height) / 1e4 : 0;
  if (!options->floats)
    warn_of_depth(&lowest, -lowest.height, "other start values, or links without it in ground=\"...\"", diagnostics);
  else if (own == NULL) note_height(robot, &lowest, &starts, height, diagnostics);
  else if (options->value_of(own, &given))
    warn_of_depth(&lowest, height - given, format_text("start=\"%g\" of base_z, or above", height), diagnostics);
  return height;
}

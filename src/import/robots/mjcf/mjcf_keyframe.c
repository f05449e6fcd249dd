#include "robots/mjcf/mjcf_sections.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "names/similar.h"
#include "xml/nodes.h"

/* Numbers per joint in qpos, and in qvel. */
static const size_t positions[JOINT_TYPES] = {[REVOLUTE] = 1, [PRISMATIC] = 1, [BALL] = 4, [FLOATING] = 7};
static const size_t velocities[JOINT_TYPES] = {[REVOLUTE] = 1, [PRISMATIC] = 1, [BALL] = 3, [FLOATING] = 6};

/* Returns the <key> of the options; NULL after reporting that there is none. */
static xmlNodePtr find_key(struct Mjcf *mjcf) {
  const char *name = mjcf->file.options->keyframe;
  struct SimilarName similar = {.wanted = name};
  const char **names = NULL;
  size_t count = 0;
  for (xmlNodePtr section = mjcf->root->children; section != NULL; section = section->next)
    for (xmlNodePtr key = is_element(section, "keyframe") ? section->children : NULL; key != NULL; key = key->next) {
      if (!is_element(key, "key")) continue;
      if (attribute_is(key, "name", name)) return key;
      if (!has_attribute(key, "name")) continue;
      const char *known = attribute(key, "name");
      similar_consider(&similar, known);
      APPEND(names, count, known);
    }
  const char *expected =
      count > 0 ? format_text("expected one of %s", list_of_names(names, count)) : "the file has none";
  report_error(mjcf->file.diagnostics, mjcf->file.robot->line, "there is no <key> '%s'; %s", name,
               suggestion(similar.best, expected));
  return NULL;
}

/* Reads a list of `expected` numbers. Returns NULL if it is missing, or after reporting another count. */
static double *read_list(struct Mjcf *mjcf, xmlNodePtr key, const char *name, size_t expected) {
  char *text = attribute(key, name);
  if (text == NULL) return NULL;
  double *values = allocate(expected + 1, sizeof *values);
  if (parse_numbers(text, expected, values) == expected) return values;
  mjcf_error(mjcf, key, "%s=\"%.60s\" of <key> is not valid; expected %zu number%s", name, text, expected,
             expected == 1 ? "" : "s");
  return NULL;
}

static size_t sum_of(const struct Robot *robot, const size_t *counts) {
  size_t sum = 0;
  for (size_t i = 0; i < robot->joint_count; i++) sum += counts[robot->joints[i]->type];
  return sum;
}

/* Sets the rate of a quaternion, q (0, omega) / 2, from the angular velocity along the rotated axes. */
static void set_rate(const double q[4], const double omega[3], double rate[4]) {
  rate[0] = -(q[1] * omega[0] + q[2] * omega[1] + q[3] * omega[2]) / 2;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    rate[i + 1] = (q[0] * omega[i] + q[j + 1] * omega[k] - q[k + 1] * omega[j]) / 2;
  }
}

/* Scales a quaternion to the length 1, as MuJoCo does; one of length 0 does not rotate. */
static void normalize(double q[4]) {
  double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int i = 0; i < 4; i++) q[i] = length > 0 ? q[i] / length : i == 0;
}

static void start_joint(struct RobotJoint *joint, const double *position, const double *velocity) {
  struct JointStart *start = &joint->start;
  size_t first = joint->type == BALL ? 3 : 0;
  size_t count = positions[joint->type], moved = joint->type == FLOATING ? 3 : first == 0 ? count : 0;
  if (position != NULL) memcpy(&start->position[first], position, count * sizeof *position);
  if (position != NULL && count >= 4) normalize(&start->position[3]);
  if (velocity == NULL) return;
  memcpy(start->velocity, velocity, moved * sizeof *velocity);
  if (count < 4) return;
  static const double unrotated[4] = {1};
  const double *q = &start->position[3];
  bool is_rotated = q[0] != 0 || q[1] != 0 || q[2] != 0 || q[3] != 0;
  set_rate(is_rotated ? q : unrotated, velocity + moved, &start->velocity[3]);
}

void mjcf_read_keyframe(struct Mjcf *mjcf) {
  struct Robot *robot = mjcf->file.robot;
  xmlNodePtr key = find_key(mjcf);
  if (key == NULL) return;
  const double *position = read_list(mjcf, key, "qpos", sum_of(robot, positions));
  const double *velocity = read_list(mjcf, key, "qvel", sum_of(robot, velocities));
  const double *control = read_list(mjcf, key, "ctrl", robot->actuator_count);
  for (size_t i = 0; i < robot->joint_count; i++) {
    struct RobotJoint *joint = robot->joints[i];
    start_joint(joint, position, velocity);
    if (position != NULL) position += positions[joint->type];
    if (velocity != NULL) velocity += velocities[joint->type];
  }
  size_t states = 0;
  for (size_t i = 0; i < robot->actuator_count; i++) states += robot->actuators[i].dynamics != WITHOUT_STATE;
  const double *activation = read_list(mjcf, key, "act", states);
  for (size_t i = 0; i < robot->actuator_count && activation != NULL; i++)
    if (robot->actuators[i].dynamics != WITHOUT_STATE) robot->actuators[i].start_activation = *activation++;
  for (size_t i = 0; i < robot->actuator_count && control != NULL; i++) robot->actuators[i].start = control[i];
}

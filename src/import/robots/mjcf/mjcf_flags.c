/*
 * Features that a <flag> disables. Contacts are left out at once. The others are removed from the robot when all
 * sections have been read, since settings such as inheritrange refer to them.
 */
#include <math.h>
#include <string.h>

#include "robots/mjcf/mjcf_sections.h"
#include "xml/nodes.h"

static void disable_contacts(struct Mjcf *mjcf) {
  mjcf->has_no_contacts = true;
}

static void disable_gravity(struct Mjcf *mjcf) {
  memset(mjcf->file.robot->gravity, 0, sizeof mjcf->file.robot->gravity);
}

static void disable_limits(struct Mjcf *mjcf) {
  const struct Robot *robot = mjcf->file.robot;
  for (size_t i = 0; i < robot->joint_count; i++) robot->joints[i]->lower = robot->joints[i]->upper = NAN;
  for (size_t i = 0; i < robot->tendon_count; i++) robot->tendons[i].lower = robot->tendons[i].upper = NAN;
}

static void disable_frictions(struct Mjcf *mjcf) {
  const struct Robot *robot = mjcf->file.robot;
  for (size_t i = 0; i < robot->joint_count; i++) robot->joints[i]->friction = 0;
  for (size_t i = 0; i < robot->tendon_count; i++) robot->tendons[i].friction = 0;
}

static void disable_equalities(struct Mjcf *mjcf) {
  struct Robot *robot = mjcf->file.robot;
  robot->loop_count = robot->coupling_count = 0;
  for (size_t i = 0; i < robot->joint_count; i++) robot->joints[i]->mimicked_name = NULL;
}

static void disable_constraints(struct Mjcf *mjcf) {
  disable_limits(mjcf);
  disable_frictions(mjcf);
  disable_equalities(mjcf);
}

static void disable_springs(struct Mjcf *mjcf) {
  const struct Robot *robot = mjcf->file.robot;
  for (size_t i = 0; i < robot->joint_count; i++) robot->joints[i]->stiffness = 0;
  for (size_t i = 0; i < robot->tendon_count; i++) robot->tendons[i].stiffness = 0;
}

static void disable_dampers(struct Mjcf *mjcf) {
  const struct Robot *robot = mjcf->file.robot;
  for (size_t i = 0; i < robot->joint_count; i++) robot->joints[i]->damping = 0;
  for (size_t i = 0; i < robot->tendon_count; i++) robot->tendons[i].damping = 0;
}

/* Removes all passive forces, as older versions of MuJoCo did. */
static void disable_passive_forces(struct Mjcf *mjcf) {
  struct Robot *robot = mjcf->file.robot;
  disable_springs(mjcf);
  disable_dampers(mjcf);
  robot->fluid = (struct Fluid){0};
  for (size_t i = 0; i < robot->link_count; i++) robot->links[i]->weightless = 0;
}

void mjcf_switch_off(struct Actuator *actuator) {
  memset(actuator->gain, 0, sizeof actuator->gain);
  memset(actuator->bias, 0, sizeof actuator->bias);
  actuator->force[0] = actuator->force[1] = NAN;
}

static void disable_actuation(struct Mjcf *mjcf) {
  const struct Robot *robot = mjcf->file.robot;
  for (size_t i = 0; i < robot->actuator_count; i++) mjcf_switch_off(&robot->actuators[i]);
}

static void disable_limits_of_controls(struct Mjcf *mjcf) {
  const struct Robot *robot = mjcf->file.robot;
  for (size_t i = 0; i < robot->actuator_count; i++)
    robot->actuators[i].control[0] = robot->actuators[i].control[1] = NAN;
}

/* The features, and when they are removed. */
static const struct {
  const char *name;
  void (*at_once)(struct Mjcf *mjcf), (*at_end)(struct Mjcf *mjcf);
} features[] = {
    {"contact", disable_contacts, NULL},
    {"gravity", NULL, disable_gravity},
    {"constraint", disable_contacts, disable_constraints},
    {"limit", NULL, disable_limits},
    {"frictionloss", NULL, disable_frictions},
    {"equality", NULL, disable_equalities},
    {"spring", NULL, disable_springs},
    {"damper", NULL, disable_dampers},
    {"passive", NULL, disable_passive_forces},
    {"actuation", NULL, disable_actuation},
    {"clampctrl", NULL, disable_limits_of_controls},
};

enum { FEATURES = sizeof features / sizeof *features };
_Static_assert(FEATURES <= sizeof(unsigned) * 8, "a bit for each feature");

void mjcf_read_flag(struct Mjcf *mjcf, xmlNodePtr flag) {
  mjcf->touches_parents |= attribute_is(flag, "filterparent", "disable");
  for (size_t i = 0; i < FEATURES; i++) {
    if (!attribute_is(flag, features[i].name, "disable")) continue;
    mjcf->disabled |= 1u << i;
    if (features[i].at_once != NULL) features[i].at_once(mjcf);
  }
}

void mjcf_remove_disabled(struct Mjcf *mjcf) {
  for (size_t i = 0; i < FEATURES; i++)
    if ((mjcf->disabled >> i & 1u) != 0 && features[i].at_end != NULL) features[i].at_end(mjcf);
}

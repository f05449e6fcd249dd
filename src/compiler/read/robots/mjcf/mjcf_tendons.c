#include "read/robots/mjcf/mjcf_tendons.h"

#include <string.h>

#include "base/memory.h"
#include "read/names/similar.h"
#include "read/robots/mjcf/mjcf_tree.h"
#include "read/xml/nodes.h"

static void read_pulls(struct Mjcf *mjcf, xmlNodePtr node, struct Tendon *tendon) {
  struct Transmission *transmission = &tendon->transmission;
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) {
    if (!is_element(child, "joint")) continue;
    struct Pull pull = {.joint_name = required_attribute(&mjcf->file, child, "joint"), .coefficient = 1};
    required_attribute(&mjcf->file, child, "coef");
    read_numbers(&mjcf->file, child, "coef", 1, &pull.coefficient);
    transmission->pulls = make_room(transmission->pulls, transmission->count, sizeof *transmission->pulls);
    transmission->pulls[transmission->count++] = pull;
  }
  if (transmission->count == 0)
    report_error(mjcf->file.diagnostics, tendon->line,
                 "the tendon '%s' has no joint; expected <joint joint=\"...\" coef=\"...\"/> in it", tendon->name);
}

/* Without lengths of its own it is relaxed where the springs of its joints are. */
static void read_relaxed(struct Mjcf *mjcf, xmlNodePtr node, struct Tendon *tendon) {
  double lengths[2] = {-1, -1};
  if (mjcf_numbers(mjcf, node, "springlength", 1, 2, lengths) == 1) lengths[1] = lengths[0];
  if (lengths[0] == -1 && lengths[1] == -1) {
    lengths[0] = 0;
    for (size_t i = 0; i < tendon->transmission.count; i++) {
      const struct Pull *pull = &tendon->transmission.pulls[i];
      const struct Joint *joint = mjcf_joint(mjcf, pull->joint_name);
      if (joint != NULL) lengths[0] += pull->coefficient * joint->rest;
    }
    lengths[1] = lengths[0];
  }
  if (lengths[1] < lengths[0])
    report_error(mjcf->file.diagnostics, tendon->line,
                 "springlength of <fixed> is from %g to %g; expected the lower one first", lengths[0], lengths[1]);
  memcpy(tendon->relaxed, lengths, sizeof lengths);
}

void mjcf_read_tendon(struct Mjcf *mjcf, xmlNodePtr node) {
  static const char *const refused[] = {"frictionloss", "actuatorfrcrange"};
  struct Robot *robot = mjcf->file.robot;
  if (!is_element(node, "fixed")) {
    mjcf_report_unknown(
        mjcf, node,
        "a <fixed> one, or a <spring> or a <constraint> of a distance in a <system> that includes the robot");
    return;
  }
  struct Tendon tendon = {.name = attribute(node, "name"), .line = xmlGetLineNo(node)};
  double limits[2];
  if (tendon.name == NULL) tendon.name = format_text("tendon%zu", robot->tendon_count + 1);
  read_pulls(mjcf, node, &tendon);
  read_relaxed(mjcf, node, &tendon);
  tendon.stiffness = mjcf_number_not_negative(mjcf, node, "stiffness", 0);
  tendon.damping = mjcf_number_not_negative(mjcf, node, "damping", 0);
  tendon.armature = mjcf_number_not_negative(mjcf, node, "armature", 0);
  mjcf_limits(mjcf, node, "range", "limited", limits);
  tendon.lower = limits[0];
  tendon.upper = limits[1];
  for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) mjcf_refuse(mjcf, node, refused[i]);
  robot->tendons = make_room(robot->tendons, robot->tendon_count, sizeof *robot->tendons);
  robot->tendons[robot->tendon_count++] = tendon;
}

const struct Tendon *mjcf_tendon(struct Mjcf *mjcf, xmlNodePtr node, const char *name) {
  const struct Robot *robot = mjcf->file.robot;
  struct Similar similar = {.wanted = name};
  for (size_t i = 0; i < robot->tendon_count; i++) {
    if (strcmp(robot->tendons[i].name, name) == 0) return &robot->tendons[i];
    similar_consider(&similar, robot->tendons[i].name);
  }
  report_error(mjcf->file.diagnostics, xmlGetLineNo(node), "there is no tendon '%s' for a <%s>; %s", name,
               (const char *)node->name,
               similar.best != NULL ? format_text("did you mean '%s'?", similar.best) : "expected one of the file");
  return NULL;
}

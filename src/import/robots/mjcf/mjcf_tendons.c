#include "robots/mjcf/mjcf_sections.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "names/similar.h"
#include "robots/mjcf/values/mjcf_tree.h"
#include "xml/nodes.h"

static void read_fixed_tendon(struct Mjcf *mjcf, xmlNodePtr node, struct Tendon *tendon) {
  struct Transmission *transmission = &tendon->transmission;
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) {
    if (!is_element(child, "joint")) continue;
    struct TransmissionTerm term = {.joint_name = required_attribute(&mjcf->file, child, "joint"), .coefficient = 1};
    required_attribute(&mjcf->file, child, "coef");
    read_numbers(&mjcf->file, child, "coef", 1, &term.coefficient);
    APPEND(transmission->terms, transmission->count, term);
  }
  if (transmission->count == 0)
    report_error(mjcf->file.diagnostics, tendon->line,
                 "the tendon '%s' has no joint; expected <joint joint=\"...\" coef=\"...\"/> in it", tendon->name);
}

/* Reports a segment between equal sites, which has no direction. */
static void check_line(struct Mjcf *mjcf, xmlNodePtr node, const struct Tendon *tendon, const char *from,
                       const char *to) {
  if (*to == '\0' || strcmp(from, to) != 0) return;
  mjcf_error(mjcf, node, "the tendon '%s' goes from the site '%s' to itself; expected another site, or this one once",
             tendon->name, to);
}

/* Reads the sites of a spatial tendon. */
static void read_path(struct Mjcf *mjcf, xmlNodePtr node, struct Tendon *tendon) {
  struct Transmission *transmission = &tendon->transmission;
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) {
    if (child->type != XML_ELEMENT_NODE) continue;
    if (!is_element(child, "site")) {
      mjcf_report_unknown(mjcf, child, "straight lines from <site> to <site>, with one where the tendon turns");
      continue;
    }
    transmission->site_names =
        make_room(transmission->site_names, transmission->site_count, sizeof *transmission->site_names);
    size_t last = transmission->site_count++;
    transmission->site_names[last] = mjcf_site(mjcf, required_attribute(&mjcf->file, child, "site"));
    if (last > 0) check_line(mjcf, child, tendon, transmission->site_names[last - 1], transmission->site_names[last]);
  }
  transmission->sites = allocate(transmission->site_count, sizeof(struct RobotLink *));
  if (transmission->site_count < 2)
    report_error(mjcf->file.diagnostics, tendon->line,
                 "the tendon '%s' has fewer than two sites; expected <site site=\"...\"/> for each of its ends",
                 tendon->name);
}

/*
 * Returns the length of a fixed tendon with all joints as placed, or with their springs relaxed. Missing joints count
 * 0; they are reported elsewhere.
 */
static double sum_of_terms(const struct Mjcf *mjcf, const struct Transmission *transmission, bool is_relaxed) {
  double length = 0;
  for (size_t i = 0; i < transmission->count; i++) {
    const struct RobotJoint *joint = mjcf_joint(mjcf, transmission->terms[i].joint_name);
    if (joint == NULL) continue;
    length += transmission->terms[i].coefficient * (is_relaxed ? joint->rest : joint->start.position[0]);
  }
  return length;
}

/* Returns the length with all joints as placed, without segments at missing sites, reported elsewhere. */
static double start_length(const struct Mjcf *mjcf, const struct Transmission *transmission) {
  double length = sum_of_terms(mjcf, transmission, false);
  for (size_t i = 1; i < transmission->site_count; i++) {
    const struct Placement *from = mjcf_placement_of(mjcf, transmission->site_names[i - 1]),
                           *to = mjcf_placement_of(mjcf, transmission->site_names[i]);
    if (from == NULL || to == NULL) continue;
    const double *a = from->translation, *b = to->translation;
    length += sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
  }
  return length;
}

/*
 * Returns the length at which the tendon's spring is relaxed: with the springs of all joints relaxed. For spatial
 * tendons these must be relaxed as placed; others are reported.
 */
static double relaxed_length(struct Mjcf *mjcf, xmlNodePtr node, const struct Tendon *tendon) {
  const struct Robot *robot = mjcf->file.robot;
  if (tendon->transmission.site_count == 0) return sum_of_terms(mjcf, &tendon->transmission, true);
  bool is_needed = mjcf_number(mjcf, node, "stiffness", 0) != 0;
  for (size_t i = 0; i < robot->joint_count && is_needed; i++) {
    const struct RobotJoint *joint = robot->joints[i];
    bool is_single = joint->type == REVOLUTE || joint->type == PRISMATIC;
    if (!is_single || joint->rest == joint->start.position[0]) continue;
    report_error(mjcf->file.diagnostics, tendon->line,
                 "the spring of the tendon '%s' is relaxed where all joints are at their springref, which of '%s' is "
                 "not its ref; expected springlength=\"...\"",
                 tendon->name, joint->name);
    is_needed = false;
  }
  return tendon->start;
}

static void read_relaxed(struct Mjcf *mjcf, xmlNodePtr node, struct Tendon *tendon) {
  double lengths[2] = {-1, -1};
  if (mjcf_numbers(mjcf, node, "springlength", 1, 2, lengths) == 1) lengths[1] = lengths[0];
  if (lengths[0] == -1 && lengths[1] == -1) lengths[0] = lengths[1] = relaxed_length(mjcf, node, tendon);
  if (lengths[1] < lengths[0])
    report_error(mjcf->file.diagnostics, tendon->line,
                 "springlength of <%s> is from %g to %g; expected the lower one first", (const char *)node->name,
                 lengths[0], lengths[1]);
  memcpy(tendon->relaxed, lengths, sizeof lengths);
}

void mjcf_read_tendon(struct Mjcf *mjcf, xmlNodePtr node) {
  struct Robot *robot = mjcf->file.robot;
  bool is_spatial = is_element(node, "spatial");
  if (!is_spatial && !is_element(node, "fixed")) {
    mjcf_report_unknown(mjcf, node, "a <fixed> or <spatial> one");
    return;
  }
  struct Tendon tendon = {.name = attribute(node, "name"), .line = line_of(node)};
  double limits[2];
  if (tendon.name == NULL) tendon.name = format_text("tendon%zu", robot->tendon_count + 1);
  if (is_spatial) read_path(mjcf, node, &tendon);
  else read_fixed_tendon(mjcf, node, &tendon);
  tendon.start = start_length(mjcf, &tendon.transmission);
  read_relaxed(mjcf, node, &tendon);
  tendon.stiffness = mjcf_number_not_negative(mjcf, node, "stiffness", 0);
  tendon.damping = mjcf_number_not_negative(mjcf, node, "damping", 0);
  tendon.friction = mjcf_number_not_negative(mjcf, node, "frictionloss", 0);
  tendon.armature = mjcf_number_not_negative(mjcf, node, "armature", 0);
  mjcf_limits(mjcf, node, "range", "limited", limits);
  tendon.lower = limits[0];
  tendon.upper = limits[1];
  const char *range = mjcf_text(mjcf, node, "actuatorfrcrange");
  if (range != NULL && !requests_nothing(range))
    mjcf_error(mjcf, node, "actuatorfrcrange of <%s> is not read; expected forcerange of each actuator at it",
               (const char *)node->name);
  APPEND(robot->tendons, robot->tendon_count, tendon);
}

const struct Tendon *mjcf_tendon(struct Mjcf *mjcf, xmlNodePtr node, const char *name) {
  const struct Robot *robot = mjcf->file.robot;
  struct SimilarName similar = {.wanted = name};
  for (size_t i = 0; i < robot->tendon_count; i++) {
    if (strcmp(robot->tendons[i].name, name) == 0) return &robot->tendons[i];
    similar_consider(&similar, robot->tendons[i].name);
  }
  mjcf_error(mjcf, node, "there is no tendon '%s' for a <%s>; %s", name, (const char *)node->name,
             suggestion(similar.best, "expected an existing name"));
  return NULL;
}

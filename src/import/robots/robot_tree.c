#include "robots/robot_tree.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "names/names.h"
#include "names/similar.h"

/* Links or joints by their names in the file, and by their symbols. */
struct Register {
  const char *kind;
  struct Names *names, *symbols; /* name -> struct RegisterEntry */
};

struct RegisterEntry {
  const char *name;
  long line;
  size_t index;
};

/* State while the links are connected. */
struct Connection {
  struct Robot *robot;
  struct Register links, joints;
  struct Diagnostics *diagnostics;
};

bool joint_moves(const struct RobotJoint *joint) {
  return joint != NULL && joint->type != FIXED;
}

bool joint_is_single(const struct RobotJoint *joint) {
  return joint->type == REVOLUTE || joint->type == CONTINUOUS || joint->type == PRISMATIC;
}

double robot_gravity(const struct Robot *robot) {
  const double *along = robot->gravity;
  return sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
}

bool carrier_moves(const struct RobotLink *link, bool floats) {
  return floats || link->carrier->joint != NULL;
}

static struct Register register_create(const char *kind) {
  return (struct Register){.kind = kind, .names = names_create(), .symbols = names_create()};
}

/* Returns the entry with this text if there is one. Otherwise adds the new entry and returns NULL. */
static const struct RegisterEntry *enter(struct Names *names, const char *text, struct RegisterEntry entry) {
  const struct RegisterEntry *before = names_find(names, text);
  if (before != NULL) return before;
  struct RegisterEntry *own = allocate(1, sizeof *own);
  *own = entry;
  names_set(names, text, own);
  return NULL;
}

/* Returns the symbol of a name. Reports duplicate names and symbols. */
static char *enter_name(struct Connection *connection, struct Register *all, struct RegisterEntry entry) {
  char *symbol = robot_part_symbol(entry.name);
  const struct RegisterEntry *same = enter(all->names, entry.name, entry);
  const struct RegisterEntry *alike = same == NULL ? enter(all->symbols, symbol, entry) : NULL;
  if (same != NULL)
    report_error(connection->diagnostics, entry.line,
                 "the %s '%s' is already defined on line %ld; expected another name", all->kind, entry.name,
                 file_line(connection->diagnostics, same->line).line);
  else if (alike != NULL)
    report_error(
        connection->diagnostics, entry.line,
        "the %s '%s' and '%s' on line %ld both become '%s'; expected names that differ in letters, digits or _",
        all->kind, entry.name, alike->name, file_line(connection->diagnostics, alike->line).line, symbol);
  return symbol;
}

static void enter_names(struct Connection *connection) {
  struct Robot *robot = connection->robot;
  for (size_t i = 0; i < robot->link_count; i++) {
    struct RobotLink *link = robot->links[i];
    link->symbol = enter_name(connection, &connection->links, (struct RegisterEntry){link->name, link->line, i});
  }
  for (size_t i = 0; i < robot->joint_count; i++) {
    struct RobotJoint *joint = robot->joints[i];
    joint->symbol = enter_name(connection, &connection->joints, (struct RegisterEntry){joint->name, joint->line, i});
  }
}

static void report_missing(const char *kind, const char *name, const char *what, long line,
                           const struct SimilarName *similar, struct Diagnostics *diagnostics) {
  report_error(diagnostics, line, "there is no %s '%s' for %s; %s", kind, name, what,
               suggestion(similar->best, "expected an existing name"));
}

/* Returns the entry of this name; NULL after reporting that there is none. */
static const struct RegisterEntry *find(const struct Connection *connection, const struct Register *all,
                                        const char *name, const char *what, long line) {
  const struct RegisterEntry *entry = names_find(all->names, name);
  if (entry != NULL) return entry;
  struct SimilarName similar = {.wanted = name};
  similar_consider_all(&similar, all->names);
  report_missing(all->kind, name, what, line, &similar, connection->diagnostics);
  return NULL;
}

static struct RobotLink *find_link(const struct Connection *connection, const char *name, const char *role,
                                   const struct RobotJoint *joint) {
  char *what = format_text("the %s of the joint '%s'", role, joint->name);
  const struct RegisterEntry *entry = find(connection, &connection->links, name, what, joint->line);
  return entry != NULL ? connection->robot->links[entry->index] : NULL;
}

/*
 * Connects each joint to its parent and child. Joints are visited from the last one, as children are added in front of
 * their siblings.
 */
static void connect_links(struct Connection *connection) {
  struct Robot *robot = connection->robot;
  for (size_t i = robot->joint_count; i-- > 0;) {
    struct RobotJoint *joint = robot->joints[i];
    struct RobotLink *parent = joint->parent = find_link(connection, joint->parent_name, "parent", joint);
    struct RobotLink *child = joint->child = find_link(connection, joint->child_name, "child", joint);
    if (parent == NULL || child == NULL) continue;
    if (child->joint != NULL) {
      report_error(
          connection->diagnostics, child->joint->line,
          "the link '%s' is the child of the joint '%s' and of '%s' on line %ld; expected a tree, in which each "
          "link has one parent (a <joint> beside an <include> closes a loop)",
          child->name, child->joint->name, joint->name, file_line(connection->diagnostics, joint->line).line);
      continue;
    }
    child->joint = joint;
    child->next_sibling = parent->first_child;
    parent->first_child = child;
  }
}

/* Finds the only link that is not a child. Reports several. */
static void find_root(struct Connection *connection) {
  struct Robot *robot = connection->robot;
  for (size_t i = 0; i < robot->link_count; i++) {
    struct RobotLink *link = robot->links[i];
    if (link->joint != NULL) continue;
    if (robot->root == NULL) robot->root = link;
    else
      report_error(
          connection->diagnostics, link->line,
          "no joint has the link '%s' as its child, nor '%s' on line %ld; expected one such link, the root of all",
          link->name, robot->root->name, file_line(connection->diagnostics, robot->root->line).line);
  }
  if (robot->link_count == 0)
    report_error(connection->diagnostics, robot->line, "the robot has no <link>; expected one at least");
}

/* Returns the next link in depth-first order. */
static struct RobotLink *following(const struct RobotLink *link) {
  if (link->first_child != NULL) return link->first_child;
  while (link->next_sibling == NULL && link->joint != NULL) link = link->joint->parent;
  return link->next_sibling;
}

/* Orders the links and reports a cycle, whose links cannot be reached from the root. */
static void order_links(struct Connection *connection) {
  struct Robot *robot = connection->robot;
  bool *reached = allocate(robot->link_count, sizeof *reached);
  for (struct RobotLink *link = robot->root; link != NULL; link = link->next) {
    const struct RegisterEntry *entry = names_find(connection->links.names, link->name);
    reached[entry->index] = true;
    link->next = following(link);
  }
  for (size_t i = 0; i < robot->link_count; i++) {
    if (reached[i]) continue;
    report_error(connection->diagnostics, robot->links[i]->joint->line,
                 "the link '%s' or a parent of it is its own ancestor; expected a tree", robot->links[i]->name);
    break;
  }
}

/* Reports placements and inertias that overflowed. */
static void check_numbers(struct Connection *connection, const struct RobotLink *link) {
  if (placement_is_finite(&link->placement) && body_is_finite(&link->carrier->carried)) return;
  report_error(connection->diagnostics, link->line,
               "the position or inertia of the link '%s' as a part of '%s' is not finite; expected smaller numbers in "
               "its <origin> and <inertial> and in those of links fixed to it",
               link->name, link->carrier->name);
}

/* Sets the carrier of each link and merges the bodies of links that are fixed to each other. */
static void join_fixed_links(struct Connection *connection) {
  const struct Robot *robot = connection->robot;
  int errors = connection->diagnostics->errors;
  for (struct RobotLink *link = robot->root; link != NULL && connection->diagnostics->errors == errors;
       link = link->next) {
    link->carrier = link;
    link->placement = no_displacement;
    if (link->joint != NULL && !joint_moves(link->joint)) {
      const struct RobotLink *parent = link->joint->parent;
      link->carrier = parent->carrier;
      link->placement = placement_within(&parent->placement, &link->joint->origin);
    }
    struct RigidBody body = body_seen_from(&link->placement, &link->body);
    link->carrier->carried = body_joined(&link->carrier->carried, &body);
    check_numbers(connection, link);
  }
}

/* Returns the joint that this one mimics; NULL after reporting an error. */
static struct RobotJoint *mimicked_by(struct Connection *connection, const struct RobotJoint *joint) {
  const struct RegisterEntry *entry =
      find(connection, &connection->joints, joint->mimicked_name, "a <mimic>", joint->line);
  struct RobotJoint *other = entry != NULL ? connection->robot->joints[entry->index] : NULL;
  if (other == NULL || (joint_is_single(joint) && joint_is_single(other))) return other;
  report_error(connection->diagnostics, joint->line,
               "the joint '%s' mimics '%s'; expected both of them revolute, continuous or prismatic", joint->name,
               other->name);
  return NULL;
}

/* Follows mimicked joints to the one with a coordinate and composes their linear functions. Reports cycles. */
static void find_leader(struct Connection *connection, struct RobotJoint *joint) {
  struct RobotJoint *leader = joint;
  joint->ratio = 1;
  for (size_t steps = 0; leader != NULL && leader->mimicked_name != NULL; steps++) {
    if (steps == connection->robot->joint_count) {
      report_error(connection->diagnostics, joint->line,
                   "the joint '%s' mimics itself, or joints that mimic each other; expected one with a motor",
                   joint->name);
      return;
    }
    joint->shift += joint->ratio * leader->offset;
    joint->ratio *= leader->multiplier;
    leader = mimicked_by(connection, leader);
  }
  if (!isfinite(joint->ratio) || !isfinite(joint->shift))
    report_error(connection->diagnostics, joint->line,
                 "the joint '%s' follows '%s' by %g of its position and %g, which is not finite; expected smaller "
                 "multipliers and offsets in the <mimic> of '%s' and of those that it mimics",
                 joint->name, leader != NULL ? leader->name : joint->mimicked_name, joint->ratio, joint->shift,
                 joint->name);
  joint->leader = leader;
  if (leader != NULL && leader != joint) leader->is_mimicked = true;
}

/* Resolves the names in a transmission. symbol: of a tendon, the prefix of parameters for its coefficients. */
static void connect_transmission(struct Connection *connection, struct Transmission *transmission, const char *kind,
                                 const char *name, const char *symbol, long line) {
  const char *what = format_text("%s %s", *kind == 'a' ? "an" : "a", kind);
  struct Register sites = {"site", connection->links.names, connection->links.symbols};
  for (size_t i = 0; i < transmission->site_count; i++) {
    const struct RegisterEntry *entry = find(connection, &sites, transmission->site_names[i], what, line);
    if (entry != NULL) transmission->sites[i] = connection->robot->links[entry->index];
  }
  for (size_t i = 0; i < transmission->count; i++) {
    struct TransmissionTerm *term = &transmission->terms[i], *first = transmission->terms;
    const struct RegisterEntry *entry = find(connection, &connection->joints, term->joint_name, what, line);
    term->joint = entry != NULL ? connection->robot->joints[entry->index] : NULL;
    if (term->joint == NULL) continue;
    if (!joint_is_single(term->joint))
      report_error(connection->diagnostics, line,
                   "the %s '%s' is at the joint '%s', which has more than one degree of freedom; expected a hinge or "
                   "slide",
                   kind, name, term->joint_name);
    if (first->joint != NULL && (first->joint->type == PRISMATIC) != (term->joint->type == PRISMATIC))
      term->symbol = format_text("%s_by_%s", symbol, term->joint->symbol);
  }
}

static void connect_wrench(struct Connection *connection, const struct Actuator *actuator) {
  struct Wrench *wrench = actuator->wrench;
  for (int i = 0; i < WRENCH_LINKS; i++) {
    const struct RegisterEntry *entry =
        wrench->names[i] != NULL ? find(connection, &connection->links, wrench->names[i], "an actuator", actuator->line)
                                 : NULL;
    if (entry != NULL) wrench->links[i] = connection->robot->links[entry->index];
  }
}

static void connect_transmissions(struct Connection *connection) {
  struct Robot *robot = connection->robot;
  for (size_t i = 0; i < robot->tendon_count; i++) {
    struct Tendon *tendon = &robot->tendons[i];
    tendon->symbol = format_text("%s_tendon", robot_symbol(tendon->name));
    connect_transmission(connection, &tendon->transmission, "tendon", tendon->name, tendon->symbol, tendon->line);
  }
  for (size_t i = 0; i < robot->actuator_count; i++) {
    struct Actuator *actuator = &robot->actuators[i];
    if (actuator->wrench != NULL) {
      connect_wrench(connection, actuator);
      continue;
    }
    if (actuator->transmission.site_count > 0 || actuator->transmission.terms->joint != NULL)
      continue; /* the link of a tendon is already resolved */
    connect_transmission(connection, &actuator->transmission, "actuator", actuator->name, "", actuator->line);
  }
}

/* Resolves joints in couplings; tendons are already resolved. */
static void connect_couplings(struct Connection *connection) {
  struct Robot *robot = connection->robot;
  for (size_t i = 0; i < robot->coupling_count; i++)
    for (int part = 0; part < 2; part++) {
      struct Coupling *coupling = &robot->couplings[i];
      struct Transmission *transmission = &coupling->parts[part].transmission;
      if (transmission->count == 1 && transmission->terms->joint == NULL)
        connect_transmission(connection, transmission, "coupling", coupling->name, "", coupling->line);
    }
}

static void connect_loops(struct Connection *connection) {
  struct Robot *robot = connection->robot;
  for (size_t i = 0; i < robot->loop_count; i++)
    for (int end = 0; end < 2; end++) {
      struct RobotLoop *loop = &robot->loops[i];
      const struct RegisterEntry *entry =
          find(connection, &connection->links, loop->link_names[end], loop->name, loop->line);
      if (entry != NULL) loop->links[end] = robot->links[entry->index];
    }
}

size_t moving_children(const struct Robot *robot, const struct RobotLink *link) {
  size_t count = 0;
  for (size_t i = 0; i < robot->joint_count; i++)
    count += joint_moves(robot->joints[i]) && robot->joints[i]->parent->carrier == link->carrier;
  return count;
}

/* True if the moment of inertia of a body about some axis is rounding error. */
static bool has_no_moment(const struct RigidBody *body) {
  const double rounding = 1e-12;
  struct Matrix3 axes;
  principal_axes(&body->tensor, &axes);
  const struct Matrix3 along = tensor_along(body, &axes);
  const double x = along.at[0][0], y = along.at[1][1], z = along.at[2][2];
  return fmin(fmin(x, y), z) <= rounding * fmax(fmax(x, y), z);
}

void robot_check_moments(const struct Robot *robot, const struct RobotLink *link, bool needs_mass, long line,
                         struct Diagnostics *diagnostics) {
  const struct RigidBody *body = &link->carrier->carried;
  if (moving_children(robot, link) > 0 || ((body->mass > 0 || !needs_mass) && !has_no_moment(body))) return;
  if (needs_mass && !(body->mass > 0))
    report_error(diagnostics, line, "the link '%s' moves freely, and has no mass; expected a <mass> above 0",
                 link->name);
  else
    report_error(diagnostics, line,
                 "the link '%s' turns freely, and has no moment of inertia about an axis; expected an <inertia> whose "
                 "principal moments are above 0",
                 link->name);
}

static void check_moments(const struct Connection *connection) {
  for (size_t i = 0; i < connection->robot->joint_count; i++) {
    const struct RobotJoint *joint = connection->robot->joints[i];
    bool turns = joint->type == FLOATING || joint->type == BALL;
    if (turns && !joint->is_mimicked && joint->armature == 0 && joint->child->moves_inertia)
      robot_check_moments(connection->robot, joint->child, joint->type == FLOATING, joint->line,
                          connection->diagnostics);
  }
}

/* Reports joints that move no inertia: neither of their link nor of its descendants, nor of a motor. */
static void check_inertia(struct Connection *connection) {
  struct Robot *robot = connection->robot;
  for (const struct RobotLink *link = robot->root; link != NULL; link = link->next) {
    struct RobotLink *ancestor = body_has_inertia(&link->carried) ? link->carrier : NULL;
    while (ancestor != NULL && !ancestor->moves_inertia) {
      ancestor->moves_inertia = true;
      ancestor = ancestor->joint != NULL ? ancestor->joint->parent->carrier : NULL;
    }
  }
  for (size_t i = 0; i < robot->joint_count; i++) {
    const struct RobotJoint *joint = robot->joints[i];
    if (!joint_moves(joint) || joint->type == PRESCRIBED || joint->is_mimicked || joint->leader != joint ||
        joint->child->moves_inertia || joint->armature > 0)
      continue;
    report_error(connection->diagnostics, joint->line,
                 "the joint '%s' moves no inertia: neither the link '%s' nor a link behind it has a mass; expected an "
                 "<inertial> there, or type=\"fixed\"",
                 joint->name, joint->child->name);
  }
}

struct RobotLink *robot_link(const struct Robot *robot, const char *name, const char *what,
                             struct Diagnostics *diagnostics) {
  struct SimilarName similar = {.wanted = name};
  const char **names = allocate(robot->link_count + 1, sizeof *names);
  for (size_t i = 0; i < robot->link_count; i++) {
    names[i] = robot->links[i]->name;
    if (strcmp(names[i], name) == 0) return robot->links[i];
    similar_consider(&similar, names[i]);
  }
  if (similar.best != NULL) report_missing("link", name, what, 0, &similar, diagnostics);
  else
    report_error(diagnostics, 0, "there is no link '%s' for %s; expected one of the links: %s", name, what,
                 list_of_names(names, robot->link_count));
  return NULL;
}

bool robot_connect(struct Robot *robot, struct Diagnostics *diagnostics) {
  struct Connection connection = {
      .robot = robot, .links = register_create("link"), .joints = register_create("joint"), .diagnostics = diagnostics};
  int errors = diagnostics->errors;
  enter_names(&connection);
  if (diagnostics->errors == errors) connect_links(&connection);
  if (diagnostics->errors == errors) find_root(&connection);
  if (diagnostics->errors == errors) order_links(&connection);
  for (size_t i = 0; i < robot->joint_count && diagnostics->errors == errors; i++)
    find_leader(&connection, robot->joints[i]);
  if (diagnostics->errors == errors) join_fixed_links(&connection);
  if (diagnostics->errors == errors) connect_transmissions(&connection);
  if (diagnostics->errors == errors) connect_couplings(&connection);
  if (diagnostics->errors == errors) connect_loops(&connection);
  if (diagnostics->errors == errors) check_inertia(&connection);
  if (diagnostics->errors == errors) check_moments(&connection);
  return diagnostics->errors == errors;
}

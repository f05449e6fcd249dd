/*
 * Conversion of a robot to a system.
 *
 *  1. urdf_read() or mjcf_read() reads the file into a struct Robot: links, joints, tendons, actuators and loops.
 *  2. robot_connect() makes a kinematic tree of it. Links that are fixed to each other become one body.
 *  3. Each movable joint becomes one or more <coordinate>s with inputs, friction, springs and limits.
 *  4. Each link becomes a <frame> in the frame of the link that carries its parent. Its pose is the constant placement
 * of the joint followed by the joint's motion. A movable link also gets a <body> with the inertia of all links fixed to
 * it.
 *  5. Tendons, actuators, loops and the tool follow as forces, constraints and outputs.
 *
 * The result is validated against the schema and read like any system. Its elements have the lines of the robot file,
 * so that messages refer to that. In joint coordinates only loops, quaternions and coupled tendons need constraints.
 * The cost is linear in the numbers of links and joints, except for pairs of geoms and some searches by name in MJCF.
 *
 * R. Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 4.
 */
#include "robots/robot_system.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "model/kinematics.h"
#include "names/similar.h"
#include "robots/description/robot_file.h"
#include "robots/mjcf/mjcf.h"
#include "robots/robot_elements.h"
#include "robots/robot_fluid.h"
#include "robots/robot_joint.h"
#include "robots/robot_shapes.h"
#include "robots/robot_start.h"
#include "robots/robot_tendon.h"
#include "robots/robot_transmission.h"
#include "robots/robot_tree.h"
#include "robots/urdf.h"
#include "xml/nodes.h"
#include "xml/schema.h"

/* Names of a floating base, and of the point at the tool. */
static const char base[] = "base", tool[] = "tool";

/* Writes all links that are fixed to this one, and itself, as one body. */
static void write_body(const struct Writer *writer, const struct RobotLink *link) {
  static const char *const moments[3][3] = {{"Ixx", "Ixy", "Ixz"}, {NULL, "Iyy", "Iyz"}, {NULL, NULL, "Izz"}};
  const struct RigidBody *body = &link->carried;
  if (!body_has_inertia(body)) return;
  xmlNodePtr node = write_element(writer, "body", "name", format_text("%s_body", link->symbol), "in", link->symbol,
                                  "mass", number(body->mass), NULL);
  for (int i = 0; i < 3; i++) set_number(node, axes[i], body->center[i]);
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) set_number(node, moments[i][j], body->tensor.at[i][j]);
}

/* Writes the coordinates, frame, body and shapes of a link; the frame is in that of the parent's carrier. */
static void write_link(struct Writer *writer, const struct RobotLink *link) {
  bool floats = writer->options->floats;
  const struct RobotJoint *joint = link->joint;
  bool moves = joint_moves(joint);
  if (moves) {
    writer->line = joint->line;
    write_joint(writer, joint);
  }
  writer->line = link->line;
  const struct JointStart start = {.position = {[2] = writer->base_height, [3] = 1}};
  if (joint == NULL && floats) write_free_coordinates(writer, base, &start, "free motion of the base");
  xmlNodePtr frame = write_element(writer, "frame", "name", link->symbol, NULL);
  if (joint != NULL) {
    const struct RobotLink *parent = joint->parent;
    struct Placement placement = placement_within(&parent->placement, &joint->origin);
    set_attribute(frame, "in", parent->carrier->symbol);
    write_placement(writer, frame, &placement);
    write_motion(writer, frame, joint);
  } else if (floats) write_free_motion(writer, frame, base);
  if (moves || (joint == NULL && floats)) write_body(writer, link);
  write_shapes(writer, link, carrier_moves(link, floats));
}

/* Returns the leaf of the tree if there is only one; NULL otherwise. */
static const struct RobotLink *only_end(const struct Robot *robot) {
  const struct RobotLink *end = NULL;
  for (const struct RobotLink *link = robot->root; link != NULL; link = link->next) {
    if (link->first_child != NULL) continue;
    if (end != NULL) return NULL;
    end = link;
  }
  return end;
}

static void write_tool(struct Writer *writer, const struct RobotLink *link) {
  writer->line = link->line;
  write_element(writer, "point", "name", tool, "in", link->symbol, NULL);
  for (int i = 0; i < 3; i++)
    write_output(writer, format_text("%s_%s", tool, axes[i]), "m", format_text("%s.%s", tool, axes[i]),
                 format_text("position of '%s' along %s", link->name, axes[i]));
  for (int i = 0; i < 3; i++)
    write_output(writer, format_text("%s_v%s", tool, axes[i]), "m/s", format_text("%s.v%s", tool, axes[i]),
                 format_text("velocity of '%s' along %s", link->name, axes[i]));
}

/* True if dampers, springs or regularized friction may make the robot stiff. */
static bool has_losses(const struct Robot *robot, const struct RobotOptions *options) {
  for (size_t i = 0; i < robot->joint_count; i++)
    if (robot->joints[i]->damping > 0 || robot->joints[i]->stiffness > 0 ||
        (robot->joints[i]->friction > 0 && !options->sticks))
      return true;
  for (size_t i = 0; i < robot->tendon_count; i++)
    if (robot->tendons[i].damping > 0 || robot->tendons[i].stiffness > 0 ||
        (robot->tendons[i].friction > 0 && !options->sticks))
      return true;
  for (size_t i = 0; i < robot->actuator_count; i++)
    if (robot->actuators[i].bias[1] != 0 || robot->actuators[i].bias[2] != 0) return true;
  return fluid_acts(&robot->fluid);
}

static void write_gravity(const struct Writer *writer, const struct Robot *robot) {
  const double *gravity = robot->gravity;
  double size = robot_gravity(robot);
  bool is_down = gravity[0] == 0 && gravity[1] == 0 && gravity[2] <= 0;
  write_parameter(writer, "g", size, "m/s2",
                  is_down ? "gravitational acceleration, along -z" : "gravitational acceleration");
  xmlNodePtr node = write_element(writer, "gravity", NULL);
  if (is_down) set_attribute(node, "z", "-g");
  for (int i = 0; i < 3 && !is_down; i++)
    if (gravity[i] != 0) set_attribute(node, axes[i], term(gravity[i] / size, "g"));
}

/* Writes the force that balances a share of a link's weight, as a potential at its centre of mass. */
static void write_balance(struct Writer *writer, const struct Robot *robot, const struct RobotLink *link) {
  double share = link->weightless * link->body.mass, size = robot_gravity(robot);
  if (share == 0 || size == 0 || !carrier_moves(link, writer->options->floats)) return;
  writer->line = link->line;
  char *name = format_text("%s_balance", link->symbol), *height = copy_text("");
  xmlNodePtr point = write_element(writer, "point", "name", name, "in", link->symbol, NULL);
  for (int i = 0; i < 3; i++) set_number(point, axes[i], link->body.center[i]);
  for (int i = 0; i < 3; i++)
    if (robot->gravity[i] != 0)
      height = format_text("%s%s%s*%s.%s", height, *height != '\0' ? " + " : "", number(robot->gravity[i] / size), name,
                           axes[i]);
  write_parameter(writer, format_text("%s_mass", name), share, "kg",
                  format_text("mass of '%s' whose weight is balanced", link->name));
  set_content(write_element(writer, "potential", NULL), format_text("%s_mass*g*(%s)", name, height));
}

static void write_loop(struct Writer *writer, const struct RobotLoop *loop) {
  writer->line = loop->line;
  write_element(writer, "joint", "name", robot_symbol(loop->name), "type", loop->is_fixed ? "fixed" : "spherical",
                "from", loop->links[0]->symbol, "to", loop->links[1]->symbol, NULL);
}

static void write_robot(struct Writer *writer, const struct Robot *robot, const struct RobotLink *end) {
  set_attribute(writer->system, "name", robot_symbol(robot->name));
  set_attribute(writer->system, "description", format_text("robot '%s'", robot->name));
  write_gravity(writer, robot);
  write_friction_parameters(writer, robot);
  if (writer->options->has_ground) write_ground(writer, robot);
  for (const struct RobotLink *link = robot->root; link != NULL; link = link->next) write_link(writer, link);
  write_pairs(writer, robot);
  for (const struct RobotLink *link = robot->root; link != NULL; link = link->next) write_balance(writer, robot, link);
  write_wind(writer, robot);
  for (const struct RobotLink *link = robot->root; link != NULL; link = link->next)
    write_fluid_forces(writer, robot, link);
  for (size_t i = 0; i < robot->tendon_count; i++) {
    writer->line = robot->tendons[i].line;
    write_tendon(writer, &robot->tendons[i]);
  }
  for (size_t i = 0; i < robot->actuator_count; i++) {
    writer->line = robot->actuators[i].line;
    write_actuator(writer, &robot->actuators[i]);
  }
  for (size_t i = 0; i < robot->joint_count; i++) {
    writer->line = robot->joints[i]->line;
    write_limited_forces(writer, robot->joints[i]);
  }
  for (size_t i = 0; i < robot->loop_count; i++) write_loop(writer, &robot->loops[i]);
  for (size_t i = 0; i < robot->coupling_count; i++) {
    writer->line = robot->couplings[i].line;
    write_coupling(writer, &robot->couplings[i]);
  }
  if (end != NULL) write_tool(writer, end);
  writer->line = robot->line;
  /* no part of such a robot is stiff, so that an explicit method suffices */
  if (!has_losses(robot, writer->options) && !writer->options->has_ground && robot->pair_count == 0)
    write_element(writer, "solver", "method", "taylor", NULL);
  write_element(writer, "experiment", "stopTime", number(1), "stepSize", number(0.01), NULL);
}

/* Reports a robot without movable joints, or a floating one without mass or moments of inertia. */
static void check_motion(const struct Robot *robot, bool floats, struct Diagnostics *diagnostics) {
  bool moves = floats;
  for (size_t i = 0; i < robot->joint_count && !moves; i++)
    moves = joint_moves(robot->joints[i]) && robot->joints[i]->type != PRESCRIBED;
  if (!moves)
    report_error(
        diagnostics, robot->line,
        "no joint of the robot moves; expected one of another type than fixed, or base=\"floating\" in an <include>, "
        "or --base floating on the command line");
  else if (floats && !robot->root->moves_inertia)
    report_error(diagnostics, robot->line, "no link of the robot has a mass; expected an <inertial> in one of them");
  else if (floats && !body_has_inertia(&robot->root->carried) && moving_children(robot, robot->root) == 1)
    report_error(diagnostics, robot->line,
                 "the root link '%s' moves freely, and has no mass; expected an <inertial> in it, or no "
                 "base=\"floating\"",
                 robot->root->name);
  else if (floats) robot_check_moments(robot, robot->root, true, robot->line, diagnostics);
}

/* Counts joints or tendons with a property; holds the first of them. */
struct PropertyCount {
  const char *kind, *name;
  long line;
  size_t count;
};

static void count_one(struct PropertyCount *common, const char *kind, const char *name, long line) {
  if (common->count++ == 0) *common = (struct PropertyCount){.kind = kind, .name = name, .line = line, .count = 1};
}

/* Warns of limits in the file if the <include> does not say how to treat them. */
static void warn_of_limits(const struct Diagnostics *diagnostics, const struct PropertyCount *common, bool is_said,
                           const char *what, const char *attribute, const char *option) {
  if (is_said || common->count == 0) return;
  size_t others = common->count - 1;
  const char *and = others > 0 ? format_text(" and of %zu other%s", others, others > 1 ? "s" : "") : "";
  report_warning(diagnostics, common->line,
                 "%s of the %s '%s'%s; expected %s in an <include>, or %s on the command line", what, common->kind,
                 common->name, and, attribute, option);
}

/* Rotates a quaternion or its rate by an angle about a unit vector: the product from the left. */
static void rotate_start(double q[4], const double axis[3], double angle) {
  double c = cos(angle / 2), s = sin(angle / 2), w = q[0], v[3] = {q[1], q[2], q[3]};
  q[0] = c * w;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    q[0] -= s * axis[i] * v[i];
    q[i + 1] = c * v[i] + s * (axis[i] * w + axis[j] * v[k] - axis[k] * v[j]);
  }
}

/* Rotates the start of a ball joint back to its largest angle. Returns false if it is within it. */
static bool limit_rotation(struct JointStart *start, double largest) {
  const double *q = &start->position[3];
  double length = hypot(hypot(q[1], q[2]), q[3]), angle = 2 * atan2(length, q[0]);
  double wanted = angle > M_PI ? 2 * M_PI - largest : largest;
  if (!(2 * atan2(length, fabs(q[0])) > largest)) return false;
  const double axis[3] = {q[1] / length, q[2] / length, q[3] / length};
  rotate_start(&start->position[3], axis, wanted - angle);
  rotate_start(&start->velocity[3], axis, wanted - angle);
  return true;
}

/* Moves the start of a joint to its nearest limit. Returns false if it is within them. */
static bool limit_start(struct RobotJoint *joint) {
  double *start = joint->start.position, before = *start;
  if (joint->type == BALL) return limit_rotation(&joint->start, joint->upper);
  if (!joint_is_single(joint) || joint->leader != joint) return false;
  if (*start < joint->lower) *start = joint->lower;
  if (*start > joint->upper) *start = joint->upper;
  return *start != before;
}

/* Warns of a start in the <include> that is beyond a stop. */
static void check_own_start(const struct RobotJoint *joint, const char *own, const struct RobotOptions *options,
                            const struct Diagnostics *diagnostics) {
  double start;
  bool is_own = joint_is_single(joint) && joint->leader == joint && own != NULL && options->value_of(own, &start);
  if (is_own && (start < joint->lower || start > joint->upper))
    report_warning(
        diagnostics, joint->line,
        "the start of the joint '%s' is %g, beyond its stops, where the simulation cannot begin; expected one "
        "from %g to %g",
        joint->name, start, joint->lower, joint->upper);
}

/* Moves starts beyond stops to these, with a warning unless the <include> gives another start. */
static void limit_starts(const struct Robot *robot, const struct RobotOptions *options, bool is_mjcf,
                         const struct Diagnostics *diagnostics) {
  struct PropertyCount starts = {.count = 0};
  for (size_t i = 0; i < robot->joint_count && options->has_stops; i++) {
    struct RobotJoint *joint = robot->joints[i];
    const char *coordinate = joint->type == BALL ? format_text("%s_qw", joint->symbol) : joint->symbol;
    const char *own = robot_own_start(options, coordinate);
    check_own_start(joint, own, options, diagnostics);
    if (limit_start(joint) && own == NULL) count_one(&starts, "joint", joint->name, joint->line);
  }
  warn_of_limits(diagnostics, &starts, false, "limits replace the start values, which are beyond them,",
                 "<coordinate name=\"...\" start=\"...\"/>",
                 !is_mjcf                    ? "JOINT=VALUE"
                 : options->keyframe != NULL ? "--keyframe with another name"
                                             : "--keyframe NAME");
}

/* Warns of limits, frictions and efforts without a word of the <include>. */
static void check_limits(const struct Robot *robot, const struct RobotOptions *options,
                         const struct Diagnostics *diagnostics) {
  struct PropertyCount ranges = {.count = 0}, efforts = {.count = 0}, frictions = {.count = 0};
  for (size_t i = 0; i < robot->joint_count; i++) {
    const struct RobotJoint *joint = robot->joints[i];
    if (!isnan(joint->lower)) count_one(&ranges, "joint", joint->name, joint->line);
    if (joint->friction > 0) count_one(&frictions, "joint", joint->name, joint->line);
    if (joint->has_motor && joint_is_single(joint) && !isnan(joint->effort))
      count_one(&efforts, "joint", joint->name, joint->line);
  }
  for (size_t i = 0; i < robot->tendon_count; i++) {
    const struct Tendon *tendon = &robot->tendons[i];
    if (!isnan(tendon->lower)) count_one(&ranges, "tendon", tendon->name, tendon->line);
    if (tendon->friction > 0) count_one(&frictions, "tendon", tendon->name, tendon->line);
  }
  warn_of_limits(diagnostics, &ranges, options->says_limits, "motion is not stopped at the limits",
                 "limits=\"stops\", or \"outputs\" if this is meant,", "--limits stops");
  warn_of_limits(diagnostics, &frictions, options->says_friction, "creep replaces sticking by the friction",
                 "friction=\"sticks\", or \"creeps\" if this is meant,", "--friction sticks");
  warn_of_limits(diagnostics, &efforts, options->says_effort, "motors may exceed the effort",
                 "effort=\"limited\", or \"unlimited\" if this is meant,", "--effort limited");
}

/* Returns the links that can touch the ground, for messages; "none" without any. */
static char *standing_links(const struct Robot *robot, const struct RobotOptions *options) {
  const char **names = allocate(robot->link_count + 1, sizeof *names);
  size_t count = 0;
  for (size_t i = 0; i < robot->link_count; i++) {
    const struct RobotLink *link = robot->links[i];
    size_t clear = 0;
    for (size_t j = 0; j < link->collision_count; j++) clear += link->collisions[j].is_clear;
    if (clear < link->collision_count && carrier_moves(link, options->floats)) names[count++] = link->name;
  }
  return count > 0 ? list_of_names(names, count) : copy_text("none");
}

/* Reports unknown links that should touch the ground, and those without a suitable shape. */
static void check_ground_contact(const struct Robot *robot, const struct RobotOptions *options,
                                 struct Diagnostics *diagnostics) {
  const char *rest = options->ground_contact;
  if (!options->has_ground || rest == NULL) return;
  for (char *name = next_name(&rest); name != NULL; name = next_name(&rest)) {
    const struct RobotLink *link = robot_link(robot, name, "the ground", diagnostics);
    size_t clear = 0;
    for (size_t i = 0; link != NULL && i < link->collision_count; i++) clear += link->collisions[i].is_clear;
    if (link != NULL && link->collision_count == clear)
      report_error(diagnostics, link->line,
                   "the link '%s' has no shape that could stand on the ground; expected a <collision> or <geom> in "
                   "it%s, or one of "
                   "the links with such shapes: %s",
                   name, clear > 0 ? ", which its contype, conaffinity or <exclude> let touch the plane" : "",
                   standing_links(robot, options));
  }
}

xmlDocPtr system_of_robot(xmlDocPtr document, const struct RobotOptions *given, struct Diagnostics *diagnostics) {
  int errors = diagnostics->errors;
  xmlNodePtr root = xmlDocGetRootElement(document);
  bool is_mjcf = is_element(root, "mujoco");
  struct Robot *robot = is_mjcf ? mjcf_read(root, given, diagnostics) : urdf_read(root, given, diagnostics);
  struct RobotOptions own = *given, *options = &own;
  own.floats &= !is_mjcf; /* bodies of the world float, which itself is fixed */
  const struct RobotLink *end = NULL;
  double height = 0;
  if (diagnostics->errors == errors && robot_connect(robot, diagnostics)) {
    check_motion(robot, options->floats, diagnostics);
    check_ground_contact(robot, options, diagnostics);
    end = options->tool != NULL ? robot_link(robot, options->tool, "the tool", diagnostics) : only_end(robot);
  }
  if (diagnostics->errors == errors) {
    check_limits(robot, options, diagnostics);
    limit_starts(robot, options, is_mjcf, diagnostics);
    if (options->has_ground) height = robot_start_height(robot, options, diagnostics);
    if (!is_mjcf) find_pairs(robot, options, diagnostics);
  }
  xmlFreeDoc(document);
  document = NULL;
  if (diagnostics->errors == errors) {
    document = xmlNewDoc((const xmlChar *)"1.0");
    struct Writer writer = {.system = xmlNewNode(NULL, (const xmlChar *)"system"),
                            .line = robot->line,
                            .options = options,
                            .base_height = height};
    xmlDocSetRootElement(document, writer.system);
    write_robot(&writer, robot, end);
    schema_check(document, diagnostics);
  }
  if (diagnostics->errors == errors) return document;
  xmlFreeDoc(document);
  return NULL;
}

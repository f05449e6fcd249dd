#include "robots/urdf.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/paths.h"
#include "model/hull.h"
#include "meshes/mesh_file.h"
#include "meshes/package_path.h"
#include "robots/description/robot_file.h"
#include "xml/nodes.h"

const char *const joint_types[JOINT_TYPES] = {"fixed",    "revolute", "continuous", "prismatic",
                                              "floating", "planar",   "ball",       "prescribed"};

/* Remedy for features of joints with several coordinates that cannot be converted. */
static const char in_system[] = "a <force> in a <system> that includes the robot";

static struct Placement read_origin(struct RobotFile *urdf, xmlNodePtr parent) {
  double translation[3] = {0}, angles[3] = {0};
  xmlNodePtr origin = child_of(urdf, parent, "origin");
  read_numbers(urdf, origin, "xyz", 3, translation);
  read_numbers(urdf, origin, "rpy", 3, angles);
  return placement_of(translation, angles);
}

static struct Matrix3 read_tensor(struct RobotFile *urdf, xmlNodePtr node) {
  static const char *const names[3][3] = {{"ixx", "ixy", "ixz"}, {"ixy", "iyy", "iyz"}, {"ixz", "iyz", "izz"}};
  struct Matrix3 tensor;
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) tensor.at[i][j] = tensor.at[j][i] = required_number(urdf, node, names[i][j]);
  return tensor;
}

static void check_inertial(struct RobotFile *urdf, xmlNodePtr node, const struct RobotLink *link,
                           const struct RigidBody *body) {
  long line = line_of(node);
  if (body->mass < 0)
    report_error(urdf->diagnostics, line, "the mass %g of the link '%s' is negative; expected 0 or more", body->mass,
                 link->name);
}

static void read_inertial(struct RobotFile *urdf, xmlNodePtr node, struct RobotLink *link) {
  static const char *const known[] = {"origin", "mass", "inertia", NULL};
  leave_out_others(urdf, node, known);
  xmlNodePtr mass = required_child_of(urdf, node, "mass"), inertia = required_child_of(urdf, node, "inertia");
  int errors = urdf->diagnostics->errors;
  struct Placement placement = read_origin(urdf, node);
  struct RigidBody body = {.mass = 0};
  if (mass != NULL) body.mass = required_number(urdf, mass, "value");
  if (inertia != NULL) body.tensor = read_tensor(urdf, inertia);
  if (urdf->diagnostics->errors == errors) check_inertial(urdf, node, link, &body);
  link->body = body_seen_from(&placement, &body);
}

/* Returns the only child of this name; NULL if there is none or several. */
static xmlNodePtr only_child_of(xmlNodePtr parent, const char *name) {
  xmlNodePtr found = NULL;
  size_t count = 0;
  for (xmlNodePtr node = parent->children; node != NULL; node = node->next) {
    if (!is_element(node, name)) continue;
    found = node;
    count++;
  }
  return count == 1 ? found : NULL;
}

/* Reads a <mesh>. Returns why it cannot be used, else NULL; no error, as robots are usable without meshes. */
static char *read_mesh(const struct RobotFile *urdf, xmlNodePtr node, bool touches, struct Collision *collision) {
  const char *robot = urdf->diagnostics->file;
  char *named = attribute(node, "filename"), *scale = attribute(node, "scale"), *problem = NULL;
  double *factors = collision->scale;
  for (int i = 0; i < 3; i++) factors[i] = 1;
  if (scale != NULL && (parse_numbers(scale, 3, factors) != 3 || factors[0] * factors[1] * factors[2] == 0))
    return format_text("the scale of a <mesh> is '%.60s'; expected three numbers other than 0", scale);
  char *path = named != NULL ? path_in_package(robot, named) : NULL;
  if (path == NULL)
    return format_text(
        "the mesh '%s' does not exist; expected a path relative to this file, or that of a package here or "
        "in a folder above",
        named != NULL ? named : "");
  struct Mesh *mesh = mesh_read(path_beside_file(robot, path), factors, &problem);
  if (mesh == NULL) return problem;
  if (touches && !mesh_find_corners(mesh)) problem = format_text("the mesh '%s' is flat; expected a volume", named);
  collision->corners = allocate(mesh->corner_count, sizeof *collision->corners);
  collision->corner_count = mesh->corner_count;
  for (size_t i = 0; i < mesh->corner_count; i++)
    memcpy(collision->corners[i], mesh->points[mesh->corners[i]], sizeof *collision->corners);
  release(mesh->points);
  release(mesh->triangles);
  collision->type = "mesh";
  collision->file = path;
  return problem;
}

/*
 * Reads sizes. Returns true if any is positive, as boxes may be flat. Reports negative sizes, and if the shape touches
 * the ground, sizes that are all 0. Other shapes of size 0 are common placeholders.
 */
static bool read_sizes(struct RobotFile *urdf, xmlNodePtr node, const char *name, size_t count, bool touches,
                       double *sizes) {
  int errors = urdf->diagnostics->errors;
  if (*required_attribute(urdf, node, name) != '\0') read_numbers(urdf, node, name, count, sizes);
  double least = sizes[0], largest = sizes[0];
  for (size_t i = 1; i < count; i++) {
    least = fmin(least, sizes[i]);
    largest = fmax(largest, sizes[i]);
  }
  if (urdf->diagnostics->errors == errors && (least < 0 || (touches && !(largest > 0))))
    report_error(urdf->diagnostics, line_of(node), "%s=\"%.60s\" of <%s> is not valid; expected %s above 0", name,
                 attribute(node, name), (const char *)node->name, count == 1 ? "a number" : "sides");
  return largest > 0;
}

/* Reads a <geometry>. Returns false if it has no usable shape. *problem: why a mesh is not usable, else NULL. */
static bool read_geometry(struct RobotFile *urdf, xmlNodePtr node, bool touches, struct Collision *collision,
                          char **problem) {
  xmlNodePtr sphere = child_of(urdf, node, "sphere"), box = child_of(urdf, node, "box");
  xmlNodePtr round = child_of(urdf, node, "cylinder"), capsule = round == NULL ? child_of(urdf, node, "capsule") : NULL;
  xmlNodePtr mesh = only_child_of(node, "mesh");
  bool has_size = true;
  if (round == NULL) round = capsule;
  if (sphere != NULL) {
    collision->type = "sphere";
    has_size = read_sizes(urdf, sphere, "radius", 1, touches, &collision->radius);
  } else if (box != NULL) {
    collision->type = "box";
    has_size = read_sizes(urdf, box, "size", 3, touches, collision->size);
  } else if (round != NULL) {
    collision->type = capsule != NULL ? "capsule" : "cylinder";
    has_size = read_sizes(urdf, round, "radius", 1, touches, &collision->radius);
    has_size &= read_sizes(urdf, round, "length", 1, touches, &collision->length);
  } else if (mesh != NULL) *problem = read_mesh(urdf, mesh, touches, collision);
  return collision->type != NULL && (has_size || touches) && *problem == NULL;
}

static void read_collision(struct RobotFile *urdf, xmlNodePtr node, struct RobotLink *link) {
  xmlNodePtr geometry = child_of(urdf, node, "geometry");
  struct Collision collision = {.placement = read_origin(urdf, node), .friction = NAN, .line = line_of(node)};
  char *problem = NULL;
  bool touches = link_touches_ground(urdf->options, link->name);
  if (geometry == NULL || !read_geometry(urdf, geometry, touches, &collision, &problem)) {
    if (touches)
      note_untouched(
          urdf, collision.line,
          format_text("a <collision> of the link '%s' touches nothing: %s", link->name,
                      problem != NULL
                          ? problem
                          : "it has no geometry; expected a <box>, <sphere>, <cylinder>, <capsule> or <mesh>"));
    else {
      leave_out(urdf, "collision");
      note_mesh_problem(urdf, problem);
    }
    return;
  }
  APPEND(link->collisions, link->collision_count, collision);
}

/* Returns the <color> of the material of this name anywhere in the file; NULL for none. */
static xmlNodePtr find_color(xmlNodePtr node, const char *name) {
  xmlNodePtr color = NULL;
  if (is_element(node, "material") && attribute_is(node, "name", name)) color = only_child_of(node, "color");
  for (xmlNodePtr child = node->children; child != NULL && color == NULL; child = child->next)
    if (child->type == XML_ELEMENT_NODE) color = find_color(child, name);
  return color;
}

/* Returns the color of a visual as text; NULL if the file gives none. */
static char *read_color(xmlNodePtr visual) {
  xmlNodePtr material = only_child_of(visual, "material");
  xmlNodePtr color = material != NULL ? only_child_of(material, "color") : NULL;
  if (material != NULL && color == NULL && has_attribute(material, "name"))
    color = find_color(xmlDocGetRootElement(visual->doc), attribute(material, "name"));
  double rgba[4];
  if (color == NULL || !has_attribute(color, "rgba") || parse_numbers(attribute(color, "rgba"), 4, rgba) != 4)
    return NULL;
  return color_text(rgba);
}

/*
 * Reads a <visual>. Returns false if it cannot be drawn. Errors in it are not reported, as the motion does not depend
 * on it.
 */
static bool read_visual(struct RobotFile *urdf, xmlNodePtr node, struct RobotLink *link) {
  char *problem = NULL;
  struct Diagnostics quiet = *urdf->diagnostics;
  struct RobotFile file = {.robot = urdf->robot, .options = urdf->options, .diagnostics = &quiet};
  quiet.errors = ERROR_LIMIT + 1;
  struct Collision visual = {.placement = read_origin(&file, node), .line = line_of(node)};
  xmlNodePtr geometry = child_of(&file, node, "geometry");
  bool is_right = quiet.errors == ERROR_LIMIT + 1 && geometry != NULL && xmlChildElementCount(geometry) == 1 &&
                  read_geometry(&file, geometry, false, &visual, &problem) && quiet.errors == ERROR_LIMIT + 1;
  note_mesh_problem(urdf, problem);
  if (!is_right) {
    leave_out(urdf, "visual");
    return false;
  }
  visual.color = read_color(node);
  APPEND(link->visuals, link->visual_count, visual);
  return true;
}

/* Reads the visuals of a link. If some cannot be drawn, the collisions are drawn instead. */
static void read_visuals(struct RobotFile *urdf, xmlNodePtr node, struct RobotLink *link) {
  bool is_whole = true;
  for (xmlNodePtr child = node->children; child != NULL; child = child->next)
    if (is_element(child, "visual")) is_whole &= read_visual(urdf, child, link);
  if (!is_whole && link->collision_count > 0) link->visual_count = 0;
}

static void read_link(struct RobotFile *urdf, xmlNodePtr node) {
  static const char *const known[] = {"inertial", "visual", "collision", NULL};
  struct RobotLink *link = allocate(1, sizeof *link);
  link->name = required_attribute(urdf, node, "name");
  link->line = line_of(node);
  leave_out_others(urdf, node, known);
  for (xmlNodePtr child = node->children; child != NULL; child = child->next)
    if (is_element(child, "collision")) read_collision(urdf, child, link);
  read_visuals(urdf, node, link);
  xmlNodePtr inertial = child_of(urdf, node, "inertial");
  if (inertial != NULL) read_inertial(urdf, inertial, link);
  add_link(urdf, link);
}

/* True if the joint has several coordinates. */
static bool has_several(const struct RobotJoint *joint) {
  return joint->type == FLOATING || joint->type == PLANAR || joint->type == BALL;
}

static enum RobotJointType read_type(struct RobotFile *urdf, xmlNodePtr node) {
  char *text = required_attribute(urdf, node, "type");
  int type = 0; /* the ball of MJCF is spherical in files of Bullet */
  while (type < BALL && strcmp(text, joint_types[type]) != 0) type++;
  if (type < BALL || strcmp(text, "spherical") == 0) return (enum RobotJointType)type;
  if (*text != '\0')
    report_error(urdf->diagnostics, line_of(node),
                 "type=\"%s\" of <joint> is not known; expected revolute, continuous, prismatic, fixed, floating, "
                 "planar or spherical",
                 text);
  return FIXED;
}

/* Reads the axis and normalizes it; x if the file gives none. */
static void read_axis(struct RobotFile *urdf, xmlNodePtr node, struct RobotJoint *joint) {
  xmlNodePtr axis = child_of(urdf, node, "axis");
  joint->axis[0] = 1;
  read_numbers(urdf, axis, "xyz", 3, joint->axis);
  double length =
      sqrt(joint->axis[0] * joint->axis[0] + joint->axis[1] * joint->axis[1] + joint->axis[2] * joint->axis[2]);
  bool has_axis = joint->type == PLANAR || (joint->type != FIXED && !has_several(joint));
  if (has_axis && !(length > 0 && isfinite(length)))
    report_error(urdf->diagnostics, line_of(axis),
                 "the <axis> of the joint '%s' has the length %g; expected a direction such as 0 0 1", joint->name,
                 length);
  for (int i = 0; i < 3 && length > 0; i++) joint->axis[i] /= length;
}

/* Reads the effort. 0 means no limit, as in MuJoCo: exporters write it if they know none. */
static void read_effort(struct RobotFile *urdf, xmlNodePtr node, struct RobotJoint *joint) {
  xmlNodePtr limit = child_of(urdf, node, "limit");
  joint->effort = NAN;
  if (limit == NULL || !has_attribute(limit, "effort") || joint->type == FIXED) return;
  double effort = number_not_negative(urdf, limit, "effort");
  bool is_limited = urdf->options->is_effort_limited;
  if (is_limited && effort == 0)
    warn_unread(urdf, line_of(limit), "effort=\"0\" of <limit>, which stands for no limit,",
                "the largest force or torque of the motor");
  if (is_limited && effort > 0 && has_several(joint))
    warn_unread(urdf, line_of(limit), "effort of a floating, planar or spherical joint", in_system);
  if (effort > 0) joint->effort = effort;
}

/* Reads the limits. A missing one is 0, as URDF defines; none are set if both are missing. */
static void read_limit(struct RobotFile *urdf, xmlNodePtr node, struct RobotJoint *joint) {
  xmlNodePtr limit = child_of(urdf, node, "limit");
  joint->lower = joint->upper = NAN;
  if (limit != NULL && has_several(joint) && (has_attribute(limit, "lower") || has_attribute(limit, "upper")))
    warn_unread(urdf, line_of(limit), "<limit lower upper> of a floating, planar or spherical joint",
                "a <stop> at each of its coordinates in a <system> that includes the robot");
  if (limit == NULL || (joint->type != REVOLUTE && joint->type != PRISMATIC)) return;
  double lower = 0, upper = 0;
  bool is_given = read_numbers(urdf, limit, "lower", 1, &lower);
  is_given |= read_numbers(urdf, limit, "upper", 1, &upper);
  if (urdf->options->has_stops && is_given && lower == upper)
    report_error(urdf->diagnostics, line_of(limit),
                 "the limits of the joint '%s' are both %g; expected lower below upper, or type=\"fixed\"", joint->name,
                 lower);
  if (has_attribute(limit, "velocity")) leave_out(urdf, "velocity of limit");
  if (lower > upper)
    report_error(urdf->diagnostics, line_of(limit), "lower=\"%g\" of <limit> is above upper=\"%g\"; expected it below",
                 lower, upper);
  if (!is_given) return;
  joint->lower = lower;
  joint->upper = upper;
}

static void read_dynamics(struct RobotFile *urdf, xmlNodePtr node, struct RobotJoint *joint) {
  xmlNodePtr dynamics = child_of(urdf, node, "dynamics");
  if (dynamics == NULL || joint->type == FIXED) return;
  double damping = number_not_negative(urdf, dynamics, "damping");
  double friction = number_not_negative(urdf, dynamics, "friction");
  double stiffness = number_not_negative(urdf, dynamics, "spring_stiffness");
  if (has_several(joint)) {
    if (damping > 0 || friction > 0 || stiffness > 0)
      warn_unread(urdf, line_of(dynamics), "<dynamics> of a floating, planar or spherical joint", in_system);
    return;
  }
  joint->damping = damping;
  joint->friction = friction;
  joint->stiffness = stiffness;
  read_numbers(urdf, dynamics, "spring_reference", 1, &joint->rest);
}

static void read_mimic(struct RobotFile *urdf, xmlNodePtr node, struct RobotJoint *joint) {
  xmlNodePtr mimic = child_of(urdf, node, "mimic");
  joint->multiplier = 1;
  if (mimic == NULL || joint->type == FIXED) return;
  joint->mimicked_name = required_attribute(urdf, mimic, "joint");
  read_numbers(urdf, mimic, "multiplier", 1, &joint->multiplier);
  read_numbers(urdf, mimic, "offset", 1, &joint->offset);
}

static char *read_end(struct RobotFile *urdf, xmlNodePtr joint, const char *name) {
  xmlNodePtr node = required_child_of(urdf, joint, name);
  return node != NULL ? required_attribute(urdf, node, "link") : copy_text("");
}

static void read_joint(struct RobotFile *urdf, xmlNodePtr node) {
  static const char *const known[] = {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic", NULL};
  struct RobotJoint *joint = allocate(1, sizeof *joint);
  joint->name = required_attribute(urdf, node, "name");
  joint->line = line_of(node);
  joint->type = read_type(urdf, node);
  joint->has_motor = true;
  joint->parent_name = read_end(urdf, node, "parent");
  joint->child_name = read_end(urdf, node, "child");
  joint->origin = read_origin(urdf, node);
  read_axis(urdf, node, joint);
  read_effort(urdf, node, joint);
  read_limit(urdf, node, joint);
  read_dynamics(urdf, node, joint);
  read_mimic(urdf, node, joint);
  leave_out_others(urdf, node, known);
  add_joint(urdf, joint);
}

static const struct Attributes attributes[] = {
    {"origin", "xyz rpy", NULL, ALWAYS_ACTS},
    {"axis", "xyz", NULL, ALWAYS_ACTS},
    {"limit", "lower upper effort velocity acceleration drake:acceleration", NULL, ALWAYS_ACTS},
    {"dynamics", "damping friction spring_stiffness spring_reference", NULL, ALWAYS_ACTS},
    {"mimic", "joint multiplier offset", NULL, ALWAYS_ACTS},
    {"mass", "value", NULL, ALWAYS_ACTS},
    {"inertia", "ixx iyy izz ixy ixz iyz", NULL, ALWAYS_ACTS},
    {0},
};

/* Elements of simulators that change the motion, with the equivalent in this language. */
static const struct {
  const char *name;
  enum Condition condition;
  const char *remedy;
} of_simulators[] = {
    {"springStiffness", ALWAYS_ACTS, "spring_stiffness of <dynamics>"},
    {"springReference", ALWAYS_ACTS, "spring_reference of <dynamics>"},
    {"dampingFactor", ALWAYS_ACTS, "a <dissipation> in a <system> that includes the robot"},
    {"turnGravityOff", ALWAYS_ACTS, in_system},
    {"static", ALWAYS_ACTS, "a joint of type fixed"},
    {"rotor_inertia", ALWAYS_ACTS, "a <kinetic> of the joint's velocity in a <system> that includes the robot"},
    {"mu", ACTS_ON_GROUND, "ground_friction of the robot"},
    {"mu1", ACTS_ON_GROUND, "ground_friction of the robot"},
    {"mu2", ACTS_ON_GROUND, "ground_friction of the robot"},
    {"mu_static", ACTS_ON_GROUND, "ground_friction of the robot"},
    {"mu_dynamic", ACTS_ON_GROUND, "ground_friction of the robot"},
    {"lateral_friction", ACTS_ON_GROUND, "ground_friction of the robot"},
    {"contact_coefficients", ACTS_ON_GROUND, "ground_friction of the robot"},
    {"selfCollide", ACTS_BETWEEN_LINKS, "self=\"true\" in an <include>"},
};

static void check_simulators(struct RobotFile *urdf, xmlNodePtr node) {
  for (size_t i = 0; i < sizeof of_simulators / sizeof *of_simulators; i++) {
    if (!is_element(node, of_simulators[i].name) || !condition_holds(urdf->options, of_simulators[i].condition))
      continue;
    const xmlChar *text = node->children != NULL ? node->children->content : NULL;
    if (text == NULL || !requests_nothing((const char *)text))
      warn_unread(urdf, line_of(node), format_text("<%s>", (const char *)node->name), of_simulators[i].remedy);
  }
  for (xmlNodePtr child = node->children; child != NULL; child = child->next)
    if (child->type == XML_ELEMENT_NODE) check_simulators(urdf, child);
}

/* Returns the name of an element of xacro behind its prefix; NULL for other elements. */
static const char *xacro_name(xmlNodePtr node) {
  const char *name = (const char *)node->name, *prefix = node->ns != NULL ? (const char *)node->ns->prefix : NULL;
  if (prefix != NULL) return strcmp(prefix, "xacro") == 0 ? name : NULL;
  return strncmp(name, "xacro:", 6) == 0 ? name + 6 : NULL;
}

/* True if the element of xacro is a definition, which adds nothing to the robot. */
static bool defines_only(const char *name) {
  return strcmp(name, "property") == 0 || strcmp(name, "arg") == 0 || strcmp(name, "macro") == 0;
}

/* Returns the first element or expression of xacro that must be expanded before; NULL for none. */
static xmlNodePtr find_xacro(xmlNodePtr node) {
  if (node->type != XML_ELEMENT_NODE) return NULL;
  const char *name = xacro_name(node);
  if (name != NULL) return defines_only(name) ? NULL : node;
  for (const xmlAttr *given = node->properties; given != NULL; given = given->next)
    for (const xmlNode *text = given->children; text != NULL; text = text->next)
      if (text->content != NULL &&
          (strstr((const char *)text->content, "${") != NULL || strstr((const char *)text->content, "$(") != NULL))
        return node;
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) {
    xmlNodePtr found = find_xacro(child);
    if (found != NULL) return found;
  }
  return NULL;
}

static void report_xacro(struct Diagnostics *diagnostics, xmlNodePtr node) {
  const char *name = xacro_name(node);
  report_error(diagnostics, line_of(node),
               "<%s%s> is of xacro, whose macros and expressions are not expanded here; expected plain URDF, as 'xacro "
               "%s > robot.urdf' writes it",
               name != NULL ? "xacro:" : "", name != NULL ? name : (const char *)node->name,
               file_name(diagnostics->file));
}

struct Robot *urdf_read(xmlNodePtr root, const struct RobotOptions *options, struct Diagnostics *diagnostics) {
  struct RobotFile urdf = {.robot = allocate(1, sizeof *urdf.robot), .options = options, .diagnostics = diagnostics};
  static const char *const known[] = {"link", "joint", "material", NULL};
  xmlNodePtr xacro = find_xacro(root);
  urdf.robot->line = line_of(root);
  urdf.robot->gravity[2] = -9.81;
  urdf.robot->name = attribute(root, "name");
  if (urdf.robot->name == NULL || *urdf.robot->name == '\0') urdf.robot->name = copy_text("robot");
  if (options->keyframe != NULL)
    report_error(
        diagnostics, urdf.robot->line,
        "keyframe=\"%s\" is for MJCF; expected start values by <coordinate name=\"...\" start=\"...\"/> in the "
        "<include>, or such as JOINT=1 on the command line",
        options->keyframe);
  if (xacro != NULL) report_xacro(diagnostics, xacro);
  for (xmlNodePtr node = root->children; node != NULL && xacro == NULL; node = node->next) {
    if (is_element(node, "link")) read_link(&urdf, node);
    else if (is_element(node, "joint")) read_joint(&urdf, node);
  }
  leave_out_others(&urdf, root, known);
  if (xacro == NULL) {
    check_attributes(&urdf, root, attributes);
    check_simulators(&urdf, root);
  }
  report_left_out(&urdf);
  return urdf.robot;
}

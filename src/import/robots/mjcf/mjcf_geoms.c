#include "robots/mjcf/mjcf_sections.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "robots/mjcf/mjcf_contacts.h"
#include "robots/mjcf/values/mjcf_tree.h"
#include "robots/mjcf/mjcf_meshes.h"
#include "xml/nodes.h"

static const double usual_density = 1000; /* kg/m3, MuJoCo's default */

enum GeomType { SPHERE, CAPSULE, CYLINDER, BOX, ELLIPSOID, PLANE, MESH, HEIGHT_FIELD, DISTANCES, GEOM_TYPES };
static const char *const geom_types[GEOM_TYPES + 1] = {"sphere", "capsule", "cylinder", "box", "ellipsoid",
                                                       "plane",  "mesh",    "hfield",   "sdf", NULL};

/* size: radius and half length of a capsule or cylinder; half extent along each axis of others. */
struct Geom {
  enum GeomType type;
  struct Placement placement;
  double size[3];
  const struct MjcfMesh *mesh; /* NULL for other types */
};

/* Places a geom along z between the points of `fromto`. Boxes and ellipsoids get equal widths in x and y. */
static void place_between(struct Mjcf *mjcf, xmlNodePtr node, struct Geom *geom) {
  double ends[6], along[3];
  if (mjcf_numbers(mjcf, node, "fromto", 6, 6, ends) == 0) return;
  for (int i = 0; i < 3; i++) {
    geom->placement.translation[i] = (ends[i] + ends[i + 3]) / 2;
    along[i] = ends[i] - ends[i + 3];
  }
  double length = make_unit(along);
  bool is_round = geom->type == CAPSULE || geom->type == CYLINDER;
  if (!(length > 0) || (!is_round && geom->type != BOX && geom->type != ELLIPSOID)) {
    mjcf_error(
        mjcf, node,
        "fromto of a <geom> is not valid; expected two different points, of a capsule, cylinder, box or ellipsoid");
    return;
  }
  geom->placement.rotation = rotation_of_z(along);
  geom->size[is_round ? 1 : 2] = length / 2;
  if (!is_round) geom->size[1] = geom->size[0];
}

/* Sets the principal axes of a body, and its moments about them in descending order, as MuJoCo does. */
static void sorted_axes(const struct RigidBody *body, struct Matrix3 *sorted, double moments[3]) {
  struct Matrix3 axes;
  principal_axes(&body->tensor, &axes);
  struct Matrix3 along = tensor_along(body, &axes);
  int order[3] = {0, 1, 2};
  for (int i = 0; i < 3; i++)
    for (int j = 2; j > i; j--)
      if (along.at[order[j]][order[j]] > along.at[order[j - 1]][order[j - 1]]) {
        int moved = order[j];
        order[j] = order[j - 1];
        order[j - 1] = moved;
      }
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    moments[i] = along.at[order[i]][order[i]];
    sorted->at[i][0] = axes.at[i][order[0]];
    sorted->at[i][1] = axes.at[i][order[1]];
    sorted->at[i][2] = axes.at[j][order[0]] * axes.at[k][order[1]] - axes.at[k][order[0]] * axes.at[j][order[1]];
  }
}

/*
 * Fits the size and the placement of a shape to a mesh, as MuJoCo does without fitaabb. The shape has the means of the
 * sides of the box with the mass and the moments of the mesh. The longest side of the box is along z.
 */
static void fit_to_mesh(struct Mjcf *mjcf, xmlNodePtr node, const struct MjcfMesh *mesh, struct Geom *geom) {
  const struct RigidBody *body = &mesh->body;
  double moments[3], box[3], *size = geom->size, scale = mjcf_number(mjcf, node, "fitscale", 1);
  struct Placement placement;
  if (mjcf_compiler(mjcf, node)->fits_bounds)
    mjcf_error(mjcf, node,
               "a <geom> of type %s is fitted to a mesh by fitaabb=\"true\", which is not read; expected its size, or "
               "fitaabb=\"false\"",
               geom_types[geom->type]);
  sorted_axes(body, &placement.rotation, moments);
  memcpy(placement.translation, body->center, sizeof placement.translation);
  geom->placement = placement_within(&geom->placement, &placement);
  for (int i = 0; i < 3; i++)
    box[i] = scale * sqrt(fmax(0, 6 * (moments[(i + 1) % 3] + moments[(i + 2) % 3] - moments[i]) / body->mass)) / 2;
  memcpy(size, box, sizeof box);
  if (geom->type == SPHERE) size[0] = (box[0] + box[1] + box[2]) / 3;
  if (geom->type == CAPSULE || geom->type == CYLINDER) {
    size[0] = (box[0] + box[1]) / 2;
    size[1] = geom->type == CAPSULE ? fmax(0, box[2] - size[0] / 2) : box[2];
  }
}

/* Reads a geom and reports sizes that are missing or not positive. */
static struct Geom read_geom(struct Mjcf *mjcf, xmlNodePtr node) {
  static const int needed[GEOM_TYPES] = {[SPHERE] = 1, [CAPSULE] = 2, [CYLINDER] = 2, [BOX] = 3, [ELLIPSOID] = 3};
  struct Geom geom = {.type = (enum GeomType)mjcf_word(mjcf, node, "type", geom_types)};
  const char *mesh = mjcf_text(mjcf, node, "mesh");
  const struct MjcfMesh *found = mesh != NULL ? mjcf_mesh(mjcf, node, mesh) : NULL;
  bool fits = found != NULL && found->is_weighed && needed[geom.type] > 0;
  geom.placement = mjcf_placement(mjcf, node);
  int errors = mjcf->file.diagnostics->errors;
  if (fits) fit_to_mesh(mjcf, node, found, &geom);
  if (fits) return geom;
  if (found != NULL) geom.mesh = found;
  if (mesh != NULL) geom.type = MESH;
  if (needed[geom.type] > 0) mjcf_numbers(mjcf, node, "size", 1, 3, geom.size);
  place_between(mjcf, node, &geom);
  for (int i = 0; i < needed[geom.type] && mjcf->file.diagnostics->errors == errors; i++)
    if (!(geom.size[i] > 0))
      mjcf_error(mjcf, node, "a <geom> of type %s has a size of %g; expected %d above 0", geom_types[geom.type],
                 geom.size[i], needed[geom.type]);
  return geom;
}

static double volume(const struct Geom *geom) {
  const double *s = geom->size;
  switch (geom->type) {
  case SPHERE: return 4 * M_PI / 3 * s[0] * s[0] * s[0];
  case CAPSULE: return M_PI * s[0] * s[0] * (4 * s[0] / 3 + 2 * s[1]);
  case CYLINDER: return M_PI * s[0] * s[0] * 2 * s[1];
  case BOX: return 8 * s[0] * s[1] * s[2];
  case ELLIPSOID: return 4 * M_PI / 3 * s[0] * s[1] * s[2];
  default: return 0;
  }
}

/*
 * Sets the principal moments of a solid capsule: a cylinder, and two hemispheres, whose centres of mass are 3/8 of the
 * radius beyond its ends.
 */
static void capsule_moments(double mass, const double *size, double moments[3]) {
  double r = size[0], h = size[1], ball = mass * (4 * r / 3) / (4 * r / 3 + 2 * h), rod = mass - ball;
  moments[2] = rod * r * r / 2 + 2 * ball * r * r / 5;
  moments[0] = moments[1] = rod * (3 * r * r + 4 * h * h) / 12 + ball * (2 * r * r / 5 + h * h + 3 * h * r / 4);
}

static struct RigidBody solid(const struct Geom *geom, double mass) {
  const double *s = geom->size;
  double moments[3] = {0};
  if (geom->type == CAPSULE) capsule_moments(mass, s, moments);
  for (int i = 0; i < 3; i++) {
    double a = s[(i + 1) % 3], b = s[(i + 2) % 3];
    if (geom->type == SPHERE) moments[i] = 2 * mass * s[0] * s[0] / 5;
    else if (geom->type == BOX) moments[i] = mass * (a * a + b * b) / 3;
    else if (geom->type == ELLIPSOID) moments[i] = mass * (a * a + b * b) / 5;
    else if (geom->type == CYLINDER)
      moments[i] = i == 2 ? mass * s[0] * s[0] / 2 : mass * (3 * s[0] * s[0] + 4 * s[1] * s[1]) / 12;
  }
  struct RigidBody body = {.mass = mass};
  for (int i = 0; i < 3; i++) body.tensor.at[i][i] = moments[i];
  return body_seen_from(&geom->placement, &body);
}

/* Returns the inertia of a geom. Reports geoms with a mass whose shape is not supported. */
static struct RigidBody weigh(struct Mjcf *mjcf, xmlNodePtr node, const struct Geom *geom) {
  bool has_mass = mjcf_text(mjcf, node, "mass") != NULL;
  double density = mjcf_number_not_negative(mjcf, node, "density", usual_density);
  double mass = has_mass ? mjcf_number_not_negative(mjcf, node, "mass", 0) : density * volume(geom);
  bool is_solid = geom->type <= ELLIPSOID, has_problem = geom->mesh != NULL && geom->mesh->problem != NULL;
  mjcf_reject(mjcf, node, "shellinertia");
  if (fluid_acts(&mjcf->file.robot->fluid) && mjcf_is(mjcf, node, "fluidshape", "ellipsoid"))
    mjcf_error(mjcf, node,
               "fluidshape=\"ellipsoid\" of <geom> is not read; expected none, for the fluid's forces on a box");
  if (geom->mesh != NULL && geom->mesh->is_weighed) {
    struct RigidBody body = body_scaled(&geom->mesh->body, has_mass ? mass / geom->mesh->body.mass : density);
    return body_seen_from(&geom->placement, &body);
  }
  if (!is_solid && geom->type != PLANE && (has_mass ? mass : density) > 0)
    mjcf_error(mjcf, node,
               "the inertia of a <geom> of type %s is not known%s%s; expected an <inertial> in its body, as MuJoCo's "
               "mj_saveLastXML writes it, or mass=\"0\"",
               geom_types[geom->type], has_problem ? ": " : "", has_problem ? geom->mesh->problem : "");
  return is_solid ? solid(geom, mass) : (struct RigidBody){.mass = 0};
}

/* Returns the color of the geom or of its material; NULL for none. */
static char *read_color(struct Mjcf *mjcf, xmlNodePtr node) {
  const char *name = mjcf_text(mjcf, node, "material");
  double rgba[4];
  if (mjcf_numbers(mjcf, node, "rgba", 4, 4, rgba) > 0) return color_text(rgba);
  for (xmlNodePtr section = mjcf->root->children; section != NULL && name != NULL; section = section->next)
    for (xmlNodePtr asset = is_element(section, "asset") ? section->children : NULL; asset != NULL; asset = asset->next)
      if (is_element(asset, "material") && attribute_is(asset, "name", name) &&
          mjcf_numbers(mjcf, asset, "rgba", 4, 4, rgba) > 0)
        return color_text(rgba);
  return NULL;
}

/* Returns why the geom cannot be a shape; NULL if it can. */
static const char *problem_of(const struct Geom *geom, bool touches) {
  if (geom->type <= ELLIPSOID) return NULL;
  if (geom->type == HEIGHT_FIELD) return "expected a plane or boxes";
  if (geom->type != MESH || geom->mesh == NULL) return "expected a sphere, capsule, cylinder, box, ellipsoid or mesh";
  if (touches && geom->mesh->problem == NULL && geom->mesh->is_flat) return "its mesh is flat; expected a volume";
  return geom->mesh->problem;
}

static struct Collision shape_of(const struct Geom *geom, long line) {
  struct Collision shape = {.type = geom_types[geom->type], .placement = geom->placement, .line = line};
  if (geom->type == MESH) {
    shape.file = geom->mesh->path;
    memcpy(shape.scale, geom->mesh->scale, sizeof shape.scale);
  } else if (geom->type == BOX || geom->type == ELLIPSOID)
    for (int i = 0; i < 3; i++) shape.size[i] = 2 * geom->size[i];
  else shape.radius = geom->size[0];
  if (geom->type == CAPSULE || geom->type == CYLINDER) shape.length = 2 * geom->size[1];
  return shape;
}

/* Adds a shape to those that can touch. */
static void add_collision(struct Mjcf *mjcf, const struct MjcfContact *contact, struct RobotLink *link,
                          struct Collision *shape) {
  mjcf_note_contact(mjcf, contact, link);
  APPEND(link->collisions, link->collision_count, *shape);
}

/* Makes the first plane that does not move the ground, and others shapes. Planes of moving bodies touch nothing. */
static void add_plane(struct Mjcf *mjcf, const struct MjcfContact *contact, const struct Geom *geom,
                      struct RobotLink *link) {
  struct Robot *robot = mjcf->file.robot;
  bool is_fixed = mjcf_is_static(contact);
  if (is_fixed && robot->ground == NULL) {
    robot->ground = allocate(1, sizeof *robot->ground);
    robot->ground->placement = placement_within(mjcf_placement_of(mjcf, link->name), &geom->placement);
    mjcf->ground = *contact;
  } else if (is_fixed) {
    struct Collision shape = {.type = "plane", .placement = geom->placement, .line = line_of(contact->node)};
    add_collision(mjcf, contact, link, &shape);
  } else if (mjcf->file.options->has_ground)
    report_warning(mjcf->file.diagnostics, line_of(contact->node),
                   "a <geom> of type plane of the body '%s' touches nothing; expected it in a body that does not move",
                   link->name);
}

/* Adds a geom that can touch to the collisions, any other to the visuals. */
static void add_shape(struct Mjcf *mjcf, xmlNodePtr node, const struct Geom *geom, struct RobotLink *link) {
  struct MjcfContact contact = mjcf_contact(mjcf, node);
  bool touches = mjcf_may_collide(mjcf, &contact);
  bool meets_ground = touches && link_touches_ground(mjcf->file.options, link->name);
  const char *problem = problem_of(geom, meets_ground);
  if (geom->type == PLANE) {
    if (touches) add_plane(mjcf, &contact, geom, link);
    return;
  }
  bool may_stand = geom->type != MESH && touches && !mjcf->file.options->says_ground;
  if (problem != NULL && (meets_ground || may_stand))
    note_untouched(&mjcf->file, line_of(node),
                   format_text("a <geom> of type %s of the body '%s' touches nothing: %s", geom_types[geom->type],
                               link->name, problem));
  else if (problem != NULL && geom->type == MESH && geom->mesh != NULL)
    note_mesh_problem(&mjcf->file, geom->mesh->problem);
  else if (problem != NULL)
    leave_out(&mjcf->file, "geoms other than sphere, capsule, cylinder, box, ellipsoid and mesh");
  if (problem != NULL) return;
  struct Collision shape = shape_of(geom, line_of(node));
  shape.color = read_color(mjcf, node);
  if (touches) add_collision(mjcf, &contact, link, &shape);
  else APPEND(link->visuals, link->visual_count, shape);
}

static void read_inertial(struct Mjcf *mjcf, xmlNodePtr node, struct RobotLink *link) {
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  struct Placement placement = mjcf_placement(mjcf, node);
  struct RigidBody body = {.mass = mjcf_number_not_negative(mjcf, node, "mass", 0)};
  double moments[6] = {0};
  bool is_full = mjcf_numbers(mjcf, node, "fullinertia", 6, 6, moments) > 0;
  if (!is_full) mjcf_numbers(mjcf, node, "diaginertia", 3, 3, moments);
  else if (has_attribute(node, "diaginertia"))
    mjcf_error(mjcf, node, "<inertial> has diaginertia and fullinertia; expected one of them");
  required_attribute(&mjcf->file, node, "mass");
  for (int i = 0; i < 6; i++) body.tensor.at[row[i]][column[i]] = body.tensor.at[column[i]][row[i]] = moments[i];
  link->body = body_seen_from(&placement, &body);
  link->has_axes = !is_full;
  link->axes = placement.rotation;
}

/* Reads the geoms of a body, and those in its <frame>s, which transform them. groups: that have a mass; NULL for none. */
static void read_geoms(struct Mjcf *mjcf, xmlNodePtr node, const struct Placement *outer, const double *groups,
                       struct RobotLink *link) {
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) {
    if (is_element(child, "frame")) {
      struct Placement inner = mjcf_placement(mjcf, child);
      inner = placement_within(outer, &inner);
      read_geoms(mjcf, child, &inner, groups, link);
    }
    if (!is_element(child, "geom")) continue;
    struct Geom geom = read_geom(mjcf, child);
    geom.placement = placement_within(outer, &geom.placement);
    double group = mjcf_number(mjcf, child, "group", 0);
    if (groups != NULL && group >= groups[0] && group <= groups[1]) {
      struct RigidBody part = weigh(mjcf, child, &geom);
      link->has_axes = !body_has_inertia(&link->body) && geom.mesh == NULL;
      link->axes = geom.placement.rotation;
      link->body = body_joined(&link->body, &part);
    }
    add_shape(mjcf, child, &geom, link);
  }
}

/*
 * Raises the mass and the principal moments of a body to the least ones of its file, and balances impossible ones. In
 * MuJoCo the centre of mass of a body without inertia is displaced from its origin by its own pos.
 */
static void bound_inertia(struct Mjcf *mjcf, xmlNodePtr node, struct RobotLink *link) {
  const struct MjcfCompiler *compiler = mjcf_compiler(mjcf, node);
  struct RigidBody *body = &link->body;
  if (!body_has_inertia(body)) mjcf_numbers(mjcf, node, "pos", 3, 3, body->center);
  if (!link->has_axes) principal_axes(&body->tensor, &link->axes);
  link->has_axes = true;
  struct Matrix3 tensor = tensor_along(body, &link->axes), bounded = {{{0}}};
  double moments[3], sum = 0;
  bool is_possible = true;
  for (int i = 0; i < 3; i++) moments[i] = fmax(tensor.at[i][i], compiler->least_moment);
  for (int i = 0; i < 3; i++) sum += moments[i];
  for (int i = 0; i < 3; i++) is_possible &= 2 * moments[i] <= sum;
  for (int i = 0; i < 3; i++) bounded.at[i][i] = compiler->balances_moments && !is_possible ? sum / 3 : moments[i];
  struct Placement turn = {.rotation = link->axes};
  struct RigidBody along = {.tensor = bounded};
  body->tensor = body_seen_from(&turn, &along).tensor;
  body->mass = fmax(body->mass, compiler->least_mass);
}

void mjcf_read_body(struct Mjcf *mjcf, xmlNodePtr node, struct RobotLink *link) {
  bool is_world = is_element(node, "worldbody");
  xmlNodePtr inertial = child_of(&mjcf->file, node, "inertial");
  const struct MjcfCompiler *compiler = mjcf_compiler(mjcf, node);
  bool has_own = inertial != NULL && compiler->inertia_from_geoms != ALWAYS,
       weighs = !is_world && !has_own && compiler->inertia_from_geoms != NEVER;
  if (has_own) read_inertial(mjcf, inertial, link);
  read_geoms(mjcf, node, &no_displacement, weighs ? compiler->inertia_groups : NULL, link);
  bool is_bounded = compiler->least_mass > 0 || compiler->least_moment > 0 || compiler->balances_moments;
  if (!is_world && is_bounded) bound_inertia(mjcf, node, link);
}

#include "read/robots/mjcf/mjcf_geoms.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "read/xml/nodes.h"

static const double usual_density = 1000; /* kg/m3 */

enum GeomType { SPHERE, CAPSULE, CYLINDER, BOX, ELLIPSOID, PLANE, MESH, HEIGHT_FIELD, DISTANCES, GEOM_TYPES };
static const char *const geom_types[GEOM_TYPES + 1] = {"sphere", "capsule", "cylinder", "box", "ellipsoid",
                                                       "plane",  "mesh",    "hfield",   "sdf", NULL};

/* Of a capsule and a cylinder the radius and half of the length; else half of the extent along each axis. */
struct Geom {
  enum GeomType type;
  struct Placement place;
  double size[3];
};

/* Between two points, along z; boxes and ellipsoids are as wide in both directions. */
static void place_between(struct Mjcf *mjcf, xmlNodePtr node, struct Geom *geom) {
  double ends[6], along[3];
  if (mjcf_numbers(mjcf, node, "fromto", 6, 6, ends) == 0) return;
  for (int i = 0; i < 3; i++) {
    geom->place.translation[i] = (ends[i] + ends[i + 3]) / 2;
    along[i] = ends[i] - ends[i + 3];
  }
  double length = make_unit(along);
  bool is_round = geom->type == CAPSULE || geom->type == CYLINDER;
  if (!(length > 0) || (!is_round && geom->type != BOX && geom->type != ELLIPSOID)) {
    report_error(mjcf->file.diagnostics, xmlGetLineNo(node),
                 "fromto of a <geom> gives no place; expected two points, of a capsule, cylinder, box or ellipsoid");
    return;
  }
  geom->place.rotation = rotation_of_z(along);
  geom->size[is_round ? 1 : 2] = length / 2;
  if (!is_round) geom->size[1] = geom->size[0];
}

/* Reports sizes that are missing, or not above 0. */
static struct Geom read_geom(struct Mjcf *mjcf, xmlNodePtr node) {
  static const int needed[GEOM_TYPES] = {[SPHERE] = 1, [CAPSULE] = 2, [CYLINDER] = 2, [BOX] = 3, [ELLIPSOID] = 3};
  struct Geom geom = {.type = (enum GeomType)mjcf_word(mjcf, node, "type", geom_types)};
  if (mjcf_text(mjcf, node, "mesh") != NULL) geom.type = MESH;
  geom.place = mjcf_placement(mjcf, node);
  int errors = mjcf->file.diagnostics->errors;
  if (needed[geom.type] > 0) mjcf_numbers(mjcf, node, "size", 1, 3, geom.size);
  place_between(mjcf, node, &geom);
  for (int i = 0; i < needed[geom.type] && mjcf->file.diagnostics->errors == errors; i++)
    if (!(geom.size[i] > 0))
      report_error(mjcf->file.diagnostics, xmlGetLineNo(node),
                   "a <geom> of type %s has a size of %g; expected %d above 0", geom_types[geom.type], geom.size[i],
                   needed[geom.type]);
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

/* Of a solid capsule: a cylinder, and two halves of a sphere whose centres of mass are 3/8 of the radius beyond its ends. */
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
  return body_seen_from(&geom->place, &body);
}

/* What the geom adds to the body's inertia; reports what has a mass and no shape here. */
static struct RigidBody weigh(struct Mjcf *mjcf, xmlNodePtr node, const struct Geom *geom) {
  bool has_mass = mjcf_text(mjcf, node, "mass") != NULL;
  double density = mjcf_number_not_negative(mjcf, node, "density", usual_density);
  double mass = has_mass ? mjcf_number_not_negative(mjcf, node, "mass", 0) : density * volume(geom);
  bool is_solid = geom->type <= ELLIPSOID;
  mjcf_refuse(mjcf, node, "shellinertia");
  if (!is_solid && geom->type != PLANE && (has_mass ? mass : density) > 0)
    report_error(mjcf->file.diagnostics, xmlGetLineNo(node),
                 "the inertia of a <geom> of type %s is not known; expected an <inertial> in its body, as MuJoCo's "
                 "mj_saveLastXML writes it, or mass=\"0\"",
                 geom_types[geom->type]);
  return is_solid ? solid(geom, mass) : (struct RigidBody){.mass = 0};
}

/* As a shape, unless nothing can touch it. */
static void add_collision(struct Mjcf *mjcf, xmlNodePtr node, const struct Geom *geom, struct Link *link) {
  bool touches = mjcf_number(mjcf, node, "contype", 1) != 0 || mjcf_number(mjcf, node, "conaffinity", 1) != 0;
  if (!touches || geom->type == PLANE) return;
  struct Collision collision = {
      .type = geom_types[geom->type], .place = geom->place, .line = xmlGetLineNo(node), .radius = geom->size[0]};
  if (geom->type > BOX) {
    if (!link_touches_ground(mjcf->file.options, link->name))
      leave_out(&mjcf->file, "geoms other than sphere, capsule, cylinder and box");
    else
      report_warning(
          mjcf->file.diagnostics, collision.line,
          "a <geom> of type %s of the body '%s' touches nothing; expected a sphere, capsule, cylinder or box",
          geom_types[geom->type], link->name);
    return;
  }
  if (geom->type == BOX) {
    collision.radius = 0;
    for (int i = 0; i < 3; i++) collision.size[i] = 2 * geom->size[i];
  } else if (geom->type != SPHERE) collision.length = 2 * geom->size[1];
  link->collisions = make_room(link->collisions, link->collision_count, sizeof *link->collisions);
  link->collisions[link->collision_count++] = collision;
}

static void read_inertial(struct Mjcf *mjcf, xmlNodePtr node, struct Link *link) {
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  struct Placement place = mjcf_placement(mjcf, node);
  struct RigidBody body = {.mass = mjcf_number_not_negative(mjcf, node, "mass", 0)};
  double moments[6] = {0};
  bool is_full = mjcf_numbers(mjcf, node, "fullinertia", 6, 6, moments) > 0;
  if (!is_full) mjcf_numbers(mjcf, node, "diaginertia", 3, 3, moments);
  else if (has_attribute(node, "diaginertia"))
    report_error(mjcf->file.diagnostics, xmlGetLineNo(node),
                 "<inertial> has diaginertia and fullinertia; expected one of them");
  required_attribute(&mjcf->file, node, "mass");
  for (int i = 0; i < 6; i++) body.tensor.at[row[i]][column[i]] = body.tensor.at[column[i]][row[i]] = moments[i];
  link->body = body_seen_from(&place, &body);
}

/* Of the body itself and of the <frame>s in it, in which geoms are placed. */
static void read_geoms(struct Mjcf *mjcf, xmlNodePtr node, const struct Placement *outer, bool weighs,
                       struct Link *link) {
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) {
    if (is_element(child, "frame")) {
      struct Placement inner = mjcf_placement(mjcf, child);
      inner = placement_within(outer, &inner);
      read_geoms(mjcf, child, &inner, weighs, link);
    }
    if (!is_element(child, "geom")) continue;
    struct Geom geom = read_geom(mjcf, child);
    geom.place = placement_within(outer, &geom.place);
    if (weighs) {
      struct RigidBody part = weigh(mjcf, child, &geom);
      link->body = body_joined(&link->body, &part);
    }
    add_collision(mjcf, child, &geom, link);
  }
}

void mjcf_read_body(struct Mjcf *mjcf, xmlNodePtr node, struct Link *link) {
  bool is_world = is_element(node, "worldbody");
  xmlNodePtr inertial = child_of(&mjcf->file, node, "inertial");
  bool has_own = inertial != NULL && mjcf->inertia_from_geoms != ALWAYS;
  if (has_own) read_inertial(mjcf, inertial, link);
  read_geoms(mjcf, node, &no_displacement, !is_world && !has_own && mjcf->inertia_from_geoms != NEVER, link);
}

#include "read/robots/mjcf/mjcf_contacts.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "read/robots/mjcf/mjcf_tree.h"
#include "read/xml/nodes.h"

struct MjcfContact mjcf_contact(struct Mjcf *mjcf, xmlNodePtr node) {
  double friction[3] = {1};
  mjcf_numbers(mjcf, node, "friction", 1, 3, friction);
  struct MjcfContact contact = {.node = node,
                                .friction = friction[0],
                                .dimensions = mjcf_number(mjcf, node, "condim", 3),
                                .priority = mjcf_number(mjcf, node, "priority", 0),
                                .type = (unsigned)(long)mjcf_number(mjcf, node, "contype", 1),
                                .affinity = (unsigned)(long)mjcf_number(mjcf, node, "conaffinity", 1)};
  if (contact.friction < 0)
    report_error(mjcf->file.diagnostics, xmlGetLineNo(node), "friction=\"%g\" of <%s> is negative; expected 0 or more",
                 contact.friction, (const char *)node->name);
  double d = contact.dimensions;
  if (d != 1 && d != 3 && d != 4 && d != 6)
    report_error(mjcf->file.diagnostics, xmlGetLineNo(node), "condim=\"%g\" of <%s>; expected 1, 3, 4 or 6", d,
                 (const char *)node->name);
  return contact;
}

/* The body of an element: the <body> or <worldbody> around its <frame>s. */
static xmlNodePtr body_around(xmlNodePtr node) {
  while (is_element(node->parent, "frame")) node = node->parent;
  return node->parent;
}

static bool is_body_named(xmlNodePtr body, const char *name) {
  return is_element(body, "worldbody") ? strcmp(name, mjcf_world) == 0 : attribute_is(body, "name", name);
}

/* An element of <contact> in which the two attributes say this of the two, in either order; NULL for none. */
static xmlNodePtr find_contact(const struct Mjcf *mjcf, const char *kind, const char *const names[2], xmlNodePtr first,
                               xmlNodePtr second, bool (*is_named)(xmlNodePtr node, const char *name)) {
  for (xmlNodePtr section = mjcf->root->children; section != NULL; section = section->next)
    for (xmlNodePtr node = is_element(section, "contact") ? section->children : NULL; node != NULL; node = node->next) {
      if (!is_element(node, kind) || !has_attribute(node, names[0]) || !has_attribute(node, names[1])) continue;
      const char *a = attribute(node, names[0]), *b = attribute(node, names[1]);
      if ((is_named(first, a) && is_named(second, b)) || (is_named(first, b) && is_named(second, a))) return node;
    }
  return NULL;
}

static bool is_excluded(const struct Mjcf *mjcf, xmlNodePtr first, xmlNodePtr second) {
  static const char *const names[2] = {"body1", "body2"};
  return find_contact(mjcf, "exclude", names, first, second, is_body_named) != NULL;
}

static bool is_geom_named(xmlNodePtr geom, const char *name) {
  return attribute_is(geom, "name", name);
}

static xmlNodePtr find_pair(const struct Mjcf *mjcf, const struct MjcfContact *first,
                            const struct MjcfContact *second) {
  static const char *const names[2] = {"geom1", "geom2"};
  return find_contact(mjcf, "pair", names, first->node, second->node, is_geom_named);
}

/* True if a <pair> names the geom. */
static bool is_in_pair(const struct Mjcf *mjcf, xmlNodePtr geom) {
  const char *name = attribute(geom, "name");
  for (xmlNodePtr section = mjcf->root->children; section != NULL && name != NULL; section = section->next)
    for (xmlNodePtr node = is_element(section, "contact") ? section->children : NULL; node != NULL; node = node->next)
      if (is_element(node, "pair") && (attribute_is(node, "geom1", name) || attribute_is(node, "geom2", name)))
        return true;
  return false;
}

bool mjcf_touches(const struct Mjcf *mjcf, const struct MjcfContact *contact) {
  return contact->type != 0 || contact->affinity != 0 || is_in_pair(mjcf, contact->node);
}

static bool masks_meet(const struct MjcfContact *first, const struct MjcfContact *second) {
  return (first->type & second->affinity) != 0 || (second->type & first->affinity) != 0;
}

/* Friction and dimensions of two geoms: those of the higher priority, or else the larger ones. */
static struct MjcfContact combined(const struct MjcfContact *first, const struct MjcfContact *second) {
  if (first->priority != second->priority) return first->priority > second->priority ? *first : *second;
  struct MjcfContact contact = *first;
  contact.friction = fmax(first->friction, second->friction);
  contact.dimensions = fmax(first->dimensions, second->dimensions);
  return contact;
}

/* With the file's plane, where it has one; else as the geom says. */
static void meet_ground(struct Mjcf *mjcf, struct MjcfContact contact, struct Collision *shape) {
  const struct MjcfContact *ground = mjcf->ground.node != NULL ? &mjcf->ground : NULL;
  long line = xmlGetLineNo(contact.node);
  xmlNodePtr pair = ground != NULL ? find_pair(mjcf, ground, &contact) : NULL;
  shape->is_clear = mjcf->has_no_contacts;
  if (ground != NULL && pair == NULL)
    shape->is_clear |=
        !masks_meet(ground, &contact) || is_excluded(mjcf, body_around(ground->node), body_around(contact.node));
  if (ground != NULL) contact = combined(ground, &contact);
  if (pair != NULL) {
    double friction[5] = {contact.friction};
    mjcf_numbers(mjcf, pair, "friction", 1, 5, friction);
    contact.friction = friction[0];
    contact.dimensions = mjcf_number(mjcf, pair, "condim", contact.dimensions);
  }
  shape->friction = contact.dimensions == 1 ? 0 : contact.friction;
  if (contact.dimensions > 3 && !shape->is_clear)
    warn_unread(&mjcf->file, line,
                format_text("the torsional%s friction of condim=\"%g\"", contact.dimensions == 6 ? " and rolling" : "",
                            contact.dimensions),
                "condim=\"3\", or a <force> against the spin in a <system> that includes the robot");
}

void mjcf_set_contact(struct Mjcf *mjcf, const struct MjcfContact *contact, struct Collision *shape) {
  if (mjcf->file.options->has_ground) meet_ground(mjcf, *contact, shape);
  mjcf->contacts = make_room(mjcf->contacts, mjcf->contact_count, sizeof *mjcf->contacts);
  mjcf->contacts[mjcf->contact_count++] = *contact;
}

static bool has_joint(xmlNodePtr body) {
  xmlNodePtr node = body->children;
  while (node != NULL && !is_element(node, "joint") && !is_element(node, "freejoint")) node = node->next;
  return node != NULL;
}

/* The next body outwards, itself included, that has a joint; else the <worldbody>. */
static xmlNodePtr moving_body(xmlNodePtr body) {
  while (!is_element(body, "worldbody") && !has_joint(body)) body = body_around(body);
  return body;
}

static bool is_static(const struct MjcfContact *contact) {
  return is_element(moving_body(body_around(contact->node)), "worldbody");
}

/* A body does not touch the one that carries it, unless that stands. */
static bool carries(const struct Mjcf *mjcf, xmlNodePtr carrier, xmlNodePtr body) {
  return !mjcf->touches_parents && !is_element(carrier, "worldbody") && !is_element(body, "worldbody") &&
         moving_body(body_around(body)) == carrier;
}

/* True if MuJoCo lets the two touch. */
static bool may_meet(const struct Mjcf *mjcf, const struct MjcfContact *first, const struct MjcfContact *second) {
  xmlNodePtr bodies[2] = {body_around(first->node), body_around(second->node)};
  xmlNodePtr moving[2] = {moving_body(bodies[0]), moving_body(bodies[1])};
  if (find_pair(mjcf, first, second) != NULL) return true;
  return moving[0] != moving[1] && masks_meet(first, second) && !carries(mjcf, moving[0], moving[1]) &&
         !carries(mjcf, moving[1], moving[0]) && !is_excluded(mjcf, bodies[0], bodies[1]);
}

static char *name_of(xmlNodePtr node) {
  if (is_element(node, "worldbody")) return copy_text("the world");
  return has_attribute(node, "name") ? format_text("the %s '%s'", (const char *)node->name, attribute(node, "name"))
                                     : format_text("the %s on line %ld", (const char *)node->name, xmlGetLineNo(node));
}

/* Warns of the first of several shapes that touch in MuJoCo alone. */
static void warn_of_pair(struct Mjcf *mjcf, const struct MjcfContact *first, const struct MjcfContact *second,
                         size_t count) {
  const char *others = count > 1 ? format_text(", and %zu other such pair%s", count - 1, count > 2 ? "s" : "") : "";
  report_warning(mjcf->file.diagnostics, xmlGetLineNo(first->node),
                 "%s of %s does not touch %s of %s%s, unlike in MuJoCo; expected a <contact between=\"...\" "
                 "and=\"...\"> of shapes that may meet, in a <system> that includes the robot",
                 name_of(first->node), name_of(body_around(first->node)), name_of(second->node),
                 name_of(body_around(second->node)), others);
}

/* Warns of shapes that may meet: one of the two stands, or none. */
static void check_pairs(struct Mjcf *mjcf, bool with_static) {
  const struct MjcfContact *found[2] = {NULL};
  size_t count = 0;
  for (size_t i = 0; i < mjcf->contact_count; i++)
    for (size_t j = 0; j < mjcf->contact_count; j++) {
      const struct MjcfContact *first = &mjcf->contacts[i], *second = &mjcf->contacts[j];
      bool is_wanted =
          with_static ? is_static(first) && !is_static(second) : i < j && !is_static(first) && !is_static(second);
      if (!is_wanted || !may_meet(mjcf, first, second)) continue;
      if (count++ > 0) continue;
      found[0] = first;
      found[1] = second;
    }
  if (count > 0) warn_of_pair(mjcf, found[0], found[1], count);
}

/* Warns of a plane on which the <include> lets nothing stand, without saying so. */
static void check_ground(struct Mjcf *mjcf) {
  bool is_met = false;
  if (mjcf->ground.node == NULL || mjcf->file.options->says_ground) return;
  for (size_t i = 0; i < mjcf->contact_count; i++)
    is_met |= !is_static(&mjcf->contacts[i]) && may_meet(mjcf, &mjcf->ground, &mjcf->contacts[i]);
  if (is_met)
    report_warning(
        mjcf->file.diagnostics, xmlGetLineNo(mjcf->ground.node),
        "nothing stands on %s; expected ground=\"true\" in an <include>, or ground=\"false\" if this is meant",
        name_of(mjcf->ground.node));
}

void mjcf_check_contacts(struct Mjcf *mjcf) {
  const struct RobotOptions *options = mjcf->file.options;
  if (mjcf->has_no_contacts && options->has_ground)
    report_warning(mjcf->file.diagnostics, mjcf->file.robot->line,
                   "nothing touches the ground: contact=\"disable\" of <flag>; expected a file without it");
  if (mjcf->has_no_contacts || (options->says_ground && !options->has_ground)) return;
  check_ground(mjcf);
  check_pairs(mjcf, true);
  check_pairs(mjcf, false);
}

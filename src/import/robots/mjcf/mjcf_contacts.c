#include "robots/mjcf/mjcf_contacts.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "robots/description/shape_pairs.h"
#include "robots/mjcf/values/mjcf_tree.h"
#include "xml/nodes.h"

/* Returns the nearest body with a joint, from this one outward; the <worldbody> if there is none. */
static xmlNodePtr moving_body(const struct Mjcf *mjcf, xmlNodePtr body) {
  while (!is_element(body, "worldbody") && !mjcf_moves(mjcf, body)) body = mjcf_body_around(body);
  return body;
}

static char *name_or_nothing(xmlNodePtr node) {
  char *name = is_element(node, "worldbody") ? copy_text(mjcf_world) : attribute(node, "name");
  return name != NULL ? name : copy_text("");
}

void mjcf_read_rule(struct Mjcf *mjcf, xmlNodePtr node) {
  bool is_pair = is_element(node, "pair");
  if (!is_pair && !is_element(node, "exclude")) {
    mjcf_report_unknown(mjcf, node, "a <pair> or <exclude>");
    return;
  }
  struct ContactRule rule = {.node = node, .is_pair = is_pair};
  for (int i = 0; i < 2; i++)
    rule.names[i] = required_attribute(&mjcf->file, node, format_text("%s%d", is_pair ? "geom" : "body", i + 1));
  APPEND(mjcf->rules, mjcf->rule_count, rule);
}

struct MjcfContact mjcf_contact(struct Mjcf *mjcf, xmlNodePtr node) {
  double friction[3] = {1};
  mjcf_numbers(mjcf, node, "friction", 1, 3, friction);
  xmlNodePtr body = mjcf_body_around(node);
  struct MjcfContact contact = {.node = node,
                                .body = body,
                                .moving = moving_body(mjcf, body),
                                .name = name_or_nothing(node),
                                .body_name = name_or_nothing(body),
                                .friction = friction[0],
                                .dimensions = mjcf_number(mjcf, node, "condim", 3),
                                .priority = mjcf_number(mjcf, node, "priority", 0),
                                .type = (unsigned)(long)mjcf_number(mjcf, node, "contype", 1),
                                .affinity = (unsigned)(long)mjcf_number(mjcf, node, "conaffinity", 1)};
  if (contact.friction < 0)
    mjcf_error(mjcf, node, "friction=\"%g\" of <%s> is negative; expected 0 or more", contact.friction,
               (const char *)node->name);
  double d = contact.dimensions;
  if (d != 1 && d != 3 && d != 4 && d != 6)
    mjcf_error(mjcf, node, "condim=\"%g\" of <%s> is not valid; expected 1, 3, 4 or 6", d, (const char *)node->name);
  return contact;
}

bool mjcf_is_static(const struct MjcfContact *contact) {
  return is_element(contact->moving, "worldbody");
}

/* Returns the <pair> of two geoms, or the <exclude> of two bodies, in either order; NULL for none. */
static const struct ContactRule *find_rule(const struct Mjcf *mjcf, bool is_pair, const char *first,
                                           const char *second) {
  for (size_t i = 0; i < mjcf->rule_count; i++) {
    const struct ContactRule *rule = &mjcf->rules[i];
    const char *a = rule->names[0], *b = rule->names[1];
    if (rule->is_pair == is_pair &&
        ((strcmp(first, a) == 0 && strcmp(second, b) == 0) || (strcmp(first, b) == 0 && strcmp(second, a) == 0)))
      return rule;
  }
  return NULL;
}

static bool is_excluded(const struct Mjcf *mjcf, const struct MjcfContact *first, const struct MjcfContact *second) {
  return find_rule(mjcf, false, first->body_name, second->body_name) != NULL;
}

static const struct ContactRule *find_pair(const struct Mjcf *mjcf, const struct MjcfContact *first,
                                           const struct MjcfContact *second) {
  return find_rule(mjcf, true, first->name, second->name);
}

bool mjcf_may_collide(const struct Mjcf *mjcf, const struct MjcfContact *contact) {
  bool is_in_pair = false;
  for (size_t i = 0; i < mjcf->rule_count; i++)
    for (int k = 0; k < 2; k++)
      is_in_pair |= mjcf->rules[i].is_pair && strcmp(mjcf->rules[i].names[k], contact->name) == 0;
  return contact->type != 0 || contact->affinity != 0 || is_in_pair;
}

static bool masks_meet(const struct MjcfContact *first, const struct MjcfContact *second) {
  return (first->type & second->affinity) != 0 || (second->type & first->affinity) != 0;
}

/* Returns the friction and dimensions of a pair of geoms: those of higher priority, or else the larger ones. */
static struct MjcfContact combined(const struct MjcfContact *first, const struct MjcfContact *second) {
  if (first->priority != second->priority) return first->priority > second->priority ? *first : *second;
  struct MjcfContact contact = *first;
  contact.friction = fmax(first->friction, second->friction);
  contact.dimensions = fmax(first->dimensions, second->dimensions);
  return contact;
}

/* Returns the friction and dimensions of two geoms, or those of their <pair>. */
static struct MjcfContact meeting(struct Mjcf *mjcf, const struct MjcfContact *first,
                                  const struct MjcfContact *second) {
  const struct ContactRule *pair = find_pair(mjcf, first, second);
  struct MjcfContact contact = combined(first, second);
  if (pair == NULL) return contact;
  double friction[5] = {contact.friction};
  mjcf_numbers(mjcf, pair->node, "friction", 1, 5, friction);
  contact.friction = friction[0];
  contact.dimensions = mjcf_number(mjcf, pair->node, "condim", contact.dimensions);
  return contact;
}

static void warn_of_spin(struct Mjcf *mjcf, long line, double dimensions) {
  if (dimensions > 3)
    warn_unread(
        &mjcf->file, line,
        format_text("the torsional%s friction of condim=\"%g\"", dimensions == 6 ? " and rolling" : "", dimensions),
        "condim=\"3\", or a <force> against the spin in a <system> that includes the robot");
}

/* Sets the contact of a shape with the file's plane, or by its own attributes if there is no plane. */
static void meet_ground(struct Mjcf *mjcf, struct MjcfContact contact, struct Collision *shape) {
  const struct MjcfContact *ground = mjcf->ground.node != NULL ? &mjcf->ground : NULL;
  long line = line_of(contact.node);
  const struct ContactRule *pair = ground != NULL ? find_pair(mjcf, ground, &contact) : NULL;
  shape->is_clear |= mjcf->has_no_contacts;
  if (ground != NULL && pair == NULL)
    shape->is_clear |= !masks_meet(ground, &contact) || is_excluded(mjcf, ground, &contact);
  if (ground != NULL) contact = meeting(mjcf, ground, &contact);
  shape->friction = contact.dimensions == 1 ? 0 : contact.friction;
  if (!shape->is_clear) warn_of_spin(mjcf, line, contact.dimensions);
}

void mjcf_note_contact(struct Mjcf *mjcf, const struct MjcfContact *contact, struct RobotLink *link) {
  mjcf->contacts = make_room(mjcf->contacts, mjcf->contact_count, sizeof *mjcf->contacts);
  struct MjcfContact *known = &mjcf->contacts[mjcf->contact_count++];
  *known = *contact;
  known->link = link;
  known->index = link->collision_count;
}

/* True if the carrier is the parent of the contact's body: these do not touch, unless the parent is static. */
static bool is_carried(const struct Mjcf *mjcf, const struct MjcfContact *contact, const struct MjcfContact *carrier) {
  return !mjcf->touches_parents && !mjcf_is_static(carrier) && !mjcf_is_static(contact) &&
         moving_body(mjcf, mjcf_body_around(contact->moving)) == carrier->moving;
}

/* True if the two geoms can touch in MuJoCo. */
static bool may_meet(const struct Mjcf *mjcf, const struct MjcfContact *first, const struct MjcfContact *second) {
  if (find_pair(mjcf, first, second) != NULL) return true;
  return first->moving != second->moving && masks_meet(first, second) && !is_carried(mjcf, first, second) &&
         !is_carried(mjcf, second, first) && !is_excluded(mjcf, first, second);
}

static char *name_of(const struct Mjcf *mjcf, xmlNodePtr node) {
  if (is_element(node, "worldbody")) return copy_text("the world");
  return has_attribute(node, "name") ? format_text("the %s '%s'", (const char *)node->name, attribute(node, "name"))
                                     : format_text("the %s on line %ld", (const char *)node->name,
                                                   file_line(mjcf->file.diagnostics, line_of(node)).line);
}

/* Names a geom and its body, if that has a name. */
static char *name_in_body(const struct Mjcf *mjcf, const struct MjcfContact *contact) {
  char *name = name_of(mjcf, contact->node);
  bool is_known = is_element(contact->body, "worldbody") || has_attribute(contact->body, "name");
  return is_known ? format_text("%s of %s", name, name_of(mjcf, contact->body)) : name;
}

/* Returns the pair of two geoms, without its friction. */
static struct ShapePair pair_of(const struct MjcfContact *first, const struct MjcfContact *second) {
  return (struct ShapePair){.links = {first->link, second->link},
                            .indices = {first->index, second->index},
                            .friction = NAN,
                            .line = line_of(first->node)};
}

/* Warns of pairs of geoms that touch in MuJoCo only, by the first pair. */
static void warn_of_pair(struct Mjcf *mjcf, const struct MjcfContact *first, const struct MjcfContact *second,
                         size_t count) {
  const char *others = count > 1 ? format_text(", and %zu other such pair%s", count - 1, count > 2 ? "s" : "") : "";
  struct ShapePair pair = pair_of(first, second);
  report_warning(mjcf->file.diagnostics, line_of(first->node), "%s does not touch %s%s, unlike in MuJoCo; expected %s",
                 name_in_body(mjcf, first), name_in_body(mjcf, second), others,
                 mjcf->file.options->has_self ? how_to_touch(mjcf->file.options, &pair)
                                              : "self=\"true\" in an <include>, or --self on the command line");
}

/* Adds the contact of two geoms if the options request it. Returns false if there is none, or none is possible. */
static bool add_contact(struct Mjcf *mjcf, const struct MjcfContact *first, const struct MjcfContact *second) {
  struct ShapePair pair = pair_of(first, second);
  if (touch_in_system(mjcf->file.options, &pair)) return true;
  if (!mjcf->file.options->has_self ||
      !shapes_can_touch(&first->link->collisions[first->index], &second->link->collisions[second->index]))
    return false;
  struct MjcfContact contact = meeting(mjcf, first, second);
  pair.friction = contact.dimensions == 1 ? 0 : contact.friction;
  add_shape_pair(mjcf->file.robot, &pair);
  warn_of_spin(mjcf, line_of(first->dimensions > second->dimensions ? first->node : second->node), contact.dimensions);
  return true;
}

/* Adds or warns of pairs that can touch: static and moving geoms, or two moving ones. */
static void check_pairs(struct Mjcf *mjcf, bool with_static) {
  const struct MjcfContact *found[2] = {NULL};
  size_t count = 0;
  for (size_t i = 0; i < mjcf->contact_count; i++)
    for (size_t j = 0; j < mjcf->contact_count; j++) {
      const struct MjcfContact *first = &mjcf->contacts[i], *second = &mjcf->contacts[j];
      bool is_wanted = with_static ? mjcf_is_static(first) && !mjcf_is_static(second)
                                   : i < j && !mjcf_is_static(first) && !mjcf_is_static(second);
      if (!is_wanted || !may_meet(mjcf, first, second) || add_contact(mjcf, first, second)) continue;
      if (count++ > 0) continue;
      found[0] = first;
      found[1] = second;
    }
  if (count > 0) warn_of_pair(mjcf, found[0], found[1], count);
}

/* Warns of a plane that geoms could touch if the <include> said ground="true", unless it says ground="false". */
static void check_ground(struct Mjcf *mjcf) {
  bool is_met = false;
  if (mjcf->ground.node == NULL || mjcf->file.options->says_ground) return;
  for (size_t i = 0; i < mjcf->contact_count; i++)
    is_met |= !mjcf_is_static(&mjcf->contacts[i]) && may_meet(mjcf, &mjcf->ground, &mjcf->contacts[i]);
  if (is_met)
    report_warning(mjcf->file.diagnostics, line_of(mjcf->ground.node),
                   "nothing stands on %s; expected ground=\"true\" in an <include> or --ground on the command line, or "
                   "ground=\"false\" if this is meant",
                   name_of(mjcf, mjcf->ground.node));
}

void mjcf_find_contacts(struct Mjcf *mjcf) {
  const struct RobotOptions *options = mjcf->file.options;
  for (size_t i = 0; i < mjcf->contact_count && options->has_ground; i++) {
    const struct MjcfContact *contact = &mjcf->contacts[i];
    meet_ground(mjcf, *contact, &contact->link->collisions[contact->index]);
  }
  if (mjcf->has_no_contacts && options->has_ground)
    report_warning(mjcf->file.diagnostics, mjcf->file.robot->line,
                   "nothing touches the ground, as <flag> disables contacts; remove this");
  if (mjcf->has_no_contacts || (options->says_ground && !options->has_ground && !options->has_self)) return;
  check_ground(mjcf);
  check_pairs(mjcf, true);
  check_pairs(mjcf, false);
}

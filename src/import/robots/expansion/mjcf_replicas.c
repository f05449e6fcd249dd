/*
 * Copies of a <replicate count offset euler sep>. Copy i is in a <frame> with the rotation R_i by i times the Euler
 * angles, and the position p_i: p_0 = 0, p_(i + 1) = p_i + R_i offset. Names in a copy end with `sep` and the number of
 * the copy, with zeros in front up to equal length. Elements of other sections that refer to these names are copied to
 * the end of their section, in MuJoCo's order. A <replicate> in another one is replaced first.
 */
#include "robots/expansion/mjcf_replicas.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "robots/description/rigid_body.h"
#include "robots/description/robot_file.h"
#include "robots/expansion/mjcf_attachments.h"
#include "robots/expansion/mjcf_files.h"
#include "robots/expansion/mjcf_names.h"
#include "xml/lines.h"
#include "xml/nodes.h"

/* Copies of one element, and of all elements of a file together; larger files could not be simulated. */
enum { COUNT_LIMIT = 1000, ELEMENTS_LIMIT = 20000 };

const struct EulerAngles usual_angles = {"xyz", M_PI / 180};

/* A file whose <replicate> elements are replaced. */
struct Expansion {
  xmlNodePtr root;
  struct EulerAngles angles;
  struct Diagnostics *diagnostics;
  size_t copied; /* elements */
};

/* A <replicate> while it is replaced. */
struct Replication {
  struct Names *names; /* "kind name" of all elements in it, and of tendons that are copied for them */
  const char *separator;
  size_t count, digits;
  struct Diagnostics *diagnostics;
};

/* Appends the suffix of a copy to an attribute. */
static void add_suffix(const struct Replication *replication, xmlNodePtr node, const char *name, size_t copy) {
  char *text = format_text("%s%s%0*zu", attribute(node, name), replication->separator, (int)replication->digits, copy);
  xmlSetProp(node, (const xmlChar *)name, (const xmlChar *)text);
}

static void rename_references(const struct Replication *replication, xmlNodePtr node, size_t copy) {
  for (size_t i = 0; i < MJCF_REFERENCES; i++)
    if (mjcf_refers(replication->names, node, i)) add_suffix(replication, node, mjcf_references[i].attribute, copy);
  for (xmlNodePtr child = node->children; child != NULL; child = child->next)
    if (child->type == XML_ELEMENT_NODE) rename_references(replication, child, copy);
}

static void rename_all(const struct Replication *replication, xmlNodePtr node, size_t copy) {
  if (node->type != XML_ELEMENT_NODE) return;
  if (has_attribute(node, "name")) add_suffix(replication, node, "name", copy);
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) rename_all(replication, child, copy);
}

/* Reports an <equality> between a copied element and another one, which MuJoCo would omit. */
static void check_equality(const struct Replication *replication, xmlNodePtr node) {
  if (mjcf_count_references(replication->names, node) < mjcf_count_references(NULL, node))
    report_error(replication->diagnostics, line_of(node),
                 "a <%s> of <equality> is between an element of a <replicate> and another one; expected both in the "
                 "<replicate>, or one <%s> for each copy",
                 (const char *)node->name, (const char *)node->name);
}

/* Replaces elements of a section that refer to copied ones by copies at its end. */
static void copy_references(struct Replication *replication, xmlNodePtr section) {
  xmlNodePtr *found = NULL;
  size_t count = 0;
  for (xmlNodePtr node = section->children; node != NULL; node = node->next) {
    if (node->type != XML_ELEMENT_NODE || mjcf_count_references(replication->names, node) == 0) continue;
    if (is_element(section, "equality")) check_equality(replication, node);
    found = make_room(found, count, sizeof(xmlNodePtr));
    found[count++] = node;
  }
  for (size_t copy = 0; copy < replication->count; copy++)
    for (size_t i = 0; i < count; i++) {
      xmlNodePtr node = mjcf_copy_within(found[i]);
      rename_references(replication, node, copy);
      if (has_attribute(node, "name")) add_suffix(replication, node, "name", copy);
      xmlAddChild(section, node);
    }
  for (size_t i = 0; i < count; i++) {
    if (is_element(section, "tendon")) mjcf_note_name(replication->names, found[i]);
    xmlUnlinkNode(found[i]);
    xmlFreeNode(found[i]);
  }
}

static void set_numbers(xmlNodePtr node, const char *name, const double numbers[3]) {
  char *text = format_text("%.17g %.17g %.17g", numbers[0], numbers[1], numbers[2]);
  xmlNewProp(node, (const xmlChar *)name, (const xmlChar *)text);
}

/* Reads three numbers; 0 if the attribute is missing. Reports others. */
static void read_three(const struct Replication *replication, xmlNodePtr node, const char *name, double values[3]) {
  char *text = attribute(node, name);
  if (text == NULL || parse_numbers(text, 3, values) == 3) return;
  report_error(replication->diagnostics, line_of(node), "%s=\"%.60s\" of <replicate> is not valid; expected 3 numbers",
               name, text);
}

/* Puts the copies of the content before the <replicate>, each in a frame. */
static void copy_content(const struct Replication *replication, xmlNodePtr node, const struct EulerAngles *angles) {
  double offset[3] = {0}, euler[3] = {0};
  struct Placement placement = no_displacement;
  read_three(replication, node, "offset", offset);
  read_three(replication, node, "euler", euler);
  for (size_t copy = 0; copy < replication->count; copy++) {
    double multiple[3], rotation[3];
    for (int i = 0; i < 3; i++) multiple[i] = (double)copy * euler[i];
    for (int i = 0; i < 3; i++) rotation[i] = multiple[i] * angles->unit;
    placement.rotation = rotation_of_euler(angles->sequence, rotation);
    xmlNodePtr frame = xmlNewDocNode(node->doc, NULL, (const xmlChar *)"frame", NULL);
    set_line(frame, line_of(node));
    set_numbers(frame, "pos", placement.translation);
    set_numbers(frame, "euler", multiple);
    struct Placement step = no_displacement;
    memcpy(step.translation, offset, sizeof offset);
    placement = placement_within(&placement, &step);
    for (xmlNodePtr child = node->children; child != NULL; child = child->next) {
      if (child->type != XML_ELEMENT_NODE) continue;
      xmlNodePtr content = mjcf_copy_within(child);
      rename_all(replication, content, copy);
      xmlAddChild(frame, content);
    }
    xmlAddPrevSibling(node, frame);
  }
}

/* Returns the number of elements in another one. */
static size_t count_elements(xmlNodePtr parent) {
  size_t count = 0;
  for (xmlNodePtr node = parent->children; node != NULL; node = node->next)
    if (node->type == XML_ELEMENT_NODE) count += 1 + count_elements(node);
  return count;
}

/* Reads the number of copies. Returns 0 after reporting a wrong one. */
static size_t read_count(struct Expansion *expansion, xmlNodePtr node) {
  double count = 0;
  char *text = attribute(node, "count");
  bool is_number = text != NULL && parse_numbers(text, 1, &count) == 1;
  if (!is_number || count < 1 || count > COUNT_LIMIT || count != floor(count)) {
    report_error(expansion->diagnostics, line_of(node), "count=\"%.60s\" of <replicate> is not valid; expected 1 to %d",
                 text != NULL ? text : "", COUNT_LIMIT);
    return 0;
  }
  expansion->copied += (size_t)count * count_elements(node);
  if (expansion->copied <= ELEMENTS_LIMIT) return (size_t)count;
  report_error(expansion->diagnostics, line_of(node), "more than %d elements are copied by <replicate>; expected fewer",
               ELEMENTS_LIMIT);
  return 0;
}

static void replace(struct Expansion *expansion, xmlNodePtr node) {
  char *separator = attribute(node, "sep");
  struct Replication replication = {.names = names_create(),
                                    .separator = separator != NULL ? separator : "",
                                    .count = read_count(expansion, node),
                                    .diagnostics = expansion->diagnostics};
  if (replication.count == 0) return;
  replication.digits = strlen(format_text("%zu", replication.count - 1));
  mjcf_note_names(replication.names, node);
  copy_content(&replication, node, &expansion->angles);
  for (size_t i = 0; i < MJCF_REFERRING_SECTIONS; i++)
    for (xmlNodePtr section = expansion->root->children; section != NULL; section = section->next)
      if (is_element(section, mjcf_referring_sections[i])) copy_references(&replication, section);
  xmlUnlinkNode(node);
  xmlFreeNode(node);
}

/* Replaces the <replicate> elements in a parent, the innermost first. */
static void replace_in(struct Expansion *expansion, xmlNodePtr parent) {
  for (xmlNodePtr node = parent->children, next; node != NULL; node = next) {
    next = node->next;
    if (node->type != XML_ELEMENT_NODE) continue;
    replace_in(expansion, node);
    if (is_element(node, "replicate")) replace(expansion, node);
  }
}

void mjcf_read_angles(xmlNodePtr compiler, struct EulerAngles *angles) {
  char *sequence = attribute(compiler, "eulerseq");
  if (attribute_is(compiler, "angle", "radian")) angles->unit = 1;
  if (attribute_is(compiler, "angle", "degree")) angles->unit = usual_angles.unit;
  if (sequence != NULL && strlen(sequence) == 3 && strspn(sequence, "xyzXYZ") == 3) angles->sequence = sequence;
}

void mjcf_replicate(xmlNodePtr root, struct Diagnostics *diagnostics) {
  struct Expansion expansion = {root, usual_angles, diagnostics, 0};
  for (xmlNodePtr node = root->children; node != NULL; node = node->next)
    if (is_element(node, "compiler") && mjcf_model_of(node) == 0) mjcf_read_angles(node, &expansion.angles);
  for (xmlNodePtr node = root->children; node != NULL; node = node->next)
    if (is_element(node, "worldbody")) replace_in(&expansion, node);
}

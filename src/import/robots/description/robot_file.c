#include "robots/description/robot_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "xml/nodes.h"

char *next_name(const char **rest) {
  static const char separators[] = " \t\r\n,";
  const char *name = *rest + strspn(*rest, separators);
  size_t length = strcspn(name, separators);
  *rest = name + length;
  return length > 0 ? format_text("%.*s", (int)length, name) : NULL;
}

/* Adds a text to the list. Returns false if it is in the list already or the list is full. */
static bool note_once(char **list, size_t *count, size_t limit, const char *text) {
  for (size_t i = 0; i < *count; i++)
    if (strcmp(list[i], text) == 0) return false;
  if (*count == limit) return false;
  list[(*count)++] = copy_text(text);
  return true;
}

void leave_out(struct RobotFile *file, const char *what) {
  note_once(file->left_out, &file->left_out_count, LEFT_OUT_LIMIT, what);
}

void warn_unread(struct RobotFile *file, long line, const char *what, const char *remedy) {
  if (note_once(file->unread, &file->unread_count, UNREAD_LIMIT, what))
    report_warning(file->diagnostics, line, "%s is not read, and may change the motion; expected %s", what, remedy);
}

void leave_out_others(struct RobotFile *file, xmlNodePtr parent, const char *const *names) {
  for (xmlNodePtr node = parent->children; node != NULL; node = node->next) {
    if (node->type != XML_ELEMENT_NODE) continue;
    size_t i = 0;
    while (names[i] != NULL && !is_element(node, names[i])) i++;
    if (names[i] == NULL) leave_out(file, (const char *)node->name);
  }
}

xmlNodePtr child_of(struct RobotFile *file, xmlNodePtr parent, const char *name) {
  xmlNodePtr found = NULL;
  for (xmlNodePtr node = parent->children; node != NULL; node = node->next) {
    if (!is_element(node, name)) continue;
    if (found != NULL)
      report_error(file->diagnostics, line_of(node), "<%s> has a second <%s>; expected one", (const char *)parent->name,
                   name);
    else found = node;
  }
  return found;
}

xmlNodePtr required_child_of(struct RobotFile *file, xmlNodePtr parent, const char *name) {
  xmlNodePtr found = child_of(file, parent, name);
  if (found == NULL)
    report_error(file->diagnostics, line_of(parent), "<%s> has no <%s>; expected one in it", (const char *)parent->name,
                 name);
  return found;
}

char *required_attribute(struct RobotFile *file, xmlNodePtr node, const char *name) {
  char *text = attribute(node, name);
  if (text != NULL && *text != '\0') return text;
  report_error(file->diagnostics, line_of(node), "<%s> needs the attribute '%s'; expected %s=\"...\"",
               (const char *)node->name, name, name);
  return text != NULL ? text : copy_text("");
}

size_t parse_numbers(const char *text, size_t limit, double *values) {
  static const char blanks[] = " \t\r\n";
  size_t count = 0;
  text += strspn(text, blanks);
  for (; *text != '\0'; count++) {
    char *end;
    size_t decimal = strspn(text, "+-.0123456789eE"); /* strtod also accepts 0x1 and nan */
    if (count == limit) return 0;
    values[count] = strtod(text, &end);
    if (end == text || (size_t)(end - text) > decimal || !isfinite(values[count])) return 0;
    text = end + strspn(end, blanks);
    if (text == end && *text != '\0') return 0;
  }
  return count;
}

bool read_numbers(struct RobotFile *file, xmlNodePtr node, const char *name, size_t count, double *values) {
  char *text = node != NULL ? attribute(node, name) : NULL;
  if (text == NULL) return false;
  double read[3] = {0};
  if (parse_numbers(text, count, read) == count) memcpy(values, read, count * sizeof *values);
  else
    report_error(file->diagnostics, line_of(node), "%s=\"%.60s\" of <%s> is not valid; expected %s", name, text,
                 (const char *)node->name,
                 count == 1 ? "a number such as 2, -0.5 or 1e-3" : "three numbers such as 0 0.5 -1e-3");
  return true;
}

double required_number(struct RobotFile *file, xmlNodePtr node, const char *name) {
  double value = 0;
  char *text = required_attribute(file, node, name);
  if (*text != '\0') read_numbers(file, node, name, 1, &value);
  return value;
}

double number_not_negative(struct RobotFile *file, xmlNodePtr node, const char *name) {
  double value = 0;
  read_numbers(file, node, name, 1, &value);
  if (value < 0)
    report_error(file->diagnostics, line_of(node), "%s=\"%g\" of <%s> is negative; expected 0 or more", name, value,
                 (const char *)node->name);
  return value;
}

bool requests_nothing(const char *text) {
  static const char *const nothing[] = {"false", "none", "auto", "disable"};
  double values[NUMBERS_LIMIT];
  for (size_t i = 0; i < sizeof nothing / sizeof *nothing; i++)
    if (strcmp(text, nothing[i]) == 0) return true;
  size_t count = parse_numbers(text, NUMBERS_LIMIT, values), i = 0;
  while (i < count && values[i] == 0) i++;
  return count > 0 && i == count;
}

static bool is_among(const char *names, const char *name) {
  for (char *next = next_name(&names); next != NULL; next = next_name(&names))
    if (strcmp(next, name) == 0) return true;
  return false;
}

bool condition_holds(const struct RobotOptions *options, enum Condition condition) {
  return condition == ALWAYS_ACTS || (condition == ACTS_ON_GROUND && options->has_ground) ||
         (condition == ACTS_AT_STOPS && options->has_stops) ||
         (condition == ACTS_BETWEEN_LINKS && options->has_ground && !options->has_self);
}

static void check_attribute(struct RobotFile *file, xmlNodePtr node, const char *name, const struct Attributes *table) {
  const char *element = (const char *)node->name, *remedy = NULL;
  bool is_known_element = false;
  if (*name == '-') return; /* a note of the reader, see mjcf_attachments.c */
  for (const struct Attributes *row = table; row->elements != NULL; row++) {
    if (!is_among(row->elements, element)) continue;
    is_known_element = true;
    if (!is_among(row->names, name)) continue;
    remedy = row->remedy;
    if (remedy == NULL || !condition_holds(file->options, row->condition) || requests_nothing(attribute(node, name)))
      return;
  }
  if (is_known_element)
    warn_unread(file, line_of(node), format_text("%s of <%s>", name, element),
                remedy != NULL ? remedy : "one of the attributes that the reference names");
}

void check_attributes(struct RobotFile *file, xmlNodePtr node, const struct Attributes *table) {
  for (const xmlAttr *given = node->properties; given != NULL; given = given->next)
    check_attribute(file, node, (const char *)given->name, table);
  for (xmlNodePtr child = node->children; child != NULL; child = child->next)
    if (child->type == XML_ELEMENT_NODE) check_attributes(file, child, table);
}

void note_mesh_problem(struct RobotFile *file, char *problem) {
  if (problem == NULL) return;
  if (file->mesh_problem == NULL) file->mesh_problem = problem;
  file->mesh_problems++;
}

void note_untouched(struct RobotFile *file, long line, char *shape) {
  if (file->untouched_count++ > 0) return;
  file->untouched = shape;
  file->untouched_line = line;
}

char *color_text(const double rgba[4]) {
  char *text = copy_text("#");
  for (int i = 0; i < 4; i++) text = format_text("%s%02x", text, (unsigned)lround(255 * fmin(fmax(rgba[i], 0), 1)));
  return text;
}

void report_left_out(struct RobotFile *file) {
  char *list = copy_text("");
  for (size_t i = 0; i < file->left_out_count; i++)
    list = format_text("%s%s%s", list, i > 0 ? ", " : "", file->left_out[i]);
  if (*list != '\0' && file->diagnostics->errors == 0)
    report_warning(file->diagnostics, 0, "left out, since the motion does not depend on them: %s", list);
  size_t others = file->untouched_count > 0 ? file->untouched_count - 1 : 0;
  if (file->untouched != NULL)
    report_warning(file->diagnostics, file->untouched_line, "%s%s", file->untouched,
                   others > 0 ? format_text("; %zu other shape%s", others,
                                            others > 1 ? "s touch nothing either" : " touches nothing either")
                              : "");
  if (file->mesh_problem != NULL && file->diagnostics->errors == 0)
    report_warning(file->diagnostics, 0, "%zu mesh%s not drawn; the first: %s", file->mesh_problems,
                   file->mesh_problems == 1 ? " is" : "es are", file->mesh_problem);
}

bool link_touches_ground(const struct RobotOptions *options, const char *link) {
  const char *rest = options->ground_contact;
  if (!options->has_ground || rest == NULL) return options->has_ground;
  for (char *name = next_name(&rest); name != NULL; name = next_name(&rest))
    if (strcmp(name, link) == 0) return true;
  return false;
}

void add_link(struct RobotFile *file, struct RobotLink *link) {
  struct Robot *robot = file->robot;
  robot->links = make_room(robot->links, robot->link_count, sizeof(struct RobotLink *));
  robot->links[robot->link_count++] = link;
}

void add_joint(struct RobotFile *file, struct RobotJoint *joint) {
  struct Robot *robot = file->robot;
  robot->joints = make_room(robot->joints, robot->joint_count, sizeof(struct RobotJoint *));
  robot->joints[robot->joint_count++] = joint;
}

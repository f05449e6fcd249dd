#include "robots/mjcf/values/mjcf_values.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "robots/expansion/mjcf_attachments.h"
#include "xml/nodes.h"

const struct MjcfCompiler *mjcf_compiler(const struct Mjcf *mjcf, xmlNodePtr node) {
  return &mjcf->compilers[mjcf_model_of(node)];
}

/* Returns the <default> of this class, at any depth; NULL for none. */
static xmlNodePtr find_class(xmlNodePtr parent, const char *name) {
  for (xmlNodePtr node = parent->children; node != NULL; node = node->next) {
    if (!is_element(node, "default")) continue;
    if (attribute_is(node, "class", name)) return node;
    xmlNodePtr found = find_class(node, name);
    if (found != NULL) return found;
  }
  return NULL;
}

/*
 * Returns the class of an element: its own, or the childclass of the nearest ancestor from the same file; NULL for
 * none.
 */
static const char *class_of(xmlNodePtr node) {
  const char *name = attribute(node, "class");
  size_t model = mjcf_model_of(node);
  for (node = node->parent; name == NULL && node != NULL && mjcf_model_of(node) == model; node = node->parent)
    name = attribute(node, "childclass");
  return name;
}

/*
 * Returns the class from which this one inherits: the enclosing <default>. All outermost <default>s of a file together
 * form the class of all its elements; they are visited from the last one. A class inherits from those up to the one in
 * which it is. class: NULL before the first. NULL at the end.
 */
static xmlNodePtr next_class(const struct Mjcf *mjcf, xmlNodePtr element, xmlNodePtr class) {
  if (class != NULL && class->parent != mjcf->root) return class->parent;
  size_t model = mjcf_model_of(class != NULL ? class : element);
  xmlNodePtr node = class != NULL ? class->prev : mjcf->root->last;
  while (node != NULL && !(is_element(node, "default") && mjcf_model_of(node) == model)) node = node->prev;
  return node;
}

/* Returns the innermost class of an element; NULL for none. */
static xmlNodePtr first_class(const struct Mjcf *mjcf, xmlNodePtr node) {
  const char *name = class_of(node);
  xmlNodePtr class = name != NULL ? find_class(mjcf->root, name) : NULL;
  return class != NULL && class->parent != mjcf->root ? class : next_class(mjcf, node, NULL);
}

/* True if the text is one of the words, which end with NULL. */
static bool is_one_of(const char *text, const char *const *words) {
  while (*words != NULL && strcmp(text, *words) != 0) words++;
  return *words != NULL;
}

static bool is_actuator(xmlNodePtr node) {
  static const char *const kinds[] = {"motor",  "position", "velocity", "general", "intvelocity", "cylinder",
                                      "damper", "muscle",   "adhesion", "dcmotor", NULL};
  return node->type == XML_ELEMENT_NODE && is_one_of((const char *)node->name, kinds);
}

/* Attributes whose meaning depends on the kind of actuator. The others are common to all kinds. */
static const char *const of_laws[] = {"kp",      "kv",     "dampratio", "timeconst", "inheritrange",
                                      "dyntype", "dynprm", "gaintype",  "gainprm",   "biastype",
                                      "biasprm", "area",   "diameter",  "bias",      NULL};

/* True if this <default> applies to the attribute of the element: common ones of actuators to all kinds. */
static bool is_default_of(xmlNodePtr node, xmlNodePtr element, const char *name) {
  if (is_actuator(element) && !is_one_of(name, of_laws)) return is_actuator(node);
  bool is_tendon = is_element(element, "fixed") || is_element(element, "spatial");
  return is_element(node, is_tendon ? "tendon" : (const char *)element->name);
}

/* Returns the element, or of the <default>s for it the innermost, that has one of two attributes; NULL for none. */
static xmlNodePtr holder_of(const struct Mjcf *mjcf, xmlNodePtr node, const char *name, const char *other) {
  if (has_attribute(node, name) || has_attribute(node, other)) return node;
  for (xmlNodePtr class = first_class(mjcf, node); class != NULL; class = next_class(mjcf, node, class))
    for (xmlNodePtr found = class->last; found != NULL; found = found->prev)
      if (is_default_of(found, node, name) && (has_attribute(found, name) || has_attribute(found, other))) return found;
  return NULL;
}

const char *mjcf_text(const struct Mjcf *mjcf, xmlNodePtr node, const char *name) {
  xmlNodePtr holder = holder_of(mjcf, node, name, name);
  return holder != NULL ? attribute(holder, name) : NULL;
}

bool mjcf_prevails(struct Mjcf *mjcf, xmlNodePtr node, const char *name, const char *other) {
  xmlNodePtr holder = holder_of(mjcf, node, name, other);
  if (holder == NULL || !has_attribute(holder, name)) return false;
  if (has_attribute(holder, other))
    mjcf_error(mjcf, holder, "<%s> has %s and %s; expected one of them", (const char *)node->name, name, other);
  return true;
}

static bool defines_law(xmlNodePtr node) {
  size_t i = 0;
  while (of_laws[i] != NULL && !has_attribute(node, of_laws[i])) i++;
  return of_laws[i] != NULL;
}

/*
 * True if a <default> makes MuJoCo's gain and bias of the actuator differ from those read here. In MuJoCo each
 * <default> that names one sets the gain and bias of all kinds of actuators. For a <general> every <default> of another
 * kind does so. A <motor> resets them. *is_set_back: a <motor> in an inner class, or further down, has reset them.
 */
static bool overrides_law(xmlNodePtr found, xmlNodePtr node, bool *is_set_back) {
  if (!is_actuator(found)) return false;
  if (is_element(found, (const char *)node->name)) return *is_set_back && defines_law(found);
  *is_set_back |= is_element(found, "motor");
  bool may_inherit = is_element(node, "general") && !is_element(found, "general");
  return !is_element(found, "motor") && (may_inherit || defines_law(found));
}

void mjcf_check_laws(struct Mjcf *mjcf, xmlNodePtr node) {
  bool is_set_back = false;
  if (is_element(node, "motor")) return;
  for (xmlNodePtr class = first_class(mjcf, node); class != NULL; class = next_class(mjcf, node, class))
    for (xmlNodePtr found = class->last; found != NULL; found = found->prev) {
      if (!overrides_law(found, node, &is_set_back)) continue;
      mjcf_error(mjcf, node,
                 "<%s> inherits the <%s> of a <default>; expected defaults of each kind of actuator in a class of "
                 "its own",
                 (const char *)node->name,
                 is_element(found, (const char *)node->name) ? "motor" : (const char *)found->name);
      return;
    }
}

static void check_class(struct Mjcf *mjcf, xmlNodePtr node, const char *name) {
  const char *class = attribute(node, name);
  if (class != NULL && strcmp(class, "main") != 0 && find_class(mjcf->root, class) == NULL)
    mjcf_error(mjcf, node, "there is no class '%s' for %s of <%s>; expected one that a <default class=\"...\"> defines",
               class, name, (const char *)node->name);
}

static void check_default(struct Mjcf *mjcf, xmlNodePtr node) {
  const char *class = attribute(node, "class");
  bool is_outermost = node->parent == mjcf->root;
  if (class == NULL && !is_outermost)
    mjcf_error(mjcf, node, "a <default> in a <default> has no class; expected class=\"...\"");
  if (class == NULL || is_outermost) return;
  xmlNodePtr first = find_class(mjcf->root, class);
  if (first != node)
    mjcf_error(mjcf, node, "the class '%s' is already defined on line %ld; expected another name", class,
               file_line(mjcf->file.diagnostics, line_of(first)).line);
}

void mjcf_check_classes(struct Mjcf *mjcf, xmlNodePtr node) {
  if (node->type != XML_ELEMENT_NODE) return;
  if (is_element(node, "default")) check_default(mjcf, node);
  else check_class(mjcf, node, "class");
  check_class(mjcf, node, "childclass");
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) mjcf_check_classes(mjcf, child);
}

size_t mjcf_numbers(struct Mjcf *mjcf, xmlNodePtr node, const char *name, size_t least, size_t most, double *values) {
  const char *text = mjcf_text(mjcf, node, name);
  double read[NUMBERS_LIMIT];
  if (text == NULL) return 0;
  size_t count = parse_numbers(text, most, read);
  if (count >= least && count > 0) {
    memcpy(values, read, count * sizeof *values);
    return count;
  }
  char *amount = least == most ? format_text("%zu", most) : format_text("%zu to %zu", least, most);
  mjcf_error(mjcf, node, "%s=\"%.60s\" of <%s> is not valid; expected %s", name, text, (const char *)node->name,
             most == 1 ? "a number such as 2, -0.5 or 1e-3" : format_text("%s numbers", amount));
  return 0;
}

double mjcf_number(struct Mjcf *mjcf, xmlNodePtr node, const char *name, double usual) {
  mjcf_numbers(mjcf, node, name, 1, 1, &usual);
  return usual;
}

double mjcf_number_not_negative(struct Mjcf *mjcf, xmlNodePtr node, const char *name, double usual) {
  double value = mjcf_number(mjcf, node, name, usual);
  if (value < 0)
    mjcf_error(mjcf, node, "%s=\"%g\" of <%s> is negative; expected 0 or more", name, value, (const char *)node->name);
  return value;
}

bool mjcf_is(const struct Mjcf *mjcf, xmlNodePtr node, const char *name, const char *value) {
  const char *text = mjcf_text(mjcf, node, name);
  return text != NULL && strcmp(text, value) == 0;
}

size_t mjcf_word(struct Mjcf *mjcf, xmlNodePtr node, const char *name, const char *const *words) {
  const char *text = mjcf_text(mjcf, node, name);
  char *list = copy_text("");
  for (size_t i = 0; words[i] != NULL; i++) {
    if (text == NULL || strcmp(text, words[i]) == 0) return i;
    list = format_text("%s%s%s", list, i > 0 ? ", " : "", words[i]);
  }
  mjcf_error(mjcf, node, "%s=\"%.60s\" of <%s> is not known; expected one of %s", name, text, (const char *)node->name,
             list);
  return 0;
}

double make_unit(double vector[3]) {
  double length = hypot(hypot(vector[0], vector[1]), vector[2]);
  for (int i = 0; i < 3 && length > 0; i++) vector[i] /= length;
  return length;
}

static void cross(const double a[3], const double b[3], double result[3]) {
  for (int i = 0; i < 3; i++) result[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

struct Matrix3 rotation_of_z(const double direction[3]) {
  double across = hypot(direction[0], direction[1]), axis[3] = {1, 0, 0};
  if (across > 0) {
    axis[0] = -direction[1] / across;
    axis[1] = direction[0] / across;
  }
  return rotation_about(axis, atan2(across, direction[2]));
}

/* Sets the rotation from an x axis and a y axis, which is made orthogonal to x. Returns false if they are parallel. */
static bool of_axes(const double given[6], struct Matrix3 *rotation) {
  double x[3] = {given[0], given[1], given[2]}, y[3] = {given[3], given[4], given[5]}, z[3];
  bool is_right = make_unit(x) > 0;
  cross(x, y, z);
  is_right &= make_unit(z) > 0;
  cross(z, x, y);
  for (int i = 0; i < 3; i++) {
    rotation->at[i][0] = x[i];
    rotation->at[i][1] = y[i];
    rotation->at[i][2] = z[i];
  }
  return is_right;
}

enum { QUATERNION, AXIS_AND_ANGLE, EULER_ANGLES, TWO_AXES, Z_AXIS, ORIENTATIONS };

/* Returns which orientation the element or its class has; ORIENTATIONS for none. */
static size_t orientation_of(struct Mjcf *mjcf, xmlNodePtr node, const char *const *names) {
  size_t kind = 0, others;
  while (kind < ORIENTATIONS && !has_attribute(node, names[kind])) kind++;
  for (others = kind + 1; others < ORIENTATIONS && !has_attribute(node, names[others]);) others++;
  if (others < ORIENTATIONS)
    mjcf_error(mjcf, node, "<%s> has %s and %s; expected one of them", (const char *)node->name, names[kind],
               names[others]);
  if (kind < ORIENTATIONS) return kind;
  kind = 0;
  while (kind < ORIENTATIONS && mjcf_text(mjcf, node, names[kind]) == NULL) kind++;
  return kind;
}

static struct Matrix3 of_euler(const struct EulerAngles *of_file, const double given[3]) {
  double angles[3];
  for (int i = 0; i < 3; i++) angles[i] = given[i] * of_file->unit;
  return rotation_of_euler(of_file->sequence, angles);
}

struct Placement mjcf_placement(struct Mjcf *mjcf, xmlNodePtr node) {
  static const char *const names[ORIENTATIONS] = {"quat", "axisangle", "euler", "xyaxes", "zaxis"};
  static const size_t counts[ORIENTATIONS] = {4, 4, 3, 6, 3};
  struct Placement placement = no_displacement;
  double v[6];
  mjcf_numbers(mjcf, node, "pos", 3, 3, placement.translation);
  size_t kind = orientation_of(mjcf, node, names);
  if (kind == ORIENTATIONS || mjcf_numbers(mjcf, node, names[kind], counts[kind], counts[kind], v) == 0)
    return placement;
  bool is_right = true;
  if (kind == QUATERNION) {
    is_right = v[0] != 0 || v[1] != 0 || v[2] != 0 || v[3] != 0;
    placement.rotation = rotation_of_quaternion(v);
  } else if (kind == AXIS_AND_ANGLE) {
    is_right = make_unit(v) > 0;
    placement.rotation = rotation_about(v, v[3] * mjcf_compiler(mjcf, node)->angles.unit);
  } else if (kind == EULER_ANGLES) placement.rotation = of_euler(&mjcf_compiler(mjcf, node)->angles, v);
  else if (kind == TWO_AXES) is_right = of_axes(v, &placement.rotation);
  else {
    is_right = make_unit(v) > 0;
    placement.rotation = rotation_of_z(v);
  }
  if (!is_right)
    mjcf_error(mjcf, node, "%s=\"%s\" of <%s> gives no direction; expected vectors that are not 0, and not parallel",
               names[kind], mjcf_text(mjcf, node, names[kind]), (const char *)node->name);
  return placement;
}

void mjcf_limits(struct Mjcf *mjcf, xmlNodePtr node, const char *range, const char *is_limited, double limits[2]) {
  static const char *const words[] = {"auto", "true", "false", NULL};
  size_t word = mjcf_word(mjcf, node, is_limited, words);
  limits[0] = limits[1] = NAN;
  double read[2] = {0};
  bool is_given = mjcf_numbers(mjcf, node, range, 2, 2, read) > 0;
  if (word == 2 || (word == 0 && !(is_given && mjcf_compiler(mjcf, node)->has_automatic_limits))) return;
  if (read[0] < read[1]) memcpy(limits, read, sizeof read);
  else
    mjcf_error(mjcf, node, "%s of <%s> is from %g to %g; expected the lower one first", range, (const char *)node->name,
               read[0], read[1]);
}

/* Counts the elements below one that have the name of an element, in a parent of equal name; *first: the first of them. */
static size_t count_alike(xmlNodePtr below, xmlNodePtr node, xmlNodePtr *first) {
  size_t count = 0;
  for (xmlNodePtr child = below->children; child != NULL; child = child->next) {
    if (child->type != XML_ELEMENT_NODE) continue;
    bool is_alike = xmlStrEqual(child->name, node->name) && xmlStrEqual(below->name, node->parent->name);
    if (is_alike && *first == NULL) *first = child;
    count += (is_alike ? 1 : 0) + count_alike(child, node, first);
  }
  return count;
}

void mjcf_report_unknown(struct Mjcf *mjcf, xmlNodePtr node, const char *remedy) {
  xmlNodePtr first = NULL;
  size_t others = count_alike(mjcf->root, node, &first) - 1; /* the tree contains the element itself */
  if (first != node) return;
  const char *number = others > 0 ? format_text(", as are %zu other%s in <%s>", others, others > 1 ? "s" : "",
                                                (const char *)node->parent->name)
                                  : "";
  mjcf_error(mjcf, node, "<%s> is not read%s, and would change the motion; expected %s", (const char *)node->name,
             number, remedy);
}

void mjcf_reject(struct Mjcf *mjcf, xmlNodePtr node, const char *names) {
  for (const char *name = next_name(&names); name != NULL; name = next_name(&names)) {
    const char *text = mjcf_text(mjcf, node, name);
    if (text == NULL || requests_nothing(text)) continue;
    bool is_word = strcmp(text, "true") == 0;
    mjcf_error(mjcf, node, "%s=\"%.60s\" of <%s> is not read, and would change the motion; expected %s=\"%s\" in it",
               name, text, (const char *)node->name, name, is_word ? "false" : "0");
  }
}

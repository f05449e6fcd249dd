#include "read/context/includes.h"

#include <errno.h>
#include <string.h>

#include "base/memory.h"
#include "base/paths.h"
#include "names/similar.h"
#include "read/context/value_texts.h"
#include "robots/robot_system.h"
#include "xml/xml.h"

/* The files of a system, and the overrides by <include>s. */
struct Includes {
  struct Names *sources;   /* prefix -> struct Source */
  struct Names *documents; /* canonical path and options for robots -> struct Document */
  struct Names *overrides; /* full name -> struct Override */
};

/* A parsed file; NULL if it has errors. */
struct Document {
  xmlDocPtr document;
};

void includes_begin(struct Reader *reader, const char *path, xmlNodePtr root) {
  reader->includes = allocate(1, sizeof *reader->includes);
  *reader->includes = (struct Includes){names_create(), names_create(), names_create()};
  struct Source *own = allocate(1, sizeof *own);
  *own = (struct Source){.file = path, .canonical_path = canonical_path(path), .prefix = copy_text(""), .root = root};
  names_set(reader->includes->sources, "", own);
  reader->source = own;
}

void includes_end(struct Reader *reader) {
  struct Includes *includes = reader->includes;
  source_enter(reader, names_find(includes->sources, ""));
  reader->scope->prefix = ""; /* the scope outlives the sources */
  for (size_t i = 0; i < includes->documents->capacity; i++)
    if (includes->documents->slots[i].text != NULL)
      xmlFreeDoc(((struct Document *)includes->documents->slots[i].meaning)->document);
  reader->includes = NULL;
}

struct Source *source_enter(struct Reader *reader, struct Source *source) {
  struct Source *before = reader->source;
  reader->source = source;
  reader->scope->prefix = source->prefix;
  reader->diagnostics->file = source->file;
  reader->diagnostics->origin = source->origin;
  return before;
}

char *path_beside(const struct Reader *reader, const char *file) {
  return path_beside_file(reader->source->file, file);
}

enum { DEPTH_LIMIT = 100 };

/* Bounds the depth of includes, and so the stack. Returns false after reporting an error. */
static bool check_depth(struct Reader *reader, xmlNodePtr node, const struct Source *source) {
  int depth = 0;
  for (const struct Source *outer = source->outer; outer != NULL; outer = outer->outer) depth++;
  if (depth <= DEPTH_LIMIT) return true;
  report_at(reader, node, "more than %d files include each other in a row; expected fewer, some of them side by side",
            DEPTH_LIMIT);
  return false;
}

/* Returns false after reporting that the file includes itself, directly or through others. */
static bool check_circle(struct Reader *reader, xmlNodePtr node, const struct Source *source) {
  const struct Source *first = source->outer;
  while (first != NULL && (first->canonical_path == NULL || strcmp(first->canonical_path, source->canonical_path) != 0))
    first = first->outer;
  if (first == NULL) return true;
  char *circle = copy_text(source->file);
  for (const struct Source *s = source->outer;; s = s->outer) {
    circle = format_text("%s -> %s", s->file, circle);
    if (s == first) break;
  }
  report_at(reader, node, "files include each other in a circle: %s; expected one that does not include the next",
            circle);
  return false;
}

/*
 * Returns the document of a <system> file, or the system made from a robot file with the options of the <include>. NULL
 * after reporting errors.
 */
static xmlDocPtr load_system(const struct Source *source, const struct RobotOptions *options,
                             struct Diagnostics *diagnostics) {
  xmlDocPtr document = xml_load(source->file, diagnostics);
  if (document == NULL) return NULL;
  if (is_robot(document)) return system_of_robot(document, options, diagnostics);
  xmlNodePtr root = xmlDocGetRootElement(document);
  if (!is_element(root, "system"))
    report_error(diagnostics, line_of(root),
                 "a <%s> cannot be included; expected the file of a <system>, <robot> or <mujoco>",
                 (const char *)root->name);
  else
    for (size_t i = 0; i < ROBOT_WORDS; i++)
      if (has_attribute(source->include, robot_word(i)))
        report_error(diagnostics, line_of(root),
                     "%s=\"...\" of <include> is for robots; expected a file that begins with <robot> or <mujoco>",
                     robot_word(i));
  if (diagnostics->errors == 0) return document;
  xmlFreeDoc(document);
  return NULL;
}

/* True if a <contact> of shapes stands beside the <include>: it replaces that of a robot with this prefix alone. */
static bool has_contact_beside(xmlNodePtr include) {
  for (xmlNodePtr node = include->parent->children; node != NULL; node = node->next)
    if (is_element(node, "contact") && has_attribute(node, "between")) return true;
  return false;
}

/* A file and the overrides of all files. */
struct Overridden {
  struct Names *overrides;
  const struct Source *source;
};

/* Returns the start that an <include> gives a coordinate of a file, as struct RobotOptions needs it. */
static char *own_start(const void *context, const char *coordinate) {
  const struct Overridden *overridden = context;
  char *name = format_text("%s%s", overridden->source->prefix, coordinate);
  const struct Override *override = override_of_attribute(names_find(overridden->overrides, name), "start");
  return override != NULL ? attribute(override->node, "start") : NULL;
}

/*
 * Returns the document of a source. It is parsed once for all <include>s of this file with the same options. They also
 * have the same prefix where contacts stand beside them, or where the height of a robot follows from its starts.
 */
static xmlDocPtr document_of(struct Reader *reader, const struct Source *source) {
  char *key = copy_text(source->canonical_path);
  const char *texts[ROBOT_WORDS];
  for (size_t i = 0; i < ROBOT_WORDS; i++) {
    texts[i] = attribute(source->include, robot_word(i));
    key = format_text("%s\n%s", key, texts[i] != NULL ? texts[i] : "");
  }
  struct RobotOptions options = robot_options_of(texts);
  bool has_height = options.floats && options.has_ground;
  if (has_height || has_contact_beside(source->include)) key = format_text("%s\n%s", key, source->prefix);
  struct Document *known = names_find(reader->includes->documents, key);
  if (known == NULL) {
    struct Diagnostics local = {.file = source->file, .origin = source->origin, .noted = reader->diagnostics->noted};
    known = allocate(1, sizeof *known);
    const struct Overridden overridden = {reader->includes->overrides, source};
    options.include = source->include;
    options.own_start = own_start;
    options.context = &overridden;
    options.value_of = value_of_numbers;
    known->document = load_system(source, &options, &local);
    reader->diagnostics->errors += local.errors;
    names_set(reader->includes->documents, key, known);
  }
  return known->document;
}

/* Appends an override of a name, after those of outer <include>s. */
static void add_override(struct Reader *reader, const char *full_name, struct Override override) {
  struct Override *added = allocate(1, sizeof *added), *last = names_find(reader->includes->overrides, full_name);
  *added = override;
  while (last != NULL && last->inner != NULL) last = last->inner;
  if (last != NULL) last->inner = added;
  else names_set(reader->includes->overrides, full_name, added);
}

static bool is_overridden_in(const struct Override *overrides, const struct Source *source) {
  while (overrides != NULL && overrides->source != source) overrides = overrides->inner;
  return overrides != NULL;
}

static void note_overrides(struct Reader *reader, const struct Source *source) {
  for (xmlNodePtr node = source->include->children; node != NULL; node = node->next) {
    char *text = node->type == XML_ELEMENT_NODE ? attribute(node, "name") : NULL;
    if (text == NULL) continue;
    char *name = parse_name(reader->scope, text, location_of(node, "name", 0), true);
    char *full_name = format_text("%s%s", source->prefix, name != NULL ? name : "");
    if (is_overridden_in(names_find(reader->includes->overrides, full_name), source->outer))
      report_at(reader, node, "the <include> overrides '%s' twice; expected once", name);
    else if (name != NULL)
      add_override(reader, full_name, (struct Override){.node = node, .source = source->outer, .target = source});
  }
}

/* Loads the file and sets the root of the source, unless there are errors. */
static void load(struct Reader *reader, xmlNodePtr node, struct Source *source) {
  source->canonical_path = canonical_path(source->file);
  if (source->canonical_path == NULL)
    report_at(reader, node,
              "the file '%s' cannot be read: %s; expected the file of a <system>, with a path relative to this file",
              source->file, strerror(errno));
  if (source->canonical_path == NULL || !check_depth(reader, node, source) || !check_circle(reader, node, source))
    return;
  note_overrides(reader, source);
  xmlDocPtr document = document_of(reader, source);
  if (document != NULL) source->root = xmlDocGetRootElement(document);
}

static struct Source *create_source(struct Reader *reader, xmlNodePtr node, const char *name, const char *prefix) {
  struct Source *source = allocate(1, sizeof *source), *outer = reader->source;
  char *file = attribute(node, "file");
  long line = line_of(node);
  *source = (struct Source){.file = path_beside(reader, file),
                            .prefix = copy_text(prefix),
                            .origin = format_text(" (included as '%s' on line %ld of %s)", name, line, outer->file),
                            .include = node,
                            .outer = outer};
  names_set(reader->includes->sources, prefix, source);
  load(reader, node, source);
  return source;
}

struct Source *include_open(struct Reader *reader, xmlNodePtr node) {
  char *name = name_attribute(reader, node, "as");
  if (name == NULL) return NULL;
  char *prefix = format_text("%s.", name);
  struct Source *source = names_find(reader->includes->sources, prefix);
  if (source != NULL) {
    report_at(reader, node, "as=\"%s\" is the name of the <include> on line %ld already; expected another name%s", name,
              line_of(source->include),
              source->include == node ? ", with an index such as [i] where a <for> repeats it" : "");
    source = NULL;
  } else source = create_source(reader, node, name, prefix);
  return source != NULL && source->root != NULL ? source : NULL;
}

/* True if the override has the element name of the declaration. Reports a wrong name at its first use. */
static bool check_kind(struct Reader *reader, struct Override *overrides, const char *element, const char *name) {
  const char *as = (const char *)overrides->node->name;
  bool is_right = strcmp(element, as) == 0;
  if (!overrides->is_used && !is_right) {
    struct Source *present = source_enter(reader, overrides->source);
    report_error(reader->diagnostics, line_of(overrides->node), "'%s' is not a <%s> of '%s'; expected <%s name=...>",
                 name + strlen(overrides->target->prefix), as, overrides->target->file, element);
    source_enter(reader, present);
  }
  overrides->is_used = true;
  return is_right;
}

const struct Override *overrides_of(struct Reader *reader, xmlNodePtr node, const char *name) {
  struct Override *outermost = name != NULL ? names_find(reader->includes->overrides, name) : NULL;
  bool is_right = true;
  for (struct Override *overrides = outermost; overrides != NULL; overrides = overrides->inner)
    is_right &= check_kind(reader, overrides, (const char *)node->name, name);
  return is_right ? outermost : NULL;
}

const struct Override *override_of_attribute(const struct Override *overrides, const char *attribute) {
  while (overrides != NULL && !has_attribute(overrides->node, attribute)) overrides = overrides->inner;
  return overrides;
}

const struct Override *override_of_value(const struct Override *overrides) {
  while (overrides != NULL && !has_attribute(overrides->node, "value") && !has_attribute(overrides->node, "start"))
    overrides = overrides->inner;
  return overrides != NULL && has_attribute(overrides->node, "value") ? overrides : NULL;
}

struct Source *enter_override(struct Reader *reader, const struct Override *override, xmlNodePtr *node) {
  if (override != NULL) *node = override->node;
  return source_enter(reader, override != NULL ? override->source : reader->source);
}

bool overridden_number_attribute(struct Reader *reader, xmlNodePtr node, const struct Override *overrides,
                                 const char *name, double *value) {
  struct Source *present = enter_override(reader, override_of_attribute(overrides, name), &node);
  bool right = number_attribute(reader, node, name, value);
  source_enter(reader, present);
  return right;
}

static void report_unused(struct Reader *reader, const struct Override *overrides, const char *full_name) {
  struct Source *present = source_enter(reader, overrides->source);
  const char *name = full_name + strlen(overrides->target->prefix);
  reader->scope->prefix = overrides->target->prefix;
  const char *similar = scope_similar_name(reader->scope, name);
  report_error(reader->diagnostics, line_of(overrides->node), "'%s' has no <%s> '%s'; %s", overrides->target->file,
               (const char *)overrides->node->name, name, suggestion(similar, "expected one of its names"));
  source_enter(reader, present);
}

void check_overrides(struct Reader *reader) {
  const struct Names *names = reader->includes->overrides;
  for (size_t i = 0; i < names->capacity; i++) {
    const struct Override *overrides = names->slots[i].text != NULL ? names->slots[i].meaning : NULL;
    for (; overrides != NULL; overrides = overrides->inner)
      if (!overrides->is_used) report_unused(reader, overrides, names->slots[i].text);
  }
}

/*
 * An <attach model body prefix> becomes a <frame> with a copy of the body, without the frames around it in its own file.
 * Without `body` the frame has all of the <worldbody>. Assets, defaults and settings of the file become further
 * sections at the end of the robot's. So do the elements of other sections that refer to nothing outside of the body, in
 * MuJoCo's order. Frame and sections note the number of the file. Its elements have its own settings and defaults only.
 * <option>, <keyframe> and sections that do not influence the motion are not copied.
 */
#include "robots/expansion/mjcf_attachments.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/paths.h"
#include "names/names.h"
#include "names/similar.h"
#include "robots/expansion/mjcf_files.h"
#include "robots/expansion/mjcf_includes.h"
#include "robots/expansion/mjcf_names.h"
#include "robots/expansion/mjcf_replicas.h"
#include "xml/nodes.h"

/* Attached files of a robot, which may attach each other many times. */
enum { ATTACHED_LIMIT = 1000 };

/* Names that no file can have, as they begin with "-". The first one has the number of the file. */
static const char model_note[] = "-model";
const char mjcf_file_note[] = "-file";

/* A file in which each <attach> is replaced. */
struct Attachment {
  xmlNodePtr root;
  const char *file; /* relative to the robot's file; NULL for that */
  long line;        /* of the <attach> in the robot's file; 0 in that */
  int depth;
  size_t *count; /* files attached so far, in all */
  struct Diagnostics *diagnostics;
};

/* The file that an <attach> names. */
struct Model {
  xmlNodePtr root, attach, body; /* body: NULL for all of the <worldbody> */
  char *prefix;
  size_t number;
  struct Names *names;        /* "kind name" of all elements of the body, and of what is copied for them */
  struct Names *taken;        /* "kind name" of all elements of the attaching file */
  struct Diagnostics of_file; /* messages about the file */
  long line;                  /* of the <attach> in the robot's file */
};

size_t mjcf_model_of(const xmlNode *node) {
  for (; node != NULL && node->type == XML_ELEMENT_NODE; node = node->parent) {
    const xmlAttr *number = xmlHasProp(node, (const xmlChar *)model_note);
    if (number != NULL) return strtoul((const char *)number->children->content, NULL, 10);
  }
  return 0;
}

static void set_text(xmlNodePtr node, const char *name, const char *text) {
  xmlSetProp(node, (const xmlChar *)name, (const xmlChar *)text);
}

static void note_model(const struct Model *model, xmlNodePtr node) {
  if (!has_attribute(node, model_note)) set_text(node, model_note, format_text("%zu", model->number));
}

/* Prefixes an attribute, except for names that are common to all files. */
static void add_prefix(const struct Model *model, xmlNodePtr node, const char *name, const char *common) {
  if (has_attribute(node, name) && !attribute_is(node, name, common))
    set_text(node, name, format_text("%s%s", model->prefix, attribute(node, name)));
}

/* Prefixes all names, classes and references of a copied element and its descendants. */
static void rename_all(const struct Model *model, xmlNodePtr node) {
  static const char *const others[] = {"class", "childclass", "mesh", "material"};
  if (node->type != XML_ELEMENT_NODE) return;
  if (is_element(node, "mesh") && !has_attribute(node, "name") && has_attribute(node, "file"))
    set_text(node, "name", mjcf_asset_name(attribute(node, "file")));
  add_prefix(model, node, "name", "");
  for (size_t i = 0; i < MJCF_REFERENCES; i++) add_prefix(model, node, mjcf_references[i].attribute, "world");
  for (size_t i = 0; i < sizeof others / sizeof *others; i++) add_prefix(model, node, others[i], "main");
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) rename_all(model, child);
}

/* Returns a renamed copy of an element. */
static xmlNodePtr copy_of(const struct Model *model, xmlNodePtr node) {
  xmlNodePtr copy = mjcf_copy(&model->of_file, model->line, node, model->attach->doc);
  rename_all(model, copy);
  return copy;
}

/* Returns the body of this name; NULL for none. similar: the names in place of it. */
static xmlNodePtr find_body(xmlNodePtr parent, const char *name, struct SimilarName *similar) {
  for (xmlNodePtr node = parent->children; node != NULL; node = node->next) {
    if (node->type != XML_ELEMENT_NODE) continue;
    if (is_element(node, "body") && attribute_is(node, "name", name)) return node;
    if (is_element(node, "body") && has_attribute(node, "name")) similar_consider(similar, attribute(node, "name"));
    xmlNodePtr found = find_body(node, name, similar);
    if (found != NULL) return found;
  }
  return NULL;
}

static bool find_in_worlds(struct Attachment *attachment, struct Model *model, const char *name) {
  struct SimilarName similar = {.wanted = name};
  for (xmlNodePtr node = model->root->children; node != NULL && model->body == NULL; node = node->next)
    if (is_element(node, "worldbody")) model->body = find_body(node, name, &similar);
  if (model->body == NULL)
    report_error(attachment->diagnostics, line_of(model->attach), "there is no body '%s' in the <model> '%s'; %s", name,
                 attribute(model->attach, "model"), suggestion(similar.best, "expected an existing name"));
  return model->body != NULL;
}

/* Returns the class that a body inherits from those around it; NULL for none. */
static char *class_around(xmlNodePtr body) {
  char *name = NULL;
  for (xmlNodePtr node = body->parent; name == NULL && node->type == XML_ELEMENT_NODE; node = node->parent)
    name = attribute(node, "childclass");
  return name;
}

/* Puts the frame with the copied bodies before the <attach>. */
static void copy_bodies(struct Model *model) {
  xmlNodePtr frame = xmlNewDocNode(model->attach->doc, NULL, (const xmlChar *)"frame", NULL);
  char *class = model->body != NULL ? class_around(model->body) : NULL;
  set_line(frame, line_of(model->attach));
  note_model(model, frame);
  if (class != NULL) set_text(frame, "childclass", class);
  add_prefix(model, frame, "childclass", "main");
  xmlAddPrevSibling(model->attach, frame);
  if (model->body != NULL) {
    mjcf_note_name(model->names, model->body);
    mjcf_note_names(model->names, model->body);
    xmlAddChild(frame, copy_of(model, model->body));
    return;
  }
  for (xmlNodePtr world = model->root->children; world != NULL; world = world->next) {
    if (!is_element(world, "worldbody")) continue;
    mjcf_note_names(model->names, world);
    for (xmlNodePtr node = world->children; node != NULL; node = node->next)
      if (node->type == XML_ELEMENT_NODE) xmlAddChild(frame, copy_of(model, node));
  }
}

/* Returns a copy of a section without its elements. */
static xmlNodePtr empty_copy(const struct Model *model, xmlNodePtr section) {
  xmlNodePtr copy = xmlDocCopyNode(section, model->attach->doc, 2);
  set_line(copy, line_of(model->attach));
  note_model(model, copy);
  return copy;
}

/*
 * Returns the number of references to others than the copied elements and the world. Reports names that the attaching
 * file has too, if the element also refers to copied ones, as MuJoCo would then take these. node: in the element.
 */
static size_t count_others(struct Attachment *attachment, const struct Model *model, xmlNodePtr element,
                           xmlNodePtr node, bool is_mixed) {
  size_t count = 0;
  for (size_t i = 0; i < MJCF_REFERENCES; i++) {
    const char *name = mjcf_references[i].attribute;
    if (!has_attribute(node, name) || attribute_is(node, name, "world") || mjcf_refers(model->names, node, i)) continue;
    count++;
    if (is_mixed && mjcf_refers(model->taken, node, i))
      report_error(
          attachment->diagnostics, line_of(model->attach),
          "a <%s> of the <model> '%s' refers to the body '%s' and to the %s '%s' outside of it, a name in this "
          "file too; expected another name",
          (const char *)element->name, attribute(model->attach, "model"), attribute(model->attach, "body"),
          mjcf_references[i].kind, attribute(node, name));
  }
  for (xmlNodePtr child = node->children; child != NULL; child = child->next)
    if (child->type == XML_ELEMENT_NODE) count += count_others(attachment, model, element, child, is_mixed);
  return count;
}

/* Copies the elements of a section that refer to the copied bodies only. */
static void copy_references(struct Attachment *attachment, struct Model *model, xmlNodePtr section) {
  xmlNodePtr copy = empty_copy(model, section);
  for (xmlNodePtr node = section->children; node != NULL; node = node->next) {
    if (node->type != XML_ELEMENT_NODE) continue;
    bool refers = mjcf_count_references(model->names, node) > 0;
    if (model->body != NULL && (count_others(attachment, model, node, node, refers) > 0 || !refers)) continue;
    if (is_element(section, "tendon")) mjcf_note_name(model->names, node);
    xmlAddChild(copy, copy_of(model, node));
  }
  xmlAddChild(attachment->root, copy);
}

/* Copies an <asset> without the models in it. */
static void copy_assets(const struct Attachment *attachment, const struct Model *model, xmlNodePtr section) {
  xmlNodePtr copy = empty_copy(model, section);
  for (xmlNodePtr node = section->children; node != NULL; node = node->next)
    if (node->type == XML_ELEMENT_NODE && !is_element(node, "model")) xmlAddChild(copy, copy_of(model, node));
  xmlAddChild(attachment->root, copy);
}

/* Adds the sections that belong to the model. Its own <compiler>, which may be empty, names its file. */
static void copy_sections(struct Attachment *attachment, struct Model *model, const char *file) {
  xmlNodePtr compiler = xmlNewDocNode(model->attach->doc, NULL, (const xmlChar *)"compiler", NULL);
  set_line(compiler, line_of(model->attach));
  note_model(model, compiler);
  set_text(compiler, mjcf_file_note, file);
  xmlAddChild(attachment->root, compiler);
  for (xmlNodePtr node = model->root->children; node != NULL; node = node->next) {
    if (is_element(node, "asset")) copy_assets(attachment, model, node);
    if (!is_element(node, "compiler") && !is_element(node, "default")) continue;
    xmlNodePtr copy = copy_of(model, node);
    note_model(model, copy);
    xmlAddChild(attachment->root, copy);
  }
  for (size_t i = 0; i < MJCF_REFERRING_SECTIONS; i++)
    for (xmlNodePtr node = model->root->children; node != NULL; node = node->next)
      if (is_element(node, mjcf_referring_sections[i])) copy_references(attachment, model, node);
}

/* Returns the <model> in an <asset> of the file that an <attach> names; NULL after reporting that there is none. */
static xmlNodePtr find_asset(struct Attachment *attachment, xmlNodePtr attach) {
  char *name = attribute(attach, "model");
  struct SimilarName similar = {.wanted = name != NULL ? name : ""};
  for (xmlNodePtr section = attachment->root->children; section != NULL; section = section->next)
    for (xmlNodePtr asset = is_element(section, "asset") ? section->children : NULL; asset != NULL;
         asset = asset->next) {
      if (!is_element(asset, "model") || !has_attribute(asset, "name")) continue;
      if (attribute_is(asset, "name", similar.wanted)) return asset;
      similar_consider(&similar, attribute(asset, "name"));
    }
  report_error(attachment->diagnostics, line_of(attach), "there is no <model> '%s' in an <asset> for an <attach>; %s",
               similar.wanted, suggestion(similar.best, "expected one such as <model name=\"arm\" file=\"arm.xml\"/>"));
  return NULL;
}

/* Returns the path of a model's file; NULL after reporting that it cannot be read. */
static char *find_file(struct Attachment *attachment, xmlNodePtr asset) {
  struct Diagnostics *diagnostics = attachment->diagnostics;
  char *named = attribute(asset, "file");
  char *path = named != NULL && *named != '\0' ? path_beside_file(diagnostics->file, named) : NULL;
  if (path == NULL)
    report_error(diagnostics, line_of(asset), "the <model> '%s' names no file; expected file=\"...\"",
                 attribute(asset, "name"));
  else if (canonical_path(path) == NULL)
    report_error(diagnostics, line_of(asset),
                 "the file '%s' of a <model> cannot be read: %s; expected a path relative to this file", named,
                 strerror(errno));
  else if (attachment->depth == MJCF_DEPTH_LIMIT || *attachment->count >= ATTACHED_LIMIT)
    report_error(diagnostics, line_of(asset),
                 "more than %d files attach each other in a row, or more than %d in all; expected fewer",
                 MJCF_DEPTH_LIMIT, ATTACHED_LIMIT);
  else return path;
  return NULL;
}

static void attach_in(struct Attachment *attachment, xmlNodePtr parent);

static void attach_in_worlds(struct Attachment *attachment) {
  xmlNodePtr last = attachment->root->last; /* sections of attached files follow it */
  for (xmlNodePtr node = attachment->root->children; node != NULL; node = node->next) {
    if (is_element(node, "worldbody")) attach_in(attachment, node);
    if (node == last) return;
  }
}

/* Replaces the <include>, <attach> and <replicate> elements of a model's file. Returns false after reporting errors. */
static bool expand(struct Attachment *attachment, const struct Model *model, const char *file) {
  struct Diagnostics *diagnostics = attachment->diagnostics;
  struct FileLine place = {model->of_file.file, model->of_file.origin, 0},
                  former = mjcf_switch_file(diagnostics, place);
  int errors = diagnostics->errors;
  struct Attachment inner = {.root = model->root,
                             .file = file,
                             .line = model->line,
                             .depth = attachment->depth + 1,
                             .count = attachment->count,
                             .diagnostics = diagnostics};
  if (!is_element(model->root, "mujoco"))
    report_error(diagnostics, line_of(model->root), "<%s> is the first element of a <model>; expected <mujoco>",
                 (const char *)model->root->name);
  mjcf_insert_files(model->root, diagnostics);
  attach_in_worlds(&inner);
  if (diagnostics->errors == errors) mjcf_replicate(model->root, diagnostics);
  mjcf_switch_file(diagnostics, former);
  return diagnostics->errors == errors;
}

/* Attaches the body of a model's file, which was read. */
static void attach_model(struct Attachment *attachment, struct Model *model, const char *file) {
  const char *body = attribute(model->attach, "body");
  if (!expand(attachment, model, file)) return;
  if (body != NULL && !find_in_worlds(attachment, model, body)) return;
  model->number = ++*attachment->count;
  copy_bodies(model);
  copy_sections(attachment, model, file);
}

/* Reports attributes that are not read: without them the bodies would stand elsewhere, or be others. */
static void check_attributes(const struct Attachment *attachment, xmlNodePtr node) {
  for (const xmlAttr *at = node->properties; at != NULL; at = at->next) {
    const char *name = (const char *)at->name;
    bool is_read = strcmp(name, "model") == 0 || strcmp(name, "body") == 0 || strcmp(name, "prefix") == 0;
    if (!is_read)
      report_error(attachment->diagnostics, line_of(node),
                   "%s of <attach> is not read; expected model, body and prefix, and a <frame> around it for its place",
                   name);
  }
}

static void replace(struct Attachment *attachment, xmlNodePtr node) {
  struct Diagnostics *diagnostics = attachment->diagnostics;
  check_attributes(attachment, node);
  if (!has_attribute(node, "prefix"))
    report_error(diagnostics, line_of(node), "an <attach> has no prefix; expected prefix=\"...\" for its names");
  xmlNodePtr asset = find_asset(attachment, node);
  char *path = asset != NULL ? find_file(attachment, asset) : NULL;
  if (path == NULL || !has_attribute(node, "prefix")) return;
  struct FileLine at = file_line(diagnostics, line_of(node));
  struct FileLine place = {path, format_text(" (attached on line %ld of %s)", at.line, at.file), 0};
  xmlDocPtr document = mjcf_load(diagnostics, place);
  if (document == NULL) return;
  struct Model model = {.root = xmlDocGetRootElement(document),
                        .attach = node,
                        .prefix = attribute(node, "prefix"),
                        .names = names_create(),
                        .taken = names_create(),
                        .of_file = *diagnostics,
                        .line = attachment->line > 0 ? attachment->line : line_of(node)};
  mjcf_switch_file(&model.of_file, place);
  mjcf_note_names(model.taken, attachment->root);
  char *named = attribute(asset, "file");
  attach_model(attachment, &model, attachment->file != NULL ? path_beside_file(attachment->file, named) : named);
  xmlFreeDoc(document);
}

static void attach_in(struct Attachment *attachment, xmlNodePtr parent) {
  for (xmlNodePtr node = parent->children, next; node != NULL; node = next) {
    next = node->next;
    if (is_element(node, "attach")) {
      replace(attachment, node);
      xmlUnlinkNode(node);
      xmlFreeNode(node);
    } else if (node->type == XML_ELEMENT_NODE) attach_in(attachment, node);
  }
}

size_t mjcf_attach(xmlNodePtr root, struct Diagnostics *diagnostics) {
  size_t count = 0;
  struct Attachment attachment = {.root = root, .count = &count, .diagnostics = diagnostics};
  attach_in_worlds(&attachment);
  return count;
}

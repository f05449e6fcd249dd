#include "robots/expansion/mjcf_names.h"

#include <string.h>

#include "base/memory.h"
#include "xml/nodes.h"

const struct MjcfReference mjcf_references[MJCF_REFERENCES] = {
    {"joint", "joint"},   {"joint1", "joint"}, {"joint2", "joint"},  {"jointinparent", "joint"}, {"site", "site"},
    {"site1", "site"},    {"site2", "site"},   {"refsite", "site"},  {"cranksite", "site"},      {"slidersite", "site"},
    {"sidesite", "site"}, {"body", "body"},    {"body1", "body"},    {"body2", "body"},          {"geom", "geom"},
    {"geom1", "geom"},    {"geom2", "geom"},   {"tendon", "tendon"}, {"tendon1", "tendon"},      {"tendon2", "tendon"},
};

const char *const mjcf_referring_sections[MJCF_REFERRING_SECTIONS] = {"tendon", "equality", "actuator", "contact"};

static const char *kind_of(xmlNodePtr node) {
  if (is_element(node, "freejoint")) return "joint";
  return is_element(node, "fixed") || is_element(node, "spatial") ? "tendon" : (const char *)node->name;
}

void mjcf_note_name(struct Names *names, xmlNodePtr node) {
  if (!has_attribute(node, "name")) return;
  char *key = format_text("%s %s", kind_of(node), attribute(node, "name"));
  names_set(names, key, copy_text(key));
}

void mjcf_note_names(struct Names *names, xmlNodePtr parent) {
  for (xmlNodePtr node = parent->children; node != NULL; node = node->next) {
    if (node->type != XML_ELEMENT_NODE) continue;
    mjcf_note_name(names, node);
    mjcf_note_names(names, node);
  }
}

bool mjcf_refers(const struct Names *names, xmlNodePtr node, size_t reference) {
  char *name = attribute(node, mjcf_references[reference].attribute);
  return name != NULL && names_find(names, format_text("%s %s", mjcf_references[reference].kind, name)) != NULL;
}

size_t mjcf_count_references(const struct Names *names, xmlNodePtr node) {
  size_t count = 0;
  for (size_t i = 0; i < MJCF_REFERENCES; i++)
    count += names != NULL ? mjcf_refers(names, node, i) : has_attribute(node, mjcf_references[i].attribute);
  for (xmlNodePtr child = node->children; child != NULL; child = child->next)
    if (child->type == XML_ELEMENT_NODE) count += mjcf_count_references(names, child);
  return count;
}

char *mjcf_asset_name(const char *file) {
  const char *slash = strrchr(file, '/'), *begin = slash != NULL ? slash + 1 : file, *end = strrchr(begin, '.');
  return format_text("%.*s", (int)(end != NULL ? end - begin : (long)strlen(begin)), begin);
}

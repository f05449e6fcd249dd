#include "xml/nodes.h"

#include <string.h>

#include "base/memory.h"

bool is_element(const xmlNode *node, const char *name) {
  return node->type == XML_ELEMENT_NODE && xmlStrEqual(node->name, (const xmlChar *)name);
}

bool has_attribute(xmlNodePtr node, const char *name) {
  return xmlHasProp(node, (const xmlChar *)name) != NULL;
}

char *attribute(xmlNodePtr node, const char *name) {
  xmlChar *value = xmlGetProp(node, (const xmlChar *)name);
  if (value == NULL) return NULL;
  char *copy = copy_text((const char *)value);
  xmlFree(value);
  return copy;
}

bool attribute_is(xmlNodePtr node, const char *name, const char *value) {
  char *text = attribute(node, name);
  return text != NULL && strcmp(text, value) == 0;
}

/* Returns a blank followed by the line breaks of the text. */
static char *breaks_of(const char *text) {
  char *breaks = copy_text(text), *end = breaks;
  for (; *text != '\0'; text++)
    if (*text == '\n') *end++ = '\n';
  *end = '\0';
  return format_text(" %s", breaks);
}

char *text_of(xmlNodePtr node) {
  char *text = copy_text("");
  for (xmlNodePtr part = node->children; part != NULL; part = part->next) {
    bool comment = part->type == XML_COMMENT_NODE || part->type == XML_PI_NODE;
    xmlChar *content = xmlNodeGetContent(part);
    const char *known = content != NULL ? (const char *)content : "";
    text = format_text("%s%s", text, comment ? breaks_of(known) : known);
    xmlFree(content);
  }
  return text;
}

bool is_robot(xmlDocPtr document) {
  const xmlNode *root = xmlDocGetRootElement(document);
  return root != NULL && (is_element(root, "robot") || is_element(root, "mujoco"));
}

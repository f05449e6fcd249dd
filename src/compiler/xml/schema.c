#include "xml/schema.h"

#include <stdbool.h>
#include <string.h>

#include <libxml/xmlschemas.h>

#include "base/memory.h"
#include "names/hints.h"
#include "names/similar.h"
#include "xml/nodes.h"

/* Names that are kept for a position of the schema. */
enum { CHOICE_LIMIT = 40 };

/* The names or values that the schema allows in one position. */
struct Choices {
  char *names[CHOICE_LIMIT];
  size_t count;
};

/* A validation in progress. */
struct SchemaCheck {
  xmlDocPtr schema;
  struct Diagnostics *diagnostics;
  xmlNodePtr last; /* the element at which validation was cut off; NULL for none */
};

/*
 * Cuts off all nodes after the element, at every level up to the root, so that validation ends there. libxml2 counts
 * all preceding elements for each error, which is quadratic in files with many errors. show_rest() restores the nodes.
 */
static void hide_rest(struct SchemaCheck *check, xmlNodePtr element) {
  check->last = element;
  for (xmlNodePtr node = element; node != NULL && node->type == XML_ELEMENT_NODE; node = node->parent) {
    node->_private = node->next;
    node->next = NULL;
  }
}

static void show_rest(struct SchemaCheck *check) {
  for (xmlNodePtr node = check->last; node != NULL && node->type == XML_ELEMENT_NODE; node = node->parent) {
    node->next = node->_private;
    node->_private = NULL;
  }
  check->last = NULL;
}

/* Returns the first declaration <xs:kind name="..."> below a node of the schema, in document order; NULL for none. */
static xmlNodePtr find_declared(xmlNodePtr parent, const char *kind, const char *name) {
  xmlNodePtr found = NULL;
  for (xmlNodePtr node = parent->children; node != NULL && found == NULL; node = node->next)
    found = is_element(node, kind) && attribute_is(node, "name", name) ? node : find_declared(node, kind, name);
  return found;
}

static void collect(xmlNodePtr schema, xmlNodePtr declaration, const char *kind, const char *key,
                    struct Choices *choices);

/* Collects from the target of a reference, such as <xs:group ref="..."> or <xs:extension base="...">. */
static void collect_referred(xmlNodePtr schema, xmlNodePtr node, const char *reference, const char *kind_of_target,
                             const char *kind, const char *key, struct Choices *choices) {
  xmlChar *name = xmlGetProp(node, (const xmlChar *)reference);
  xmlNodePtr target = name != NULL ? find_declared(schema, kind_of_target, (const char *)name) : NULL;
  if (target != NULL) collect(schema, target, kind, key, choices);
  xmlFree(name);
}

/*
 * Collects the attribute `key` of every <xs:kind> that the schema allows at a node, such as the names of all attributes
 * of an element. Nested elements are not entered.
 */
static void collect(xmlNodePtr schema, xmlNodePtr declaration, const char *kind, const char *key,
                    struct Choices *choices) {
  collect_referred(schema, declaration, "type", "complexType", kind, key, choices);
  collect_referred(schema, declaration, "base", "complexType", kind, key, choices);
  collect_referred(schema, declaration, "ref", (const char *)declaration->name, kind, key, choices);
  for (xmlNodePtr node = declaration->children; node != NULL; node = node->next) {
    xmlChar *name = is_element(node, kind) ? xmlGetProp(node, (const xmlChar *)key) : NULL;
    if (name != NULL && choices->count < CHOICE_LIMIT) choices->names[choices->count++] = copy_text((const char *)name);
    xmlFree(name);
    if (node->type == XML_ELEMENT_NODE && !is_element(node, "element") && !is_element(node, "attribute"))
      collect(schema, node, kind, key, choices);
  }
}

/*
 * Returns the declaration of an element. It is the one in the type named after its parent if there is one, else the
 * first one in the schema.
 */
static xmlNodePtr declaration_of(const struct SchemaCheck *check, xmlNodePtr element) {
  xmlNodePtr schema = xmlDocGetRootElement(check->schema);
  bool is_inside = element->parent->type == XML_ELEMENT_NODE;
  xmlNodePtr around = is_inside ? find_declared(schema, "complexType", (const char *)element->parent->name) : NULL;
  xmlNodePtr own = around != NULL ? find_declared(around, "element", (const char *)element->name) : NULL;
  return own != NULL ? own : find_declared(schema, "element", (const char *)element->name);
}

static struct Choices choices_in(const struct SchemaCheck *check, xmlNodePtr element, const char *kind) {
  struct Choices choices = {.count = 0};
  xmlNodePtr declaration = declaration_of(check, element);
  if (declaration != NULL) collect(xmlDocGetRootElement(check->schema), declaration, kind, "name", &choices);
  return choices;
}

/*
 * Returns the values that the schema lists for an attribute, from the type named after its element or else from
 * anywhere. Empty if the schema lists none.
 */
static struct Choices choices_of_value(const struct SchemaCheck *check, xmlNodePtr element, const char *attribute) {
  struct Choices choices = {.count = 0};
  xmlNodePtr schema = xmlDocGetRootElement(check->schema);
  xmlNodePtr type = find_declared(schema, "complexType", (const char *)element->name);
  xmlNodePtr declaration = find_declared(type != NULL ? type : schema, "attribute", attribute);
  if (declaration == NULL) declaration = find_declared(schema, "attribute", attribute);
  if (declaration != NULL) collect(schema, declaration, "enumeration", "value", &choices);
  return choices;
}

/* Returns "did you mean 'unit'?" for the most similar choice, or "expected name, start or unit" if none is similar. */
static char *remedy(const char *wanted, struct Choices choices) {
  struct SimilarName similar = {.wanted = wanted};
  struct TextStream text;
  FILE *file = open_text(&text);
  for (size_t i = 0; i < choices.count; i++) similar_consider(&similar, choices.names[i]);
  if (similar.best != NULL) fprintf(file, "did you mean '%s'?", similar.best);
  else fputs(choices.count > 0 ? "expected " : "expected none", file);
  for (size_t i = 0; similar.best == NULL && i < choices.count; i++)
    fprintf(file, "%s%s", i == 0 ? "" : i + 1 == choices.count ? " or " : ", ", choices.names[i]);
  return close_text(&text);
}

static void report_attribute(const struct SchemaCheck *check, xmlNodePtr element, const char *name) {
  const char *of = (const char *)element->name;
  char *what_then = remedy(name, choices_in(check, element, "attribute"));
  report_error(check->diagnostics, line_of_attribute(element, name), "<%s> has no attribute '%s'; %s", of, name,
               what_then);
}

/* Reports a missing attribute, unless a given one is a probable misspelling, which is reported by itself. */
static void report_missing_attribute(const struct SchemaCheck *check, xmlNodePtr element, const char *name) {
  for (const xmlAttr *given = element->properties; given != NULL; given = given->next) {
    struct SimilarName similar = {.wanted = (const char *)given->name};
    similar_consider(&similar, name);
    if (similar.best != NULL) return;
  }
  report_error(check->diagnostics, line_of(element), "<%s> needs the attribute '%s'; expected %s=\"...\"",
               (const char *)element->name, name, name);
}

static void report_element(const struct SchemaCheck *check, xmlNodePtr element) {
  const char *name = (const char *)element->name, *parent = (const char *)element->parent->name;
  const char *hint = hint_for_element(name);
  bool is_known = find_declared(xmlDocGetRootElement(check->schema), "element", name) != NULL;
  char *what_then = remedy(name, choices_in(check, element->parent, "element"));
  report_error(check->diagnostics, line_of(element), "<%s> %s <%s>; %s", name,
               is_known ? "cannot stand in" : "is not an element of", parent, *hint != '\0' ? hint : what_then);
}

/* Returns the first child of this type that is not blank; NULL for none. */
static xmlNodePtr first_of(xmlNodePtr element, xmlElementType type) {
  xmlNodePtr node = element->children;
  while (node != NULL && (node->type != type || xmlIsBlankNode(node))) node = node->next;
  return node;
}

static void report_text(const struct SchemaCheck *check, const xmlNode *node, const char *where, const char *expected) {
  const char *word = (const char *)node->content + strspn((const char *)node->content, " \t\r\n");
  long line = line_of(node);
  for (const char *c = (const char *)node->content; c < word; c++) line += *c == '\n';
  report_error(check->diagnostics, line, "the text '%.*s' stands in <%s>; expected it in %s",
               (int)strcspn(word, " \t\r\n"), word, where, expected);
}

/* Reports text between elements, or content in an element that must be empty. */
static void report_content(const struct SchemaCheck *check, xmlNodePtr element) {
  const char *name = (const char *)element->name;
  const xmlNode *text = first_of(element, XML_TEXT_NODE), *inner = first_of(element, XML_ELEMENT_NODE);
  struct Choices elements = choices_in(check, element, "element");
  if (elements.count > 0 && text != NULL)
    report_text(check, text, name, "an element such as <potential>...</potential>, or in <!-- ... -->");
  else if (inner != NULL)
    report_error(check->diagnostics, line_of(inner),
                 "<%s> stands inside of <%s>; expected the end of <%s> before it, by </%s> or />",
                 (const char *)inner->name, name, name, name);
  else if (text != NULL) report_text(check, text, name, "an attribute");
}

static void report_root(const struct SchemaCheck *check, xmlNodePtr root) {
  const char *name = (const char *)root->name;
  if (root->ns != NULL)
    report_error(check->diagnostics, line_of(root), "<%s> belongs to the namespace '%s'; expected no xmlns", name,
                 (const char *)root->ns->href);
  else
    report_error(check->diagnostics, line_of(root),
                 "the file begins with <%s>; expected <system name=\"...\">, <linearization of=\"...\" name=\"...\"> "
                 "or <robot name=\"...\">",
                 name);
}

/* Returns the attribute that a message of libxml2 mentions; "" if the message is about the element's text. */
static char *attribute_in(const char *message) {
  static const char before[] = "attribute '";
  const char *begin = strstr(message, before);
  if (begin == NULL) return copy_text("");
  begin += strlen(before);
  return format_text("%.*s", (int)strcspn(begin, "'"), begin);
}

static void report_value(const struct SchemaCheck *check, const xmlError *error, xmlNodePtr element) {
  char *name = attribute_in(error->message), *what_then = NULL;
  char *value = (char *)xmlGetProp(element, (const xmlChar *)name);
  bool is_text = *name == '\0';
  char *what = is_text ? format_text("<%s>", (const char *)element->name)
                       : format_text("%s=\"%.60s\" of <%s>", name, value, (const char *)element->name);
  switch (error->code) {
  case XML_SCHEMAV_CVC_MINLENGTH_VALID:
    what_then = copy_text(is_text ? "is empty; expected an expression in it" : "is empty; expected a value");
    break;
  case XML_SCHEMAV_CVC_MAXLENGTH_VALID:
    what_then = format_text("is too long; expected at most %s characters", (const char *)error->str3);
    break;
  case XML_SCHEMAV_CVC_PATTERN_VALID:
    if (strcmp(name, "color") == 0) what_then = copy_text("is not a color; expected one such as #ff8000, or #ff800080");
    else
      what_then = format_text("is not a name; expected letters a to z, digits and _, with no digit first%s",
                              strstr(error->str2, "\\[") != NULL ? ", and an index as in name[1]" : "");
    break;
  case XML_SCHEMAV_CVC_ENUMERATION_VALID: {
    char *list = remedy(value, choices_of_value(check, element, name));
    what_then = format_text("is not known; %s", list);
    break;
  }
  case XML_SCHEMAV_CVC_MINEXCLUSIVE_VALID: what_then = copy_text("is not above 0; expected a positive number"); break;
  default: what_then = copy_text("is not a number; expected one such as 2, 0.5 or 1e-3");
  }
  report_error(check->diagnostics, line_of_attribute(element, name), "%s %s", what, what_then);
  xmlFree(value);
}

static void report_schema_error(void *context, xmlErrorPtr error) {
  struct SchemaCheck *check = context;
  xmlNodePtr element = error->node;
  if (check->last != NULL) return;
  if (element == NULL || error->message == NULL) {
    report_error(check->diagnostics, error->line,
                 "the file does not match the schema; expected the elements and attributes of fmu/system.xsd");
    return;
  }
  switch (error->code) {
  case XML_SCHEMAV_CVC_TYPE_3_1_1:
  case XML_SCHEMAV_CVC_COMPLEX_TYPE_3_2_1:
  case XML_SCHEMAV_CVC_COMPLEX_TYPE_3_2_2: report_attribute(check, element, error->str1); break;
  case XML_SCHEMAV_CVC_COMPLEX_TYPE_4: report_missing_attribute(check, element, error->str1); break;
  case XML_SCHEMAV_ELEMENT_CONTENT: report_element(check, element); break;
  case XML_SCHEMAV_CVC_TYPE_3_1_2:
  case XML_SCHEMAV_CVC_COMPLEX_TYPE_2_1:
  case XML_SCHEMAV_CVC_COMPLEX_TYPE_2_2:
  case XML_SCHEMAV_CVC_COMPLEX_TYPE_2_3: report_content(check, element); break;
  case XML_SCHEMAV_CVC_ELT_1: report_root(check, element); break;
  default: report_value(check, error, element);
  }
  if (check->diagnostics->errors > ERROR_LIMIT && element->type == XML_ELEMENT_NODE) hide_rest(check, element);
}

static xmlDocPtr schema_document(void) {
  return xmlReadMemory(system_schema, (int)strlen(system_schema), NULL, NULL, 0);
}

void schema_check(xmlDocPtr document, struct Diagnostics *diagnostics) {
  struct SchemaCheck check = {.schema = schema_document(), .diagnostics = diagnostics};
  xmlSchemaParserCtxtPtr parser = check.schema != NULL ? xmlSchemaNewDocParserCtxt(check.schema) : NULL;
  xmlSchemaPtr schema = parser != NULL ? xmlSchemaParse(parser) : NULL;
  xmlSchemaValidCtxtPtr validation = schema != NULL ? xmlSchemaNewValidCtxt(schema) : NULL;
  if (validation != NULL) {
    int errors = diagnostics->errors;
    xmlSchemaSetValidStructuredErrors(validation, (xmlStructuredErrorFunc)report_schema_error, &check);
    bool is_right = xmlSchemaValidateDoc(validation, document) == 0;
    show_rest(&check);
    if (!is_right && diagnostics->errors == errors)
      report_error(diagnostics, 0,
                   "the file does not match the schema; expected the elements and attributes of fmu/system.xsd");
  } else {
    report_error(diagnostics, 0, "the schema of system.xml cannot be used; expected libxml2 with schema support");
  }
  xmlSchemaFreeValidCtxt(validation);
  xmlSchemaFree(schema);
  xmlSchemaFreeParserCtxt(parser);
  xmlFreeDoc(check.schema);
}

/* Prints the elements declared below a node of the schema, each at its first declaration. */
static void print_elements(FILE *file, xmlNodePtr schema, xmlNodePtr parent) {
  for (xmlNodePtr node = parent->children; node != NULL; node = node->next) {
    char *name = is_element(node, "element") ? attribute(node, "name") : NULL;
    if (name != NULL && find_declared(schema, "element", name) == node) fprintf(file, "element %s\n", name);
    print_elements(file, schema, node);
  }
}

void schema_print_elements(FILE *file) {
  xmlDocPtr document = schema_document();
  xmlNodePtr schema = xmlDocGetRootElement(document);
  if (schema != NULL) print_elements(file, schema, schema);
  xmlFreeDoc(document);
}

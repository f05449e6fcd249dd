#include "xml/xml.h"

#include <string.h>

#include <libxml/parser.h>

#include "base/memory.h"
#include "xml/nodes.h"
#include "xml/schema.h"
#include "xml/source_text.h"

static bool is_undefined_prefix(const xmlError *error) {
  return error->code == XML_NS_ERR_UNDEFINED_NAMESPACE && error->str1 != NULL && error->str2 != NULL;
}

/* True if the error is a prefix without xmlns in a robot's file, which drop_prefixes() warns of. */
static bool is_prefix_in_robot(const xmlError *error) {
  const xmlParserCtxt *parser = error->ctxt;
  return is_undefined_prefix(error) && parser != NULL && parser->myDoc != NULL && is_robot(parser->myDoc);
}

/* Returns the name after an undeclared prefix, which libxml2 leaves in it; NULL for none. */
static const char *name_after_prefix(const xmlNode *node) {
  const char *colon = node->ns == NULL ? strchr((const char *)node->name, ':') : NULL;
  return colon != NULL ? colon + 1 : NULL;
}

/* Renames elements with an undeclared prefix, except those of xacro. Returns the first one's full name; NULL for none. */
static char *drop_prefixes(xmlNodePtr node, long *line) {
  char *first = NULL;
  const char *name = name_after_prefix(node);
  if (name != NULL && strncmp((const char *)node->name, "xacro:", 6) != 0) {
    char *own = copy_text(name);
    first = copy_text((const char *)node->name);
    *line = line_of(node);
    xmlNodeSetName(node, (const xmlChar *)own);
  }
  for (xmlNodePtr child = node->children; child != NULL; child = child->next) {
    long other;
    char *found = child->type == XML_ELEMENT_NODE ? drop_prefixes(child, &other) : NULL;
    if (found == NULL || first != NULL) continue;
    first = found;
    *line = other;
  }
  return first;
}

static void warn_of_prefixes(xmlDocPtr document, const struct Diagnostics *diagnostics) {
  long line;
  char *name = drop_prefixes(xmlDocGetRootElement(document), &line);
  if (name == NULL) return;
  int length = (int)strcspn(name, ":");
  report_warning(diagnostics, line,
                 "<%s> is read without its prefix, which the file does not define; expected xmlns:%.*s=\"...\" in its "
                 "first element",
                 name, length, name);
}

/* Returns a message for an error of the XML parser in terms of the file; NULL to keep the message of libxml2. */
static char *meaning_of(const xmlError *error) {
  const char *message = error->message != NULL ? error->message : "", *name = error->str1, *other = error->str2;
  if (strstr(message, "EntityRef") != NULL)
    return copy_text("a text has a bare '&'; write &amp; for the sign itself, or 'and' between conditions");
  if (strstr(message, "not proper UTF-8") != NULL)
    return copy_text("the file has letters in an encoding other than UTF-8; save it in UTF-8");
  switch (error->code) {
  case XML_ERR_NAME_REQUIRED:
    return copy_text("'<' begins an element or stands in a text; write &lt; for the sign itself, or 0 > x for x < 0");
  case XML_ERR_LT_IN_ATTRIBUTE:
    return copy_text("'<' stands in an attribute, or a quote is missing before it; write &lt; for the sign itself, or "
                     "0 > x for x < 0");
  case XML_ERR_ATTRIBUTE_NOT_STARTED:
    return copy_text("the value of an attribute is not in straight quotes; expected name=\"value\"");
  case XML_ERR_ATTRIBUTE_WITHOUT_VALUE:
    return format_text("the attribute '%s' has no value; expected %s=\"...\"", name, name);
  case XML_ERR_ATTRIBUTE_REDEFINED: return format_text("the attribute '%s' is given twice; expected once", name);
  case XML_ERR_SPACE_REQUIRED:
    return copy_text(
        "attributes do not follow each other; expected name=\"value\" name=\"value\", with both quotes and "
        "a blank between them");
  case XML_ERR_GT_REQUIRED: return format_text("<%s> is not closed; expected > or /> at its end", name);
  case XML_ERR_TAG_NOT_FINISHED:
    return copy_text("the file ends inside an element; expected its end, such as </system>");
  case XML_ERR_TAG_NAME_MISMATCH:
    return format_text(
        "</%s> stands where <%s> of line %d is still open; expected </%s> before it, or /> at the end of "
        "<%s>",
        other, name, error->int1, name, name);
  case XML_ERR_DOCUMENT_EMPTY:
    return copy_text("the file does not begin with an element; expected <system name=\"...\"> and its elements");
  case XML_ERR_DOCUMENT_END:
    return copy_text("the file has text after the end of its first element; expected one <system> around everything");
  case XML_ERR_RESERVED_XML_NAME:
    return copy_text("<?xml ...?> stands further down; expected it at the very beginning of the file, or left out");
  case XML_ERR_INVALID_ENCODING:
  case XML_ERR_UNSUPPORTED_ENCODING:
    return copy_text(
        "the file does not match the encoding of its first line, or that encoding is unknown; expected UTF-8");
  case XML_ERR_HYPHEN_IN_COMMENT: return copy_text("'--' stands inside of <!-- ... -->; expected - or a colon");
  case XML_ERR_COMMENT_NOT_FINISHED: return copy_text("a comment has no end; expected --> after <!--");
  case XML_ERR_UNDECLARED_ENTITY:
    return format_text("'&%s;' is not known; expected the character itself, and * for a product", name);
  case XML_ERR_INVALID_CHAR: return copy_text("there is an invisible character here; remove it");
  case XML_WAR_UNKNOWN_VERSION:
    return copy_text("the first line names a version of XML other than 1.0; expected <?xml version=\"1.0\"?>, or no "
                     "such line");
  default: return NULL;
  }
}

static void report_xml_error(void *diagnostics, xmlErrorPtr error) {
  const char *message = error->message != NULL ? error->message : "not readable";
  struct Diagnostics *reported = diagnostics;
  bool is_of_parser = error->domain == XML_FROM_PARSER, is_of_prefix = error->domain == XML_FROM_NAMESPACE;
  if ((is_of_parser || is_of_prefix) && reported->errors > 0) return; /* caused by the first error */
  if (is_of_prefix && is_prefix_in_robot(error)) return;
  char *meaning = is_of_parser ? meaning_of(error) : NULL;
  if (is_of_prefix && is_undefined_prefix(error))
    meaning = format_text("'%s:%s' has a prefix; expected the name alone", error->str1, error->str2);
  if (meaning != NULL) message = meaning;
  int length = (int)strcspn(message, "\n");
  if (error->level == XML_ERR_WARNING) report_warning(diagnostics, error->line, "%.*s", length, message);
  else report_error(diagnostics, error->line, "%.*s", length, message);
}

/*
 * Stops parsing at a document type declaration: by its entities a short file can expand to any length ("billion
 * laughs"). libxml2 passes its parser as the first argument.
 */
static void reject_document_type(void *context, const xmlChar *name, const xmlChar *external_id,
                                 const xmlChar *system_id) {
  (void)name, (void)external_id, (void)system_id;
  xmlParserCtxtPtr parser = context;
  report_error(parser->_private, parser->input->line,
               "<!DOCTYPE ...> and entities are not read; expected the file without them, and <constant>, <define> or "
               "<for> in place of entities");
  xmlStopParser(parser);
}

static xmlDocPtr parse(const char *path, const char *text, size_t length, struct Diagnostics *diagnostics) {
  xmlParserCtxtPtr parser = xmlNewParserCtxt();
  if (parser == NULL) return NULL;
  parser->_private = diagnostics;
  parser->sax->internalSubset = reject_document_type;
  int errors = diagnostics->errors;
  enum { OPTIONS = XML_PARSE_NONET | XML_PARSE_NOCDATA };
  xmlDocPtr document = xmlCtxtReadMemory(parser, text, (int)length, path, NULL, OPTIONS);
  xmlFreeParserCtxt(parser);
  if (diagnostics->errors == errors) {
    if (document != NULL) lines_find(document, text, length);
    if (document != NULL && is_robot(document)) warn_of_prefixes(document, diagnostics);
    return document;
  }
  xmlFreeDoc(document);
  return NULL;
}

xmlDocPtr xml_read(const char *path, struct Diagnostics *diagnostics) {
  size_t length;
  char *text = source_text(path, &length, diagnostics);
  xmlSetStructuredErrorFunc(diagnostics, (xmlStructuredErrorFunc)report_xml_error);
  xmlDocPtr document = text != NULL ? parse(path, text, length, diagnostics) : NULL;
  release(text);
  if (document == NULL && diagnostics->errors == 0)
    report_error(diagnostics, 0, "cannot be read; expected an XML file");
  xmlSetStructuredErrorFunc(NULL, NULL);
  return document;
}

xmlDocPtr xml_load(const char *path, struct Diagnostics *diagnostics) {
  xmlDocPtr document = xml_read(path, diagnostics);
  if (document != NULL && !is_robot(document)) schema_check(document, diagnostics);
  if (diagnostics->errors == 0) return document;
  xmlFreeDoc(document);
  return NULL;
}

#include "read/xml.h"

#include <stdbool.h>
#include <string.h>

#include <libxml/parser.h>
#include <libxml/xmlschemas.h>

/* What may stand where an element was not expected; libxml2 does not tell. */
static const char *expected_elements(const xmlError *error) {
  const xmlNode *node = error->node;
  if (error->domain != XML_FROM_SCHEMASV || error->code != XML_SCHEMAV_ELEMENT_CONTENT || node->parent == NULL)
    return "";
  if (xmlStrEqual(node->parent->name, (const xmlChar *)"linearization")) return " Expected at, solver or experiment.";
  return " Expected constant, parameter, input, coordinate, particle, body, kinetic, potential, dissipation, force, "
         "define, output or for, and outside of <for> also work, solver or experiment.";
}

/* What XML says of characters that have a meaning of their own in it, in other words. */
static const char *meaning_of(const xmlError *error) {
  if (error->domain != XML_FROM_PARSER) return NULL;
  bool of_reference = error->message != NULL && strstr(error->message, "EntityRef") != NULL;
  if (of_reference)
    return "'&' stands in a text; write &amp; for the sign itself, and min, max, abs or sign for conditions";
  switch (error->code) {
  case XML_ERR_NAME_REQUIRED:
    return "'<' begins an element or stands in a text; write &lt; for the sign itself, and min, max, abs or sign for "
           "conditions";
  case XML_ERR_LT_IN_ATTRIBUTE:
    return "'<' stands in an attribute; write &lt; for the sign itself, and min, max, abs or sign for conditions";
  case XML_ERR_ATTRIBUTE_NOT_STARTED: return "the value of an attribute is not in quotes; expected name=\"value\"";
  case XML_ERR_TAG_NOT_FINISHED: return "the file ends inside an element; expected its end, such as </system>";
  default: return NULL;
  }
}

static void report_xml_error(void *diagnostics, xmlErrorPtr error) {
  const char *message = error->message != NULL ? error->message : "not readable";
  struct Diagnostics *told = diagnostics;
  if (error->domain == XML_FROM_PARSER && told->errors > 0) return; /* what follows from the first mistake */
  if (meaning_of(error) != NULL) message = meaning_of(error);
  int length = (int)strcspn(message, "\n");
  if (error->level == XML_ERR_WARNING) report_warning(diagnostics, error->line, "%.*s", length, message);
  else report_error(diagnostics, error->line, "%.*s%s", length, message, expected_elements(error));
}

static void validate(xmlDocPtr document, struct Diagnostics *diagnostics) {
  xmlSchemaParserCtxtPtr parser = xmlSchemaNewMemParserCtxt(system_schema, (int)strlen(system_schema));
  xmlSchemaPtr schema = parser != NULL ? xmlSchemaParse(parser) : NULL;
  xmlSchemaValidCtxtPtr validation = schema != NULL ? xmlSchemaNewValidCtxt(schema) : NULL;
  if (validation != NULL) {
    int errors = diagnostics->errors;
    xmlSchemaSetValidStructuredErrors(validation, (xmlStructuredErrorFunc)report_xml_error, diagnostics);
    if (xmlSchemaValidateDoc(validation, document) != 0 && diagnostics->errors == errors)
      report_error(diagnostics, 0, "the file does not match the schema of system.xml");
  } else {
    report_error(diagnostics, 0, "the schema of system.xml cannot be used; expected libxml2 with schema support");
  }
  xmlSchemaFreeValidCtxt(validation);
  xmlSchemaFree(schema);
  xmlSchemaFreeParserCtxt(parser);
}

/*
 * Ends the reading at a document type declaration, with which a short file can stand for one of any length. libxml2 hands
 * its parser on as the first argument.
 */
static void refuse_document_type(void *context, const xmlChar *name, const xmlChar *external_id,
                                 const xmlChar *system_id) {
  (void)name, (void)external_id, (void)system_id;
  xmlParserCtxtPtr parser = context;
  report_error(parser->_private, parser->input->line,
               "<!DOCTYPE ...> and entities are not read; expected the file without them, and <constant>, <define> or "
               "<for> for what repeats");
  xmlStopParser(parser);
}

static xmlDocPtr parse(const char *path, struct Diagnostics *diagnostics) {
  xmlParserCtxtPtr parser = xmlNewParserCtxt();
  if (parser == NULL) return NULL;
  parser->_private = diagnostics;
  parser->sax->internalSubset = refuse_document_type;
  int errors = diagnostics->errors;
  xmlDocPtr document = xmlCtxtReadFile(parser, path, NULL, XML_PARSE_NONET | XML_PARSE_BIG_LINES | XML_PARSE_NOCDATA);
  xmlFreeParserCtxt(parser);
  if (diagnostics->errors == errors) return document;
  xmlFreeDoc(document);
  return NULL;
}

xmlDocPtr xml_load(const char *path, struct Diagnostics *diagnostics) {
  xmlSetStructuredErrorFunc(diagnostics, (xmlStructuredErrorFunc)report_xml_error);
  xmlDocPtr document = parse(path, diagnostics);
  if (document == NULL && diagnostics->errors == 0)
    report_error(diagnostics, 0, "cannot be read; expected an XML file");
  if (document != NULL) validate(document, diagnostics);
  xmlSetStructuredErrorFunc(NULL, NULL);
  return document;
}

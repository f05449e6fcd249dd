#include "variables_section.h"

#include <math.h>
#include <stdio.h>

#include "algebra/formula.h"
#include "base/memory.h"
#include "latex.h"
#include "xml_output.h"

static void write_row(const struct Page *page, const struct InterfaceVariable *variable) {
  static const char *const kinds[] = {
      [VARIABLE_TIME] = "time",           [VARIABLE_STATE] = "state",         [VARIABLE_DERIVATIVE] = "derivative",
      [VARIABLE_INPUT] = "input",         [VARIABLE_PARAMETER] = "parameter", [VARIABLE_RESULT] = "computed",
      [VARIABLE_STATISTIC] = "statistic", [VARIABLE_MODE] = "mode",           [VARIABLE_CONTACT] = "mode",
  };
  const struct ScalarVariable *entry = &variable->entry;
  char start[NUMBER_LENGTH] = "";
  if (entry->type == TYPE_BOOLEAN) snprintf(start, sizeof start, "%s", entry->start == 0.0 ? "false" : "true");
  else if (!isnan(entry->start)) number_text(entry->start, start);
  const char *kind = is_calculated_parameter(entry)                       ? "calculated parameter"
                     : entry->is_output && entry->kind == VARIABLE_RESULT ? "output"
                                                                          : kinds[entry->kind];
  xmlTextWriterStartElement(page->writer, BAD_CAST "tr");
  xmlTextWriterStartElement(page->writer, BAD_CAST "td"); /* for the name as formulas show it, which the script adds */
  write_attribute(page->writer, "data-latex", latex_of(page->model, entry->name));
  xmlTextWriterEndElement(page->writer);
  page_element(page, "th", entry->name);
  page_element(page, "td", kind);
  page_element(page, "td", variable->unit != NULL ? variable->unit : "");
  page_element(page, "td", start);
  page_element(page, "td", variable->description != NULL ? variable->description : "");
  xmlTextWriterEndElement(page->writer);
}

/* Rows of the table; pages with more load slowly. */
enum { ROW_LIMIT = 1000 };

/* Writes the search field, which the page's script uses. */
static void write_search(const struct Page *page) {
  xmlTextWriterStartElement(page->writer, BAD_CAST "input");
  write_attribute(page->writer, "type", "search");
  write_attribute(page->writer, "id", "search");
  write_attribute(page->writer, "placeholder", "Search in names, kinds, units and descriptions");
  write_attribute(page->writer, "aria-label", "Search variables");
  xmlTextWriterEndElement(page->writer);
}

void write_variables(struct Page *page) {
  static const char *const headings[] = {"", "name", "kind", "unit", "start", "description"};
  page_heading(page, "Variables");
  write_search(page);
  xmlTextWriterStartElement(page->writer, BAD_CAST "table");
  write_attribute(page->writer, "id", "variables");
  xmlTextWriterStartElement(page->writer, BAD_CAST "tr");
  for (size_t i = 0; i < sizeof headings / sizeof *headings; i++) page_element(page, "th", headings[i]);
  xmlTextWriterEndElement(page->writer);
  size_t count = page->interface->count_in_fmi2, rows = count < ROW_LIMIT ? count : ROW_LIMIT;
  for (size_t i = 0; i < rows; i++) write_row(page, &page->interface->variables[i]);
  xmlTextWriterEndElement(page->writer);
  page_rest(page, count, rows, "variables, which modelDescription.xml has,");
}

#include "documentation.h"

#include <math.h>
#include <string.h>

#include <libxml/xmlwriter.h>

#include "base/memory.h"
#include "equation_lines.h"
#include "page.h"
#include "scene.h"
#include "variables_section.h"
#include "xml_output.h"

/* page.css, and the scripts in their order, as strings that the build makes. */
extern const char page_style[], page_script[];

static void write_solver(struct Page *page) {
  const struct Method *method = page->equations->method;
  if (method == NULL) return;
  page_heading(page, "Solver");
  page_paragraph(page, method->sentence);
  if (!isnan(page->model->solver.max_step)) {
    char *text = format_text("No step of the method is longer than %g s.", page->model->solver.max_step);
    page_paragraph(page, text);
  } else if (method->series == FIRST_TERMS)
    page_paragraph(
        page,
        "Each step is so short that it skips no narrow peak, jump or pulse of a function in the equations, as far as "
        "the first three terms of their Taylor series show; maxStep in system.xml bounds the steps further.");
}

/* Writes whether equations are compiled or interpreted, see program.h. */
static void write_form(struct Page *page) {
  const struct Program *program = page->program;
  bool only_series = program->is_table && program->series != NULL && !program->series_is_table;
  const char *form =
      only_series ? "those of the Taylor series as compiled C code, the others in tables, which the FMU interprets"
      : program->is_table ? "in tables, which the FMU interprets: a C compiler would take long for them"
                          : "as compiled C code";
  char *text = format_text("The equations are %zu instructions, %s.", instruction_count(program), form);
  page_heading(page, "Code");
  page_paragraph(page, text);
}

static void write_sections(struct Page *page) {
  write_equations(page);
  write_solver(page);
  write_form(page);
  write_variables(page);
}

/* Writes the text without escapes, which browsers would not decode here. The comments make the page valid XML, too. */
static void write_verbatim(const struct Page *page, const char *name, const char *text) {
  xmlTextWriterStartElement(page->writer, BAD_CAST name);
  xmlTextWriterWriteFormatRaw(page->writer, "/*<![CDATA[*/%s/*]]>*/", text);
  xmlTextWriterEndElement(page->writer);
}

static void write_head(const struct Page *page) {
  static const char *const metas[][2] = {{"viewport", "width=device-width, initial-scale=1"},
                                         {"color-scheme", "light dark"}};
  xmlTextWriterStartElement(page->writer, BAD_CAST "head");
  xmlTextWriterStartElement(page->writer, BAD_CAST "meta");
  write_attribute(page->writer, "charset", "utf-8");
  xmlTextWriterEndElement(page->writer);
  for (size_t i = 0; i < 2; i++) {
    xmlTextWriterStartElement(page->writer, BAD_CAST "meta");
    write_attribute(page->writer, "name", metas[i][0]);
    write_attribute(page->writer, "content", metas[i][1]);
    xmlTextWriterEndElement(page->writer);
  }
  page_element(page, "title", page->model->name);
  write_verbatim(page, "style", page_style);
  xmlTextWriterEndElement(page->writer);
}

/* Writes the scene as text, which the page's script replaces by a picture. */
static void write_scene(const struct Page *page, const struct StartScene *scene) {
  xmlBufferPtr buffer = xmlBufferCreate();
  xmlTextWriterPtr writer = xmlNewTextWriterMemory(buffer, 0);
  xmlTextWriterSetIndent(writer, 1);
  start_scene_write(writer, scene);
  xmlFreeTextWriter(writer);
  xmlTextWriterStartElement(page->writer, BAD_CAST "pre");
  write_attribute(page->writer, "class", "scene");
  xmlTextWriterWriteString(page->writer, xmlBufferContent(buffer));
  xmlTextWriterEndElement(page->writer);
  xmlBufferFree(buffer);
}

static void write_contents(const struct Page *page) {
  xmlTextWriterStartElement(page->writer, BAD_CAST "nav");
  for (size_t i = 0; i < page->heading_count; i++) {
    xmlTextWriterStartElement(page->writer, BAD_CAST "a");
    xmlTextWriterWriteFormatAttribute(page->writer, BAD_CAST "href", "#section%zu", i + 1);
    xmlTextWriterWriteString(page->writer, BAD_CAST page->headings[i]);
    xmlTextWriterEndElement(page->writer);
  }
  xmlTextWriterEndElement(page->writer);
}

/* Writes the versions of the system and of lagrange-fmu, and the author; no date, so that builds are reproducible. */
static void write_origin(const struct Page *page) {
  const struct Origin *origin = &page->model->origin;
  char *version = origin->version != NULL ? format_text("Version %s of the system. ", origin->version) : copy_text("");
  char *author = origin->author != NULL ? format_text("By %s. ", origin->author) : copy_text("");
  page_element(page, "footer", format_text("%s%sEquations derived by lagrange-fmu %s.", version, author, LAGC_VERSION));
}

/* Writes the page around the sections, which are written first, as the contents list them. */
static void write_page(const struct Page *page, const struct StartScene *scene, const xmlBuffer *sections) {
  xmlTextWriterPtr writer = page->writer;
  xmlTextWriterWriteDTD(writer, BAD_CAST "html", NULL, NULL, NULL);
  xmlTextWriterStartElement(writer, BAD_CAST "html");
  write_attribute(writer, "lang", "en");
  write_head(page);
  xmlTextWriterStartElement(writer, BAD_CAST "body");
  write_contents(page);
  xmlTextWriterStartElement(writer, BAD_CAST "main");
  page_element(page, "h1", page->model->name);
  if (page->model->description != NULL) page_paragraph(page, page->model->description);
  write_scene(page, scene);
  xmlTextWriterWriteRaw(writer, xmlBufferContent(sections));
  write_origin(page);
  xmlTextWriterEndElement(writer);
  write_verbatim(page, "script", page_script);
  xmlTextWriterEndElement(writer);
  xmlTextWriterEndElement(writer);
}

bool documentation_write(xmlBufferPtr buffer, const struct Program *program, const struct Summary *summary,
                         const struct StartScene *scene) {
  struct Display display = {.graph = program->model->graph, .names = &summary->names};
  struct Page page = {.program = program,
                      .model = program->model,
                      .equations = program->equations,
                      .interface = program->interface,
                      .summary = summary,
                      .display = &display};
  xmlBufferPtr sections = xmlBufferCreate();
  xmlTextWriterPtr writer = xmlNewTextWriterMemory(buffer, 0);
  page.writer = sections != NULL ? xmlNewTextWriterMemory(sections, 0) : NULL;
  bool written = writer != NULL && page.writer != NULL;
  if (written) {
    write_sections(&page);
    written = xmlTextWriterFlush(page.writer) >= 0;
    xmlFreeTextWriter(page.writer);
    page.writer = writer;
    write_page(&page, scene, sections);
    written = xmlTextWriterEndDocument(writer) >= 0 && written;
  }
  xmlFreeTextWriter(writer);
  xmlBufferFree(sections);
  return written;
}

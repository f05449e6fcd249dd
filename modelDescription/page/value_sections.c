#include "value_sections.h"

#include "base/memory.h"
#include "mechanics/switching.h"

/* Writes the author's names for expressions, which formulas use where possible. */
void write_definitions(struct Page *page) {
  const struct VariableList *definitions = &page->model->definitions;
  const struct NodeNames *names = &page->summary->names;
  bool first = true;
  for (size_t i = 0; i < definitions->count; i++) {
    const struct Variable *definition = &definitions->items[i];
    if (names->of[definition->node] != definition->name) continue;
    if (first) page_heading(page, "Definitions");
    first = false;
    page_equation(page, definition->name, without_branches(page->model, definition->shown));
  }
}

void write_calculated(struct Page *page) {
  const struct VariableList *calculated = &page->model->calculated;
  size_t shown = calculated->count < SHOWN_LIMIT ? calculated->count : SHOWN_LIMIT;
  if (shown == 0) return;
  page_heading(page, "Calculated parameters");
  for (size_t i = 0; i < shown; i++) page_equation(page, calculated->items[i].name, calculated->items[i].node);
  page_rest(page, calculated->count, shown, "parameters");
}

/* Writes start values that are expressions. */
void write_starts(struct Page *page) {
  const struct VariableList *const lists[] = {&page->model->coordinates, &page->model->velocities, &page->model->states,
                                              &page->model->modes};
  size_t count = 0;
  for (size_t list = 0; list < 4; list++)
    for (size_t i = 0; i < lists[list]->count; i++) {
      const struct Variable *started = &lists[list]->items[i];
      if (!start_follows(page->model, started)) continue;
      if (count++ == 0) page_heading(page, "Start values of variables that are not set before the simulation");
      if (count <= SHOWN_LIMIT) page_equation(page, started->name, started->start_expression);
    }
  page_rest(page, count, count < SHOWN_LIMIT ? count : SHOWN_LIMIT, "start values");
}

/* Writes the rates of the states; the power of the work is in the mechanics section. */
void write_rates(struct Page *page) {
  const struct VariableList *states = &page->model->states;
  size_t shown = 0;
  for (size_t i = 0; i < page->summary->rate_count; i++) {
    if (states->items[i].is_work) continue;
    if (shown++ == 0) page_heading(page, "States");
    page_equation(page, format_text("der(%s)", states->items[i].name), page->summary->rates[i]);
  }
  page_rest(page, states->count, page->summary->rate_count, "states");
}

void write_outputs(struct Page *page) {
  const struct VariableList *outputs = &page->model->outputs;
  if (outputs->count == 0) return;
  page_heading(page, "Outputs");
  for (size_t i = 0; i < page->summary->output_count; i++)
    page_equation(page, outputs->items[i].name, page->summary->outputs[i]);
  page_rest(page, outputs->count, page->summary->output_count, "outputs");
}

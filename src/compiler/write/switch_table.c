#include "write/switch_table.h"

#include "write/c_text.h"
#include "write/description.h"
#include "write/statements.h"

static int mode_index(const struct Program *program, Node mode) {
  return graph_symbol_of(program->model->graph, mode)->index;
}

static void write_branches(FILE *file, const struct Program *program) {
  const struct SwitchingExpressions *switching = program->equations->switching;
  if (switching->branch_count == 0) return;
  fputs("static const struct BranchFacts branch_facts[] = {", file);
  for (size_t i = 0; i < switching->branch_count; i++) {
    const struct Branch *branch = switching->branches[i];
    fprintf(file, "{%d, ", mode_index(program, branch->mode));
    write_c_string(file, branch->function);
    fprintf(file, ", %ld, %s, %s}, ", branch->line, branch->is_side ? "true" : "false",
            switching->holds_energy[i] ? "true" : "false");
  }
  fputs("};\n\n", file);
}

static void write_name(FILE *file, const struct Program *program, size_t constraint) {
  write_c_string(file, program->model->constraints.items[constraint].name);
  fputs("}, ", file);
}

static void write_contact_facts(FILE *file, const struct Program *program, const struct Contact *contact) {
  fprintf(file, "{%d, %zu, ", mode_index(program, contact->mode), contact->constraint);
  write_name(file, program, contact->constraint);
}

static void write_friction_facts(FILE *file, const struct Program *program, const struct Friction *friction) {
  fprintf(file, "{%d, %d, %zu, ", mode_index(program, friction->mode), mode_index(program, friction->told),
          friction->constraint);
  write_name(file, program, friction->constraint);
}

static const char *friction_laws_of(const struct Switches *switches) {
  return has_planes(switches) ? "plane_friction_laws" : "friction_laws";
}

static void write_contacts(FILE *file, const struct Program *program) {
  const struct Switches *switches = &program->model->switches;
  if (switches->contact_count > 0) fputs("extern const struct ContactLaws contact_laws;\n\n", file);
  if (switches->contact_count > 0) fputs("static const struct ContactFacts contact_facts[] = {", file);
  for (size_t i = 0; i < switches->contact_count; i++) write_contact_facts(file, program, &switches->contacts[i]);
  if (switches->contact_count > 0) fputs("};\n\n", file);
  if (switches->friction_count > 0)
    fprintf(file, "extern const struct FrictionLaws %s;\n\n", friction_laws_of(switches));
  if (switches->friction_count > 0) fputs("static const struct FrictionFacts friction_facts[] = {", file);
  for (size_t i = 0; i < switches->friction_count; i++) write_friction_facts(file, program, &switches->frictions[i]);
  if (switches->friction_count > 0) fputs("};\n\n", file);
}

static void write_planes(FILE *file, const struct Program *program) {
  const struct Switches *switches = &program->model->switches;
  if (!has_planes(switches)) return;
  fputs("static const struct PlaneFacts plane_facts[] = {", file);
  for (size_t i = 0; i < switches->friction_count; i++) {
    const struct PlaneSide *along = &switches->frictions[i].plane;
    if (along->axis != ALONG) continue;
    const struct PlaneSide *across = &switches->frictions[i + 1].plane;
    fprintf(file, "{%zu, {%d, %d}, %d, %d}, ", i, mode_index(program, along->heading),
            mode_index(program, across->heading), mode_index(program, along->lower), mode_index(program, along->upper));
  }
  fputs("};\n\n", file);
}

static void write_rests(FILE *file, const struct Program *program) {
  const struct Switches *switches = &program->model->switches;
  const bool *rests = program->equations->switching->rests;
  if (rests == NULL) return;
  fputs("static const bool rests[] = {", file);
  for (size_t i = 0; i < switches->friction_count * switches->contact_count; i++)
    fputs(rests[i] ? "true, " : "false, ", file);
  fputs("};\n\n", file);
}

static void write_assignments(FILE *file, const struct Program *program, const struct Event *event) {
  for (size_t i = 0; i < event->assignment_count; i++) {
    const struct Symbol *symbol = graph_symbol_of(program->model->graph, event->assignments[i].symbol);
    size_t first = symbol->kind == VELOCITY ? program->equations->count : 0;
    fprintf(file, "{%s, %zu}, ", symbol->kind == MODE ? "VARIABLE_MODE" : "VARIABLE_STATE",
            first + (size_t)symbol->index);
  }
}

static void write_events(FILE *file, const struct Program *program) {
  static const char *const passages[] = {[PASSAGE_HOLDS] = "PASSAGE_HOLDS",
                                         [PASSAGE_RISES] = "PASSAGE_RISES",
                                         [PASSAGE_FALLS] = "PASSAGE_FALLS",
                                         [PASSAGE_BOTH] = "PASSAGE_BOTH"};
  const struct Switches *switches = &program->model->switches;
  if (switches->event_count == 0) return;
  fputs("static const struct AssignmentFacts assignment_facts[] = {", file);
  for (size_t i = 0; i < switches->event_count; i++) write_assignments(file, program, &switches->events[i]);
  fputs("};\n\nstatic const struct EventFacts event_facts[] = {", file);
  size_t assignment = 0;
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct Event *event = &switches->events[i];
    int side = event->side != ZERO ? mode_index(program, event->side) : 0;
    fprintf(file, "{%s, %d, %s, %zu, %zu, ", passages[event->passage], side, event->is_of_contacts ? "true" : "false",
            assignment, event->assignment_count);
    write_c_string(file, event->text);
    fputs("}, ", file);
    assignment += event->assignment_count;
  }
  fputs("};\n\n", file);
}

void switching_write(FILE *file, const struct Program *program) {
  const struct SwitchingExpressions *switching = program->equations->switching;
  if (switching == NULL) return;
  const struct Switches *switches = &program->model->switches;
  fputs("extern const struct EventLaws event_laws;\n\n", file);
  for (enum FunctionName i = LAGRANGIAN_ROUTINES; i < ROUTINE_COUNT; i++)
    statements_function(file, program, i, "", program->routines[i]);
  if (program->watched_series != NULL) statements_watched_limit(file, program);
  write_branches(file, program);
  write_contacts(file, program);
  write_planes(file, program);
  write_rests(file, program);
  write_events(file, program);
  fprintf(file,
          "static const struct SwitchTable switches = {\n    .mode_count = %zu,\n    .branch_count = %zu,\n"
          "    .contact_count = %zu,\n    .friction_count = %zu,\n    .event_count = %zu,\n"
          "    .assignment_count = %zu,\n    .energy_count = %zu,\n",
          switches->mode_count, switching->branch_count, switches->contact_count, switches->friction_count,
          switches->event_count, switching->assignment_count, switching->energy_count);
  write_fields(file, program, IN_SWITCHES, IN_SWITCHES);
  if (switching->branch_count > 0) fputs("    .branches = branch_facts,\n", file);
  if (program->watched_series != NULL)
    fprintf(file,
            "    .watched_rows = %zu,\n    .watched_acceleration_row = %zu,\n    .watched_acceleration_count = %zu,\n",
            program->watched_series->row_count, program->watched_series->acceleration_row,
            program->watched_series->acceleration_count);
  if (switching->friction_varies) fputs("    .friction_varies = true,\n", file);
  if (switching->feels_forces) fputs("    .feels_forces = true,\n", file);
  if (switching->has_sides) fputs("    .has_sides = true,\n", file);
  if (switches->contact_count > 0) fputs("    .contacts = contact_facts,\n    .contact_laws = &contact_laws,\n", file);
  if (switching->rests != NULL) fputs("    .rests_on = rests,\n", file);
  if (switches->friction_count > 0)
    fprintf(file, "    .frictions = friction_facts,\n    .friction_laws = &%s,\n", friction_laws_of(switches));
  if (has_planes(switches))
    fputs("    .planes = plane_facts,\n    .plane_count = sizeof plane_facts / sizeof *plane_facts,\n", file);
  if (switches->event_count > 0) fputs("    .events = event_facts,\n    .assignments = assignment_facts,\n", file);
  fputs("};\n\n", file);
}

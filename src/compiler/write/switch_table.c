#include "write/switch_table.h"

#include "program/facts/switch_facts.h"
#include "write/c_text.h"
#include "write/description.h"
#include "write/statements.h"

static const char *name_of(bool truth) {
  return truth ? "true" : "false";
}

/* Writes a string that ends an element of an array. */
static void write_name(FILE *file, const char *name) {
  write_c_string(file, name);
  fputs("}, ", file);
}

static void write_branches(FILE *file, const struct SwitchTable *facts) {
  if (facts->branch_count == 0) return;
  fputs("static const struct BranchFacts branch_facts[] = {", file);
  for (size_t i = 0; i < facts->branch_count; i++) {
    const struct BranchFacts *branch = &facts->branches[i];
    fprintf(file, "{%zu, ", branch->mode);
    write_c_string(file, branch->function);
    fputs(", ", file);
    write_c_string(file, branch->file);
    fprintf(file, ", %ld, %s, %s}, ", branch->line, name_of(branch->is_side), name_of(branch->holds_energy));
  }
  fputs("};\n\n", file);
}

static void write_contacts(FILE *file, const struct SwitchTable *facts) {
  if (facts->contact_count == 0) return;
  fputs("extern const struct ContactLaws contact_laws;\n\nstatic const struct ContactFacts contact_facts[] = {", file);
  for (size_t i = 0; i < facts->contact_count; i++) {
    fprintf(file, "{%zu, %zu, ", facts->contacts[i].mode, facts->contacts[i].constraint);
    write_name(file, facts->contacts[i].name);
  }
  fputs("};\n\n", file);
}

static const char *friction_laws_of(const struct SwitchTable *facts) {
  return facts->plane_count > 0 ? "plane_friction_laws" : "friction_laws";
}

static void write_frictions(FILE *file, const struct SwitchTable *facts) {
  if (facts->friction_count == 0) return;
  fprintf(file, "extern const struct FrictionLaws %s;\n\nstatic const struct FrictionFacts friction_facts[] = {",
          friction_laws_of(facts));
  for (size_t i = 0; i < facts->friction_count; i++) {
    const struct FrictionFacts *friction = &facts->frictions[i];
    fprintf(file, "{%zu, %zu, %zu, ", friction->mode, friction->told, friction->constraint);
    write_c_string(file, friction->name);
    fprintf(file, ", %s}, ", name_of(friction->is_given));
  }
  fputs("};\n\n", file);
}

static void write_planes(FILE *file, const struct SwitchTable *facts) {
  if (facts->plane_count == 0) return;
  fputs("static const struct PlaneFacts plane_facts[] = {", file);
  for (size_t i = 0; i < facts->plane_count; i++) {
    const struct PlaneFacts *plane = &facts->planes[i];
    fprintf(file, "{%zu, {%zu, %zu}, %zu, %zu}, ", plane->along, plane->heading[0], plane->heading[1], plane->lower,
            plane->upper);
  }
  fputs("};\n\n", file);
}

static void write_rests(FILE *file, const struct SwitchTable *facts) {
  if (facts->rests_on == NULL) return;
  fputs("static const bool rests[] = {", file);
  for (size_t i = 0; i < facts->friction_count * facts->contact_count; i++)
    fprintf(file, "%s, ", name_of(facts->rests_on[i]));
  fputs("};\n\n", file);
}

static void write_event(FILE *file, const struct EventFacts *event) {
  static const char *const passages[] = {[PASSAGE_HOLDS] = "PASSAGE_HOLDS",
                                         [PASSAGE_RISES] = "PASSAGE_RISES",
                                         [PASSAGE_FALLS] = "PASSAGE_FALLS",
                                         [PASSAGE_BOTH] = "PASSAGE_BOTH",
                                         [PASSAGE_SAMPLES] = "PASSAGE_SAMPLES"};
  fprintf(file, "{%s, %zu, %s, %zu, %zu, ", passages[event->passage], event->side, name_of(event->is_of_contacts),
          event->first_assignment, event->assignment_count);
  write_name(file, event->when);
}

static void write_events(FILE *file, const struct SwitchTable *facts) {
  if (facts->event_count == 0) return;
  fputs("static const struct AssignmentFacts assignment_facts[] = {", file);
  for (size_t i = 0; i < facts->assignment_count; i++)
    fprintf(file, "{%s, %zu}, ", facts->assignments[i].kind == VARIABLE_MODE ? "VARIABLE_MODE" : "VARIABLE_STATE",
            facts->assignments[i].index);
  fputs("};\n\nstatic const struct EventFacts event_facts[] = {", file);
  for (size_t i = 0; i < facts->event_count; i++) write_event(file, &facts->events[i]);
  fputs("};\n\n", file);
}

static void write_timed(FILE *file, const struct SwitchTable *facts) {
  if (facts->timed_count == 0) return;
  fputs("extern const struct TimeLaws time_laws;\n\n", file);
  write_sizes(file, "size_t", "timed", facts->timed, facts->timed_count);
}

static void write_samples(FILE *file, const struct SwitchTable *facts) {
  if (facts->sample_count == 0) return;
  fputs("static const struct SampleFacts sample_facts[] = {", file);
  for (size_t i = 0; i < facts->sample_count; i++) {
    const struct SampleFacts *sample = &facts->samples[i];
    fprintf(file, "{%zu, %zu, %zu, %zu, %zu}, ", sample->event, sample->branch, sample->base, sample->count,
            sample->period);
  }
  fputs("};\n\n", file);
}

static void write_flag(FILE *file, const char *name, bool is_set) {
  if (is_set) fprintf(file, "    .%s = true,\n", name);
}

static void write_table(FILE *file, const struct Program *program, const struct SwitchTable *facts) {
  fprintf(file,
          "static const struct SwitchTable switches = {\n    .mode_count = %zu,\n    .branch_count = %zu,\n"
          "    .contact_count = %zu,\n    .friction_count = %zu,\n    .event_count = %zu,\n"
          "    .assignment_count = %zu,\n    .energy_count = %zu,\n",
          facts->mode_count, facts->branch_count, facts->contact_count, facts->friction_count, facts->event_count,
          facts->assignment_count, facts->energy_count);
  write_fields(file, program, IN_SWITCHES, IN_SWITCHES);
  if (facts->branch_count > 0) fputs("    .branches = branch_facts,\n", file);
  if (program->watched_series != NULL)
    fprintf(file,
            "    .watched_rows = %zu,\n    .watched_acceleration_row = %zu,\n    .watched_acceleration_count = %zu,\n",
            facts->watched_rows, facts->watched_acceleration_row, facts->watched_acceleration_count);
  write_flag(file, "friction_varies", facts->friction_varies);
  write_flag(file, "feels_forces", facts->feels_forces);
  write_flag(file, "has_sides", facts->has_sides);
  if (facts->contact_count > 0) fputs("    .contacts = contact_facts,\n    .contact_laws = &contact_laws,\n", file);
  if (facts->rests_on != NULL) fputs("    .rests_on = rests,\n", file);
  if (facts->friction_count > 0)
    fprintf(file, "    .frictions = friction_facts,\n    .friction_laws = &%s,\n", friction_laws_of(facts));
  if (facts->plane_count > 0)
    fputs("    .planes = plane_facts,\n    .plane_count = sizeof plane_facts / sizeof *plane_facts,\n", file);
  if (facts->event_count > 0) fputs("    .events = event_facts,\n    .assignments = assignment_facts,\n", file);
  if (facts->timed_count > 0)
    fprintf(file, "    .timed = timed,\n    .timed_count = %zu,\n    .time_laws = &time_laws,\n", facts->timed_count);
  if (facts->sample_count > 0)
    fprintf(file, "    .samples = sample_facts,\n    .sample_count = %zu,\n", facts->sample_count);
  fputs("};\n\n", file);
}

void switching_write(FILE *file, const struct Program *program) {
  if (program->equations->switching == NULL) return;
  struct SwitchTable facts = switch_facts_of(program);
  fputs("extern const struct EventLaws event_laws;\n\n", file);
  for (enum FunctionName i = LAGRANGIAN_ROUTINES; i < ROUTINE_COUNT; i++)
    statements_function(file, program, i, "", program->routines[i]);
  if (program->watched_series != NULL) statements_watched_limit(file, program);
  write_branches(file, &facts);
  write_contacts(file, &facts);
  write_frictions(file, &facts);
  write_planes(file, &facts);
  write_rests(file, &facts);
  write_events(file, &facts);
  write_timed(file, &facts);
  write_samples(file, &facts);
  write_table(file, program, &facts);
}

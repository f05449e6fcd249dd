#include "write/switch_table.h"

#include "program/metadata/switch_metadata.h"
#include "write/c_text.h"
#include "write/description.h"
#include "write/instruction_tables.h"
#include "write/statements.h"

static const char *name_of(bool truth) {
  return truth ? "true" : "false";
}

/* Writes a string that ends an element of an array. */
static void write_name(FILE *file, const char *name) {
  write_c_string(file, name);
  fputs("}, ", file);
}

static void write_branches(FILE *file, const struct SwitchTable *metadata) {
  if (metadata->branch_count == 0) return;
  fputs("static const struct BranchMetadata branch_metadata[] = {", file);
  for (size_t i = 0; i < metadata->branch_count; i++) {
    const struct BranchMetadata *branch = &metadata->branches[i];
    fprintf(file, "{%zu, ", branch->mode);
    write_c_string(file, branch->function);
    fputs(", ", file);
    write_c_string(file, branch->file);
    fprintf(file, ", %ld, %s, %s}, ", branch->line, name_of(branch->is_last_sign), name_of(branch->holds_energy));
  }
  fputs("};\n\n", file);
}

static void write_contacts(FILE *file, const struct SwitchTable *metadata) {
  if (metadata->contact_count == 0) return;
  fputs("extern const struct ContactLaws contact_laws;\n\nstatic const struct ContactMetadata contact_metadata[] = {",
        file);
  for (size_t i = 0; i < metadata->contact_count; i++) {
    const struct ContactMetadata *contact = &metadata->contacts[i];
    fprintf(file, "{%zu, %zu, %zu, ", contact->mode, contact->constraint, contact->carried);
    write_name(file, contact->name);
  }
  fputs("};\n\n", file);
}

static const char *friction_laws_of(const struct SwitchTable *metadata) {
  return metadata->plane_count > 0 ? "plane_friction_laws" : "friction_laws";
}

static void write_frictions(FILE *file, const struct SwitchTable *metadata) {
  if (metadata->friction_count == 0) return;
  fprintf(file, "extern const struct FrictionLaws %s;\n\nstatic const struct FrictionMetadata friction_metadata[] = {",
          friction_laws_of(metadata));
  for (size_t i = 0; i < metadata->friction_count; i++) {
    const struct FrictionMetadata *friction = &metadata->frictions[i];
    fprintf(file, "{%zu, %zu, %zu, ", friction->mode, friction->reported, friction->constraint);
    write_c_string(file, friction->name);
    fprintf(file, ", %s, %s}, ", name_of(friction->is_given), name_of(friction->has_static_limit));
  }
  fputs("};\n\n", file);
}

static void write_planes(FILE *file, const struct SwitchTable *metadata) {
  if (metadata->plane_count == 0) return;
  fputs("static const struct PlaneMetadata plane_metadata[] = {", file);
  for (size_t i = 0; i < metadata->plane_count; i++) {
    const struct PlaneMetadata *plane = &metadata->planes[i];
    fprintf(file, "{%zu, {%zu, %zu}, %zu, %zu}, ", plane->along, plane->slip_direction[0], plane->slip_direction[1],
            plane->lower, plane->upper);
  }
  fputs("};\n\n", file);
}

static void write_resting(FILE *file, const struct SwitchTable *metadata) {
  if (metadata->resting_count == 0) return;
  fputs("void resting_find(struct Resolution *resolution);\n\n"
        "static const struct RestingMetadata resting_metadata[] = {",
        file);
  for (size_t i = 0; i < metadata->resting_count; i++)
    fprintf(file, "{%d, %zu, %zu}, ", (int)metadata->resting[i].kind, metadata->resting[i].mode,
            metadata->resting[i].index);
  fputs("};\n\n", file);
}

static void write_rests(FILE *file, const struct SwitchTable *metadata) {
  if (metadata->rests_on == NULL) return;
  fputs("static const bool rests[] = {", file);
  for (size_t i = 0; i < metadata->friction_count * metadata->contact_count; i++)
    fprintf(file, "%s, ", name_of(metadata->rests_on[i]));
  fputs("};\n\n", file);
}

static void write_balls(FILE *file, const struct SwitchTable *metadata) {
  if (metadata->ball_count == 0) return;
  fputs("static const char *const ball_names[] = {", file);
  for (size_t i = 0; i < metadata->ball_count; i++) {
    write_c_string(file, metadata->ball_names[i]);
    fputs(", ", file);
  }
  fputs("};\n\n", file);
}

static void write_event(FILE *file, const struct EventMetadata *event) {
  static const char *const passages[] = {[PASSAGE_HOLDS] = "PASSAGE_HOLDS",
                                         [PASSAGE_RISES] = "PASSAGE_RISES",
                                         [PASSAGE_FALLS] = "PASSAGE_FALLS",
                                         [PASSAGE_BOTH] = "PASSAGE_BOTH",
                                         [PASSAGE_SAMPLES] = "PASSAGE_SAMPLES"};
  fprintf(file, "{%s, %zu, %s, %zu, %zu, ", passages[event->passage], event->last_sign, name_of(event->is_of_contacts),
          event->first_assignment, event->assignment_count);
  write_name(file, event->when);
}

static void write_events(FILE *file, const struct SwitchTable *metadata) {
  if (metadata->event_count == 0) return;
  fputs("static const struct AssignmentMetadata assignment_metadata[] = {", file);
  for (size_t i = 0; i < metadata->assignment_count; i++)
    fprintf(file, "{%s, %zu}, ", metadata->assignments[i].kind == VARIABLE_MODE ? "VARIABLE_MODE" : "VARIABLE_STATE",
            metadata->assignments[i].index);
  fputs("};\n\nstatic const struct EventMetadata event_metadata[] = {", file);
  for (size_t i = 0; i < metadata->event_count; i++) write_event(file, &metadata->events[i]);
  fputs("};\n\n", file);
}

static void write_timed(FILE *file, const struct SwitchTable *metadata) {
  if (metadata->timed_count == 0) return;
  fputs("extern const struct TimeLaws time_laws;\n\n", file);
  write_sizes(file, "size_t", "timed", metadata->timed, metadata->timed_count);
}

static void write_samples(FILE *file, const struct SwitchTable *metadata) {
  if (metadata->sample_count == 0) return;
  fputs("static const struct SampleMetadata sample_metadata[] = {", file);
  for (size_t i = 0; i < metadata->sample_count; i++) {
    const struct SampleMetadata *sample = &metadata->samples[i];
    fprintf(file, "{%zu, %zu, %zu, %zu, %zu}, ", sample->event, sample->branch, sample->base, sample->count,
            sample->period);
  }
  fputs("};\n\n", file);
}

static void write_flag(FILE *file, const char *name, bool is_set) {
  if (is_set) fprintf(file, "    .%s = true,\n", name);
}

static void write_table(FILE *file, const struct Program *program, const struct SwitchTable *metadata) {
  fprintf(file,
          "static const struct SwitchTable switches = {\n    .mode_count = %zu,\n    .branch_count = %zu,\n"
          "    .contact_count = %zu,\n    .friction_count = %zu,\n    .event_count = %zu,\n"
          "    .assignment_count = %zu,\n    .energy_count = %zu,\n",
          metadata->mode_count, metadata->branch_count, metadata->contact_count, metadata->friction_count,
          metadata->event_count, metadata->assignment_count, metadata->energy_count);
  write_fields(file, program, IN_SWITCHES, IN_SWITCHES);
  if (metadata->branch_count > 0) fputs("    .branches = branch_metadata,\n", file);
  if (program->watched_series != NULL)
    fprintf(file,
            "    .watched_rows = %zu,\n    .watched_acceleration_row = %zu,\n    .watched_acceleration_count = %zu,\n",
            metadata->watched_rows, metadata->watched_acceleration_row, metadata->watched_acceleration_count);
  write_flag(file, "friction_varies", metadata->friction_varies);
  write_flag(file, "feels_forces", metadata->feels_forces);
  write_flag(file, "has_last_signs", metadata->has_last_signs);
  if (metadata->contact_count > 0)
    fputs("    .contacts = contact_metadata,\n    .contact_laws = &contact_laws,\n", file);
  if (metadata->ball_count > 0)
    fprintf(file, "    .ball_names = ball_names,\n    .ball_count = %zu,\n", metadata->ball_count);
  if (metadata->rests_on != NULL) fputs("    .rests_on = rests,\n", file);
  if (metadata->friction_count > 0)
    fprintf(file, "    .frictions = friction_metadata,\n    .friction_laws = &%s,\n", friction_laws_of(metadata));
  if (metadata->plane_count > 0)
    fputs("    .planes = plane_metadata,\n    .plane_count = sizeof plane_metadata / sizeof *plane_metadata,\n", file);
  if (metadata->resting_count > 0)
    fprintf(file, "    .resting = resting_metadata,\n    .resting_count = %zu,\n    .find_resting = resting_find,\n",
            metadata->resting_count);
  if (metadata->event_count > 0)
    fputs("    .events = event_metadata,\n    .assignments = assignment_metadata,\n", file);
  if (metadata->timed_count > 0)
    fprintf(file,
            "    .timed = timed,\n    .timed_count = %zu,\n    .affine_count = %zu,\n    .time_laws = &time_laws,\n",
            metadata->timed_count, metadata->affine_count);
  if (metadata->sample_count > 0)
    fprintf(file, "    .samples = sample_metadata,\n    .sample_count = %zu,\n", metadata->sample_count);
  fputs("};\n\n", file);
}

/* Writes the functions of struct SwitchTable. */
static void write_functions(FILE *file, const struct Program *program, const struct Encoding *tables) {
  for (enum FunctionName i = LAGRANGIAN_IR_FUNCTIONS; i < IR_FUNCTION_COUNT; i++) {
    if (!has_function(program, i)) continue;
    if (program->switches_are_table) instruction_tables_function(file, tables, i, program->ir_functions[i]);
    else statements_function(file, program, i, "", program->ir_functions[i]);
  }
  if (program->watched_series != NULL) statements_watched_limit(file, program);
}

void switching_write(FILE *file, const struct Program *program, const struct Encoding *tables) {
  if (program->equations->switching == NULL) return;
  struct SwitchTable metadata = switch_metadata_of(program);
  fputs("extern const struct EventLaws event_laws;\n\n", file);
  write_functions(file, program, tables);
  write_branches(file, &metadata);
  write_contacts(file, &metadata);
  write_frictions(file, &metadata);
  write_planes(file, &metadata);
  write_resting(file, &metadata);
  write_rests(file, &metadata);
  write_balls(file, &metadata);
  write_events(file, &metadata);
  write_timed(file, &metadata);
  write_samples(file, &metadata);
  write_table(file, program, &metadata);
}

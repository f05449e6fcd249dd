#include "write/switch_table.h"

#include "program/metadata/switch_metadata.h"
#include "write/c_text.h"
#include "write/description.h"
#include "write/instruction_tables.h"
#include "write/statements.h"

static const char *const passages[] = {[PASSAGE_HOLDS] = "PASSAGE_HOLDS",
                                       [PASSAGE_RISES] = "PASSAGE_RISES",
                                       [PASSAGE_FALLS] = "PASSAGE_FALLS",
                                       [PASSAGE_BOTH] = "PASSAGE_BOTH",
                                       [PASSAGE_SAMPLES] = "PASSAGE_SAMPLES"};
static const char *const resting_kinds[] = {[RESTING_VELOCITY] = "RESTING_VELOCITY",
                                            [RESTING_PRESCRIBED] = "RESTING_PRESCRIBED",
                                            [RESTING_SUM] = "RESTING_SUM"};

static const struct ElementType
    branches =
        STRUCT_TYPE(BranchMetadata, FIELD(BranchMetadata, mode), FIELD(BranchMetadata, function),
                    FIELD(BranchMetadata, file), FIELD(BranchMetadata, line), FIELD(BranchMetadata, is_last_sign),
                    FIELD(BranchMetadata, holds_energy), FIELD(BranchMetadata, is_of_forces)),
    contacts = STRUCT_TYPE(ContactMetadata, FIELD(ContactMetadata, mode), FIELD(ContactMetadata, constraint),
                           FIELD(ContactMetadata, carried), FIELD(ContactMetadata, name),
                           FIELD(ContactMetadata, restitution_is_constant)),
    frictions =
        STRUCT_TYPE(FrictionMetadata, FIELD(FrictionMetadata, mode), FIELD(FrictionMetadata, reported),
                    FIELD(FrictionMetadata, share), FIELD(FrictionMetadata, constraint), FIELD(FrictionMetadata, name),
                    FIELD(FrictionMetadata, is_given), FIELD(FrictionMetadata, has_static_limit)),
    planes = STRUCT_TYPE(PlaneMetadata, FIELD(PlaneMetadata, along), FIELD(PlaneMetadata, slip_direction),
                         FIELD(PlaneMetadata, lower), FIELD(PlaneMetadata, upper)),
    resting = STRUCT_TYPE(RestingMetadata, NAMED_FIELD(RestingMetadata, kind, resting_kinds),
                          FIELD(RestingMetadata, mode), FIELD(RestingMetadata, index)),
    assignments = STRUCT_TYPE(AssignmentMetadata, NAMED_FIELD(AssignmentMetadata, kind, variable_kind_names),
                              FIELD(AssignmentMetadata, index)),
    events = STRUCT_TYPE(EventMetadata, NAMED_FIELD(EventMetadata, passage, passages), FIELD(EventMetadata, last_sign),
                         FIELD(EventMetadata, is_of_contacts), FIELD(EventMetadata, first_assignment),
                         FIELD(EventMetadata, assignment_count), FIELD(EventMetadata, when)),
    samples = STRUCT_TYPE(SampleMetadata, FIELD(SampleMetadata, event), FIELD(SampleMetadata, branch),
                          FIELD(SampleMetadata, base), FIELD(SampleMetadata, count), FIELD(SampleMetadata, period));

/* All fields but functions, laws and rests_on. */
static const struct ElementType switch_fields = STRUCT_TYPE(
    SwitchTable, FIELD(SwitchTable, mode_count), FIELD(SwitchTable, importer), FIELD(SwitchTable, branch_count),
    ARRAY_FIELD(SwitchTable, branches, branch_count, "branch_metadata", branches), FIELD(SwitchTable, contact_count),
    ARRAY_FIELD(SwitchTable, contacts, contact_count, "contact_metadata", contacts), FIELD(SwitchTable, friction_count),
    ARRAY_FIELD(SwitchTable, frictions, friction_count, "friction_metadata", frictions),
    FIELD(SwitchTable, plane_count), ARRAY_FIELD(SwitchTable, planes, plane_count, "plane_metadata", planes),
    FIELD(SwitchTable, resting_count), ARRAY_FIELD(SwitchTable, resting, resting_count, "resting_metadata", resting),
    FIELD(SwitchTable, ball_count), ARRAY_FIELD(SwitchTable, ball_names, ball_count, "ball_names", text_elements),
    FIELD(SwitchTable, assignment_count),
    ARRAY_FIELD(SwitchTable, assignments, assignment_count, "assignment_metadata", assignments),
    FIELD(SwitchTable, event_count), ARRAY_FIELD(SwitchTable, events, event_count, "event_metadata", events),
    FIELD(SwitchTable, timed_count), FIELD(SwitchTable, affine_count),
    ARRAY_FIELD(SwitchTable, timed, timed_count, "timed", size_elements), FIELD(SwitchTable, sample_count),
    ARRAY_FIELD(SwitchTable, samples, sample_count, "sample_metadata", samples), FIELD(SwitchTable, energy_count),
    FIELD(SwitchTable, feels_forces), FIELD(SwitchTable, friction_varies), FIELD(SwitchTable, has_last_signs),
    FIELD(SwitchTable, watched_rows), FIELD(SwitchTable, watched_acceleration_row),
    FIELD(SwitchTable, watched_acceleration_count));

/* Writes the functions of struct SwitchTable. */
static void write_functions(FILE *file, const struct Program *program, const struct Encoding *tables) {
  for (enum FunctionName i = LAGRANGIAN_IR_FUNCTIONS; i < IR_FUNCTION_COUNT; i++) {
    if (!has_function(program, i)) continue;
    if (program->switches_are_table) instruction_tables_function(file, tables, i, program->ir_functions[i]);
    else statements_function(file, program, i, "", program->ir_functions[i]);
  }
  if (program->watched_series != NULL) statements_watched_limit(file, program);
}

static const char *friction_laws_of(const struct SwitchTable *metadata) {
  return switches_need_cone_path(metadata) ? "plane_friction_laws" : "friction_laws";
}

static void declare_laws(FILE *file, const struct SwitchTable *metadata) {
  fputs("extern const struct EventLaws event_laws;\n\n", file);
  if (metadata->contact_count > 0) fputs("extern const struct ContactLaws contact_laws;\n\n", file);
  if (metadata->friction_count > 0)
    fprintf(file, "extern const struct FrictionLaws %s;\n\n", friction_laws_of(metadata));
  if (switches_need_cone_path(metadata)) fputs("extern const struct ConePath cone_path;\n\n", file);
  if (metadata->rests_on != NULL) fputs("extern const struct SlidingLaws sliding_laws;\n\n", file);
  if (metadata->contact_count > 1) {
    fputs("bool step_over_events(struct Instance *instance, double until, double end, double *share, double *time,\n",
          file);
    fputs("                      double *longest);\n\n", file);
  }
  if (metadata->resting_count > 0) fputs("void resting_find(struct Resolution *resolution);\n\n", file);
  if (metadata->timed_count > 0) fputs("extern const struct TimeLaws time_laws;\n\n", file);
}

static void write_laws(FILE *file, const struct SwitchTable *metadata) {
  if (metadata->contact_count > 0) fputs("    .contact_laws = &contact_laws,\n", file);
  if (metadata->friction_count > 0) fprintf(file, "    .friction_laws = &%s,\n", friction_laws_of(metadata));
  if (switches_need_cone_path(metadata)) fputs("    .cone_path = &cone_path,\n", file);
  if (metadata->rests_on != NULL) fputs("    .sliding_laws = &sliding_laws,\n", file);
  if (metadata->contact_count > 1) fputs("    .step_over_events = step_over_events,\n", file);
  if (metadata->resting_count > 0) fputs("    .find_resting = resting_find,\n", file);
  if (metadata->timed_count > 0) fputs("    .time_laws = &time_laws,\n", file);
  if (metadata->rests_on != NULL) fputs("    .rests_on = rests,\n", file);
}

void switching_write(FILE *file, const struct Program *program, const struct Encoding *tables) {
  if (program->equations->switching == NULL) return;
  struct SwitchTable metadata = switch_metadata_of(program);
  write_functions(file, program, tables);
  declare_laws(file, &metadata);
  write_arrays(file, &switch_fields, &metadata);
  if (metadata.rests_on != NULL)
    write_array(file, "rests", &truth_elements, metadata.rests_on, metadata.friction_count * metadata.contact_count);
  fputs("static const struct SwitchTable switches = {\n", file);
  write_fields(file, &switch_fields, &metadata);
  write_laws(file, &metadata);
  write_functions_of(file, program, IN_SWITCHES, IN_SWITCHES);
  fputs("};\n\n", file);
}

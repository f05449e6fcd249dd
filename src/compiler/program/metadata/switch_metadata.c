#include "program/metadata/switch_metadata.h"

#include "base/memory.h"
#include "base/paths.h"

static size_t mode_index(const struct Program *program, Node mode) {
  return (size_t)graph_symbol_of(program->model->graph, mode)->index;
}

static const char *name_of(const struct Program *program, size_t constraint) {
  return program->model->constraints.items[constraint].name;
}

static const struct BranchMetadata *branches_of(const struct Program *program) {
  const struct SwitchingExpressions *switching = program->equations->switching;
  struct BranchMetadata *metadata = allocate(switching->branch_count, sizeof *metadata);
  for (size_t i = 0; i < switching->branch_count; i++) {
    const struct Branch *branch = switching->branches[i];
    struct FileLine slot = noted_line(program->model->lines, branch->line);
    metadata[i] = (struct BranchMetadata){mode_index(program, branch->mode),
                                          branch->function,
                                          file_name(slot.file),
                                          slot.line,
                                          branch->is_last_sign,
                                          switching->holds_energy[i],
                                          switching->is_of_forces[i]};
  }
  return metadata;
}

static const struct ContactMetadata *contacts_of(const struct Program *program) {
  const struct Switches *switches = &program->model->switches;
  struct ContactMetadata *metadata = allocate(switches->contact_count, sizeof *metadata);
  for (size_t i = 0; i < switches->contact_count; i++) {
    const struct Contact *contact = &switches->contacts[i];
    bool has_carried = contact->carried != ZERO;
    metadata[i] = (struct ContactMetadata){mode_index(program, contact->mode), contact->constraint,
                                           mode_index(program, has_carried ? contact->carried : contact->mode),
                                           name_of(program, contact->constraint),
                                           graph_is_constant_in_time(program->model->graph, contact->restitution)};
  }
  return metadata;
}

static const struct FrictionMetadata *frictions_of(const struct Program *program) {
  const struct Switches *switches = &program->model->switches;
  struct FrictionMetadata *metadata = allocate(switches->friction_count, sizeof *metadata);
  for (size_t i = 0; i < switches->friction_count; i++) {
    const struct Friction *friction = &switches->frictions[i];
    metadata[i] =
        (struct FrictionMetadata){mode_index(program, friction->mode),
                                  mode_index(program, friction->reported),
                                  mode_index(program, friction->share != ZERO ? friction->share : friction->mode),
                                  friction->constraint,
                                  name_of(program, friction->constraint),
                                  friction->is_given,
                                  friction->has_static_limit && !friction->is_given};
  }
  return metadata;
}

/* Adds the planar frictions. Each has two successive components, along and across. */
static void add_planes(struct SwitchTable *metadata, const struct Program *program) {
  const struct Switches *switches = &program->model->switches;
  struct PlaneMetadata *planes = allocate(switches->friction_count, sizeof *planes);
  for (size_t i = 0; i < switches->friction_count; i++) {
    const struct FrictionPlane *along = &switches->frictions[i].plane;
    if (along->axis != ALONG) continue;
    planes[metadata->plane_count++] =
        (struct PlaneMetadata){.along = i,
                               .slip_direction = {mode_index(program, along->slip_direction),
                                                  mode_index(program, switches->frictions[i + 1].plane.slip_direction)},
                               .lower = mode_index(program, along->lower),
                               .upper = mode_index(program, along->upper)};
  }
  metadata->planes = planes;
}

static struct AssignmentMetadata assignment_of(const struct Program *program, Node assigned) {
  const struct Symbol *symbol = graph_symbol_of(program->model->graph, assigned);
  return (struct AssignmentMetadata){symbol->kind == MODE ? VARIABLE_MODE : VARIABLE_STATE,
                                     state_slot(program->equations->count, symbol)};
}

/* Adds the events and the concatenated list of their assignments. */
static void add_events(struct SwitchTable *metadata, const struct Program *program) {
  const struct Switches *switches = &program->model->switches;
  struct EventMetadata *events = allocate(metadata->event_count, sizeof *events);
  struct AssignmentMetadata *assignments = allocate(metadata->assignment_count, sizeof *assignments);
  size_t assignment = 0;
  for (size_t i = 0; i < metadata->event_count; i++) {
    const struct Event *event = &switches->events[i];
    events[i] =
        (struct EventMetadata){.passage = event->passage,
                               .last_sign = event->last_sign != ZERO ? mode_index(program, event->last_sign) : 0,
                               .is_of_contacts = event->is_of_contacts,
                               .first_assignment = assignment,
                               .assignment_count = event->assignment_count,
                               .when = event->text};
    for (size_t k = 0; k < event->assignment_count; k++)
      assignments[assignment++] = assignment_of(program, event->assignments[k].symbol);
  }
  metadata->events = events;
  metadata->assignments = assignments;
}

static size_t branch_with(const struct SwitchingExpressions *switching, Node mode) {
  size_t branch = 0;
  while (switching->branches[branch]->mode != mode) branch++;
  return branch;
}

static const struct RestingMetadata *resting_of(const struct Program *program) {
  const struct Switches *switches = &program->model->switches;
  struct RestingMetadata *metadata = allocate(switches->resting_count, sizeof *metadata);
  size_t sums = 0;
  for (size_t i = 0; i < switches->resting_count; i++) {
    const struct RestingVelocity *resting = &switches->resting[i];
    size_t index = resting->kind == RESTING_SUM ? sums++ : resting->coordinate;
    metadata[i] = (struct RestingMetadata){resting->kind, mode_index(program, resting->mode), index};
  }
  return metadata;
}

static const struct SampleMetadata *samples_of(const struct Program *program) {
  const struct SwitchingExpressions *switching = program->equations->switching;
  const struct Switches *switches = &program->model->switches;
  struct SampleMetadata *metadata = allocate(switching->sample_count, sizeof *metadata);
  size_t count = 0;
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct SampleClock *sample = &switches->events[i].sample;
    if (switches->events[i].passage != PASSAGE_SAMPLES) continue;
    metadata[count++] =
        (struct SampleMetadata){i, branch_with(switching, sample->branch), mode_index(program, sample->base),
                                mode_index(program, sample->count), mode_index(program, sample->period)};
  }
  return metadata;
}

static const char *const *ball_names_of(const struct Switches *switches) {
  const char **names = allocate(switches->ball_count, sizeof *names);
  for (size_t i = 0; i < switches->ball_count; i++) names[i] = switches->balls[i].name;
  return names;
}

struct SwitchTable switch_metadata_of(const struct Program *program) {
  const struct SwitchingExpressions *switching = program->equations->switching;
  const struct Switches *switches = &program->model->switches;
  if (switching == NULL) return (struct SwitchTable){0};
  struct SwitchTable metadata = {.mode_count = switches->mode_count,
                                 .branch_count = switching->branch_count,
                                 .contact_count = switches->contact_count,
                                 .friction_count = switches->friction_count,
                                 .event_count = switches->event_count,
                                 .assignment_count = switching->assignment_count,
                                 .energy_count = switching->energy_count,
                                 .feels_forces = switching->feels_forces,
                                 .friction_varies = switching->friction_varies,
                                 .has_last_signs = switching->has_last_signs,
                                 .rests_on = switching->rests,
                                 .resting_count = switches->resting_count,
                                 .ball_count = switches->ball_count,
                                 .timed = switching->timed,
                                 .timed_count = switching->timed_count,
                                 .affine_count = switching->affine_count,
                                 .sample_count = switching->sample_count};
  metadata.importer = program->model->parameters.count + switches->mode_count;
  if (switches->importer != ZERO) metadata.importer = mode_index(program, switches->importer);
  if (metadata.branch_count > 0) metadata.branches = branches_of(program);
  if (metadata.contact_count > 0) metadata.contacts = contacts_of(program);
  if (metadata.friction_count > 0) metadata.frictions = frictions_of(program);
  if (metadata.resting_count > 0) metadata.resting = resting_of(program);
  if (metadata.ball_count > 0) metadata.ball_names = ball_names_of(switches);
  if (has_planes(switches)) add_planes(&metadata, program);
  if (metadata.event_count > 0) add_events(&metadata, program);
  if (metadata.sample_count > 0) metadata.samples = samples_of(program);
  if (program->watched_series != NULL) {
    metadata.watched_rows = program->watched_series->row_count;
    metadata.watched_acceleration_row = program->watched_series->acceleration_row;
    metadata.watched_acceleration_count = program->watched_series->acceleration_count;
  }
  return metadata;
}

bool switches_need_cone_path(const struct SwitchTable *switches) {
  return switches->rests_on != NULL || switches->plane_count > 0;
}

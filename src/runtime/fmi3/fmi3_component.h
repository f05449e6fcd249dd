/* An instance as FMI 3.0 sees it: its core, and what its caller has handed over. */
#ifndef FMI3_COMPONENT_H
#define FMI3_COMPONENT_H

#include "fmi3.h"
#include "stepping/intermediate.h"

/* For what a function makes of its arguments. */
enum WorkspaceUse { WORKSPACE_REFERENCES, WORKSPACE_KNOWNS, WORKSPACE_VALUES, WORKSPACE_COUNT };

/* Memory that grows. */
struct Workspace {
  void *block;
  size_t size;
};

/* What an fmi3Instance points to. */
struct Component {
  struct Instance instance;
  fmi3LogMessageCallback logger;
  fmi3InstanceEnvironment environment;
  unsigned categories;                                /* of the log, that are enabled */
  fmi3IntermediateUpdateCallback intermediate_update; /* NULL for none */
  struct Intermediate intermediate;
  bool early_return_allowed;
  bool has_returned_early; /* the callback asked for the end of the step */
  void *before;            /* the situation before a communication step */
  struct Workspace workspaces[WORKSPACE_COUNT];
};

/* Where the component's messages go. */
struct Log log_of(struct Component *component);

/* The status that the caller sees. */
static inline fmi3Status status_of(enum Status status) {
  static const fmi3Status of[] = {[STATUS_DONE] = fmi3OK,
                                  [STATUS_WARNING] = fmi3Warning,
                                  [STATUS_DISCARD] = fmi3Discard,
                                  [STATUS_ERROR] = fmi3Error};
  return of[status];
}

#endif

/* Event handling: locates events; finds modes, velocities and states after them. Linked only if there are events. */
#pragma once

#include "instance/instance.h"

/* Reasons for finding modes. */
enum Occasion {
  AT_START,   /* start of the simulation: no mode is known */
  AT_CHANGE,  /* a parameter, an input or a state may have been set */
  AT_EVENT,   /* an indicator has changed its sign */
  IN_EXCHANGE /* an importer that integrates asks; it may be past the zero of an indicator */
};

struct CommunicationStep;

/* Progress of a communication step through its events. */
struct EventProgress {
  double searched;  /* time up to which all events have been handled, in s */
  bool is_lost;     /* an event after it cannot be resolved */
  bool is_slow;     /* the step has taken a good part of a second; the warning was logged */
  int close_events; /* Zeno counter: consecutive events that time or the indicator's rounding does not separate */
  int close_events_at_rest; /* Zeno counter: consecutive close events of one indicator at rest */
  size_t creeping;          /* friction of most events of frictions in planes that do not slide */
  int creeping_events;      /* Zeno counter: its events, less those of other such frictions, since it slid */
  double last;              /* last event, in s from the start of the step; 0 for none */
  double distance;          /* between the last two events, in s; 0 for none */
  long count;               /* events in the step */
  int unsure;               /* intervals in the step in which a zero may hide */
  double step_limit;        /* limit of the solver's step in s if events lie too close for longer ones; 0 for none */
  int nearer;               /* times that this was shortened since a solver step without events */
  size_t indicator;         /* of the last event */
  double looked_ahead;      /* the last time from which modes were found by looking ahead; -INFINITY for none */
  double share;             /* of the last time step over events (time_step.h); 0 for none */
  int looks;                /* how many more times they were from that time */
};

/* The functions of the room events/, which FMUs without events do not link. */
struct EventLaws {
  /* Returns the number of doubles of workspace that an instance needs. */
  size_t (*work_count)(void);
  /*
   * Brings the modes into agreement with the state to which an importer has integrated. Impacts and events may change
   * the state. Returns NULL, or the reason why the motion cannot continue, after logging the cause.
   */
  const char *(*resolve)(struct Instance *instance);
  /* Sets the modes from start values, while these may be set: all contacts are open, all frictions slide. */
  void (*guess)(struct Instance *instance);
  /* Finds the modes at the start, after impacts and events there. False after logging an error. */
  bool (*start)(struct Instance *instance);
  /*
   * Opens contacts and releases frictions that a new parameter, input or state has set in motion. False after logging
   * why the step is discarded, such as bodies that penetrate each other.
   */
  bool (*part)(struct Instance *instance, double time);
  /* Finds the modes after a parameter, input or state was set. False after logging why the step is discarded. */
  bool (*resolve_change)(struct Instance *instance, double time);
  /*
   * Finds modes and state after the event that ended a step, or after a parameter, input or state was set. Returns
   * NULL, or the reason why the motion cannot continue.
   */
  const char *(*update)(struct Instance *instance);
  /* Handles the next event in the solver's last step. Returns NULL, or the reason why the motion ends there. */
  const char *(*pass)(struct Instance *instance, struct CommunicationStep *step, struct EventProgress *progress);
  /* Checks the laws at the end of a communication step. Returns NULL, or the violated one, after logging the cause. */
  const char *(*check)(struct Instance *instance, double time);
  /*
   * Handles a solver that cannot continue: the zero of an indicator that it cannot reach may be near. Returns NULL
   * after passing one, problem if there is none, or the reason why the motion ends there.
   */
  const char *(*pass_barrier)(struct Instance *instance, struct CommunicationStep *step, const char *problem,
                              struct EventProgress *progress);
  /* Passes events of the step, which would take too much work, by time steps. False if that fails. */
  bool (*step_over)(struct Instance *instance, const struct CommunicationStep *step, struct EventProgress *progress);
  /* Logs the events of a step with too many solver steps, if most of them ended at events. */
  void (*explain)(struct Instance *instance, const struct CommunicationStep *step,
                  const struct EventProgress *progress);
  /* Logs why the solver stopped, if a contact has jammed at the instance's state; false if none has. */
  bool (*explain_stop)(struct Instance *instance, double time);
  /* Logs the contact in which the centre of a ball is in the other shape at the instance's state; false if none is. */
  bool (*explain_ball)(struct Instance *instance, enum Status status, double time);
  /* True if the constraint belongs to a contact or friction, which closes and opens at events. */
  bool (*holds_at_times)(const char *constraint);
  /*
   * Sets the modes of pieces by the signs at a point. Methods and importers try points beyond the end of a piece, where
   * it may have no value. False if no piece changes. After true, return_pieces() restores the modes.
   */
  bool (*change_pieces)(struct Instance *instance, const struct Point *point);
  void (*return_pieces)(struct Instance *instance);
  /* Evaluates the indicators as reported to an importer. False if the accelerations do not exist. */
  bool (*indicators)(struct Instance *instance, double *value);
  /* True if an indicator has a sign that its mode does not allow. */
  bool (*is_due)(struct Instance *instance);
};

extern const struct EventLaws event_laws;

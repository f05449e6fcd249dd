/* A mechanical system: variables, energies and forces, as read from system.xml; massless.h adds regularizations. */
#pragma once

#include "algebra/units/quantity.h"
#include "base/diagnostics.h"
#include "model/drawn_line.h"
#include "model/kinematics.h"
#include "model/mesh.h"
#include "model/methods.h"
#include "model/switches.h"
#include "variable_type.h"

/* A variable, or another named element of a system. Fields that do not apply are NULL, NAN or ZERO. */
struct Variable {
  char *name, *description;
  char *unit;         /* as written; NULL if none was given */
  char *display_unit; /* unit in which importers may show it; NULL if none was given */
  enum VariableType type;
  struct Dimension dimension;
  double start, minimum, maximum, nominal; /* NAN if none was given */
  Node start_expression; /* of a state or mode: the expression of its start value; ZERO for other variables */
  Node node;             /* its symbol, or the value of an output */
  Node shown;            /* of a definition: its expression on the page, with functions in place of pieces; else ZERO */
  Node rate;             /* of a <state>: its time derivative, which may contain accelerations and constraint forces */
  char *force_name;      /* of a constraint: name of its force if that is not NAME.force; else NULL */
  bool is_norm;          /* of a constraint: the norm of a quaternion, whose force moves nothing */
  bool is_of_velocities; /* of a constraint: its force times the constraint is a power, not an energy */
  Node force_share; /* of a joint's constraint: the share of its force that has this name; ZERO for the whole force */
  bool is_fixed;    /* of a coordinate: constraints change neither its start value nor that of its velocity */
  bool is_work;     /* of a state: that of <work/>, whose rate is the power of the nonconservative forces */
  long line;
};

/* A growing list. Appending may move its items. */
struct VariableList {
  struct Variable *items;
  size_t count;
};

/* A particle or a rigid body. Components that were not given are ZERO and absent. */
struct Body {
  char *name;
  struct Quantity mass, inertia;
  struct Quantity position[3], angle;
  Node displaced[4]; /* x, y, z and angle, also as functions of virtual displacements */
  bool has_position[3], has_angle;
  bool is_in_frame;     /* it uses the fields below, not an angle and a scalar inertia */
  size_t frame;         /* index among the model's frames */
  struct Vector offset; /* m, of the centre of mass, along the frame's axes */
  struct Matrix tensor; /* kg.m2, about the centre of mass, along the frame's axes */
  /*
   * m/s, of the centre of mass, and rad/s, along the frame's axes. The displaced ones are also functions of virtual
   * displacements and their rates.
   */
  struct Vector velocity, angular_velocity, displaced_velocity, displaced_angular_velocity;
  long line;
};

/* A frame, also as a function of virtual displacements. The first frame is the base. */
struct ReferenceFrame {
  char *name;
  size_t parent;   /* index among the model's frames */
  bool is_of_body; /* rotates with the planar body of its name */
  struct Pose pose;
  struct Pose *steps; /* from the parent to the frame, each relative to the one before */
  size_t step_count;
};

/* A Cartesian force along one component of a position, which is also a function of virtual displacements. */
struct PointForce {
  Node position, force;
};

/* A torque and the angular velocity of its object, along the same axes; also for virtual displacements. */
struct Torque {
  struct Vector torque, angular_velocity;
};

/*
 * Regularization of M: an inertia m for a rate that is 0 on the motion, that of a holonomic constraint, or a
 * nonholonomic constraint itself. M + j^T m j, where j is the constraint's row of J, may be regular if M is singular.
 * Neither the motion nor the forces change.
 */
struct Regularization {
  Node constraint, inertia;
};

/* Prescribed motion of a coordinate. */
struct PrescribedMotion {
  bool is_prescribed; /* false for a coordinate that moves by its equation */
  Node acceleration;  /* a function of inputs, parameters and time */
  size_t reaction;    /* index of the driving force among the reactions */
};

/* The operating point of a linearization: a value for each symbol of the graph, ZERO if none was given. */
struct LinearizationPoint {
  Node *values;
  bool *given;
};

/* Author and terms of a system; NULL if not given. */
struct Origin {
  char *author, *version, *copyright, *license;
};

/* Motions that inputs or prescribed coordinates impose. */
struct PrescribedMotions {
  Node *input_rates;                 /* [inputs]: the input that is its time derivative; ZERO for none */
  bool inputs_move;                  /* positions or energies depend on inputs */
  bool states_move;                  /* positions or kinetic energies depend on states */
  struct PrescribedMotion *motions;  /* [coordinates] */
  size_t motion_count;               /* number of prescribed coordinates */
  const struct Variable *constraint; /* a rheonomic constraint, whose force does work; NULL for none */
};

enum ShapeType { SHAPE_PLANE, SHAPE_SPHERE, SHAPE_BOX, SHAPE_CYLINDER, SHAPE_CAPSULE, SHAPE_MESH, SHAPE_ELLIPSOID };
enum { SHAPE_TYPES = SHAPE_ELLIPSOID + 1 };

/* Names in type="...". */
extern const char *const shape_type_names[SHAPE_TYPES];

/* A shape that is drawn, and may have contacts. A plane is normal to its axis; bodies are on the positive side. */
struct ContactShape {
  char *name;
  enum ShapeType type;
  size_t frame;           /* index among the model's frames: position and orientation */
  const char *in;         /* name of the frame or body; a particle in the plane has the base's axes */
  size_t particle;        /* index of that particle among the bodies; NO_PARTICLE for none */
  int axis;               /* of a plane, cylinder or capsule: x, y or z of the frame */
  struct Vector offset;   /* m, of its centre, along the frame's axes */
  struct Matrix rotation; /* rotation from its own axes to the frame's */
  Node angles[3];         /* rad, of that rotation: about the frame's x, y and z in turn */
  Node radius, length;    /* m; the length of a capsule excludes its round ends */
  struct Vector size;     /* m, of a box or ellipsoid along its axes */
  bool is_flat[3];        /* the box has no size along the axis in the file: a side of 0, or none */
  bool stands;            /* a cylinder touches planes with points of its ends, too; a wheel with its rims alone */
  struct Mesh *mesh;      /* NULL for other types */
  bool is_hidden;         /* has contacts, but is not drawn */
  char *color;            /* such as "#ff8000", or "#ff800080" at half opacity; NULL for the page's choice */
};

#define NO_PARTICLE ((size_t)-1)

/* Index of the base among the frames. */
enum { BASE_FRAME = 0 };

/* Bodies, their frames and their shapes. */
struct Mechanism {
  struct Body *bodies;
  size_t body_count;
  struct ReferenceFrame *frames;
  size_t frame_count;
  struct ContactShape *shapes;
  size_t shape_count;
  struct VariableList element_variables; /* positions, velocities, lengths and forces of elements, as nodes */
  struct Vector gravity;                 /* m/s2: the acceleration of <gravity>, along the base's axes */
  struct Regularization *regularizations;
  size_t regularization_count;
};

/* In J; the dissipation in W. */
struct Energies {
  struct Quantity kinetic;          /* K of L = K - U, of bodies and <kinetic> terms */
  struct Quantity explicit_kinetic; /* of <kinetic> terms only */
  struct Quantity kinetic_energy;   /* the energy of both, see energies.h */
  bool has_prescribed;              /* masses have a prescribed velocity, even if all velocities are 0 */
  struct Quantity potential, dissipation;
  /* The sums of <kinetic> terms, potentials and dissipations, also as functions of virtual displacements. */
  struct Quantity displaced_kinetic, displaced_potential, displaced_dissipation;
};

/* The nonconservative forces: sums along coordinates, Cartesian forces and torques. */
struct Forces {
  struct Quantity *along; /* [coordinates]: generalized forces */
  struct PointForce *at_points;
  size_t point_count;
  struct Torque *torques;
  size_t torque_count;
  struct Quantity prescribed_power; /* W: power of Cartesian forces along the motion that only time prescribes */
  bool any;                         /* the model has forces, dissipation or prescribed motions */
};

/* The symbols that the equations of motion are solved for. */
struct Unknowns {
  Node *accelerations; /* [coordinates] */
  Node *forces;        /* [constraints]: of kind ACCELERATION; their indices follow those of the coordinates */
};

/* Attributes of <solver>; NAN for numbers that were not given. */
struct SolverChoice {
  const struct Method *method; /* NULL for the default */
  double tolerance, max_step;  /* max_step in s */
  double max_steps;            /* in one communication step; a whole number */
  long line;
};

/* Attributes of <experiment>, in s; NAN if not given. */
struct Experiment {
  double start_time, stop_time, step_size;
};

/* A value of <preset>, which the variable of this name gets before the start. */
struct PresetValue {
  const char *name;
  double value; /* in the unit of the variable */
};

/* Start values that users may choose by a name. */
struct Preset {
  const char *name, *description; /* description: NULL if none was given */
  struct PresetValue *values;     /* at least one, of different variables */
  size_t count;
};

/*
 * A condition of a task: the value of an expression lies between two numbers in its unit, one of which may be infinite.
 */
struct Goal {
  const char *formula; /* of variables of the FMU */
  double minimum, maximum;
};

/* Something that users try to reach by inputs: all goals at once, for some time. */
struct Task {
  const char *name, *description; /* description: NULL if none was given */
  const char *preset;             /* name of the preset from which it starts; NULL for the start values */
  struct Goal *goals;             /* at least one */
  size_t count;
  double hold, limit; /* s: how long the goals must be met, and until when; limit is infinite if none was given */
};

/* The content of a system. Lists keep the order of declaration. */
struct Model {
  char *name, *description;
  const struct FileLines *lines; /* lines of included files, see base/diagnostics.h */
  struct Origin origin;
  struct Graph *graph;
  Node time;
  struct VariableList parameters, inputs, coordinates, velocities, outputs;
  struct VariableList states;      /* of first order, after the velocities: of <state> and <work/> */
  struct VariableList calculated;  /* parameters computed from others; their nodes are the values */
  struct VariableList definitions; /* of <define>; their nodes are the expressions */
  size_t sensitivity_count; /* number of last coordinates that are sensitivities of the others, see sensitivities.h */
  size_t state_sensitivity_count; /* the same for states */
  struct VariableList displacements;
  struct VariableList modes; /* declared by the author; modes of switches have no names */
  struct VariableList
      constraints; /* each is 0 at all times: a function of coordinates and time, or linear in the velocities */
  struct VariableList reactions; /* forces along the displacements, then driving forces */
  struct Switches switches;
  struct PrescribedMotions prescribed;
  struct Mechanism mechanism;
  struct LineDrawing drawing;
  struct Energies energies;
  struct Forces forces;
  struct Unknowns unknowns;
  bool linearized;
  bool unrolled;                   /* accelerations are needed as expressions */
  struct LinearizationPoint point; /* if linearized */
  struct SolverChoice solver;
  struct Experiment experiment;
  struct Preset *presets;
  size_t preset_count;
  struct Task *tasks;
  size_t task_count;
};

/* Returns the index of a coordinate, velocity or first-order state in the state; of other symbols, their index. */
size_t state_slot(size_t coordinates, const struct Symbol *symbol);

/* Returns the number of time derivatives of the input that are inputs too; they follow it. */
size_t input_rate_count(const struct Model *model, size_t input);

/* True if the input is the time derivative of the one before. */
bool is_input_rate(const struct Model *model, size_t input);

/* Adds a term to a sum. */
void add_term(struct Model *model, struct Quantity *sum, Node term);

/* Returns a variable with unknown dimension, and without start value, range and nominal value. */
struct Variable variable_create(char *name, char *description, long line);

/* True if the start value depends on parameters. */
bool start_follows(const struct Model *model, const struct Variable *variable);

/* Returns the start values of all symbols, in the order of the graph's; 0 for accelerations. */
double *start_values(const struct Model *model);

/* Returns the state of <work/>; NULL if there is none. */
const struct Variable *work_of(const struct Model *model);

/* True if there are neither coordinates nor states. */
bool is_motionless(const struct Model *model);

/* True if some coordinate is fixed at the start. */
bool has_fixed_coordinates(const struct Model *model);

/* Returns the unknown of a row of the system K x = b of inertia.h: an acceleration, or a constraint force. */
Node unknown_of_row(const struct Model *model, size_t row);

/* Returns the force that a contact carries beside the constraint; ZERO for other constraints. */
Node carried_force(const struct Model *model, size_t constraint);

/* Returns the force of a constraint; of a contact, with the part that it carries beside the constraint. */
Node whole_constraint_force(const struct Model *model, size_t constraint);

/* Returns the name of a constraint's force. */
char *constraint_force_name(const struct Variable *constraint);

/*
 * Returns the dimension of that force: energy, or power for constraints of velocities, by the constraint's dimension.
 */
struct Dimension constraint_force_dimension(const struct Variable *constraint);

/* Returns the unit of a variable as written, else from its dimension; NULL if FMI cannot express it. */
char *variable_unit(const struct Variable *variable);

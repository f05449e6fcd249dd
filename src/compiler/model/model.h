/* A mechanical system: variables, energies, forces. The reader fills it as its author wrote it; massless.h adds inertias. */
#pragma once

#include "algebra/units/quantity.h"
#include "base/diagnostics.h"
#include "model/kinematics.h"
#include "model/mesh.h"
#include "model/methods.h"
#include "model/switches.h"
#include "variable_type.h"

struct Variable {
  char *name, *description;
  char *unit;         /* as written, NULL where none was given */
  char *display_unit; /* that importers may show it in; NULL where none was given */
  enum VariableType type;
  struct Dimension dimension;
  double start, minimum, maximum, nominal; /* NAN where none was given */
  Node start_expression;                   /* of a state, whose value is start; ZERO of others */
  Node node;                               /* the symbol, or the value of an output */
  Node rate;             /* of a <state>: its time derivative, which may hold accelerations and forces */
  char *force_name;      /* of a constraint, where its force is not NAME.force; else NULL */
  bool is_of_velocities; /* of a constraint, whose force times it is a power then, else an energy */
  Node force_share;      /* of a joint's constraint: what of its force has this name; ZERO for all */
  bool is_fixed;         /* of a coordinate: constraints move neither its start nor its velocity's */
  bool is_work;          /* of a state: that of <work/>, whose rate is the power of the forces */
  long line;
};

struct VariableList {
  struct Variable *items;
  size_t count;
};

/* A particle or a rigid body. Components that were not given are ZERO and not present. */
struct Body {
  char *name;
  struct Quantity mass, inertia;
  struct Quantity position[3], angle;
  Node displaced[4]; /* x, y, z and angle as functions of displacements too */
  bool has_position[3], has_angle;
  bool is_in_frame;     /* has the following in place of an angle and its inertia */
  size_t frame;         /* among the model's */
  struct Vector offset; /* m, of the centre of mass along the frame's axes */
  struct Matrix tensor; /* kg.m2, about the centre of mass along the frame's axes */
  /* m/s of the centre of mass and rad/s, along the frame's axes; also as functions of displacements and their rates. */
  struct Vector velocity, angular_velocity, displaced_velocity, displaced_angular_velocity;
  long line;
};

/* Axes that are moved and turned, as functions of displacements too. The first one is the base. */
struct ReferenceFrame {
  char *name;
  size_t parent;   /* among the model's */
  bool is_of_body; /* turns with the planar body of its name */
  struct Pose pose;
  struct Pose *steps; /* from the parent to the frame, each as seen from the one before */
  size_t step_count;
};

/* A Cartesian force along a component of a position, which is a function of displacements too. */
struct PointForce {
  Node position, force;
};

/* A torque and the angular velocity of what it turns, a function of displacements too, along the same axes. */
struct Torque {
  struct Vector torque, angular_velocity;
};

/*
 * What has an inertia without energy, since it rests: the rate of a holonomic constraint, or a nonholonomic one itself.
 * Adding its inertia to M, which may be singular without it, changes neither the motion nor the forces.
 */
struct Stillness {
  Node constraint, inertia;
};

/* How a coordinate moves that is driven: in a given way. */
struct Drive {
  bool given;        /* false of a coordinate that moves by its equation */
  Node acceleration; /* a function of inputs, parameters and time */
  size_t reaction;   /* the place of the drive's force among the reactions */
};

/* The point of a linearisation: one value for each symbol of the graph, ZERO where none was given. */
struct LinearizationPoint {
  Node *values;
  bool *given;
};

/* Who made a system, and on what terms: texts as given; NULL where none was. */
struct Origin {
  char *author, *version, *copyright, *license;
};

/* What moves in a given way, by inputs or by drives. */
struct GivenMotion {
  Node *input_rates;                 /* of each input: the one that is its time derivative; ZERO for none */
  bool inputs_move;                  /* positions or energies depend on inputs */
  struct Drive *drives;              /* one a coordinate */
  size_t drive_count;                /* of those that are given */
  const struct Variable *constraint; /* one that moves in a given way, so that it does work; NULL for none */
};

enum ShapeType { SHAPE_PLANE, SHAPE_SPHERE, SHAPE_BOX, SHAPE_CYLINDER, SHAPE_CAPSULE, SHAPE_MESH, SHAPE_ELLIPSOID };
enum { SHAPE_TYPES = SHAPE_ELLIPSOID + 1 };

/* As in type="...". */
extern const char *const shape_type_names[SHAPE_TYPES];

/* What is drawn, and touches. A plane is where its axis is 0, and open above it. */
struct ContactShape {
  char *name;
  enum ShapeType type;
  size_t frame;         /* among the model's: where it is and how it turns */
  const char *in;       /* the frame or body; a particle in the plane has the base's axes */
  size_t particle;      /* that one's place among the bodies; NO_PARTICLE for none */
  int axis;             /* of a plane, cylinder or capsule: x, y or z of the frame */
  struct Vector offset; /* m, of its middle along the frame's axes */
  struct Matrix turn;   /* from its own axes to the frame's */
  Node angles[3];       /* rad, of that about the frame's x, y and z, one after the other */
  Node radius, length;  /* m; of a capsule without its round ends */
  struct Vector size;   /* m, of a box or ellipsoid along its axes */
  struct Mesh *mesh;    /* NULL of other types */
  bool is_hidden;       /* touches, and is not drawn */
  char *color; /* such as "#ff8000", or "#ff800080" where half of it is seen through; NULL for the page's choice */
};

#define NO_PARTICLE ((size_t)-1)

/* The place of the base among the frames. */
enum { BASE_FRAME = 0 };

/* Bodies, the frames that they are in, and their shapes. */
struct Mechanism {
  struct Body *bodies;
  size_t body_count;
  struct ReferenceFrame *frames;
  size_t frame_count;
  struct ContactShape *shapes;
  size_t shape_count;
  struct VariableList places; /* where bodies, frames and points are, and how they move, in the nodes */
  struct Vector gravity;      /* m/s2: the direction of what <gravity> gives, along the base's axes */
  struct Stillness *stillnesses;
  size_t stillness_count;
};

/* In J, and in W the dissipation. */
struct Energies {
  struct Quantity kinetic;          /* K of L = K - U, of the bodies and of the <kinetic> terms */
  struct Quantity explicit_kinetic; /* of the <kinetic> terms alone */
  struct Quantity kinetic_energy;   /* the energy of both, see energies.h */
  bool driven;                      /* masses are moved in a given way, also where all velocities are 0 */
  struct Quantity potential, dissipation;
  /* The sums of the <kinetic> terms, potentials and dissipations as functions of displacements too. */
  struct Quantity displaced_kinetic, displaced_potential, displaced_dissipation;
};

struct Forces {
  struct Quantity *along; /* generalized force along each coordinate */
  struct PointForce *at_points;
  size_t point_count;
  struct Torque *torques;
  size_t torque_count;
  struct Quantity driven_power; /* W: of Cartesian forces along the motion that time alone gives */
  bool any;                     /* some force, dissipation or drive was given */
};

/* The symbols that the equations of motion are solved for. */
struct Unknowns {
  Node *accelerations; /* of each coordinate */
  Node *forces;        /* of each constraint, of the kind ACCELERATION, numbered after the coordinates */
};

/* What <solver> says; NAN where a number was not given. */
struct SolverChoice {
  const struct Method *method; /* NULL for the default */
  double tolerance, max_step;  /* max_step in s */
  double max_steps;            /* in one communication step, a whole number */
  long line;
};

/* What <experiment> says, in s; NAN where none was given. */
struct Experiment {
  double start_time, stop_time, step_size;
};

struct Model {
  char *name, *description;
  const struct FileLines *lines; /* that stand for those of included files */
  struct Origin origin;
  struct Graph *graph;
  Node time;
  struct VariableList parameters, inputs, coordinates, velocities, outputs;
  struct VariableList states;      /* of first order, behind the velocities: of <state> and of <work/> */
  struct VariableList calculated;  /* parameters that follow from others, their values in the nodes */
  struct VariableList definitions; /* what each <define> stands for, in its node */
  size_t variation_count;          /* of the coordinates, the last ones: derivatives of the others, see variations.h */
  size_t state_variation_count;    /* the same of the states */
  struct VariableList displacements;
  struct VariableList modes; /* that the author declared; those of switches have no names */
  struct VariableList
      constraints;               /* each is 0 at all times: of coordinates and time, or also linear in the velocities */
  struct VariableList reactions; /* forces along the displacements, then of the drives */
  struct Switches switches;
  struct GivenMotion given;
  struct Mechanism mechanism;
  struct Energies energies;
  struct Forces forces;
  struct Unknowns unknowns;
  bool linearized;
  bool unrolled;                   /* the accelerations are wanted as expressions */
  struct LinearizationPoint point; /* where linearized */
  struct SolverChoice solver;
  struct Experiment experiment;
};

/* The place of a coordinate, a velocity or a state behind them among all states; the index alone of other symbols. */
size_t state_place(size_t coordinates, const struct Symbol *symbol);

/* How many time derivatives of the input are inputs too; they follow it. */
size_t input_rate_count(const struct Model *model, size_t input);

/* Whether the input is the time derivative of the one before it. */
bool is_input_rate(const struct Model *model, size_t input);

/* Adds a term to one of the sums. */
void add_term(struct Model *model, struct Quantity *sum, Node term);

/* Without dimension, start value, range and nominal value. */
struct Variable variable_create(char *name, char *description, long line);

/* Whether the start value is an expression of parameters. */
bool start_follows(const struct Model *model, const struct Variable *variable);

/* The start values of all symbols, in the order of the graph's; accelerations are 0. */
double *start_values(const struct Model *model);

/* The state of <work/>; NULL where none was asked for. */
const struct Variable *work_of(const struct Model *model);

/* True if nothing moves: there are neither coordinates nor states. */
bool is_motionless(const struct Model *model);

/* Whether some coordinate is. */
bool has_fixed_coordinates(const struct Model *model);

/* The symbol of what a row of inertia.h is solved for: an acceleration, or the force of a constraint. */
Node unknown_of_row(const struct Model *model, size_t row);

/* The name of the force of a constraint. */
char *constraint_force_name(const struct Variable *constraint);

/* Of that force: energy by the constraint's unit; of a joint that holds a velocity, still a force. */
struct Dimension constraint_force_dimension(const struct Variable *constraint);

/* The unit of a variable, for output: as written, else from its dimension; NULL where FMI has none. */
char *variable_unit(const struct Variable *variable);

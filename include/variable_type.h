/* The types of FMI variables. Parameters of all types are stored as numbers; those of Booleans are 0 or 1. */
#ifndef VARIABLE_TYPE_H
#define VARIABLE_TYPE_H

enum VariableType { TYPE_REAL, TYPE_INTEGER, TYPE_BOOLEAN };

#endif

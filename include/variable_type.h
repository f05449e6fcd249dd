/* The types that variables have in FMI. Parameters of all types are numbers: whole ones, and 0 or 1 of a Boolean. */
#ifndef VARIABLE_TYPE_H
#define VARIABLE_TYPE_H

enum VariableType { TYPE_REAL, TYPE_INTEGER, TYPE_BOOLEAN };

#endif

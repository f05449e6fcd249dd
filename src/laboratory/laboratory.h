/*
 * lagc and the runtime in one module: derives a system and simulates it by the functions of FMI 2.0, without a
 * compiler. All methods except those of SUNDIALS are available.
 */
#pragma once

/*
 * Derives the system of a file, once in a process. pull: adds inputs that pull bodies, as lagc --pull. Returns 0; on
 * errors, writes messages to stderr, and nothing can be instantiated. robot: options for the file of a robot, such as
 * base=floating, each in a line of its own; "" for none.
 */
int derive(const char *path, int pull, const char *robot);

/* Return modelDescription.xml and documentation/index.html of the derived system, as lagc writes them. */
const char *model_description(void);
const char *documentation(void);

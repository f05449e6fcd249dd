/*
 * lagc and the runtime in one module: derives a system and simulates it by the functions of FMI 2.0, without a
 * compiler. All methods except those of SUNDIALS are available.
 */
#pragma once

/*
 * Derives the system of a file, once in a process. pull: adds inputs that pull bodies, as lagc --pull. Returns 0; on
 * errors, writes messages to stderr, and nothing can be instantiated.
 */
int derive(const char *path, int pull);

/* Return modelDescription.xml and documentation/index.html of the derived system, as lagc writes them. */
const char *model_description(void);
const char *documentation(void);

/*
 * lagc and the runtime in one module: a system is derived and then simulated by the functions of FMI 2.0, without a compiler.
 * It has the methods but those of SUNDIALS.
 */
#pragma once

/*
 * Derives the system of a file; pull: with inputs by which bodies can be pulled, as lagc --pull. Once in a process. Returns 0;
 * otherwise messages are on stderr, and nothing can be instantiated.
 */
int derive(const char *path, int pull);

/* Of the system that was derived: modelDescription.xml and the page documentation/index.html, as lagc writes them. */
const char *model_description(void);
const char *documentation(void);

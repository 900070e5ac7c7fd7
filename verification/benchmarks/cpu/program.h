/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
   SPDX-License-Identifier: Apache-2.0 */
/* What the busy programs share. They do no input or output, leave one word in `result` and end
   with the exit call of Linux on ARM, which emulators of processes know; a brick without a handler
   stops there. */
#ifndef PROGRAM_H
#define PROGRAM_H

typedef unsigned int word;

/* Data that a packed program keeps among its code. */
#ifdef PACKED
#define PLACE __attribute__((section(".text.table")))
#else
#define PLACE
#endif

extern word result;
extern void run(void);

#endif /* PROGRAM_H */

/* What the checks in C have in common: what was promised, and numbers by their bits, so that two machines can be compared. */
#ifndef CHECK_H
#define CHECK_H

#include "saltus.h"

#include <stdio.h>
#include <string.h>

static unsigned failures;

static inline void expect(const char *what, SaltusStatus got, SaltusStatus wanted) {
    if (got != wanted) {
        printf("wrong: %s gave status %d (%s), not %d\n", what, (int)got, saltus_status_text((uint32_t)got), (int)wanted);
        ++failures;
    }
}

static inline void hold(const char *what, int holds) {
    if (!holds) {
        printf("wrong: %s\n", what);
        ++failures;
    }
}

static inline void print(const char *name, const double *numbers, size_t count) {
    for (size_t i = 0; i < count; ++i) {
        unsigned long words[2] = {0, 0};
        unsigned char bytes[8];
        memcpy(bytes, &numbers[i], 8);
        for (int byte = 7; byte >= 0; --byte) {
            words[byte / 4] = words[byte / 4] << 8 | bytes[byte];
        }
        printf("%s %08lx%08lx\n", name, words[1], words[0]);
    }
}

/* Instructions since some time in the past, and bytes of stack that were used since it was last painted, but the caller's: of a board under
 * QEMU's -icount; always 0 elsewhere. */
#ifdef COUNTS_INSTRUCTIONS
unsigned long instructions(void);
void paint_stack(void);
unsigned long stack_used(void);
#else
static inline unsigned long instructions(void) {
    return 0;
}
static inline void paint_stack(void) {}
static inline unsigned long stack_used(void) {
    return 0;
}
#endif

#endif

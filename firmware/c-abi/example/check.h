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

/* A digest of what a walk says: FNV-1a over its bytes. */
static uint64_t digest = 0xcbf29ce484222325u;

static inline void take(const void *what, size_t bytes) {
    const unsigned char *byte = what;
    for (size_t i = 0; i < bytes; ++i) {
        digest = (digest ^ byte[i]) * 0x100000001b3u;
    }
}

static inline void print_digest(SaltusPhase phase) {
    printf("walk %s %08lx%08lx\n", saltus_phase_text((uint32_t)phase), (unsigned long)(digest >> 32), (unsigned long)(digest & 0xffffffffu));
}

/* Instructions since some time in the past, and how many bytes of stack, of those that were painted, were used since then, but the caller's: of a
 * board under QEMU's -icount; always 0 elsewhere. */
#ifdef COUNTS_INSTRUCTIONS
unsigned long instructions(void);
void paint_stack(size_t bytes);
unsigned long stack_used(size_t bytes);
#else
static inline unsigned long instructions(void) {
    return 0;
}
static inline void paint_stack(size_t bytes) {
    (void)bytes;
}
static inline unsigned long stack_used(size_t bytes) {
    return bytes & 0;
}
#endif

/* What a call costs at most. */
typedef struct {
    unsigned long instructions, stack;
} Cost;

enum { WATCHED = 48 * 1024 };

static inline unsigned long begin_cost(void) {
    paint_stack(WATCHED);
    return instructions();
}

static inline Cost larger(Cost a, Cost b) {
    return (Cost){a.instructions > b.instructions ? a.instructions : b.instructions, a.stack > b.stack ? a.stack : b.stack};
}

static inline void end_cost(Cost *most, unsigned long since) {
    since = instructions() - since;
    *most = larger(*most, (Cost){since, stack_used(WATCHED)});
}

static inline void print_cost(const char *robot, const char *what, Cost cost) {
    printf("costs %s %s %lu, bytes of stack %lu\n", robot, what, cost.instructions, cost.stack);
}

#endif

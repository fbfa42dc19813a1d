/* Start of a Cortex-M7: vectors, coprocessor, data; console and end by newlib's semihosting. */
#include <stdint.h>
#include <stdlib.h>

extern uint32_t stack_top, data_start, data_end, data_load, __bss_start__, __bss_end__;
extern void initialise_monitor_handles(void);
extern int main(void);

void reset(void) {
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; /* CPACR: the floating-point unit */
    __asm volatile("dsb\n isb");
    const uint32_t *from = &data_load;
    for (uint32_t *to = &data_start; to < &data_end;) {
        *to++ = *from++;
    }
    for (uint32_t *to = &__bss_start__; to < &__bss_end__;) {
        *to++ = 0;
    }
    initialise_monitor_handles();
    exit(main());
}

/* newlib calls these around main. */
void _init(void) {}
void _fini(void) {}

static void fault(void) {
    _Exit(2);
}

__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    &stack_top, (void *)reset, (void *)fault, (void *)fault, (void *)fault, (void *)fault, (void *)fault,
};

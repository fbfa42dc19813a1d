/* Start of a Cortex-M7: vectors, coprocessor, data; console and end by newlib's semihosting. */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

extern uint32_t stack_top, data_start, data_end, data_load, __bss_start__, __bss_end__;
extern void initialise_monitor_handles(void);
extern int main(void);
unsigned long instructions(void);
void paint_stack(size_t bytes);
unsigned long stack_used(size_t bytes);

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

/* SysTick counts down from here at 25 MHz; under QEMU's -icount with shift 6 an instruction takes 64 ns: 1.6 of its periods. */
static volatile uint32_t *const systick = (uint32_t *)0xE000E010u;

unsigned long instructions(void) {
    static uint32_t last, periods; /* Of 24 bits the first: ten million instructions may pass between two calls. */
    if ((systick[0] & 1u) == 0) {
        systick[1] = 0x00ffffffu;
        systick[2] = 0;
        systick[0] = 5u;
    }
    uint32_t now = 0x00ffffffu - systick[2];
    periods += (now - last) & 0x00ffffffu;
    last = now;
    return (unsigned long)((uint64_t)periods * 5u / 8u);
}

/* What is painted ends a little below the stack pointer: these two functions have frames as well. */
enum { OWN = 64, PAINT = 0x5a17a5a5 };

static volatile uint32_t *stack_now(void) {
    uint32_t pointer;
    __asm volatile("mov %0, sp" : "=r"(pointer));
    return (volatile uint32_t *)pointer;
}

__attribute__((noinline)) void paint_stack(size_t bytes) {
    volatile uint32_t *top = stack_now() - OWN / 4;
    for (volatile uint32_t *word = top - bytes / 4; word < top; ++word) {
        *word = PAINT;
    }
}

__attribute__((noinline)) unsigned long stack_used(size_t bytes) {
    volatile uint32_t *top = stack_now() - OWN / 4, *word = top - bytes / 4;
    while (word < top && *word == PAINT) {
        ++word;
    }
    return (unsigned long)(top - word) * 4 + OWN;
}

static void fault(void) {
    _Exit(2);
}

/* An entry of the table: the stack's top, or a handler. */
typedef union {
    const void *top;
    void (*run)(void);
} Vector;

__attribute__((section(".vectors"), used)) static const Vector vectors[16] = {
    {.top = &stack_top}, {.run = reset}, {.run = fault}, {.run = fault}, {.run = fault}, {.run = fault}, {.run = fault},
};

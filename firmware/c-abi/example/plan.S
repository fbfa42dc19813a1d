/* The plan of A1's double backflip in constant memory: PLAN names the file. */
    .section .rodata
    .global plan_begin, plan_end
    .balign 8
plan_begin:
    .incbin PLAN
plan_end:
#ifdef __ELF__
    .section .note.GNU-stack, "", %progbits
#endif

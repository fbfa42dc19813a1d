//! Puts the chosen board's memory map where the linker finds it.

fn main() -> Result<(), Box<dyn core::error::Error>> {
    saltus_memory::link("nucleo-h743zi2").map(drop)
}

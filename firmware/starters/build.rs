//! Puts the board's memory map and the names of its interrupts where the linker finds them.

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let out = saltus_memory::link("mps2-an500")?;
    let interrupts = "PROVIDE(SPARE0 = DefaultHandler);\nPROVIDE(SPARE1 = DefaultHandler);\n";
    Ok(std::fs::write(out.join("device.x"), interrupts)?)
}

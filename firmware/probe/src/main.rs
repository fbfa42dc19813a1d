//! The probe on the host: `saltus-probe a1-f64` writes what that image writes, without cost lines.

mod host;

fn main() -> std::io::Result<()> {
    host::run(&saltus_probe::parts())
}

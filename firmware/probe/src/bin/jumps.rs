//! The jumps on the host, apart from the rest because they build quickly: `jumps jump-a1-f64`.

#[path = "../host.rs"]
mod host;

fn main() -> std::io::Result<()> {
    host::run(&saltus_probe::flight::parts())
}

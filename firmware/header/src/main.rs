//! Writes `c-abi/include/saltus.h` from the crate's source. `--check` only compares, and fails where they differ.

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    match run(std::env::args().nth(1).as_deref() == Some("--check")) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(check: bool) -> Result<(), Box<dyn core::error::Error>> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../c-abi");
    let config = cbindgen::Config::from_file(source.join("cbindgen.toml"))?;
    let header = cbindgen::Builder::new()
        .with_config(config)
        .with_src(source.join("src/lib.rs"))
        .generate()?;
    let mut text = Vec::new();
    header.write(&mut text);
    let path = source.join("include/saltus.h");
    if !check {
        std::fs::write(path, text)?;
    } else if std::fs::read(path)? != text {
        return Err("c-abi/include/saltus.h is not what the source gives: `cargo xtask c-abi --overwrite` writes it".into());
    }
    Ok(())
}

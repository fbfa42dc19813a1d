//! `cargo xtask smoke`: no panic is reachable from any public algorithm.
//!
//! The image's panic handler calls a function that exists nowhere, so the image links only if the handler was removed
//! as unreachable. A proof that cannot fail is none: with one panic introduced the same link must fail, and must name
//! the missing function.

use anyhow::{Context, Result, bail, ensure};
use object::{Object, ObjectSymbol};

use crate::bare::Choice;
use crate::board::{self, Board};
use crate::{image, panics, run};

/// The function the panic handler calls.
const UNDEFINED: &str = "saltus_panic_is_reachable";

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Where `core` comes from.
    #[arg(long, value_enum, default_value = "auto")]
    core: Choice,
    /// Only this board.
    #[arg(long, value_parser = board::NAMES)]
    board: Option<String>,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    for board in board::chosen(args.board.as_deref()) {
        links_without_panic(board, args.core)?;
        fails_with_panic(board, args.core)?;
    }
    println!("smoke: no panic is reachable, and the proof fails when one is");
    Ok(())
}

/// How the linker says that a panic is reachable.
fn undefined() -> String {
    format!("undefined symbol: {UNDEFINED}")
}

fn links_without_panic(board: &Board, core: Choice) -> Result<()> {
    let mut build = image::command(board, core)?;
    let output = run::output(&mut build)?;
    if !output.status.success() {
        let errors = String::from_utf8_lossy(&output.stderr);
        if !errors.contains(&undefined()) {
            bail!("the image does not build:\n{errors}");
        }
        let found = panics::find(board, core)?;
        bail!(
            "a panic is reachable from {} places:\n{}",
            found.len(),
            found.join("\n")
        );
    }
    let path = image::build(board, core)?;
    let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
    let elf = object::File::parse(&*bytes)?;
    let names: Vec<&str> = elf
        .symbols()
        .filter_map(|symbol| symbol.name().ok())
        .collect();
    ensure!(
        names.contains(&"main"),
        "{} has no symbols: nothing was checked",
        path.display()
    );
    let panicking: Vec<_> = names.iter().filter(|name| name.contains("panic")).collect();
    ensure!(
        panicking.is_empty(),
        "the image contains panicking code: {panicking:?}"
    );
    println!("  links: no panic is reachable");
    Ok(())
}

fn fails_with_panic(board: &Board, core: Choice) -> Result<()> {
    let mut build = image::command(board, core)?;
    let output = run::output(build.args(["--features", "introduce_panic"]))?;
    if output.status.success() {
        bail!("the image links with a panic introduced: the proof proves nothing");
    }
    let errors = String::from_utf8_lossy(&output.stderr);
    ensure!(
        errors.contains(&undefined()),
        "the build with a panic introduced failed for another reason:\n{errors}"
    );
    println!("  with a panic introduced: {UNDEFINED} is undefined, as it must be");
    Ok(())
}

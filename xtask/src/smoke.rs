//! `cargo xtask smoke`: no panic is reachable from any public algorithm.
//!
//! The images' panic handler calls a function that exists nowhere, so an image links only if the handler was removed
//! as unreachable. A proof that cannot fail is none: with one panic introduced the same link must fail, and must name
//! the missing function.

use anyhow::{Context, Result, bail, ensure};
use object::{Object, ObjectSymbol};

use crate::bare::Bare;
use crate::board::{QUICKEST, Selection};
use crate::image::{Image, build_ahead};
use crate::{panics, run};

/// The function the panic handler calls.
const UNDEFINED: &str = "saltus_panic_is_reachable";

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    selection: Selection,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let mut linked = 0;
    for board in args.selection.boards() {
        let bare = Bare::find(board.target, args.selection.core)?;
        println!("{}: {}; {bare}", board.name, board.processor);
        fails_with_panic(&Image {
            board,
            name: QUICKEST,
            bare: &bare,
        })?;
        let names: Vec<_> = args.selection.images(board).collect();
        build_ahead(board, &bare, &names)?;
        for name in names {
            links_without_panic(&Image {
                board,
                name,
                bare: &bare,
            })
            .context(name)?;
            println!("  {name} links: no panic is reachable");
            linked += 1;
        }
    }
    ensure!(linked > 0, "no such image on such a board");
    println!("smoke: no panic is reachable in {linked} images, and the proof fails when one is");
    Ok(())
}

/// How the linker says that a panic is reachable.
fn undefined() -> String {
    format!("undefined symbol: {UNDEFINED}")
}

fn links_without_panic(image: &Image<'_>) -> Result<()> {
    let output = run::output(&mut image.command())?;
    if !output.status.success() {
        let errors = String::from_utf8_lossy(&output.stderr);
        if !errors.contains(&undefined()) {
            bail!("the image does not build:\n{errors}");
        }
        let found = panics::find(image)?;
        bail!(
            "a panic is reachable from {} places:\n{}",
            found.len(),
            found.join("\n")
        );
    }
    let path = image.build()?;
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
    Ok(())
}

fn fails_with_panic(image: &Image<'_>) -> Result<()> {
    let output = run::output(image.command().args(["--features", "introduce_panic"]))?;
    if output.status.success() {
        bail!("the image links with a panic introduced: the proof proves nothing");
    }
    let errors = String::from_utf8_lossy(&output.stderr);
    ensure!(
        errors.contains(&undefined()),
        "the build with a panic introduced failed for another reason:\n{errors}"
    );
    println!(
        "  {} with a panic introduced: {UNDEFINED} is undefined, as it must be",
        image.name
    );
    Ok(())
}

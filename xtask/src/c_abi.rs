//! `cargo xtask c-abi`: the C header is what the source gives, and programs in C do with it what they should.
//!
//! Three of them misuse the library: null, unaligned and moved blocks, wrong sizes, versions, plans, numbers. They end with an error if
//! a status is not the promised one, and what they compute on a Cortex-M7 is what they compute here, bit for bit. Together they call every
//! function of the header, so that their link for the board shows that no panic is reachable. A fourth flies A1 in MuJoCo. A controller in C++ with
//! the shape of ros2_control's is compiled without ROS, and stepped through a jump beside the header's own calls.

use core::time::Duration;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::bare::{Bare, Choice};
use crate::board::BOARDS;
use crate::{image, mujoco, run};

const LIMIT: Duration = Duration::from_secs(120);
/// Programs that run here and on the board.
const EXAMPLES: [&str; 3] = ["landing", "machine", "machine_icub"];
/// The plan that they are given.
const PLAN: &str = "firmware/probe/plans/a1-double-backflip.bin";
/// What is flown.
const TASK: &str = "a1/lateral";
const STRICT: [&str; 6] = [
    "-std=c11",
    "-O2",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-pedantic",
];
/// What a Rust library needs of the host.
const SYSTEM: [&str; 3] = ["-lm", "-lpthread", "-ldl"];
/// Every instruction takes 64 ns of the emulated clock: `example/start.c` counts them by it.
const COUNTING: [&str; 2] = ["-icount", "shift=6,align=off,sleep=off"];
const CORTEX_M7: [&str; 6] = [
    "-mcpu=cortex-m7",
    "-mthumb",
    "-mfloat-abi=hard",
    "-mfpu=fpv5-d16",
    "--specs=rdimon.specs",
    "-nostartfiles",
];

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Where `core` comes from.
    #[arg(long, value_enum, default_value = "auto")]
    core: Choice,
    /// Write the header instead of comparing with it.
    #[arg(long)]
    overwrite: bool,
    /// Only fly these tasks of A1 in MuJoCo.
    #[arg(long, num_args = 1.., value_name = "TASK")]
    fly: Vec<String>,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let folder = run::root().join("firmware/c-abi");
    if !args.fly.is_empty() {
        return fly(&folder, &for_host()?, &args.fly);
    }
    let mut header = run::firmware_cargo();
    header.args([
        "run",
        "--quiet",
        "--profile=host",
        "--locked",
        "--package",
        "saltus-header",
    ]);
    if !args.overwrite {
        header.args(["--", "--check"]);
    }
    run::succeed(&mut header)?;
    println!("c-abi: the header is what the source gives");
    all_called(&folder)?;
    in_cpp(&folder)?;
    let library = for_host()?;
    ros2_control(&folder, &library)?;
    let board = for_board(args.core)?;
    for example in EXAMPLES {
        let here = on_host(&folder, &library, example)?;
        let there = on_board(&folder, &board, example)?;
        compare(example, &here, &there)?;
    }
    fly(&folder, &library, &[TASK.to_owned()])
}

/// The same bits on both machines; sizes and costs, which are not, are printed.
fn compare(example: &str, here: &str, there: &str) -> Result<()> {
    let own = |line: &&str| line.starts_with("blocks ") || line.starts_with("costs ");
    let numbers = |text| {
        str::lines(text)
            .filter(|line| !own(line))
            .collect::<Vec<_>>()
    };
    let (here, on_board) = (numbers(here), numbers(there));
    if let Some((a, b)) = here.iter().zip(&on_board).find(|(a, b)| a != b) {
        bail!("{example}.c writes {a:?} on the host and {b:?} on the board");
    }
    ensure!(
        here.len() == on_board.len() && here.len() > 90,
        "{example}.c writes {} lines on the host and {} on the board",
        here.len(),
        on_board.len()
    );
    for line in there.lines().filter(own) {
        match line.strip_prefix("costs ") {
            Some(cost) => println!("c-abi: on a Cortex-M7, in instructions: {cost}"),
            None => println!("c-abi: bytes of the {line}"),
        }
    }
    println!(
        "c-abi: {} lines of {example}.c are the same on gcc's host and on a Cortex-M7; misuse gives the promised status",
        here.len()
    );
    Ok(())
}

/// Every function of the header is called by a program that is linked for the board.
fn all_called(folder: &Path) -> Result<()> {
    let header = fs::read_to_string(folder.join("include/saltus.h"))?;
    let mut sources = String::new();
    for example in EXAMPLES {
        sources += &fs::read_to_string(folder.join(format!("example/{example}.c")))?;
    }
    sources += &fs::read_to_string(folder.join("example/check.h"))?;
    let mut count = 0;
    for line in header.lines() {
        let Some((before, _)) = line.split_once('(') else {
            continue;
        };
        let name = before.rsplit([' ', '*']).next().unwrap_or_default();
        if name.starts_with("saltus_") && !before.starts_with(' ') {
            ensure!(
                sources.contains(&format!("{name}(")),
                "no example calls {name}"
            );
            count += 1;
        }
    }
    ensure!(count > 30, "only {count} functions found in the header");
    println!("c-abi: the examples call all {count} functions of the header");
    Ok(())
}

/// The header is C++ as well.
fn in_cpp(folder: &Path) -> Result<()> {
    if !run::exists("g++") {
        run::install_debian(&["g++"])?;
    }
    let mut compile = Command::new("g++");
    compile.args([
        "-std=c++17",
        "-x",
        "c++",
        "-fsyntax-only",
        "-Wall",
        "-Wextra",
        "-Werror",
    ]);
    compile.arg("-pedantic").arg("-include");
    run::succeed(
        compile
            .arg(folder.join("include/saltus.h"))
            .arg("/dev/null"),
    )
}

/// The controller with the shape of ros2_control's, stepped.
fn ros2_control(folder: &Path, library: &Path) -> Result<()> {
    let program = library.with_file_name("ros2_control_step");
    let sources = folder.join("example/ros2_control");
    let mut compile = Command::new("g++");
    compile.args(["-std=c++17", "-O2", "-Wall", "-Wextra", "-Werror"]);
    compile
        .arg("-pedantic")
        .arg("-I")
        .arg(folder.join("include"));
    compile.args(["jump_controller.cpp", "step.cpp"].map(|name| sources.join(name)));
    compile.arg(library).args(SYSTEM).arg("-o").arg(&program);
    run::succeed(&mut compile)?;
    let mut step = Command::new(&program);
    print!(
        "{}",
        run::stdout_within(step.arg(run::root().join(PLAN)), LIMIT)?
    );
    Ok(())
}

/// The library for this machine.
fn for_host() -> Result<PathBuf> {
    let mut build = run::firmware_cargo();
    build.args(["build", "--quiet", "--profile=host", "--locked"]);
    run::succeed(build.args(["--package", "saltus-c"]))?;
    Ok(image::firmware_target()?.join("host/libsaltus.a"))
}

/// The library for a Cortex-M7.
fn for_board(core: Choice) -> Result<PathBuf> {
    let board = &BOARDS[0];
    for (program, package) in [
        ("arm-none-eabi-gcc", "gcc-arm-none-eabi"),
        ("qemu-system-arm", "qemu-system-arm"),
    ] {
        if !run::exists(program) {
            run::install_debian(&[package, "libnewlib-arm-none-eabi"])?;
        }
    }
    let mut build = Bare::find(board.target, core)?.build_for(board.name, board.rustflags);
    run::succeed(build.args(["--quiet", "--package", "saltus-c"]))?;
    let built = image::firmware_target()?.join(board.target);
    Ok(built.join("release/libsaltus.a"))
}

/// A compiler with an example's sources; `plan.S` has the bytes of a plan.
fn compiler(program: &str, folder: &Path, example: &str) -> Command {
    let mut compile = Command::new(program);
    let plan = run::root().join(PLAN);
    compile.args(STRICT).arg("-I").arg(folder.join("include"));
    compile.arg(format!("-DPLAN=\"{}\"", plan.display()));
    compile.arg(folder.join(format!("example/{example}.c")));
    compile.arg(folder.join("example/plan.S"));
    compile
}

/// Builds an example with the host's compiler, and runs it.
fn on_host(folder: &Path, library: &Path, example: &str) -> Result<String> {
    let program = library.with_file_name(format!("c-{example}"));
    let mut compile = compiler("gcc", folder, example);
    compile.arg(library).args(SYSTEM).arg("-o").arg(&program);
    run::succeed(&mut compile)?;
    run::stdout_within(&mut Command::new(&program), LIMIT)
}

/// Builds an example for a Cortex-M7, and runs it under QEMU. That it links shows that no panic is reachable.
fn on_board(folder: &Path, library: &Path, example: &str) -> Result<String> {
    let image = library.with_file_name(format!("c-{example}"));
    let mut compile = compiler("arm-none-eabi-gcc", folder, example);
    compile.args(CORTEX_M7).arg("-DCOUNTS_INSTRUCTIONS");
    compile.arg(folder.join("example/start.c")).arg(library);
    compile.arg("-T").arg(folder.join("example/mps2-an500.ld"));
    compile.args(["-Wl,--gc-sections,--no-warn-execstack", "-lm", "-o"]);
    run::succeed(compile.arg(&image))?;
    run::stdout_within(BOARDS[0].emulator(&image).args(COUNTING), LIMIT)
}

/// Plans these tasks, and flies A1 in MuJoCo by the header alone.
fn fly(folder: &Path, library: &Path, tasks: &[String]) -> Result<()> {
    let (mujoco, search) = mujoco::library_for_c()?;
    let program = library.with_file_name("fly_a1");
    let mut compile = Command::new("gcc");
    compile.args(STRICT).arg("-I").arg(folder.join("include"));
    compile.arg("-isystem").arg(mujoco.join("include"));
    compile.arg(folder.join("example/fly_a1.c")).arg(library);
    compile.arg(mujoco.join("libmujoco.so")).args(SYSTEM);
    run::succeed(compile.arg("-o").arg(&program))?;
    for task in tasks {
        let out = run::root().join("target/c-abi").join(task);
        run::remove_folder(&out)?;
        let mut plan = mujoco::saltus()?;
        run::succeed(plan.args(["plan", task, "--out"]).arg(&out))?;
        let mut fly = Command::new(&program);
        fly.arg(&out).env("LD_LIBRARY_PATH", &search);
        let told = run::stdout_within(&mut fly, LIMIT).with_context(|| format!("{task} in C"))?;
        print!("{told}");
    }
    Ok(())
}

//! What stands below the options in `--help`: examples, and what the exit codes mean.

pub(crate) const PROGRAM: &str = "\
Begin with:
  saltus run a1/lateral                  plan a jump, simulate it, and write a report for your browser
  saltus help COMMAND                    more about a command, with examples

Tasks: a1/lateral, a1/lateral-down, a1/spin-90, a1/diagonal, a1/forward-60, a1/barrel-roll, a1/barrel-roll-box,
a1/double-barrel-roll, a1/double-backflip; icub/velocity and icub/torque for `run`; or a TOML file of your own.

Exit codes of every command: 0 done and good; 2 the answer is no, or the command line is refused, or a file or folder that it names: the
same command fails again; 1 not done, or not told, for a reason outside such as a full disk: the same command may do later; 130 stopped by
Ctrl-C; 141 in silence where the reader of the output has gone, with the files complete. NO_COLOR=1 switches colours off.";

pub(crate) const PLAN: &str = "\
Examples:
  saltus plan a1/lateral                              plan, audit, and tell
  saltus plan a1/lateral --out out/lateral            also keep plan.bin, which controllers read, plan.json, and scene.xml for MuJoCo
  saltus plan my-task.toml --robot my.urdf            your own task for your own quadruped
  saltus plan a1/forward-60 --timing 0.5,0.3,0.55     with given durations of the phases
  saltus plan --reference spin --stage whole-body     a reference problem of paper A

Exit codes: 0 planned and passed its audit; 2 there is no such plan (the output tells what blocks and what would have to change), or a file or
an option is refused; 1 the plan cannot be written. A file or folder of a plan appears only with code 0.";

pub(crate) const VERIFY: &str = "\
Examples:
  saltus verify out/lateral/plan.bin
  saltus verify plan.bin --robot my.urdf --json

Exit codes: 0 the plan passes; 2 it does not, or is refused; 1 the answer cannot be written.";

pub(crate) const IMPORT: &str = "\
Examples:
  saltus import my.urdf                               check only: what it is, and what is doubtful in it
  saltus import my.urdf --out my-model                a no_std crate with its tables
  saltus import arm.urdf --base fixed --lock gripper=0.02

Exit codes: 0 the robot is good (warnings go to standard error); 2 the file, an option or the folder is refused;
1 the crate cannot be written.";

pub(crate) const RUN: &str = "\
Examples:
  saltus run a1/barrel-roll                           report, log and result in out/a1-barrel-roll
  saltus run a1/lateral --seed 3                      the lab of seed 3: masses, ground, motors, sensors, delays
  saltus run a1/lateral --plant ground=soft,payload=2@0,0,0.05 --interface joint-pd
  saltus run out/lateral/plan.bin                     a stored plan, as `saltus plan --out` wrote it
  saltus run icub/velocity --height 0.03 --plant mass=1.05,noise
  saltus run my-task.toml --json --out out/mine

Exit codes: 0 on target (flown as planned, standing 2 s later within 0.10 m and 10°, hardware within its budgets; a humanoid: upright
and high enough); 2 not on target, or proven to be impossible, or a file or an option is refused; 1 the results cannot be
written. The folder appears only when it is complete.";

pub(crate) const WATCH: &str = "\
Examples:
  saltus watch out/a1-lateral                         its report in your browser
  saltus watch out/a1-lateral out/a1-lateral-2        both on one page: animated in step, curves in the same plots, what differs
  saltus watch gallery/a1-barrel-roll-native gallery/a1-barrel-roll-mujoco
  saltus watch out/a1-lateral --no-open               only the address, where there is no screen

The page is one file that needs no network; its clock is zero at the planned take-off of every run. `saltus verdicts --out gallery` makes
many runs at once.

Exit codes: 0 the page is there (its address is told, whether a browser opens it or not); 2 a folder is no run, or damaged, or runs of
quadrupeds and humanoids are mixed; 1 the page cannot be written.";

pub(crate) const ENVELOPE: &str = "\
Examples:
  saltus envelope a1/lateral --samples 20
  saltus envelope a1/lateral --shard 2/4 --out study   a quarter of a study; shards in one folder make one table
  saltus envelope a1/diagonal --without weighing,posture what two of the measures against disturbances are worth together
  saltus envelope a1/diagonal --ablate                 the study beside the same study without each measure

Exit codes: 0 the study or its shard is complete; 130 stopped by Ctrl-C, with the table of the samples so far: the same command goes on;
2 there is no such plan (the output tells why), or the task, the folder or an option is refused; 1 the results cannot be written.";

pub(crate) const VERDICTS: &str = "\
Examples:
  saltus verdicts                                      the nine tasks of A1, every measure
  saltus verdicts --plant ground=soft --interface joint-pd
  saltus verdicts jump-planner/tasks/extra/*.toml            tasks of your own
  saltus verdicts --conditions --lab 100               what each condition does, and a hundred seeds of the lab
  saltus verdicts --ranges                             what may differ from the plan, and the lab's ranges
  saltus verdicts --expect jump-planner/tasks/expected.toml      the gate: every verdict as expected
  saltus verdicts a1/lateral icub/velocity --out gallery         also a page with pictures, and a report of every run

Exit codes: 0 all on target, or all as expected; 2 one is not: it is named, or a task is refused; 130 stopped by Ctrl-C.";

pub(crate) const REPRODUCE: &str = "\
Examples:
  saltus reproduce --quick                            native simulator only
  saltus reproduce --expect jump-planner/tasks/expected.toml      the gate: every item as expected
  saltus reproduce --json --out out/papers            also MuJoCo, in a build with the feature `mujoco`

Exit codes: 0 every claim that can be judged holds; 2 one does not, or the folder is refused; 130 stopped by Ctrl-C, with the page of the
rows so far; 1 the page cannot be written.";

pub(crate) const COMPLETIONS: &str = "\
Examples:
  saltus completions bash > ~/.local/share/bash-completion/completions/saltus
  saltus completions fish > ~/.config/fish/completions/saltus.fish
  saltus completions zsh > ~/.zfunc/_saltus";

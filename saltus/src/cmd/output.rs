//! What a command prints: text, one JSON object, or nothing; and how far it is, on a terminal only.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use core::ops::RangeInclusive;
use core::str::FromStr;
use core::time::Duration;
use indicatif::{ProgressBar, ProgressStyle};
use jump_lab::Sim;
use jump_lab::humanoid::Landing;
use jump_lab::lab::PlantArgument;
use jump_lab::quadruped::measure::Measure;
use jump_planner::planned::Planner;
use jump_planner::range::Range;
use jump_planner::task::Task;

/// Options of every command that prints a result.
#[derive(clap::Args, Clone, Copy)]
pub(crate) struct Output {
    /// Print one JSON object on standard output and nothing else; an error is an object with the key `error`.
    #[arg(long)]
    pub(crate) json: bool,
    /// Print nothing but errors: the exit code and the files tell the rest.
    #[arg(long, short, conflicts_with = "json")]
    pub(crate) quiet: bool,
}

impl Output {
    /// Names limits of a robot that are none, and links that no simulator sees collide.
    pub(crate) fn warn_of(self, task: &Task) {
        if self.quiet {
            return;
        }
        let robot = &task.robot;
        for placeholder in robot.placeholders() {
            tell!("saltus: warning: {}: {placeholder}", robot.name);
        }
        let pairs = robot.overlapping(&task.start);
        let pairs: Vec<String> = pairs.iter().map(|pair| pair.join(" and ")).collect();
        if !pairs.is_empty() {
            tell!(
                "saltus: warning: {}: links are in each other where the robot stands, so nobody sees them collide ({}): correct the sizes of \
                 its shapes",
                robot.name,
                pairs.join(", ")
            );
        }
    }

    /// Whether text for people is wanted.
    pub(crate) fn is_text(self) -> bool {
        !self.json && !self.quiet
    }

    /// A spinner with a message; hidden where nobody looks.
    pub(crate) fn spinner(self) -> ProgressBar {
        if !self.is_text() {
            return ProgressBar::hidden();
        }
        let bar = ProgressBar::new_spinner();
        bar.enable_steady_tick(Duration::from_millis(100));
        bar
    }

    /// A bar of so many steps; hidden where nobody looks.
    pub(crate) fn bar(self, steps: u64, template: &str) -> Result<ProgressBar, String> {
        if !self.is_text() {
            return Ok(ProgressBar::hidden());
        }
        let style = ProgressStyle::with_template(template).map_err(|error| error.to_string())?;
        let bar = ProgressBar::new(steps);
        bar.set_style(style.progress_chars("=> "));
        Ok(bar)
    }
}

/// A whole number from the first to the last; what it must be is said where it is something else.
pub(crate) fn whole(
    range: RangeInclusive<u64>,
) -> impl Fn(&str) -> Result<u64, String> + Clone + Send + Sync + 'static {
    move |text| {
        let number = text.parse().ok().filter(|x| range.contains(x));
        let (low, high) = (range.start(), range.end());
        number.ok_or_else(|| format!("a whole number from {low} to {high} is needed"))
    }
}

/// A number in a range; what it must be is said where it is something else.
pub(crate) fn number(
    range: Range,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| {
        let number = text.parse::<f64>().map_err(|error| error.to_string())?;
        range.check(number).map(|()| number)
    }
}

/// One of these names.
fn named<T: FromStr<Err = String> + Clone + Send + Sync + 'static>(
    names: impl IntoIterator<Item = PossibleValue>,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names).try_map(|name| name.parse::<T>())
}

/// A name with what it means.
fn value(name: &'static str, what: &'static str) -> PossibleValue {
    PossibleValue::new(name).help(what)
}

/// What differs from the plan; an empty text, as an unset variable of a script leaves it, is none.
pub(crate) fn plant(text: &str) -> Result<PlantArgument, String> {
    let plant: PlantArgument = text.parse()?;
    if plant == PlantArgument::NOTHING {
        return Err(
            "nothing is named: give lab, noise or KEY=VALUE, separated by commas, or leave the option out".to_owned(),
        );
    }
    Ok(plant)
}

/// Simulators by their names.
pub(crate) fn sims() -> impl TypedValueParser<Value = Sim> {
    named(Sim::ALL.map(|sim| value(sim.name(), sim.what())))
}

/// Measures against disturbances by their names.
pub(crate) fn measures() -> impl TypedValueParser<Value = Measure> {
    named(Measure::ALL.map(|measure| value(measure.name(), measure.what())))
}

/// Landings of a humanoid by their names.
pub(crate) fn landings() -> impl TypedValueParser<Value = Landing> {
    named(Landing::ALL.map(|landing| value(landing.name(), landing.what())))
}

/// Planners by their names.
pub(crate) fn planners() -> impl TypedValueParser<Value = Planner> {
    named(Planner::ALL.map(|planner| PossibleValue::new(planner.name())))
}

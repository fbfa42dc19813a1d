//! How often a jump succeeds, over what may differ from the plan.

use core::sync::atomic::{AtomicU64, Ordering};
use core::time::Duration;
use std::collections::BTreeMap;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;

use jump_lab::lab::keys::ROWS;
use jump_lab::quadruped::Planned;
use jump_lab::quadruped::envelope::{Counts, Sample, table, trial, wilson};
use numpy::PyArray1;
use pyo3::{Py, PyAny, PyResult, Python, pyclass, pyfunction, pymethods};

use crate::arrays::List;
use crate::errors::{bad, failed};
use crate::plan::Plan;
use crate::run::Conditions;

/// How long Ctrl-C waits at most, beside the runs that are under way.
const POLL: Duration = Duration::from_millis(100);

/// A sample, or what went wrong.
type Done = Result<Sample, String>;

/// Flies a plan `samples` times, each in a lab that differs otherwise, in `jobs` threads (all cores by default), and judges every run.
///
/// Sample i of a seed is the same run on every machine, and that of `saltus envelope`. `plant`, `interface`, `without` and `sim` are those
/// of run. `progress(done, samples)` is called after every sample. Whatever it raises, and Ctrl-C, ends the study after the runs that are
/// under way, and is raised here.
///
/// Raises BadInput that names the argument, and Error where a run cannot begin.
#[pyfunction]
#[pyo3(signature = (plan, samples = 100, progress = None, *, seed = 1, sim = "native", plant = None, interface = "torque", without = Vec::new(), jobs = None))]
#[allow(
    clippy::too_many_arguments,
    reason = "they are the options of the command, and Python names its arguments"
)]
pub(crate) fn envelope(
    py: Python<'_>,
    plan: Py<Plan>,
    samples: u64,
    progress: Option<Py<PyAny>>,
    seed: u64,
    sim: &str,
    plant: Option<&str>,
    interface: &str,
    without: Vec<String>,
    jobs: Option<usize>,
) -> PyResult<Envelope> {
    let conditions = Conditions::read(sim, plant, interface, &without)?;
    let cores = || thread::available_parallelism().map_or(1, usize::from);
    let jobs = jobs.unwrap_or_else(cores);
    if jobs == 0 {
        return Err(bad("jobs: must be at least 1, not 0"));
    }
    let study = Study {
        planned: &plan.get().0.clone(),
        conditions: &conditions,
        seed,
        samples,
        next: &AtomicU64::new(0),
    };
    let mut done = py.detach(|| {
        study.run(jobs, |done| {
            Python::attach(|py| {
                py.check_signals()?;
                match (&progress, done) {
                    (Some(progress), Some(done)) => progress.call1(py, (done, samples)).map(|_| ()),
                    _ => Ok(()),
                }
            })
        })
    })?;
    done.sort_by_key(|sample| sample.index);
    Ok(Envelope(done))
}

/// A study under way.
#[derive(Clone, Copy)]
struct Study<'a> {
    planned: &'a Planned,
    conditions: &'a Conditions,
    seed: u64,
    samples: u64,
    /// The next sample that nobody has begun.
    next: &'a AtomicU64,
}

impl Study<'_> {
    /// All samples. `tell` hears how many there are after each, and nothing now and then; its error ends the study.
    fn run(
        self,
        jobs: usize,
        mut tell: impl FnMut(Option<usize>) -> PyResult<()>,
    ) -> PyResult<Vec<Sample>> {
        thread::scope(|scope| {
            let (sender, receiver) = channel();
            for _ in 0..jobs {
                let sender = sender.clone();
                scope.spawn(move || self.work(&sender));
            }
            drop(sender);
            let mut done = Vec::new();
            loop {
                let told = match receiver.recv_timeout(POLL) {
                    Err(RecvTimeoutError::Disconnected) => return Ok(done),
                    Err(RecvTimeoutError::Timeout) => tell(None),
                    Ok(Err(error)) => Err(failed(error)),
                    Ok(Ok(sample)) => {
                        done.push(sample);
                        tell(Some(done.len()))
                    }
                };
                if told.is_err() {
                    // Nobody begins another one.
                    self.next.store(self.samples, Ordering::Relaxed);
                    return told.map(|()| done);
                }
            }
        })
    }

    /// Runs samples until there are none left.
    fn work(self, sender: &Sender<Done>) {
        loop {
            let index = self.next.fetch_add(1, Ordering::Relaxed);
            if index >= self.samples || sender.send(self.sample(index)).is_err() {
                return;
            }
        }
    }

    fn sample(self, index: u64) -> Done {
        let Conditions {
            sim,
            plant,
            interface,
            without,
        } = self.conditions;
        let trial = trial(
            (self.seed, index),
            plant.as_ref(),
            (*sim, *interface),
            without,
        );
        let run = self.planned.run(trial)?;
        Ok(Sample::new(index, &trial, &self.planned.judge(&run)))
    }
}

/// The samples of a study.
#[pyclass(frozen, module = "saltus")]
pub(crate) struct Envelope(Vec<Sample>);

impl Envelope {
    fn column<'py>(&self, py: Python<'py>, of: impl Fn(&Sample) -> f64) -> List<'py> {
        PyArray1::from_iter(py, self.0.iter().map(of))
    }
}

#[pymethods]
impl Envelope {
    /// "target", or what failed first, by sample.
    #[getter]
    fn outcomes(&self) -> Vec<&str> {
        self.0
            .iter()
            .map(|sample| sample.outcome.as_str())
            .collect()
    }

    /// Seeds with which run repeats each sample.
    #[getter]
    fn seeds(&self) -> Vec<u64> {
        self.0.iter().map(|sample| sample.seed).collect()
    }

    /// What differed, by key of `--plant`: arrays of shape (samples,).
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> BTreeMap<&'static str, List<'py>> {
        let columns = ROWS
            .iter()
            .map(|row| (row.name, self.column(py, |sample| sample.value(row.key))));
        columns.collect()
    }

    /// Distance of the feet's middle from the goal's in the end, m, shape (samples,); NaN where a run ended before.
    #[getter]
    fn feet_error<'py>(&self, py: Python<'py>) -> List<'py> {
        self.column(py, |sample| sample.feet_error)
    }

    /// Angle of the base from the goal's in the end, degrees, shape (samples,); NaN where a run ended before.
    #[getter]
    fn rotation_error<'py>(&self, py: Python<'py>) -> List<'py> {
        self.column(py, |sample| sample.rotation_error)
    }

    /// Share of the runs that were on target.
    #[getter]
    fn rate(&self) -> f64 {
        let counts = Counts::of(&self.0);
        counts.on_target as f64 / counts.samples.max(1) as f64
    }

    /// Wilson's 95 % interval of the rate.
    #[getter]
    fn interval(&self) -> (f64, f64) {
        let counts = Counts::of(&self.0);
        let [low, high] = wilson(counts.on_target, counts.samples);
        (low, high)
    }

    /// How many runs failed, by what failed first.
    #[getter]
    fn failed(&self) -> BTreeMap<String, usize> {
        Counts::of(&self.0).failed
    }

    /// Rates by cells of what differed, as text of comma-separated values: the table of `saltus envelope`.
    fn table(&self) -> String {
        table(&self.0)
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    fn __repr__(&self) -> String {
        let counts = Counts::of(&self.0);
        format!(
            "Envelope({} of {} on target)",
            counts.on_target, counts.samples
        )
    }
}

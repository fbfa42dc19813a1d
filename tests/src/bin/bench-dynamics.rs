//! rbd-core's side of the ratio table and of the instruction counts.
//!
//! ```text
//! bench-dynamics time TAG MS DIR [ALGORITHM]  ns of every algorithm, or one, over the peers' states in DIR
//! bench-dynamics list                         the algorithms: robot model algorithm
//! bench-dynamics count ROBOT MODEL ALGORITHM  each golden state once, for callgrind; `none` measures the rest
//! ```
//!
//! Each call starts from a quaternion and joint angles, as Pinocchio's do: the rotation matrix and all sines and
//! cosines are inside the measurement.

use core::hint::black_box;
use std::path::Path;
use std::process::ExitCode;

use a1_model::A1;
use icub_model::gazebo::AsPublished as Icub23;
use rbd_core::{
    AbaDerivatives, AbaDerivativesWorkspace, AbaWorkspace, AccelerationKind, Axes, BlockMatrix,
    BodyMotions, CentroidalDerivatives, CentroidalMap, ComJacobian, DerivativesWorkspace, Force,
    Frame, FrameDerivatives, FrameJacobian, Kinematics, MassFactors, MassMatrix, Model,
    RneaDerivatives, TableModel, Tree, aba, aba_derivatives, bias_accelerations, center_of_mass,
    centroidal_bias, centroidal_derivatives, centroidal_map, centroidal_momentum_rate,
    centroidal_state, com_jacobian, com_motion, contact_dynamics, crba, difference,
    forward_accelerations, forward_kinematics, forward_velocities, frame_derivatives,
    frame_jacobian, generalized_gravity, impact, integrate, joint_jacobians, mass_matrix_inverse,
    nonlinear_effects, rnea, rnea_derivatives, rnea_with_forces,
};
use saltus_tests::bench::{HeldFeet, State, time};

/// Algorithms by the names that the peer benches use; the argument is the index of a state.
type Algorithms<'a> = Vec<(&'static str, Box<dyn FnMut(usize) + 'a>)>;

/// The algorithms of one model, as they are added.
struct Bench<'a, M, const N: usize> {
    model: &'a M,
    feet: &'a [Frame<f64>],
    states: &'a [State<N>],
    list: Algorithms<'a>,
}

/// Adds an algorithm to a [`Bench`]; `$p` is the posture of a state `$s`, and what the body returns is kept alive.
macro_rules! algorithm {
    ($bench:ident, $name:literal, |$s:ident, $p:ident| $body:expr) => {
        let (model, states) = ($bench.model, $bench.states);
        $bench.list.push((
            $name,
            Box::new(move |i| {
                let $s = &states[i];
                let $p = $s.posture(model);
                black_box(&$body);
            }),
        ));
    };
}

impl<'a, M: Tree<f64, N>, const N: usize> Bench<'a, M, N> {
    /// Inverse and forward dynamics and what they are made of.
    fn dynamics(&mut self) {
        let (model, feet) = (self.model, self.feet);
        let mut forces = [Force::ZERO; N];
        for foot in feet {
            if let rbd_core::Link::Joint(i) = foot.link {
                forces[i] = Force::from_array([1.0, 2.0, 30.0, 0.0, 0.0, 0.0]);
            }
        }
        algorithm!(self, "rnea", |s, p| rnea(
            model,
            &p,
            &s.velocity,
            &s.acceleration
        ));
        algorithm!(self, "rnea_external", |s, p| {
            rnea_with_forces(
                model,
                &p,
                &s.velocity,
                &s.acceleration,
                &Force::ZERO,
                &forces,
            )
        });
        algorithm!(self, "nonlinear_effects", |s, p| nonlinear_effects(
            model,
            &p,
            &s.velocity
        ));
        algorithm!(self, "gravity", |s, p| generalized_gravity(model, &p));
        let mut mass = MassMatrix::ZERO;
        algorithm!(self, "crba", |s, p| {
            crba(model, &p, &mut mass);
            &mass
        });
        let mut ws = AbaWorkspace::new();
        algorithm!(self, "aba", |s, p| aba(
            model,
            &p,
            &s.velocity,
            &s.effort,
            &mut ws
        ));
        let mut mass = MassMatrix::ZERO;
        let mut ws = AbaWorkspace::new();
        algorithm!(self, "rnea_crba_aba", |s, p| {
            black_box(&rnea(model, &p, &s.velocity, &s.acceleration));
            crba(model, &p, &mut mass);
            black_box(&mass);
            aba(model, &p, &s.velocity, &s.effort, &mut ws)
        });

        let (mut factors, mut inverse) = (MassFactors::new(), BlockMatrix::ZERO);
        algorithm!(self, "minverse", |s, p| {
            crba(model, &p, &mut mass);
            mass_matrix_inverse(model, &mass, &mut factors, &mut inverse);
            &inverse
        });
    }

    /// Derivatives of dynamics and momentum.
    fn derivatives(&mut self) {
        let model = self.model;
        let mut of = RneaDerivatives::ZERO;
        let mut ws = DerivativesWorkspace::new();
        algorithm!(self, "rnea_derivatives", |s, p| {
            rnea_derivatives(model, &p, &s.velocity, &s.acceleration, &mut ws, &mut of);
            &of
        });
        let mut of = AbaDerivatives::ZERO;
        let mut ws = AbaDerivativesWorkspace::new();
        algorithm!(self, "aba_derivatives", |s, p| {
            aba_derivatives(model, &p, &s.velocity, &s.effort, &mut ws, &mut of);
            &of
        });

        let mut of = CentroidalDerivatives::ZERO;
        let mut ws = DerivativesWorkspace::new();
        algorithm!(self, "centroidal_derivatives", |s, p| {
            centroidal_derivatives(model, &p, &s.velocity, &s.acceleration, &mut ws, &mut of);
            &of
        });
    }

    /// Where bodies are and how they move.
    fn kinematics(&mut self) {
        let model = self.model;
        let mut kinematics = Kinematics::IDENTITY;
        algorithm!(self, "fk_placements", |s, p| {
            forward_kinematics(model, &p, &mut kinematics);
            &kinematics
        });
        let mut moving = BodyMotions::ZERO;
        algorithm!(self, "fk_velocities", |s, p| {
            forward_kinematics(model, &p, &mut kinematics);
            forward_velocities(model, &p, &s.velocity, &mut moving);
            (&kinematics, &moving)
        });
        algorithm!(self, "fk_accelerations", |s, p| {
            forward_kinematics(model, &p, &mut kinematics);
            forward_accelerations(model, &p, &s.velocity, &s.acceleration, &mut moving);
            (&kinematics, &moving)
        });
        let mut columns = [rbd_core::Motion::ZERO; N];
        algorithm!(self, "joint_jacobians", |s, p| {
            forward_kinematics(model, &p, &mut kinematics);
            joint_jacobians(model, &kinematics, &mut columns);
            &columns
        });
        algorithm!(self, "com", |s, p| center_of_mass(model, &p));
    }

    /// Motion of the feet, their Jacobians and derivatives.
    fn feet(&mut self) {
        let (model, feet) = (self.model, self.feet);
        let mut kinematics = Kinematics::IDENTITY;
        let mut moving = BodyMotions::ZERO;
        algorithm!(self, "feet_accelerations", |s, p| {
            forward_kinematics(model, &p, &mut kinematics);
            forward_accelerations(model, &p, &s.velocity, &s.acceleration, &mut moving);
            for foot in feet {
                let classical = moving.frame_classical_acceleration(foot);
                black_box(&Axes::LocalWorldAligned.motion(&kinematics.frame(foot), &classical));
            }
        });
        algorithm!(self, "feet_bias_accelerations", |s, p| {
            bias_accelerations(model, &p, &s.velocity, &mut moving);
            for foot in feet {
                black_box(&moving.frame_classical_acceleration(foot));
            }
        });
        let mut jacobian = FrameJacobian::ZERO;
        algorithm!(self, "feet_jacobians", |s, p| {
            forward_kinematics(model, &p, &mut kinematics);
            for foot in feet {
                frame_jacobian(
                    model,
                    &kinematics,
                    foot,
                    Axes::LocalWorldAligned,
                    &mut jacobian,
                );
                black_box(&jacobian);
            }
        });
        let mut of = FrameDerivatives::ZERO;
        algorithm!(self, "feet_acceleration_derivatives", |s, p| {
            forward_kinematics(model, &p, &mut kinematics);
            forward_accelerations(model, &p, &s.velocity, &s.acceleration, &mut moving);
            for foot in feet {
                let kind = AccelerationKind::Spatial;
                frame_derivatives(
                    model,
                    &kinematics,
                    &moving,
                    foot,
                    kind,
                    Axes::Local,
                    &mut of,
                );
                black_box(&of);
            }
        });
    }

    /// Dynamics with the feet held.
    fn contacts(&mut self) {
        let (model, feet) = (self.model, self.feet);
        let mut contact = HeldFeet::<N>::new();
        algorithm!(self, "constrained_dynamics", |s, p| {
            contact.prepare(model, &p, feet, Some(&s.velocity));
            let drift = nonlinear_effects(model, &p, &s.velocity);
            let free = contact.factors.solve(&(s.effort - drift));
            let rows = &contact.rows[..contact.count];
            contact_dynamics(&contact.factors, &free, rows, &mut contact.workspace)
        });
        let mut contact = HeldFeet::<N>::new();
        algorithm!(self, "impulse_dynamics", |s, p| {
            contact.prepare(model, &p, feet, None);
            let rows = &contact.rows[..contact.count];
            impact(
                &contact.factors,
                &s.velocity,
                0.0,
                rows,
                &mut contact.workspace,
            )
        });
    }

    /// Steps on the configuration manifold, each library in its own representation: a rotation matrix here, a quaternion there.
    fn manifold(&mut self) {
        let s = self.states;
        let configurations: Vec<_> = s.iter().map(State::configuration).collect();
        let from = configurations.clone();
        self.list.push((
            "integrate",
            Box::new(move |i| {
                black_box(&integrate(&from[i], &s[i].velocity));
            }),
        ));
        self.list.push((
            "difference",
            Box::new(move |i| {
                let next = (i + 1) % configurations.len();
                black_box(&difference(&configurations[i], &configurations[next]));
            }),
        ));
    }

    /// Centre of mass and momentum.
    fn momentum(&mut self) {
        let model = self.model;
        let mut jacobian = ComJacobian::ZERO;
        algorithm!(self, "com_jacobian", |s, p| {
            com_jacobian(model, &p, &mut jacobian);
            &jacobian
        });
        let mut map = CentroidalMap::ZERO;
        algorithm!(self, "centroidal_map", |s, p| {
            centroidal_map(model, &p, &mut map);
            &map
        });
        algorithm!(self, "centroidal_map_rate", |s, p| {
            centroidal_map(model, &p, &mut map);
            (&map, centroidal_bias(model, &p, &s.velocity))
        });
        algorithm!(self, "centroidal_momentum", |s, p| centroidal_state(
            model,
            &p,
            &s.velocity
        ));
        algorithm!(self, "energies", |s, p| centroidal_state(
            model,
            &p,
            &s.velocity
        ));
        algorithm!(self, "centroidal_momentum_rate", |s, p| {
            centroidal_momentum_rate(model, &p, &s.velocity, &s.acceleration)
        });
        algorithm!(self, "com_acceleration", |s, p| {
            com_motion(model, &p, &s.velocity, &s.acceleration)
        });
    }
}

/// Everything to measure on one model.
fn algorithms<'a, M: Tree<f64, N>, const N: usize>(
    model: &'a M,
    feet: &'a [Frame<f64>],
    states: &'a [State<N>],
) -> Algorithms<'a> {
    let mut bench = Bench {
        model,
        feet,
        states,
        list: Vec::new(),
    };
    bench.dynamics();
    bench.derivatives();
    bench.kinematics();
    bench.feet();
    bench.contacts();
    bench.manifold();
    bench.momentum();
    bench.list.push(("none", Box::new(|_| {})));
    bench.list
}

/// What to do with the algorithms of one robot and model.
trait Visit {
    fn visit(&mut self, robot: &str, model: &str, states: usize, list: Algorithms<'_>);
    /// Where the states come from; `None` for the golden files.
    fn states(&self) -> Option<&Path>;
}

fn each<V: Visit>(visit: &mut V) -> Result<(), String> {
    robot::<_, V, 12>(
        visit,
        "a1",
        &A1,
        &["FL_foot", "FR_foot", "RL_foot", "RR_foot"],
    )?;
    robot::<_, V, 23>(visit, "icub23", &Icub23, &["l_sole", "r_sole"])
}

/// The const model, and the same robot as a model built at run time.
fn robot<M: Model<f64, N>, V: Visit, const N: usize>(
    visit: &mut V,
    name: &str,
    model: &M,
    feet: &[&str],
) -> Result<(), String> {
    let states = load::<N, V>(visit, name)?;
    let frame = |foot: &&str| {
        model
            .frame(foot)
            .ok_or_else(|| format!("{name} has no {foot}"))
    };
    let feet = feet.iter().map(frame).collect::<Result<Vec<_>, _>>()?;
    visit.visit(
        name,
        "const",
        states.len(),
        algorithms(black_box(model), &feet, &states),
    );
    let table = TableModel::<f64, N>::new(model.base_kind(), *model.base(), model.bodies());
    let table = table.map_err(|error| error.to_string())?;
    visit.visit(
        name,
        "run-time",
        states.len(),
        algorithms(black_box(&table), &feet, &states),
    );
    Ok(())
}

fn load<const N: usize, V: Visit>(visit: &V, robot: &str) -> Result<Vec<State<N>>, String> {
    match visit.states() {
        Some(directory) => State::read(&directory.join(format!("{robot}.states"))),
        None => Ok(State::golden(robot)),
    }
}

struct Time<'a> {
    tag: &'a str,
    ms: f64,
    directory: &'a Path,
    only: Option<&'a str>,
}

impl Visit for Time<'_> {
    fn visit(&mut self, robot: &str, model: &str, states: usize, list: Algorithms<'_>) {
        for (name, mut call) in list
            .into_iter()
            .filter(|(name, _)| self.only.map_or(*name != "none", |only| *name == only))
        {
            println!(
                "{robot},{name},{:.2},{states},{}-{model}",
                time(states, self.ms, &mut call),
                self.tag
            );
        }
    }
    fn states(&self) -> Option<&Path> {
        Some(self.directory)
    }
}

struct List;

impl Visit for List {
    fn visit(&mut self, robot: &str, model: &str, states: usize, list: Algorithms<'_>) {
        for (name, _) in list {
            println!("{robot} {model} {name} {states}");
        }
    }
    fn states(&self) -> Option<&Path> {
        None
    }
}

struct Count<'a>(&'a str, &'a str, &'a str);

impl Visit for Count<'_> {
    fn visit(&mut self, robot: &str, model: &str, states: usize, list: Algorithms<'_>) {
        for (name, mut call) in list {
            if (robot, model, name) == (self.0, self.1, self.2) {
                counted_calls(states, &mut call);
            }
        }
    }
    fn states(&self) -> Option<&Path> {
        None
    }
}

/// One call per state. Callgrind counts what happens in here, under this name, and nothing else.
#[inline(never)]
fn counted_calls(states: usize, call: &mut dyn FnMut(usize)) {
    (0..states).for_each(call);
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words[..] {
        ["time", tag, ms, directory, ref only @ ..] => match ms.parse() {
            Ok(ms) => each(&mut Time {
                tag,
                ms,
                directory: Path::new(directory),
                only: only.first().copied(),
            }),
            Err(_) => Err(format!("{ms} is not a number of milliseconds")),
        },
        ["list"] => each(&mut List),
        ["count", robot, model, algorithm] => each(&mut Count(robot, model, algorithm)),
        _ => Err(
            "usage: bench-dynamics time TAG MS DIR | list | count ROBOT MODEL ALGORITHM".to_owned(),
        ),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

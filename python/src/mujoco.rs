//! MuJoCo from Python's own package: its objects behind what the simulator asks of an engine, so that nothing is linked with its library.
//!
//! The arrays of `mujoco.MjData` are MuJoCo's memory; they are taken once, and what is in them is copied after every call. Each call attaches
//! the interpreter once, and MuJoCo's own functions release it while they compute.

use contact_sim::{ContactPoint, Engine, EngineFailed, NoEngine};
use numpy::ndarray::ArrayView1;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::types::{PyAnyMethods, PyModule};
use pyo3::{Bound, Py, PyAny, PyErr, PyResult, Python, intern};

/// Compiles a model by the package `mujoco`: a [`contact_sim::Compile`].
pub(crate) fn compile(mjcf: &str) -> Result<Box<dyn Engine>, NoEngine> {
    Python::attach(|py| {
        let package = PyModule::import(py, "mujoco").map_err(|error| {
            let remedy = "`pip install mujoco` gets what sim=\"mujoco\" needs";
            NoEngine::Missing(format!("{remedy}: {}", error.value(py)))
        })?;
        let engine = PackageEngine::new(&package, mjcf).map_err(|error| {
            let words = error.value(py).to_string();
            if error.is_instance_of::<PyValueError>(py) {
                NoEngine::Refused(words)
            } else {
                let remedy = "`pip install --upgrade mujoco` may help";
                NoEngine::Missing(format!(
                    "the package mujoco cannot be used, {remedy}: {words}"
                ))
            }
        })?;
        Ok(Box::new(engine) as Box<dyn Engine>)
    })
}

/// An array of numbers that is MuJoCo's, and what it held after the last call.
#[derive(Debug)]
struct Array {
    array: Py<PyArray1<f64>>,
    values: Vec<f64>,
}

impl Array {
    fn new(data: &Bound<'_, PyAny>, name: &str) -> PyResult<Self> {
        let array = data.getattr(name)?.cast_into::<PyArray1<f64>>()?.unbind();
        let mut out = Self {
            array,
            values: Vec::new(),
        };
        out.read(data.py())?;
        Ok(out)
    }

    fn read(&mut self, py: Python<'_>) -> PyResult<()> {
        let array = self.array.bind(py).try_readonly()?;
        self.values.clear();
        self.values.extend_from_slice(array.as_slice()?);
        Ok(())
    }

    /// What is to be written, as many numbers as there are.
    fn set(&mut self, values: &[f64]) {
        for (slot, value) in self.values.iter_mut().zip(values) {
            *slot = *value;
        }
    }

    fn write(&self, py: Python<'_>) -> PyResult<()> {
        let mut array = self.array.bind(py).try_readwrite()?;
        array.as_slice_mut()?.copy_from_slice(&self.values);
        Ok(())
    }
}

/// Functions of the package.
#[derive(Debug)]
struct Functions {
    reset: Py<PyAny>,
    forward: Py<PyAny>,
    step: Py<PyAny>,
    contact_force: Py<PyAny>,
    name_to_id: Py<PyAny>,
    /// `mjOBJ_GEOM`.
    geom: Py<PyAny>,
}

impl Functions {
    fn new(package: &Bound<'_, PyModule>) -> PyResult<Self> {
        let get = |name: &str| package.getattr(name).map(Bound::unbind);
        Ok(Self {
            reset: get("mj_resetData")?,
            forward: get("mj_forward")?,
            step: get("mj_step")?,
            contact_force: get("mj_contactForce")?,
            name_to_id: get("mj_name2id")?,
            geom: package.getattr("mjtObj")?.getattr("mjOBJ_GEOM")?.unbind(),
        })
    }
}

/// A model and its state, objects of the package.
#[derive(Debug)]
struct PackageEngine {
    functions: Functions,
    model: Py<PyAny>,
    data: Py<PyAny>,
    applied: Array,
    qpos: Array,
    qvel: Array,
    qacc: Array,
    sensordata: Array,
    /// What `mj_contactForce` writes into.
    force: Py<PyArray1<f64>>,
    contacts: Vec<ContactPoint>,
    /// The state is to be put in place before the next call.
    is_reset: bool,
}

impl PackageEngine {
    fn new(package: &Bound<'_, PyModule>, mjcf: &str) -> PyResult<Self> {
        let py = package.py();
        let model = package
            .getattr("MjModel")?
            .call_method1("from_xml_string", (mjcf,))?;
        let data = package.getattr("MjData")?.call1((&model,))?;
        let mut engine = Self {
            functions: Functions::new(package)?,
            applied: Array::new(&data, "qfrc_applied")?,
            qpos: Array::new(&data, "qpos")?,
            qvel: Array::new(&data, "qvel")?,
            qacc: Array::new(&data, "qacc")?,
            sensordata: Array::new(&data, "sensordata")?,
            force: PyArray1::zeros(py, 6, false).unbind(),
            contacts: Vec::new(),
            is_reset: false,
            model: model.unbind(),
            data: data.unbind(),
        };
        // Versions that have no such arrays show it before anything flies.
        engine.read_contacts(py)?;
        Ok(engine)
    }

    /// Calls a function under these forces, and reads what it left. What is raised goes where Python puts what nobody can catch.
    fn call(
        &mut self,
        function: impl FnOnce(&Functions) -> &Py<PyAny>,
        applied: &[f64],
    ) -> Result<(), EngineFailed> {
        Python::attach(|py| {
            self.try_call(py, function, applied)
                .map_err(|error: PyErr| {
                    error.write_unraisable(py, Some(self.data.bind(py)));
                    EngineFailed
                })
        })
    }

    fn try_call(
        &mut self,
        py: Python<'_>,
        function: impl FnOnce(&Functions) -> &Py<PyAny>,
        applied: &[f64],
    ) -> PyResult<()> {
        let arguments = (&self.model, &self.data);
        if self.is_reset {
            self.functions.reset.call1(py, arguments)?;
            self.qpos.write(py)?;
            self.qvel.write(py)?;
            self.is_reset = false;
        }
        self.applied.set(applied);
        self.applied.write(py)?;
        function(&self.functions).call1(py, arguments)?;
        let arrays = [
            &mut self.qpos,
            &mut self.qvel,
            &mut self.qacc,
            &mut self.sensordata,
        ];
        arrays.into_iter().try_for_each(|array| array.read(py))?;
        self.read_contacts(py)
    }

    fn read_contacts(&mut self, py: Python<'_>) -> PyResult<()> {
        self.contacts.clear();
        let contact = self.data.bind(py).getattr(intern!(py, "contact"))?;
        let geoms = contact.getattr(intern!(py, "geom"))?;
        let geoms = geoms.cast::<PyArray2<i32>>()?.try_readonly()?;
        let frames = contact.getattr(intern!(py, "frame"))?;
        let frames = frames.cast::<PyArray2<f64>>()?.try_readonly()?;
        let (geoms, frames) = (geoms.as_array(), frames.as_array());
        let rows = geoms.rows().into_iter().zip(frames.rows());
        for (index, (geom, frame)) in rows.enumerate() {
            let arguments = (&self.model, &self.data, index, &self.force);
            self.functions.contact_force.call1(py, arguments)?;
            let force = self.force.bind(py).try_readonly()?;
            self.contacts.push(ContactPoint {
                geoms: numbers(geom)?,
                frame: numbers(frame)?,
                force: numbers(force.as_array())?,
            });
        }
        Ok(())
    }
}

/// The numbers of a row, as many as there must be.
fn numbers<T: Copy + Default, const K: usize>(row: ArrayView1<'_, T>) -> PyResult<[T; K]> {
    if row.len() != K {
        let words = format!("a contact has {} numbers in the place of {K}", row.len());
        return Err(PyTypeError::new_err(words));
    }
    let mut out = [T::default(); K];
    for (to, from) in out.iter_mut().zip(row) {
        *to = *from;
    }
    Ok(out)
}

impl Engine for PackageEngine {
    fn geom_id(&self, name: &str) -> Option<usize> {
        Python::attach(|py| {
            let arguments = (&self.model, &self.functions.geom, name);
            let id = self.functions.name_to_id.call1(py, arguments).ok()?;
            id.extract(py).ok()
        })
    }

    fn reset(&mut self, qpos: &[f64], qvel: &[f64]) {
        self.qpos.set(qpos);
        self.qvel.set(qvel);
        self.is_reset = true;
    }

    fn forward(&mut self, applied: &[f64]) -> Result<(), EngineFailed> {
        self.call(|functions| &functions.forward, applied)
    }

    fn step(&mut self, applied: &[f64]) -> Result<(), EngineFailed> {
        self.call(|functions| &functions.step, applied)
    }

    fn qpos(&self) -> &[f64] {
        &self.qpos.values
    }

    fn qvel(&self) -> &[f64] {
        &self.qvel.values
    }

    fn qacc(&self) -> &[f64] {
        &self.qacc.values
    }

    fn sensordata(&self) -> &[f64] {
        &self.sensordata.values
    }

    fn contacts(&self) -> &[ContactPoint] {
        &self.contacts
    }
}

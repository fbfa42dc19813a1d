//! Plans in flash: read by the compiler, so that a controller finds nodes and reads nothing.

use super::Container;
use crate::plan::Node;

/// A [`Container`] from bytes that are known to the compiler, which refuses to build what [`Container::read`] refuses: bytes that are no
/// plan, another version, cut off, damaged, or for other numbers of joints and feet than the type says.
///
/// Nodes become a `static` in the controller's scalar, and the bytes themselves need not be linked. For which robot the plan was made is
/// not known to the compiler, since models are traits; compare [`Container::robot`] with [`model_hash`](crate::container::model_hash)
/// in a test, or where the machine is armed.
///
/// ```
/// use jump_control::container::Container;
/// use jump_control::{Node, Plan, flash_plan};
///
/// // `plan.bin` of `saltus plan TASK --out DIR`, for a robot with two joints and one foot.
/// const PLAN: Container<'static, 2, 1> =
///     flash_plan!(include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/hop.bin")));
/// static NODES: [Node<f32, 2, 1>; PLAN.count()] = PLAN.nodes_f32();
///
/// let header = PLAN.header();
/// let plan = Plan::new(&NODES, header.takeoff, header.posing, header.touchdown, header.torques)?;
/// assert_eq!(plan.count(), 3);
/// # Ok::<(), jump_control::PlanError>(())
/// ```
///
/// One wrong bit does not compile:
///
/// ```compile_fail,E0080
/// use jump_control::container::Container;
///
/// const PLAN: Container<'static, 2, 1> = jump_control::flash_plan!(&{
///     let mut bytes = *include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/hop.bin"));
///     bytes[500] ^= 1;
///     bytes
/// });
/// ```
///
/// Nor does the plan of another robot:
///
/// ```compile_fail,E0080
/// use jump_control::container::Container;
///
/// const PLAN: Container<'static, 12, 4> = jump_control::flash_plan!(include_bytes!(concat!(
///     env!("CARGO_MANIFEST_DIR"),
///     "/tests/hop.bin"
/// )));
/// ```
#[macro_export]
macro_rules! flash_plan {
    ($bytes:expr) => {
        const {
            match $crate::container::Container::read($bytes) {
                ::core::result::Result::Ok(plan) => plan,
                ::core::result::Result::Err(error) => ::core::panic!("{}", error.reason()),
            }
        }
    };
}

/// One loop for both scalars.
macro_rules! table {
    ($T:ident $name:ident $node:ident $doc:literal) => {
        impl<const N: usize, const F: usize> Container<'_, N, F> {
            #[doc = $doc]
            /// The first `K` of them, and zeros beyond the last; `K` is [`Self::count`] for a `static`, which this is for: elsewhere they
            /// would fill the stack.
            #[must_use]
            pub const fn $name<const K: usize>(&self) -> [Node<$T, N, F>; K] {
                let mut nodes = [Node::ZERO; K];
                let mut i = 0;
                while i < K {
                    if let Some(node) = self.node(i) {
                        nodes[i] = node.$node();
                    }
                    i += 1;
                }
                nodes
            }
        }
    };
}

table!(f64 nodes_f64 node_f64 "The nodes as the sampler takes them, in double precision.");
table!(f32 nodes_f32 node_f32 "The nodes as the sampler takes them, in single precision.");

//! Source of the kernels in CUDA C.
//!
//! Every kernel is a function of one index, which a card runs on one thread for each and an emulation in a loop.

use core::fmt::Write;
use std::collections::HashMap;

use powerhouse_model::{NumberFormat, ProgramOperation};
use powerhouse_program::{cuda_head, cuda_number, cuda_statements};

use crate::layout::{ElementGroup, InputPlace};

/// Kernels around the elements.
pub(crate) const LOAD_NODES: &str = "load_nodes";
pub(crate) const LOAD_GROUPS: &str = "load_groups";
pub(crate) const KICK: &str = "kick_groups";
pub(crate) const MOVE: &str = "move_nodes";

/// Name of the kernel of a group of elements.
pub(crate) fn element_kernel(index: usize) -> String {
    format!("elements_{index}")
}

/// What a card and a C++ compiler have of each other's languages.
const BEGIN: &str = "\
#if !defined(__CUDACC__)
#include <math.h>
#include <stddef.h>
#include <string.h>
#define __device__
#endif
";

/// Arrays that loops fill are registers of a thread where the loops are unrolled.
const UNROLL: &str = "#pragma unroll";

/// Parameter of a kernel: type and name.
type Parameter = (&'static str, &'static str);

/// Writes a kernel of a body for the index `i` of `count`.
fn kernel(text: &mut String, name: &str, parameters: &[Parameter], body: &str) {
    let list = |with_types: bool| -> String {
        let written = parameters.iter().map(|(kind, name)| match with_types {
            // No two arrays overlap.
            true if kind.ends_with('*') => format!("{kind}__restrict__ {name}"),
            true => format!("{kind} {name}"),
            false => (*name).to_owned(),
        });
        written.collect::<Vec<_>>().join(", ")
    };
    let pointed = parameters.iter().enumerate();
    let pointed = pointed.map(|(index, (kind, _))| format!("*({kind} *)arguments[{index}]"));
    let pointed = pointed.collect::<Vec<_>>().join(", ");
    let (typed, named) = (list(true), list(false));
    let _ = write!(
        text,
        "
static __device__ inline void {name}_at(const size_t i, const size_t count, {typed}) {{
{body}}}
#if defined(__CUDACC__)
extern \"C\" __global__ void {name}({typed}, const size_t count) {{
  const size_t i = (size_t)blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) {name}_at(i, count, {named});
}}
#else
extern \"C\" void {name}(void **arguments, const size_t count) {{
  for (size_t i = 0; i < count; ++i) {name}_at(i, count, {pointed});
}}
#endif
"
    );
}

/// What the kernels of nodes depend on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeOptions {
    /// Whether velocities and forces are in single precision.
    pub(crate) single: bool,
    /// Whether nodes have applied forces.
    pub(crate) external: bool,
    /// Whether nodes have factors of the old velocity.
    pub(crate) decay: bool,
}

/// Source of all kernels.
pub(crate) fn source(groups: &[ElementGroup], options: NodeOptions) -> String {
    let mut text = format!("{BEGIN}{}", cuda_head());
    let node = if options.single { "float" } else { "double" };
    let _ = write!(text, "\ntypedef {node} Node;\n");
    for (index, group) in groups.iter().enumerate() {
        elements(&mut text, &element_kernel(index), group, options.single);
    }
    text.push_str(INTERNAL);
    for (name, applied) in [(LOAD_NODES, "Node *"), (LOAD_GROUPS, "double *")] {
        kernel(&mut text, name, &load_parameters(applied), LOAD_BODY);
    }
    kernel(&mut text, KICK, &KICK_PARAMETERS, KICK_BODY);
    kernel(&mut text, MOVE, &MOVE_PARAMETERS, &move_body(options));
    text
}

/// Parameters of the kernel of a group of elements; `Real` stands for its format.
fn element_parameters(single: bool) -> [Parameter; 9] {
    let [constants, history] = if single {
        ["const float *", "float *"]
    } else {
        ["const double *", "double *"]
    };
    [
        ("const double *", "displacement"),
        ("const Node *", "velocity"),
        ("Node *", "force"),
        ("size_t", "places"),
        ("size_t", "base"),
        ("const unsigned int *", "nodes"),
        (constants, "constants"),
        (history, "history"),
        ("const double *", "reference"),
    ]
}

/// Writes the kernel of a group of elements: gathers the motion of the nodes, and runs the program.
fn elements(text: &mut String, name: &str, group: &ElementGroup, single_nodes: bool) {
    let single = group.is_single();
    let real = if single { "float" } else { "double" };
    let corners = group.corners;
    let mut body = String::new();
    let mut line = |statement: &str| {
        body.push_str("  ");
        body.push_str(statement);
        body.push('\n');
    };
    line(&format!("double moved[{corners}][3];"));
    line(&format!("{real} u[{}];", 3 * corners));
    line(UNROLL);
    line(&format!("for (int a = 0; a < {corners}; ++a) {{"));
    line("  const size_t node = nodes[a * count + i];");
    line("  for (int c = 0; c < 3; ++c) {");
    line("    double value = displacement[4 * node + c];");
    if group.damping != 0.0 {
        let damping = cuda_number(NumberFormat::F64, group.damping);
        line(&format!(
            "    value = value + (double)velocity[4 * node + c] * {damping};"
        ));
    }
    if !group.reference.is_empty() {
        line("    value = value + reference[(3 * a + c) * count + i];");
    }
    line("    moved[a][c] = value;");
    line("  }");
    line("}");
    let relative = |name: &str| match single {
        // Only differences enter a strain, taken before they are rounded.
        true => format!("(float)({name}[a][c] - {name}[0][c])"),
        false => format!("{name}[a][c]"),
    };
    line(UNROLL);
    line(&format!("for (int a = 0; a < {corners}; ++a)"));
    line(&format!(
        "  for (int c = 0; c < 3; ++c) u[3 * a + c] = {};",
        relative("moved")
    ));
    let with_velocity = group.inputs.iter();
    if with_velocity
        .clone()
        .any(|i| matches!(i, InputPlace::Velocity(_)))
    {
        line(&format!("double rate[{corners}][3];"));
        line(&format!("{real} w[{}];", 3 * corners));
        line(UNROLL);
        line(&format!("for (int a = 0; a < {corners}; ++a)"));
        line(
            "  for (int c = 0; c < 3; ++c) rate[a][c] = (double)velocity[4 * (size_t)nodes[a * count + i] + c];",
        );
        line(UNROLL);
        line(&format!("for (int a = 0; a < {corners}; ++a)"));
        let value = match single_nodes {
            // As the host does: values of nodes in single precision are not rounded again.
            true => format!("({real})rate[a][c]"),
            false => relative("rate"),
        };
        line(&format!(
            "  for (int c = 0; c < 3; ++c) w[3 * a + c] = {value};"
        ));
    }
    let format = group.program.format();
    // Names of history variables that are read: what is not changed is not written.
    let operations = group.program.operations().iter().enumerate();
    let unchanged: HashMap<String, usize> = operations
        .filter_map(|(id, operation)| match operation {
            ProgramOperation::Input(index) => match group.inputs[*index as usize] {
                InputPlace::History(row) => Some((format!("v{id}"), row)),
                _ => None,
            },
            _ => None,
        })
        .collect();
    let input = |index: u32| match group.inputs[index as usize] {
        InputPlace::Displacement(i) => format!("u[{i}]"),
        InputPlace::Velocity(i) => format!("w[{i}]"),
        InputPlace::Number(number) => cuda_number(format, number),
        InputPlace::Constant(row) => format!("constants[{row} * count + i]"),
        InputPlace::History(row) => format!("history[{row} * count + i]"),
    };
    let output = |index: usize, value: &str| {
        if index < 3 * corners {
            let (corner, component) = (index / 3, index % 3);
            format!("force[{component} * places + base + {corner} * count + i] = (Node)({value});")
        } else {
            let row = index - 3 * corners;
            if unchanged.get(value) == Some(&row) {
                return String::new();
            }
            format!("history[{row} * count + i] = {value};")
        }
    };
    body.push_str(&cuda_statements(&group.program, &input, &output));
    kernel(text, name, &element_parameters(single), &body);
}

/// Sum of the forces of the elements at a node, in the order of the host.
const INTERNAL: &str = "
static __device__ inline void internal_force(const size_t node, const Node *force, const size_t places,
    const unsigned int *node_starts, const unsigned int *node_slots, const unsigned int *slot_starts,
    const unsigned int *slot_places, Node *sum) {
  sum[0] = 0; sum[1] = 0; sum[2] = 0;
  const unsigned int first = node_starts[node];
  for (unsigned int k = first; k < node_starts[node + 1]; ++k) {
    const unsigned int slot = node_slots[k];
    Node part[3] = {0, 0, 0};
    for (unsigned int j = slot_starts[slot]; j < slot_starts[slot + 1]; ++j) {
      const size_t place = slot_places[j];
      for (int c = 0; c < 3; ++c) part[c] = part[c] + force[c * places + place];
    }
    for (int c = 0; c < 3; ++c) sum[c] = k == first ? part[c] : sum[c] + part[c];
  }
}
";

/// Parameters of a kernel that writes the applied forces of a step, whose type is given.
fn load_parameters(applied: &'static str) -> [Parameter; 4] {
    [
        ("const double *", "forces"),
        ("size_t", "row"),
        ("const unsigned int *", "loaded"),
        (applied, "applied"),
    ]
}
const LOAD_BODY: &str = "  \
  const size_t at = loaded[i];
  for (int c = 0; c < 3; ++c) applied[3 * at + c] = forces[3 * (row * count + i) + c];
";

const KICK_PARAMETERS: [Parameter; 14] = [
    ("const double *", "displacement"),
    ("const Node *", "velocity"),
    ("const Node *", "force"),
    ("size_t", "places"),
    ("const unsigned int *", "node_starts"),
    ("const unsigned int *", "node_slots"),
    ("const unsigned int *", "slot_starts"),
    ("const unsigned int *", "slot_places"),
    ("const unsigned int *", "member_starts"),
    ("const unsigned int *", "members"),
    ("const double *", "matrices"),
    ("const double *", "applied"),
    ("double *", "next"),
    ("double", "step"),
];
/// New velocity of a group of nodes. A product of a matrix and a vector is a sum over columns.
const KICK_BODY: &str = "  \
  const size_t lead = members[member_starts[i]];
  Node sum[3];
  double total[3], stretch[3], before[3];
  internal_force(lead, force, places, node_starts, node_slots, slot_starts, slot_places, sum);
  for (int c = 0; c < 3; ++c) {
    total[c] = applied[3 * i + c] - (double)sum[c];
    stretch[c] = displacement[4 * lead + c] - matrices[(27 + c) * count + i];
    before[c] = (double)velocity[4 * lead + c];
  }
  if (matrices[30 * count + i] != 0) {
    for (int c = 0; c < 3; ++c) {
      total[c] = total[c] - matrices[(18 + 4 * c) * count + i] * stretch[c];
      const double carried = matrices[4 * c * count + i] * before[c];
      next[3 * i + c] = carried + matrices[(9 + 4 * c) * count + i] * total[c];
    }
    return;
  }
  for (unsigned int m = member_starts[i] + 1; m < member_starts[i + 1]; ++m) {
    internal_force(members[m], force, places, node_starts, node_slots, slot_starts, slot_places, sum);
    for (int c = 0; c < 3; ++c) total[c] = total[c] - (double)sum[c];
  }
  for (int c = 0; c < 3; ++c) {
    double spring = matrices[(18 + 3 * c) * count + i] * stretch[0];
    spring = spring + matrices[(18 + 3 * c + 1) * count + i] * stretch[1];
    spring = spring + matrices[(18 + 3 * c + 2) * count + i] * stretch[2];
    total[c] = total[c] - spring;
  }
  for (int c = 0; c < 3; ++c) {
    double carried = matrices[3 * c * count + i] * before[0];
    carried = carried + matrices[(3 * c + 1) * count + i] * before[1];
    carried = carried + matrices[(3 * c + 2) * count + i] * before[2];
    double gained = matrices[(9 + 3 * c) * count + i] * (total[0] * step);
    gained = gained + matrices[(9 + 3 * c + 1) * count + i] * (total[1] * step);
    gained = gained + matrices[(9 + 3 * c + 2) * count + i] * (total[2] * step);
    next[3 * i + c] = carried + gained;
  }
";

const MOVE_PARAMETERS: [Parameter; 17] = [
    ("double *", "displacement"),
    ("Node *", "velocity"),
    ("const Node *", "force"),
    ("size_t", "places"),
    ("const unsigned int *", "node_starts"),
    ("const unsigned int *", "node_slots"),
    ("const unsigned int *", "slot_starts"),
    ("const unsigned int *", "slot_places"),
    ("const Node *", "external"),
    ("const Node *", "gain"),
    ("const Node *", "decay"),
    ("const unsigned int *", "held"),
    ("const unsigned int *", "group_of"),
    ("const double *", "next"),
    ("double", "step"),
    ("double", "limit"),
    ("unsigned int *", "fault"),
];

/// New velocity and displacement of a node.
fn move_body(options: NodeOptions) -> String {
    let applied = if options.external {
        "external[3 * i + c]"
    } else {
        "0"
    };
    let kept = if options.decay {
        "decay[i] * old"
    } else {
        "old"
    };
    format!(
        "  Node sum[3];
  internal_force(i, force, places, node_starts, node_slots, slot_starts, slot_places, sum);
  const unsigned int group = group_of[i];
  const bool grouped = group != 0xFFFFFFFFu;
  bool beyond = false;
  for (int c = 0; c < 3; ++c) {{
    const Node applied = {applied};
    const Node inner = (held[i] >> c) & 1u ? applied : sum[c];
    const Node total = applied - inner;
    const Node old = grouped ? (Node)next[3 * (size_t)group + c] : velocity[4 * i + c];
    const Node kept = {kept};
    const Node gained = gain[i] * total;
    const Node changed = kept + gained;
    velocity[4 * i + c] = changed;
    displacement[4 * i + c] = displacement[4 * i + c] + step * (double)changed;
    const Node bound = (Node)limit;
    beyond = beyond || !(changed >= -bound && changed <= bound);
  }}
  if (beyond) *fault = 1u;
"
    )
}

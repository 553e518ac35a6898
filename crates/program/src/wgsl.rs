//! Programs in WGSL.

use powerhouse_model::{NumberFormat, Program, ProgramError, ProgramOperation};

use crate::translation::{Language, identifier, lists, statements};

/// Source in WGSL of a program: an entry point `NAME` that computes one point per invocation, in work groups of 64.
///
/// Binding 0 of group 0 is the inputs, with the first numbers of all points before the second ones, binding 1 the outputs
/// likewise. WGSL permits a fused multiply-add to round twice, so that results agree within tolerances, not to the bit.
///
/// # Errors
/// [`ProgramError::Format`] for a program in double precision, which WGSL does not have.
pub fn wgsl(program: &Program) -> Result<String, ProgramError> {
    if program.format() != NumberFormat::F32 {
        return Err(ProgramError::Format {
            name: program.name().to_owned(),
            found: program.format(),
            expected: NumberFormat::F32,
        });
    }
    let name = identifier(program.name());
    Ok(format!(
        "{lists}{HEAD}\n@compute @workgroup_size(64)\n\
         fn {name}(@builtin(global_invocation_id) invocation: vec3<u32>) {{\n  \
         let stride = arrayLength(&y) / {outputs}u;\n  \
         let point = invocation.x;\n  \
         if (point >= stride) {{ return; }}\n\
         {body}}}\n",
        lists = lists(program),
        outputs = program.outputs().len().max(1),
        body = statements(program, &Wgsl)
    ))
}

/// Bindings, and numbers that are no literals.
const HEAD: &str = "
@group(0) @binding(0) var<storage, read> x: array<f32>;
@group(0) @binding(1) var<storage, read_write> y: array<f32>;

fn infinity() -> f32 {
  var bits = 0x7F800000u;
  return bitcast<f32>(bits);
}

fn power_of_two(shifted: f32) -> f32 {
  return bitcast<f32>((bitcast<u32>(shifted) << 23u) + 0x3F800000u);
}
";

struct Wgsl;

impl Language for Wgsl {
    fn constant(&self, value: f64) -> String {
        if value.is_nan() {
            "(infinity() - infinity())".into()
        } else if value == f64::INFINITY {
            "infinity()".into()
        } else if value == f64::NEG_INFINITY {
            "(-infinity())".into()
        } else if value.is_sign_negative() {
            format!("({:?}f)", value as f32)
        } else {
            format!("{:?}f", value as f32)
        }
    }
    fn input(&self, index: u32) -> String {
        format!("x[{index}u * stride + point]")
    }
    fn function(&self, operation: ProgramOperation, operands: &[String]) -> String {
        let of = |index: usize| operands[index].as_str();
        match operation {
            ProgramOperation::Neg(_) => format!("-({})", of(0)),
            ProgramOperation::MulAdd(..) => format!("fma({}, {}, {})", of(0), of(1), of(2)),
            ProgramOperation::Sqrt(_) => format!("sqrt({})", of(0)),
            ProgramOperation::Abs(_) => format!("abs({})", of(0)),
            // Not as a sum and a difference, which translators may cancel.
            ProgramOperation::Round(_) => format!("round({})", of(0)),
            ProgramOperation::PowerOfTwo(_) => format!("power_of_two({} + 12582912.0f)", of(0)),
            ProgramOperation::Select(..) => format!("select({}, {}, {})", of(2), of(1), of(0)),
            // Translated alike into every language, or no results.
            _ => String::new(),
        }
    }
    fn named(&self, name: &str, _is_mask: bool, value: &str) -> String {
        format!("let {name} = {value};")
    }
    fn variable(&self, name: &str, value: &str) -> String {
        format!("var {name}: f32 = {value};")
    }
    fn output(&self, index: usize, value: &str) -> String {
        format!("y[{index}u * stride + point] = {value};")
    }
    fn loop_head(&self, most: u32) -> String {
        format!("for (var turn = 0u; turn < {most}u; turn++) {{")
    }
}

//! Programs in CUDA C.

use powerhouse_model::{NumberFormat, Program, ProgramOperation};

use crate::translation::{Language, identifier, lists, statements};

/// Source in CUDA C of programs, a function `NAME` of one point and a kernel `NAME_all` of many for each, where NAME is
/// the program's with underscores in place of other signs than letters and digits.
///
/// `NAME(x, y, stride)` reads input `i` at `x[i * stride]` and writes output `i` to `y[i * stride]`; input and output must not overlap.
/// `NAME_all(x, y, count)` does so for `count` points with one thread each, with the first numbers of all points before the second ones: the
/// stride is `count`.
///
/// With `--fmad=false` the results have the bits of the law or kernel from which the program was recorded. Compiled as C++ with empty definitions
/// of `__device__` and the like and `-ffp-contract=off` they have them, too.
///
/// ```
/// use powerhouse_program::{Names, cuda, record};
/// let names = Names {
///     program: "twice".into(),
///     inputs: vec!["x".into()],
///     outputs: vec!["y".into()],
/// };
/// let program = record::<f64>(names, 0, |x| vec![x[0] + x[0]])?;
/// assert!(cuda(&[&program]).contains("const double v1 = v0 + v0;"));
/// # Ok::<(), powerhouse_model::ProgramError>(())
/// ```
pub fn cuda(programs: &[&Program]) -> String {
    let mut text = String::from(HEAD);
    for program in programs {
        let single = program.format() == NumberFormat::F32;
        let real = if single { "float" } else { "double" };
        let name = identifier(program.name());
        let body = statements(program, &Cuda { single });
        text.push_str(&format!(
            "\n{}static __device__ void {name}(const {real} *x, {real} *y, const size_t stride) {{\n{body}}}\n\n\
             extern \"C\" __global__ void {name}_all(const {real} *x, {real} *y, const size_t count) {{\n  \
             const size_t point = (size_t)blockIdx.x * blockDim.x + threadIdx.x;\n  \
             if (point < count) {{ {name}(x + point, y + point, count); }}\n}}\n",
            lists(program)
        ));
    }
    text
}

/// Beginning of a source in CUDA C with the functions that [`cuda_statements`] call; [`cuda`] has it already.
pub fn cuda_head() -> &'static str {
    HEAD
}

/// Statements in CUDA C of one program, which stand in a function of their own: `input` is the expression of an input by its number,
/// `output` the statement that writes an expression to an output. All inputs are read before the first output is written. They
/// need [`cuda_head`].
///
/// ```
/// use powerhouse_program::{Names, cuda_statements, record};
/// let names = Names {
///     program: "twice".into(),
///     inputs: vec!["x".into()],
///     outputs: vec!["y".into()],
/// };
/// let program = record::<f64>(names, 0, |x| vec![x[0] + x[0]])?;
/// let text = cuda_statements(&program, &|_| "a".into(), &|_, value| format!("b = {value};"));
/// assert!(text.contains("const double v0 = a;") && text.contains("b = v1;"));
/// # Ok::<(), powerhouse_model::ProgramError>(())
/// ```
pub fn cuda_statements(
    program: &Program,
    input: &dyn Fn(u32) -> String,
    output: &dyn Fn(usize, &str) -> String,
) -> String {
    let cuda = Cuda {
        single: program.format() == NumberFormat::F32,
    };
    statements(
        program,
        &Placed {
            cuda,
            input,
            output,
        },
    )
}

/// Number in CUDA C, in the format of a program; with the bits of the double, rounded to single precision if that is the format.
pub fn cuda_number(format: NumberFormat, value: f64) -> String {
    let single = format == NumberFormat::F32;
    Cuda { single }.constant(value)
}

/// CUDA C with inputs and outputs at places of the caller's.
struct Placed<'a> {
    cuda: Cuda,
    input: &'a dyn Fn(u32) -> String,
    output: &'a dyn Fn(usize, &str) -> String,
}

impl Language for Placed<'_> {
    fn constant(&self, value: f64) -> String {
        self.cuda.constant(value)
    }
    fn input(&self, index: u32) -> String {
        (self.input)(index)
    }
    fn function(&self, operation: ProgramOperation, operands: &[String]) -> String {
        self.cuda.function(operation, operands)
    }
    fn named(&self, name: &str, is_mask: bool, value: &str) -> String {
        self.cuda.named(name, is_mask, value)
    }
    fn variable(&self, name: &str, value: &str) -> String {
        self.cuda.variable(name, value)
    }
    fn output(&self, index: usize, value: &str) -> String {
        (self.output)(index, value)
    }
    fn loop_head(&self, most: u32) -> String {
        self.cuda.loop_head(most)
    }
}

/// Bits of numbers, whose functions have other names on the device than elsewhere.
const HEAD: &str = "\
// Compile with --fmad=false: products and sums that are written apart are rounded apart.
#if defined(__CUDACC__)
static __device__ double power_of_two(const double shifted) {
  return __longlong_as_double((long long)(((unsigned long long)__double_as_longlong(shifted) << 52) + 0x3FF0000000000000ULL));
}
static __device__ float power_of_two(const float shifted) {
  return __uint_as_float((__float_as_uint(shifted) << 23) + 0x3F800000u);
}
static __device__ double infinity_of(const double) { return __longlong_as_double(0x7FF0000000000000LL); }
static __device__ float infinity_of(const float) { return __uint_as_float(0x7F800000u); }
#else
static __device__ double power_of_two(const double shifted) {
  unsigned long long bits;
  memcpy(&bits, &shifted, sizeof bits);
  bits = (bits << 52) + 0x3FF0000000000000ULL;
  double power;
  memcpy(&power, &bits, sizeof power);
  return power;
}
static __device__ float power_of_two(const float shifted) {
  unsigned int bits;
  memcpy(&bits, &shifted, sizeof bits);
  bits = (bits << 23) + 0x3F800000u;
  float power;
  memcpy(&power, &bits, sizeof power);
  return power;
}
static __device__ double infinity_of(const double) { return (double)INFINITY; }
static __device__ float infinity_of(const float) { return INFINITY; }
#endif
";

struct Cuda {
    single: bool,
}

impl Cuda {
    /// Shift of numbers that makes their last bit a one, `1.5 / EPSILON`.
    fn shift(&self) -> String {
        self.constant(if self.single {
            1.5 / f64::from(f32::EPSILON)
        } else {
            1.5 / f64::EPSILON
        })
    }
}

impl Language for Cuda {
    fn constant(&self, value: f64) -> String {
        let suffix = if self.single { "f" } else { "" };
        if value.is_finite() {
            let digits = if self.single {
                format!("{:?}", value as f32)
            } else {
                format!("{value:?}")
            };
            return if value.is_sign_negative() {
                format!("({digits}{suffix})")
            } else {
                format!("{digits}{suffix}")
            };
        }
        let infinity = format!("infinity_of(0.0{suffix})");
        if value.is_nan() {
            format!("({infinity} - {infinity})")
        } else if value < 0.0 {
            format!("(-{infinity})")
        } else {
            infinity
        }
    }
    fn input(&self, index: u32) -> String {
        format!("x[{index} * stride]")
    }
    fn function(&self, operation: ProgramOperation, operands: &[String]) -> String {
        let f = if self.single { "f" } else { "" };
        let of = |index: usize| operands[index].as_str();
        match operation {
            ProgramOperation::Neg(_) => format!("-{}", of(0)),
            ProgramOperation::MulAdd(..) => format!("fma{f}({}, {}, {})", of(0), of(1), of(2)),
            ProgramOperation::Sqrt(_) => format!("sqrt{f}({})", of(0)),
            ProgramOperation::Abs(_) => format!("fabs{f}({})", of(0)),
            ProgramOperation::Round(_) => {
                format!("({} + {shift}) - {shift}", of(0), shift = self.shift())
            }
            ProgramOperation::PowerOfTwo(_) => {
                format!("power_of_two({} + {})", of(0), self.shift())
            }
            ProgramOperation::Select(..) => format!("{} ? {} : {}", of(0), of(1), of(2)),
            // Translated alike into every language, or no results.
            _ => String::new(),
        }
    }
    fn named(&self, name: &str, is_mask: bool, value: &str) -> String {
        let real = match (is_mask, self.single) {
            (true, _) => "bool",
            (false, true) => "float",
            (false, false) => "double",
        };
        format!("const {real} {name} = {value};")
    }
    fn variable(&self, name: &str, value: &str) -> String {
        let real = if self.single { "float" } else { "double" };
        format!("{real} {name} = {value};")
    }
    fn output(&self, index: usize, value: &str) -> String {
        format!("y[{index} * stride] = {value};")
    }
    fn loop_head(&self, most: u32) -> String {
        format!("for (unsigned int turn = 0; turn < {most}u; ++turn) {{")
    }
}

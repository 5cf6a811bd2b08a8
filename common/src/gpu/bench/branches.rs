//! Branches on uniforms, found without a GPU. What a uniform decides once for all fragments is to be an override, so that
//! a shader holds nothing that it does not need: see [`Variant`](crate::gpu::Variant).

use naga::{Block, Expression, Function, Handle, Module, ShaderStage, Statement};

/// What an expression's value depends on, from least to most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Depends {
    /// Known when the pipeline is made.
    Fixed,
    /// On uniforms, nothing else.
    Uniform,
    /// On anything.
    Varying,
}

/// Branches and loops of the fragment shaders in composed WGSL that uniforms alone decide, or end; a sentence each. An
/// argument of a function is a uniform where all its callers pass one; a variable never is.
///
/// # Errors
/// What the compiler says, with the line.
pub fn uniform_branches(source: &str) -> Result<Vec<String>, String> {
    let module = super::validate_wgsl(source)?;
    let mut found = Vec::new();
    for entry in module.entry_points.iter().filter(|entry| entry.stage == ShaderStage::Fragment) {
        let mut arguments = vec![Vec::new(); module.functions.len()];
        let mut walk = |function: &Function, arguments: &mut Vec<Vec<Depends>>, own: Vec<Depends>| {
            let name = function.name.clone().unwrap_or_default();
            let mut search = Search { module: &module, function, own, arguments, found: Vec::new() };
            search.block(&function.body, false);
            found.extend(search.found.into_iter().map(|what| format!("{}: {name}: {what}", entry.name)));
        };
        walk(&entry.function, &mut arguments, vec![Depends::Varying; entry.function.arguments.len()]);
        // Functions come after those that they call.
        let functions: Vec<_> = module.functions.iter().collect();
        for (handle, function) in functions.into_iter().rev() {
            let own = std::mem::take(&mut arguments[handle.index()]);
            // What the entry does not call has been given no arguments.
            if own.len() == function.arguments.len() {
                walk(function, &mut arguments, own);
            }
        }
    }
    Ok(found)
}

/// A walk through one function.
struct Search<'a> {
    module: &'a Module,
    function: &'a Function,
    /// What the function's arguments depend on.
    own: Vec<Depends>,
    /// What those of the functions that it calls do.
    arguments: &'a mut Vec<Vec<Depends>>,
    found: Vec<String>,
}

impl Search<'_> {
    fn depends(&self, handle: Handle<Expression>) -> Depends {
        use Depends::{Fixed, Uniform, Varying};
        let all = |handles: &[Handle<Expression>]| {
            handles.iter().map(|&handle| self.depends(handle)).max().unwrap_or(Fixed)
        };
        match self.function.expressions[handle] {
            Expression::Literal(_)
            | Expression::Constant(_)
            | Expression::Override(_)
            | Expression::ZeroValue(_) => Fixed,
            Expression::GlobalVariable(variable) => match self.module.global_variables[variable].space {
                naga::AddressSpace::Uniform => Uniform,
                _ => Varying,
            },
            Expression::FunctionArgument(index) => self.own[index as usize],
            Expression::Access { base, index } if self.depends(index) == Fixed => self.depends(base),
            Expression::AccessIndex { base: inner, .. }
            | Expression::Splat { value: inner, .. }
            | Expression::Swizzle { vector: inner, .. }
            | Expression::Load { pointer: inner }
            | Expression::Unary { expr: inner, .. }
            | Expression::Relational { argument: inner, .. }
            | Expression::As { expr: inner, .. } => self.depends(inner),
            Expression::Compose { ref components, .. } => all(components),
            Expression::Binary { left, right, .. } => all(&[left, right]),
            Expression::Select { condition, accept, reject } => all(&[condition, accept, reject]),
            Expression::Math { arg, arg1, arg2, arg3, .. } => {
                let rest: Vec<_> = [arg1, arg2, arg3].into_iter().flatten().collect();
                self.depends(arg).max(all(&rest))
            }
            _ => Varying,
        }
    }

    fn block(&mut self, block: &Block, in_loop: bool) {
        for statement in block {
            match statement {
                Statement::If { condition, accept, reject } => {
                    if self.depends(*condition) == Depends::Uniform {
                        self.found.push("a branch".into());
                    }
                    let ends = |block: &Block| matches!(block.first(), Some(Statement::Break));
                    if in_loop && (ends(accept) || ends(reject)) && self.bounded(*condition) {
                        self.found.push("the end of a loop".into());
                    }
                    self.block(accept, in_loop);
                    self.block(reject, in_loop);
                }
                Statement::Switch { selector, cases } => {
                    if self.depends(*selector) == Depends::Uniform {
                        self.found.push("a switch".into());
                    }
                    cases.iter().for_each(|case| self.block(&case.body, false));
                }
                Statement::Block(inner) => self.block(inner, in_loop),
                Statement::Loop { body, continuing, .. } => {
                    self.block(body, true);
                    self.block(continuing, false);
                }
                Statement::Call { function, arguments, .. } => {
                    let passed: Vec<_> = arguments.iter().map(|&argument| self.depends(argument)).collect();
                    let known = &mut self.arguments[function.index()];
                    if known.len() == arguments.len() {
                        known.iter_mut().zip(passed).for_each(|(known, new)| *known = new.max(*known));
                    } else {
                        *known = passed;
                    }
                }
                _ => {}
            }
        }
    }

    /// Whether a condition compares something with what uniforms alone say.
    fn bounded(&self, condition: Handle<Expression>) -> bool {
        match self.function.expressions[condition] {
            Expression::Binary { left, right, .. } => {
                [left, right].iter().any(|&side| self.depends(side) == Depends::Uniform)
            }
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::uniform_branches;

    #[test]
    fn branches_on_uniforms_are_found_and_no_others() {
        let found = |body: &str| {
            let source = format!(
                "struct Few {{ count: u32, bright: f32 }}
                 @group(0) @binding(0) var<uniform> few: Few;
                 override MANY: u32 = 3u;
                 fn sum(n: u32) -> f32 {{
                     var s = 0.0;
                     for (var i = 0u; i < n; i++) {{ s += f32(i); }}
                     return s;
                 }}
                 @fragment fn fs(@builtin(position) at: vec4f) -> @location(0) vec4f {{
                     var value = 0.0;
                     {body}
                     return vec4f(value);
                 }}"
            );
            uniform_branches(&source).unwrap()
        };
        assert_eq!(found("if few.bright * 2.0 > 1.0 { value = 1.0; }"), ["fs: fs: a branch"]);
        assert_eq!(found("switch few.count { case 1u: { value = 1.0; } default: {} }"), ["fs: fs: a switch"]);
        assert_eq!(found("value = sum(few.count);"), ["fs: sum: the end of a loop"]);
        let fine = [
            "value = sum(MANY);",
            "value = sum(few.count) + sum(u32(at.x));",
            "value = sum(select(0u, few.count, at.x > 1.0));",
            "if MANY == 3u { value = few.bright; }",
            "if at.x > few.bright { value = 1.0; }",
            "value = select(0.0, 1.0, few.bright > 1.0);",
        ];
        for body in fine {
            assert_eq!(found(body), [""; 0], "{body}");
        }
    }
}

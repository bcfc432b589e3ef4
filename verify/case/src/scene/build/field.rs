//! Fields of a case file as formulas.
#![allow(non_snake_case)]

use crate::scene::build::builder::Builder;
use crate::scene::format::FormulaFormat;
use exmex::{Express, FlatEx, FloatOpsFactory, MatchLiteral};
use mtled::algebra::tensor::Vector3;
use mtled::geometry::Field;

/// Letters at most in a formula, whose parser is recursive.
const LONGEST: usize = 1000;

/// Numbers as in a case file: `2`, `0.5`, `.5`, `1e-3`, which formulas do not know by default.
#[derive(Debug, Clone)]
struct Numbers;

impl MatchLiteral for Numbers {
    fn is_literal(text: &str) -> Option<&str> {
        let digits = |from: usize| {
            text.as_bytes()[from..].iter().take_while(|byte| byte.is_ascii_digit()).count()
        };
        let whole = digits(0);
        let mut end = whole;
        let mut count = whole;
        if text[end..].starts_with('.') {
            let fraction = digits(end + 1);
            (count, end) = (count + fraction, end + 1 + fraction);
        }
        if count == 0 {
            return None;
        }
        if text[end..].starts_with(['e', 'E']) {
            let sign = usize::from(text[end + 1..].starts_with(['+', '-']));
            let exponent = digits(end + 1 + sign);
            end += if exponent > 0 { 1 + sign + exponent } else { 0 };
        }
        Some(&text[..end])
    }
}

type Expression = FlatEx<f64, FloatOpsFactory<f64>, Numbers>;

/// A formula, and for each of its variables in turn which coordinate it is.
struct Formula {
    expression: Expression,
    axes: Vec<usize>,
}

impl Formula {
    fn parse(text: &str) -> Result<Formula, String> {
        if text.len() > LONGEST {
            return Err(format!("has {} letters; at most {LONGEST} are allowed", text.len()));
        }
        let expression = Expression::parse(&with_signs(text)?)
            .map_err(|error| format!("`{text}` is not a formula: {error}"))?;
        let axis = |name: &String| match name.as_str() {
            "x" => Ok(0),
            "y" => Ok(1),
            "z" => Ok(2),
            _ => Err(format!("`{name}` is not known here; a formula depends on x, y and z")),
        };
        let axes = expression.var_names().iter().map(axis).collect::<Result<_, _>>()?;
        Ok(Formula { expression, axes })
    }

    /// The value at a position \[m\]; NaN where there is none.
    fn at(&self, X: &Vector3) -> f64 {
        let coordinates: Vec<f64> = self.axes.iter().map(|&axis| X[axis]).collect();
        self.expression.eval(&coordinates).unwrap_or(f64::NAN)
    }
}

/// A formula in which a sign is a difference from 0: the parser takes −x² for (−x)². Refused
/// are signs behind other operators, and powers of powers without parentheses, which it takes
/// from left to right.
fn with_signs(text: &str) -> Result<String, String> {
    let mut result = String::new();
    let mut last = '(';
    // Whether a power has been met since the last operator of lower rank, by depth.
    let mut power = vec![false];
    for letter in text.chars() {
        let is_sign = matches!(letter, '+' | '-');
        if is_sign && last == '(' {
            result.push('0');
        } else if is_sign && matches!(last, '+' | '-' | '*' | '/') {
            return Err(format!("has the sign `{letter}` behind `{last}`; put it in parentheses"));
        }
        let depth = power.len() - 1;
        match letter {
            '(' => power.push(false),
            ')' if depth > 0 => _ = power.pop(),
            '^' if power[depth] => {
                return Err("has a power of a power; put one in parentheses".to_string());
            }
            '^' => power[depth] = true,
            // Also the sign of a number such as 1e-3, which ends no power that matters.
            '+' | '-' | '*' | '/' if last != '^' => power[depth] = false,
            _ => {}
        }
        result.push(letter);
        if !letter.is_whitespace() {
            last = letter;
        }
    }
    Ok(result)
}

impl Builder<'_> {
    /// A field by formulas, or `None` and a mistake.
    pub(crate) fn formula(&mut self, key: &str, format: &FormulaFormat) -> Option<Field> {
        if self.is_plane() && format.z.is_some() {
            let message = "there is no motion along z in plane strain; remove it";
            self.mistake(&format!("{key}.z"), message);
        }
        if !self.is_plane() && format.z.is_none() {
            self.mistake(&format!("{key}.z"), "is missing; a formula gives all of x, y and z");
        }
        let texts = [("x", Some(&format.x)), ("y", Some(&format.y)), ("z", format.z.as_ref())];
        let mut formulas = Vec::new();
        for (name, text) in texts.into_iter().filter_map(|(name, text)| Some((name, text?))) {
            match Formula::parse(text) {
                Ok(formula) => formulas.push(formula),
                Err(message) => self.mistake(&format!("{key}.{name}"), message),
            }
        }
        if formulas.len() < if self.is_plane() { 2 } else { 3 } {
            return None;
        }
        let factor = format.factor;
        Some(Field::of(move |X| {
            let mut value = Vector3::zeros();
            for (component, formula) in value.iter_mut().zip(&formulas) {
                *component = factor * formula.at(X);
            }
            value
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_those_of_textbooks() {
        let at = |text: &str| Formula::parse(text).unwrap().at(&Vector3::new(2.0, 3.0, 0.5));
        for (text, value) in [
            ("0.01*x", 0.02),
            ("x + y*z^2 - 1", 1.75),
            ("2^-1 * (x - y)", -0.5),
            ("0 - x^2", -4.0),
            ("-x^2 + (-x^2)", -8.0),
            ("x^(-2) + y^2 * x^2", 36.25),
            ("2*(x^y)^2", 128.0),
            ("sin(PI*z)", 1.0),
            ("sqrt(x*8) / exp(0)", 4.0),
            ("1e-3*z", 5e-4),
            ("2.5E+1 - .5*y", 23.5),
            ("-y + x", -1.0),
            ("0", 0.0),
        ] {
            assert!((at(text) - value).abs() < 1e-15, "{text}: {}", at(text));
        }
        assert!(at("ln(0 - x)").is_nan());
    }

    #[test]
    fn what_is_no_formula_is_refused_with_the_reason() {
        let refusal = |text: &str| Formula::parse(text).err().unwrap();
        assert!(refusal("0.1*r").contains("`r` is not known here"));
        assert!(refusal("0.1*(x").contains("is not a formula"));
        assert!(refusal("2*-x^2").contains("the sign `-` behind `*`"));
        assert!(refusal("2^x^3").contains("a power of a power"));
        assert!(refusal("").contains("is not a formula"));
        assert!(refusal(&"x+".repeat(600)).contains("at most 1000"));
    }
}

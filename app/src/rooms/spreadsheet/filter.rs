//! The filter of the spreadsheet: `length < 2 and section == "front"`.
//!
//! Words are columns; what a row does not have is NaN and fails every comparison but `!=`. Text of any kind is read or
//! refused with a reason; nesting and length are bounded, and a filter takes time linear in its length for each row.

/// The longest expression.
const LONGEST: usize = 2_000;
/// The deepest nesting.
const DEEPEST: usize = 64;

/// A filter that was understood.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Filter {
    root: Test,
    /// The columns that it asks for, each once.
    names: Vec<String>,
}

/// What a row has in a column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FilterValue {
    /// A number.
    Number(f64),
    /// Words, compared as they are.
    Text(String),
}

#[derive(Clone, Debug, PartialEq)]
enum Test {
    And(Vec<Test>),
    Or(Vec<Test>),
    Not(Box<Test>),
    Compare(Term, Sign, Term),
    /// A number alone: other than zero.
    True(Term),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Sign {
    Less,
    LessOrSame,
    More,
    MoreOrSame,
    Same,
    Other,
}

#[derive(Clone, Debug, PartialEq)]
enum Term {
    Number(f64),
    Text(String),
    /// Number of the name in [`Filter::names`].
    Column(usize),
    Negative(Box<Term>),
    /// Left, sign, right.
    Sum(Box<Term>, char, Box<Term>),
}

impl Filter {
    /// Reads an expression. The error says what is wrong, without a full stop.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        if text.len() > LONGEST {
            return Err("the filter is too long".to_owned());
        }
        let mut parser = Parser { rest: text.trim(), names: vec![], depth: 0 };
        let root = parser.or()?;
        if !parser.rest.is_empty() {
            return Err(format!("{:?} was not expected", parser.here()));
        }
        Ok(Self { root, names: parser.names })
    }

    /// The columns that it asks for.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// Whether a row passes, where `cell(i)` is what it has in the column `names()[i]`.
    pub(crate) fn passes(&self, cell: &dyn Fn(usize) -> FilterValue) -> bool {
        self.root.holds(cell)
    }
}

impl Test {
    fn holds(&self, cell: &dyn Fn(usize) -> FilterValue) -> bool {
        match self {
            Test::And(all) => all.iter().all(|test| test.holds(cell)),
            Test::Or(any) => any.iter().any(|test| test.holds(cell)),
            Test::Not(test) => !test.holds(cell),
            Test::True(term) => match term.value(cell) {
                FilterValue::Number(x) => x != 0.0 && !x.is_nan(),
                FilterValue::Text(text) => !text.is_empty(),
            },
            Test::Compare(a, sign, b) => match (a.value(cell), b.value(cell)) {
                (FilterValue::Number(a), FilterValue::Number(b)) => match sign {
                    Sign::Less => a < b,
                    Sign::LessOrSame => a <= b,
                    Sign::More => a > b,
                    Sign::MoreOrSame => a >= b,
                    Sign::Same => a == b,
                    Sign::Other => a != b,
                },
                (FilterValue::Text(a), FilterValue::Text(b)) => match sign {
                    Sign::Less => a < b,
                    Sign::LessOrSame => a <= b,
                    Sign::More => a > b,
                    Sign::MoreOrSame => a >= b,
                    Sign::Same => a == b,
                    Sign::Other => a != b,
                },
                _ => *sign == Sign::Other,
            },
        }
    }
}

impl Term {
    fn value(&self, cell: &dyn Fn(usize) -> FilterValue) -> FilterValue {
        let number = |term: &Term| match term.value(cell) {
            FilterValue::Number(x) => x,
            FilterValue::Text(_) => f64::NAN,
        };
        match self {
            Term::Number(x) => FilterValue::Number(*x),
            Term::Text(text) => FilterValue::Text(text.clone()),
            Term::Column(i) => cell(*i),
            Term::Negative(term) => FilterValue::Number(-number(term)),
            Term::Sum(a, sign, b) => {
                let (a, b) = (number(a), number(b));
                FilterValue::Number(match sign {
                    '+' => a + b,
                    '-' => a - b,
                    '*' => a * b,
                    '/' => a / b,
                    _ => a % b,
                })
            }
        }
    }
}

struct Parser<'a> {
    /// What is left, without spaces at its start.
    rest: &'a str,
    names: Vec<String>,
    depth: usize,
}

impl Parser<'_> {
    fn here(&self) -> String {
        self.rest.chars().take(20).collect()
    }

    fn sign(&mut self, sign: &str) -> bool {
        let found = self.rest.strip_prefix(sign);
        if let Some(rest) = found {
            self.rest = rest.trim_start();
        }
        found.is_some()
    }

    fn keyword(&mut self, word: &str) -> bool {
        let found = self
            .rest
            .strip_prefix(word)
            .filter(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'));
        if let Some(rest) = found {
            self.rest = rest.trim_start();
        }
        found.is_some()
    }

    fn or(&mut self) -> Result<Test, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err("brackets are nested too deep".to_owned());
        }
        let mut any = vec![self.and()?];
        while self.keyword("or") || self.sign("||") {
            any.push(self.and()?);
        }
        self.depth -= 1;
        Ok(if any.len() == 1 { any.remove(0) } else { Test::Or(any) })
    }

    fn and(&mut self) -> Result<Test, String> {
        let mut all = vec![self.test()?];
        while self.keyword("and") || self.sign("&&") {
            all.push(self.test()?);
        }
        Ok(if all.len() == 1 { all.remove(0) } else { Test::And(all) })
    }

    fn test(&mut self) -> Result<Test, String> {
        if self.keyword("not") || (!self.rest.starts_with("!=") && self.sign("!")) {
            self.depth += 1;
            if self.depth > DEEPEST {
                return Err("brackets are nested too deep".to_owned());
            }
            let test = self.test()?;
            self.depth -= 1;
            return Ok(Test::Not(test.into()));
        }
        // A bracket may hold a condition or a number: what follows it tells.
        let (before, names) = (self.rest, self.names.len());
        let depth = self.depth;
        if self.sign("(")
            && let Ok(test) = self.or()
            && self.sign(")")
            && !self.rest.starts_with(['<', '>', '=', '+', '-', '*', '/', '%'])
            && !self.rest.starts_with("!=")
        {
            return Ok(test);
        }
        (self.rest, self.depth) = (before, depth);
        self.names.truncate(names);
        let left = self.term()?;
        for (text, sign) in [
            ("<=", Sign::LessOrSame),
            (">=", Sign::MoreOrSame),
            ("==", Sign::Same),
            ("!=", Sign::Other),
            ("<", Sign::Less),
            (">", Sign::More),
            ("=", Sign::Same),
        ] {
            if self.sign(text) {
                return Ok(Test::Compare(left, sign, self.term()?));
            }
        }
        Ok(Test::True(left))
    }

    fn term(&mut self) -> Result<Term, String> {
        self.chain(&['+', '-'], |parser| parser.chain(&['*', '/', '%'], Self::factor))
    }

    fn chain(
        &mut self,
        signs: &[char],
        part: impl Fn(&mut Self) -> Result<Term, String>,
    ) -> Result<Term, String> {
        let mut sum = part(self)?;
        let mut parts = 0;
        while let Some(sign) = self.rest.chars().next().filter(|c| signs.contains(c)) {
            parts += 1;
            if parts > DEEPEST {
                return Err("the sum is too long".to_owned());
            }
            self.rest = self.rest[1..].trim_start();
            sum = Term::Sum(sum.into(), sign, part(self)?.into());
        }
        Ok(sum)
    }

    fn factor(&mut self) -> Result<Term, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err("brackets are nested too deep".to_owned());
        }
        let term = self.bare_factor();
        self.depth -= 1;
        term
    }

    fn bare_factor(&mut self) -> Result<Term, String> {
        if self.sign("-") {
            return Ok(Term::Negative(self.factor()?.into()));
        }
        if self.sign("(") {
            let term = self.term()?;
            return if self.sign(")") {
                Ok(term)
            } else {
                Err("a closing bracket is missing".to_owned())
            };
        }
        let text = self.rest;
        if let Some(quoted) = text.strip_prefix(['"', '\'']) {
            let end = quoted.find(&text[..1]).ok_or("a closing quote is missing")?;
            self.rest = quoted[end + 1..].trim_start();
            return Ok(Term::Text(quoted[..end].to_owned()));
        }
        let word_end = text
            .find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '.'))
            .unwrap_or(text.len());
        if text.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
            // 1e-3: the sign is part of the number.
            let mut end = word_end;
            if text[..end].ends_with(['e', 'E']) && text[end..].starts_with(['+', '-']) {
                let tail = &text[end + 1..];
                end += 1 + tail.find(|c: char| !c.is_ascii_digit()).unwrap_or(tail.len());
            }
            let number = &text[..end];
            // Ids are shown in hexadecimal and can be asked for so.
            let x = match number.strip_prefix("0x") {
                Some(digits) => u64::from_str_radix(digits, 16).ok().map(|id| id as f64),
                None => number.parse().ok(),
            };
            self.rest = text[end..].trim_start();
            return x.map(Term::Number).ok_or_else(|| {
                format!("{} is no number", number.chars().take(20).collect::<String>())
            });
        }
        if word_end == 0 {
            return Err(match text {
                "" => "something is missing at the end".to_owned(),
                _ => format!("{:?} was not expected", self.here()),
            });
        }
        let word = &text[..word_end];
        self.rest = text[word_end..].trim_start();
        if ["and", "or", "not"].contains(&word) {
            return Err(format!("a condition is missing beside {word:?}"));
        }
        let at = self.names.iter().position(|name| name == word).unwrap_or_else(|| {
            self.names.push(word.to_owned());
            self.names.len() - 1
        });
        Ok(Term::Column(at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether the row length 2, points 12, section "front", width NaN passes.
    fn passes(text: &str) -> bool {
        let filter = Filter::read(text).unwrap_or_else(|why| panic!("{text}: {why}"));
        filter.passes(&|i| match filter.names()[i].as_str() {
            "length" => FilterValue::Number(2.0),
            "points" => FilterValue::Number(12.0),
            "section" => FilterValue::Text("front".to_owned()),
            "colour.x" => FilterValue::Number(0.5),
            _ => FilterValue::Number(f64::NAN),
        })
    }

    #[test]
    fn rows_pass_as_the_expression_says() {
        for (text, want) in [
            ("length < 2", false),
            ("length <= 2", true),
            ("length < 3 and section == \"front\"", true),
            ("length < 3 and section == 'back'", false),
            ("length > 3 or points >= 12", true),
            ("length > 3 or points > 12 and true_words", false),
            ("not (length > 3)", true),
            ("!(length > 3) && points = 12", true),
            ("(length + 1) * 2 == 6", true),
            ("length * 2 + 1 == 5", true),
            ("points / length == 6", true),
            ("points % 5 == 2", true),
            ("-length < -1", true),
            ("(length > 1 or points > 90) and (points < 20)", true),
            ("length", true),
            ("length - 2", false),
            ("width > 0", false),
            ("width < 0", false),
            ("width != width", true),
            ("section != 3", true),
            ("section > 3", false),
            ("colour.x >= .5", true),
            ("length > 1e-3", true),
            ("points == 0xc", true),
            ("android == 3", false),
        ] {
            assert_eq!(passes(text), want, "{text}");
        }
    }

    #[test]
    fn what_is_no_filter_says_why() {
        let deep = "(".repeat(1000);
        let long = "1+".repeat(900) + "1";
        for (text, why) in [
            ("", "something is missing at the end"),
            ("length <", "something is missing at the end"),
            ("length < 2 and", "something is missing at the end"),
            ("length ? 2", "\"? 2\" was not expected"),
            ("and length", "a condition is missing beside \"and\""),
            ("section == \"front", "a closing quote is missing"),
            ("(length < 2", "a closing bracket is missing"),
            ("1.2.3 < 4", "1.2.3 is no number"),
            (&deep, "brackets are nested too deep"),
            (&long, "the sum is too long"),
        ] {
            assert_eq!(Filter::read(text).unwrap_err(), why, "{text}");
        }
    }

    #[test]
    fn any_text_is_read_or_refused_quickly() {
        let parts = [
            "length", " and ", " or ", "not ", "(", ")", "<", "==", "1", "\"a\"", "-", "é", "!",
            "'",
        ];
        let mut seed = 9u64;
        for _ in 0..20_000 {
            let mut text = String::new();
            for _ in 0..20 {
                seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                text.push_str(parts[(seed >> 33) as usize % parts.len()]);
            }
            if let Ok(filter) = Filter::read(&text) {
                filter.passes(&|_| FilterValue::Number(1.0));
            }
        }
    }
}

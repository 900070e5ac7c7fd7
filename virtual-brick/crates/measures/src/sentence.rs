// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! Expectations in words, one sentence each; the grammar is in `docs/reference/trace.md`.

use crate::units::{signal_unit, unit};

/// Measures that a sentence may bound.
const MEASURES: [&str; 7] = [
    "cpu_utilization",
    "deadline_misses",
    "distance",
    "lateral_deviation",
    "overshoot",
    "settling_time",
    "steady_state_error",
];
const FORMS: &str =
    "<signal> [ever] between 8 and 9 rad/s [from 3 s to 9 s], <signal> at least 2 m \
    at the end, pin 17 [ever] high [after 2 s], lcd [never] shows \"text\" [at 5 s], deadlines met \
    [for <task>], response time of <task> at most 2 ms, path ends within 10 cm of (3.2, 0.4), \
    powered off [before 20 s], no fault, a fault [saying \"text\"]";
const LENGTHS: [&str; 3] = ["mm", "cm", "m"];
const TIMES: [&str; 2] = ["ms", "s"];
const SHORT_TIMES: [&str; 4] = ["ms", "us", "µs", "s"];

/// A part of a run, in s; none where nothing was named.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Window {
    /// Begin.
    pub begin: Option<f64>,
    /// End; may be the begin.
    pub end: Option<f64>,
    /// Only the end of the run.
    pub at_end: bool,
}

impl Window {
    /// The latest instant that was named; 0 when there is none.
    #[must_use]
    pub fn last_named(self) -> f64 {
        self.begin.unwrap_or(0.0).max(self.end.unwrap_or(0.0))
    }
}

/// Limits in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower limit.
    pub minimum: Option<f64>,
    /// Upper limit.
    pub maximum: Option<f64>,
}

impl Bounds {
    /// Whether a value lies inside.
    #[must_use]
    pub fn contain(self, value: f64) -> bool {
        self.minimum.is_none_or(|minimum| value >= minimum)
            && self.maximum.is_none_or(|maximum| value <= maximum)
    }
}

/// What is expected.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum Expected {
    /// A signal stays within bounds throughout the window, or is at least once (`ever`).
    Signal {
        signal: String,
        bounds: Bounds,
        unit: Option<String>,
        ever: bool,
    },
    /// A measure of the whole run lies within bounds.
    Measure { measure: String, bounds: Bounds },
    /// A line of the display contains a text at some time in the window, or (`never`) at none.
    Lcd { wanted: String, never: bool },
    /// No job of a task, or of any task, misses its deadline.
    Deadlines { task: Option<String> },
    /// The longest response time of a task is at most `limit` (s).
    Response { task: String, limit: f64 },
    /// The vehicle ends within a circle; m.
    PathEnd { x: f64, y: f64, radius: f64 },
    /// The program switches the brick off, within the window.
    PoweredOff,
    /// The program survives, or (`wanted`) stops with a fault that says `saying`.
    Fault { wanted: bool, saying: String },
}

/// One sentence.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// As it was written, with single blanks.
    pub text: String,
    /// What is looked at.
    pub window: Window,
    /// What is expected.
    pub expected: Expected,
}

impl Expectation {
    /// Read one sentence.
    ///
    /// # Errors
    /// The sentence says what is wrong with it, or what the forms are.
    pub fn parse(text: &str) -> Result<Self, String> {
        let text = single_blanks(text);
        let (sentence, window) = split_window(&text)?;
        let forms = [pin, lcd, deadlines, response, path, fault, power, signal];
        for form in forms {
            if let Some((expected, whole)) = form(sentence).transpose()? {
                if let Some(what) = whole.filter(|_| window != Window::default()) {
                    return Err(format!("'{what}' is of the whole run; leave the time out"));
                }
                return Ok(Self {
                    window,
                    expected,
                    text: text.clone(),
                });
            }
        }
        Err(format!(
            "'{text}' is not an expectation; the forms are: {FORMS}"
        ))
    }

    /// The pin that is spoken of: 0 to 31.
    #[must_use]
    pub fn pin(&self) -> Option<u32> {
        let Expected::Signal { signal, .. } = &self.expected else {
            return None;
        };
        let written = signal.strip_prefix("pin.")?;
        let number: u32 = written.parse().ok()?;
        (number < 32 && number.to_string() == written).then_some(number)
    }
}

/// What a form gives: nothing where the sentence has another; the second is the name of what is of
/// the whole run.
type Form<'a> = Option<Result<(Expected, Option<&'a str>), String>>;

/// One blank between words, but texts in quotes as they are.
fn single_blanks(text: &str) -> String {
    let pieces: Vec<&str> = text.trim().split('"').collect();
    let mut plain = String::new();
    for (index, piece) in pieces.iter().enumerate() {
        if index > 0 {
            plain.push('"');
        }
        let quoted = index % 2 == 1 && index + 1 < pieces.len();
        let mut blank = false;
        for letter in piece.chars() {
            if quoted || !letter.is_whitespace() {
                plain.push(letter);
            } else if !blank {
                plain.push(' ');
            }
            blank = letter.is_whitespace();
        }
    }
    plain
}

/// A number at the beginning, as it is written, and what follows.
fn number(text: &str) -> Option<(&str, &str)> {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let sign = usize::from(text.starts_with(['+', '-']));
    let whole = digits(sign);
    let mut end = sign + whole;
    if text[end..].starts_with('.') {
        let fraction = digits(end + 1);
        if whole + fraction == 0 {
            return None;
        }
        end += 1 + fraction;
    } else if whole == 0 {
        return None;
    }
    if text[end..].starts_with(['e', 'E']) {
        let signed = end + 1 + usize::from(text[end + 1..].starts_with(['+', '-']));
        let exponent = digits(signed);
        if exponent > 0 {
            end = signed + exponent;
        }
    }
    Some(text.split_at(end))
}

/// The value of a number that `number` found.
fn value(written: &str) -> f64 {
    written.parse().unwrap_or(f64::NAN)
}

fn blank(text: &str) -> &str {
    text.strip_prefix(' ').unwrap_or(text)
}

/// A number with one of the units in SI, and what follows.
fn quantity<'a>(text: &'a str, units: &[&str]) -> Option<(f64, &'a str)> {
    let (written, rest) = number(text)?;
    let rest = blank(rest);
    let (name, rest) = units
        .iter()
        .find_map(|name| Some((name, rest.strip_prefix(name)?)))?;
    Some((value(written) * unit(name)?.1, rest))
}

fn only<T>((found, rest): (T, &str)) -> Option<T> {
    rest.is_empty().then_some(found)
}

fn time(text: &str) -> Option<f64> {
    quantity(text, &TIMES).and_then(only)
}

/// The sentence without its window, and the window.
fn split_window(text: &str) -> Result<(&str, Window), String> {
    let begins = std::iter::once((0, 0)).chain(text.match_indices(' ').map(|(at, _)| (at, at + 1)));
    for (end, begin) in begins {
        let phrase = &text[begin..];
        if let Some(window) = window(phrase) {
            if matches!((window.begin, window.end), (Some(b), Some(e)) if e <= b)
                && phrase.starts_with("from ")
            {
                return Err(format!("'{phrase}' is empty; name the earlier time first"));
            }
            return Ok((&text[..end], window));
        }
    }
    Ok((text, Window::default()))
}

fn window(phrase: &str) -> Option<Window> {
    let (word, rest) = phrase.split_once(' ')?;
    let (begin, end, at_end) = match word {
        "from" => {
            let (begin, rest) = quantity(rest, &TIMES)?;
            (Some(begin), Some(time(rest.strip_prefix(" to ")?)?), false)
        }
        "at" if rest == "the end" => (None, None, true),
        "at" => (Some(time(rest)?), Some(time(rest)?), false),
        "after" => (Some(time(rest)?), None, false),
        "before" => (None, Some(time(rest)?), false),
        _ => return None,
    };
    Some(Window { begin, end, at_end })
}

fn is_word(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || c == '_')
}

fn quoted(text: &str) -> Option<&str> {
    let inner = text.strip_prefix('"')?.strip_suffix('"')?;
    (!inner.is_empty() && !inner.contains('"')).then_some(inner)
}

fn pin(text: &str) -> Form<'_> {
    let (written, rest) = text.strip_prefix("pin ")?.split_once(' ')?;
    let number: u32 = written.parse().ok()?;
    if number > 31 || number.to_string() != written {
        return None;
    }
    let (ever, level) = match rest.strip_prefix("ever ") {
        Some(level) => (true, level),
        None => (false, rest),
    };
    let (minimum, maximum) = match level {
        "high" => (Some(0.5), None),
        "low" => (None, Some(0.5)),
        _ => return None,
    };
    let expected = Expected::Signal {
        signal: format!("pin.{written}"),
        bounds: Bounds { minimum, maximum },
        unit: None,
        ever,
    };
    Some(Ok((expected, None)))
}

fn lcd(text: &str) -> Form<'_> {
    let rest = text.strip_prefix("lcd ")?;
    let (never, rest) = match rest.strip_prefix("never ") {
        Some(rest) => (true, rest),
        None => (false, rest),
    };
    let wanted = quoted(rest.strip_prefix("shows ")?)?.to_owned();
    Some(Ok((Expected::Lcd { wanted, never }, None)))
}

fn deadlines(text: &str) -> Form<'_> {
    let rest = text.strip_prefix("deadlines met")?;
    let task = match rest.strip_prefix(" for ") {
        Some(task) if is_word(task) => Some(task.to_owned()),
        None if rest.is_empty() => None,
        _ => return None,
    };
    Some(Ok((Expected::Deadlines { task }, Some("deadlines met"))))
}

fn response(text: &str) -> Form<'_> {
    let (task, rest) = text.strip_prefix("response time of ")?.split_once(' ')?;
    let limit = quantity(rest.strip_prefix("at most ")?, &SHORT_TIMES).and_then(only)?;
    let task = is_word(task).then(|| task.to_owned())?;
    Some(Ok((
        Expected::Response { task, limit },
        Some("response time"),
    )))
}

fn path(text: &str) -> Form<'_> {
    let (radius, rest) = quantity(text.strip_prefix("path ends within ")?, &LENGTHS)?;
    let (x, rest) = number(blank(rest.strip_prefix(" of (")?))?;
    let (y, rest) = number(blank(blank(rest).strip_prefix(',')?))?;
    let rest = blank(blank(rest).strip_prefix(')')?);
    let ends_with_blank = rest.is_empty() && text.ends_with(' ');
    let written = if rest.is_empty() { "m" } else { rest };
    if ends_with_blank || !LENGTHS.contains(&written) {
        return None;
    }
    let size = unit(written)?.1;
    let (x, y) = (value(x) * size, value(y) * size);
    Some(Ok((Expected::PathEnd { x, y, radius }, Some("path ends"))))
}

fn fault(text: &str) -> Form<'_> {
    let (wanted, rest) = match text.strip_prefix("a fault") {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix("no fault")?),
    };
    let saying = match rest.strip_prefix(" saying ") {
        Some(rest) => quoted(rest)?.to_owned(),
        None if rest.is_empty() => String::new(),
        None => return None,
    };
    if !wanted && !saying.is_empty() {
        return Some(Err("no fault says nothing; leave 'saying' out".to_owned()));
    }
    Some(Ok((Expected::Fault { wanted, saying }, Some("fault"))))
}

fn power(text: &str) -> Form<'_> {
    (text == "powered off").then_some(Ok((Expected::PoweredOff, None)))
}

/// What a bound says: its numbers as written, and the unit.
struct Written<'a> {
    minimum: Option<&'a str>,
    maximum: Option<&'a str>,
    unit: Option<&'a str>,
}

fn bound(text: &str) -> Option<Written<'_>> {
    let (minimum, maximum, rest) = if let Some(rest) = text.strip_prefix("between ") {
        let (minimum, rest) = number(rest)?;
        let (maximum, rest) = number(rest.strip_prefix(" and ")?)?;
        (Some(minimum), Some(maximum), rest)
    } else if let Some(rest) = text.strip_prefix("at least ") {
        let (minimum, rest) = number(rest)?;
        (Some(minimum), None, rest)
    } else {
        let (maximum, rest) = number(text.strip_prefix("at most ")?)?;
        (None, Some(maximum), rest)
    };
    let written = blank(rest);
    if written.is_empty() && !rest.is_empty() || !written.is_empty() && unit(written).is_none() {
        return None;
    }
    Some(Written {
        minimum,
        maximum,
        unit: (!written.is_empty()).then_some(written),
    })
}

fn signal(text: &str) -> Form<'_> {
    let (name, rest) = text.split_once(' ')?;
    let starts_well = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    if !starts_well
        || !name
            .chars()
            .all(|c| c.is_alphanumeric() || c == '_' || c == '.')
    {
        return None;
    }
    let (ever, rest) = match rest.strip_prefix("ever ") {
        Some(rest) => (true, rest),
        None => (false, rest),
    };
    let written = bound(rest)?;
    if MEASURES.contains(&name) {
        let size = written.unit.and_then(unit).map_or(1.0, |(_, size)| size);
        let measure = name.to_owned();
        let measured = bounds(&written, size).map(|bounds| Expected::Measure { measure, bounds });
        return Some(measured.map(|expected| (expected, Some(name))));
    }
    let limited = size_in(name, written.unit).and_then(|size| bounds(&written, size));
    Some(limited.map(|bounds| {
        let expected = Expected::Signal {
            signal: name.to_owned(),
            bounds,
            unit: written.unit.map(str::to_owned),
            ever,
        };
        (expected, None)
    }))
}

/// Size of the written unit in the unit of the signal.
fn size_in(signal: &str, written: Option<&str>) -> Result<f64, String> {
    let Some((name, (wanted, size))) = written.and_then(|name| Some((name, unit(name)?))) else {
        return Ok(1.0);
    };
    let known = signal_unit(signal);
    if known != wanted && !(signal.starts_with("probe.") && size == 1.0) {
        let or = |other| if known.is_empty() { other } else { known };
        return Err(format!(
            "'{signal}' is in {}, not {name}; write the bound in {}",
            or("no unit"),
            or("plain numbers")
        ));
    }
    Ok(size)
}

fn bounds(written: &Written<'_>, size: f64) -> Result<Bounds, String> {
    let [minimum, maximum] =
        [written.minimum, written.maximum].map(|bound| bound.map(|number| value(number) * size));
    match (written.minimum, written.maximum) {
        (Some(low), Some(high)) if minimum > maximum => Err(format!(
            "nothing lies between {low} and {high}; the smaller bound comes first"
        )),
        _ => Ok(Bounds { minimum, maximum }),
    }
}

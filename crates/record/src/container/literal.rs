//! Parsing of the Python literals in the headers of NumPy's files.

/// A literal: texts, whole numbers, truth values, sequences and dictionaries.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Literal {
    Text(String),
    Number(usize),
    Truth(bool),
    /// A tuple or a list.
    Sequence(Vec<Literal>),
    Dictionary(Vec<(String, Literal)>),
}

/// Deepest nesting; NumPy's headers need four levels.
const DEEPEST: usize = 20;

impl Literal {
    /// Parses a text that is one literal, with blanks around it.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let mut rest = text;
        let literal = value(&mut rest, DEEPEST)?;
        rest.trim().is_empty().then_some(literal)
    }

    /// Returns the entry of a dictionary.
    pub(super) fn get(&self, key: &str) -> Option<&Self> {
        let Self::Dictionary(entries) = self else { return None };
        entries.iter().find(|(own, _)| own == key).map(|(_, value)| value)
    }

    /// Returns the numbers of a sequence of numbers, or a single number as one.
    pub(super) fn numbers(&self) -> Option<Vec<usize>> {
        match self {
            Self::Number(number) => Some(vec![*number]),
            Self::Sequence(items) => items
                .iter()
                .map(|item| if let Self::Number(number) = item { Some(*number) } else { None })
                .collect(),
            _ => None,
        }
    }
}

fn value(rest: &mut &str, depth: usize) -> Option<Literal> {
    let depth = depth.checked_sub(1)?;
    *rest = rest.trim_start();
    if take(rest, "(") {
        return sequence(rest, ")", depth);
    }
    if take(rest, "[") {
        return sequence(rest, "]", depth);
    }
    if take(rest, "{") {
        return dictionary(rest, depth);
    }
    for (word, truth) in [("True", true), ("False", false)] {
        if take(rest, word) {
            return Some(Literal::Truth(truth));
        }
    }
    if rest.starts_with(|sign: char| sign.is_ascii_digit()) {
        let end = rest.find(|sign: char| !sign.is_ascii_digit()).unwrap_or(rest.len());
        let (digits, after) = rest.split_at(end);
        // NumPy for Python 2 wrote long integers: 100L.
        *rest = after.strip_prefix('L').unwrap_or(after);
        return digits.parse().ok().map(Literal::Number);
    }
    // Texts of Python 2 carry a letter in front.
    *rest = rest.trim_start_matches(['u', 'b']);
    let quote = ['\'', '"'].into_iter().find(|quote| rest.starts_with(*quote))?;
    text(rest, quote).map(Literal::Text)
}

/// Takes a text in quotes; a backslash makes the sign after it part of the text.
fn text(rest: &mut &str, quote: char) -> Option<String> {
    let (mut text, mut escaped) = (String::new(), false);
    for (at, sign) in rest.char_indices().skip(1) {
        match sign {
            _ if escaped => {
                text.push(sign);
                escaped = false;
            }
            '\\' => escaped = true,
            _ if sign == quote => {
                *rest = rest.get(at + sign.len_utf8()..)?;
                return Some(text);
            }
            _ => text.push(sign),
        }
    }
    None
}

fn sequence(rest: &mut &str, end: &str, depth: usize) -> Option<Literal> {
    let mut items = Vec::new();
    while !take(rest, end) {
        items.push(value(rest, depth)?);
        if !take(rest, ",") {
            return take(rest, end).then_some(Literal::Sequence(items));
        }
    }
    Some(Literal::Sequence(items))
}

fn dictionary(rest: &mut &str, depth: usize) -> Option<Literal> {
    let mut entries = Vec::new();
    while !take(rest, "}") {
        let Literal::Text(key) = value(rest, depth)? else { return None };
        if !take(rest, ":") {
            return None;
        }
        entries.push((key, value(rest, depth)?));
        if !take(rest, ",") {
            return take(rest, "}").then_some(Literal::Dictionary(entries));
        }
    }
    Some(Literal::Dictionary(entries))
}

/// Removes a sign or a word at the beginning, if it is there, with the blanks before it.
fn take(rest: &mut &str, word: &str) -> bool {
    match rest.trim_start().strip_prefix(word) {
        Some(after) => {
            *rest = after;
            true
        }
        None => false,
    }
}

#[cfg(test)]
mod tests {
    use super::Literal;

    #[test]
    fn the_headers_of_numpy_are_parsed() {
        let header =
            "{'descr': [('t', '<f8'), ('q\\'', '<f4', (3,))], 'fortran_order': False, 'shape': (7L, 2), }\n";
        let literal = Literal::parse(header).unwrap();
        assert_eq!(literal.get("shape").and_then(Literal::numbers), Some(vec![7, 2]));
        assert_eq!(literal.get("fortran_order"), Some(&Literal::Truth(false)));
        let Some(Literal::Sequence(fields)) = literal.get("descr") else { panic!("no fields") };
        let second = [Literal::Text("q'".to_owned()), Literal::Text("<f4".to_owned())];
        let Some(Literal::Sequence(parts)) = fields.get(1) else { panic!("no field") };
        assert_eq!(parts[..2], second);
        for wrong in ["{'a' 1}", "(1", "'a", "1 2", "{1: 2}", &"(".repeat(100_000), "99999999999999999999999"]
        {
            assert_eq!(Literal::parse(wrong), None, "{wrong:.20}");
        }
    }
}
